# Lets the normals of a box part at its edges, in the formats that can say so.
cat >box.obj <<'EOF'
v 0 0 0
v 2 0 0
v 2 2 0
v 0 2 0
v 0 0 2
v 2 0 2
v 2 2 2
v 0 2 2
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
EOF
cubewright convert box.obj -o sharp.obj --crease-angle 30 && grep -c '^vn' sharp.obj && grep -c '^v ' sharp.obj
cubewright convert box.obj -o smooth.obj --crease-angle 100 && grep -c '^vn' smooth.obj
cubewright convert box.obj -o sharp.glb --crease-angle 30
cubewright check sharp.glb -q && echo closed
cubewright convert sharp.glb -o smooth.obj --crease-angle 100 && grep -c '^vn' smooth.obj
cubewright convert box.obj -o lost.ply --crease-angle 30
cubewright convert box.obj -o none.obj --crease-angle 200
echo "$?"
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 --crop 0:11,0:23,0:23 --crease-angle 40 -o cap.obj -q && grep -c '^v ' cap.obj && grep -c '^vn' cap.obj
cubewright extract s.nrrd --iso 0 --crease-angle=-3 -o none.obj
echo "$?"
exit 0
