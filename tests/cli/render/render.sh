# A picture of the size asked for; an unknown camera names those there are.
cubewright make torus -o t.nrrd --dims 32 -q
cubewright render t.nrrd --iso 0 -o t.png --size 80x60 --camera top
od -A n -t u1 -j 16 -N 8 t.png
cubewright render t.nrrd --iso 0 -o u.png --camera sideways -q
echo $?
cubewright render t.nrrd --iso 99 -o u.png -q
echo $?
# A mesh needs no level, a volume's surface does; the same surface gives the same picture.
cubewright extract t.nrrd --iso 0 -o t.ply -q
cubewright render t.ply -o m.png --size 80x60 --camera top -q
cmp t.png m.png && echo "same picture"
cubewright render t.nrrd --mode mesh -o u.png
echo $?
cubewright render t.ply -o n.png --size 80x60 --camera top --mode mesh --backend cpu --color '#e6ded1' -q
cmp -s t.png n.png || echo "another colour"
# Rays of every mode end where their picture shows no difference any more.
cubewright render t.nrrd -o v.png --size 8x8 --mode vbuffer --json - -q | grep '"stop_opacity"'
cubewright render t.nrrd -o v.png --size 8x8 --mode reference --json - -q | grep '"stop_opacity"'
rm v.png
cubewright render t.ply -o 'm{turn}.png' --size 80x60 --turntable 2 --ortho --zoom 1.5 -q
ls
