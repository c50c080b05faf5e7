# A tilted table is turned over, so that it stands on its top: what is said, reported, and written; any number of threads.
cat >table.obj <<'E2'
o leg
v 15 15 0
v 25 15 0
v 15 25 0
v 25 25 0
v 15 15 30
v 25 15 30
v 15 25 30
v 25 25 30
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
o top
v 0 0 30
v 40 0 30
v 0 40 30
v 40 40 30
v 0 0 34
v 40 0 34
v 0 40 34
v 40 40 34
f 9 11 12 10
f 13 14 16 15
f 9 10 14 13
f 11 15 16 12
f 9 13 15 11
f 10 12 16 14
E2
cubewright convert table.obj --orient-print auto --pivot base -o over.obj
cubewright convert over.obj --orient-print 60 -o over2.obj 2>&1 | grep stays
cubewright convert table.obj --rotate x:20,y:35 -o tilted.obj -q
cubewright convert tilted.obj --orient-print auto -o out.obj --json - -q |
    sed -n -e '/"orient_print"/,/"after"/p' -e '/"stable"/p' -e '/"kept"/p'
for t in 1 4; do cubewright convert tilted.obj --orient-print auto -o out.obj -t $t -q; mv out.obj t$t; done
cmp t1 t4 && echo "same"
for degrees in 0 90 half; do
    cubewright convert table.obj --orient-print $degrees -o out.obj -q
    echo "exit $?"
done

# The surface of a volume is turned as it is extracted, as it is from its file.
cubewright make torus -o torus.nrrd --dims 24 -q
cubewright extract torus.nrrd --iso 0 --crop 0:11,0:23,0:23 -o half.stl -q
cubewright convert half.stl --orient-print auto -o after.stl -q
cubewright extract torus.nrrd --iso 0 --crop 0:11,0:23,0:23 --orient-print auto -o at-once.stl --json j.json
grep -c '"orient_print"' j.json
cubewright check at-once.stl --reference after.stl | grep -c 'at most 0 mm from\|at most [0-9.]*e-0[5-9] mm from'
cubewright extract torus.nrrd --iso 0 --orient-print auto --lod 300,100 -o no.glb
echo "exit $?"
cubewright extract torus.nrrd --iso 0 --orient-print 95 -o no.stl
echo "exit $?"
