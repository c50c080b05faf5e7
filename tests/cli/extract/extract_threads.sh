# The same bytes for any number of threads, in every command that makes some.
for t in 1 2 5; do
    mkdir $t
    (
        cd $t || exit
        cubewright make gyroid --noise 0.2 --dims 70x60x50 -o v.nrrd -t $t -q
        cubewright extract v.nrrd --iso 0 -o m.ply -t $t -q
        cubewright extract v.nrrd --iso 0 -o m.glb -t $t -q
        cubewright render v.nrrd --iso 0 -o p.png --size 160x120 -t $t -q
    )
done
for t in 2 5; do
    for f in v.nrrd m.ply m.glb p.png; do
        cmp 1/$f $t/$f
    done && echo same
done
