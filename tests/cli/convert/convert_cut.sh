# Cuts a mesh by a plane, part by part.
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 -o s.stl -q
cubewright convert s.stl -o up.stl --cut-plane z=0
cubewright convert s.stl -o down.obj --cut-plane=-z=25%
cubewright convert s.stl -o none.stl --cut-plane z=100mm
echo "$?"
cat >two.obj <<'E2'
o low
v 0 0 0
v 4 0 0
v 0 4 0
v 0 0 4
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
o high
v 0 0 8
v 4 0 8
v 0 4 8
v 0 0 12
f 5 7 6
f 5 6 8
f 6 7 8
f 7 5 8
E2
cubewright convert two.obj -o half.obj --cut-plane z=2mm && grep -c '^f' half.obj
cubewright convert two.obj -o top.obj --cut-plane z=6mm && grep -c '^f' top.obj
cubewright convert two.obj -o top.glb --cut-plane z=6mm
exit 0
