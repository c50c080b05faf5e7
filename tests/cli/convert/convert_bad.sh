# What convert refuses, before the input is read or after; nothing is written then.
cat >two.obj <<'END'
o a
v 0 0 0
v 1 0 0
v 0 1 0
f 1 2 3
o a
v 5 0 0
v 6 0 0
v 5 1 0
f 4 5 6
END
echo 'OFF 9 9 9' >broken.off
ln two.obj link.ply
printf 'OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n' >empty.off
try() {
    cubewright convert "$@" -q
    echo "$? $*"
}
try two.obj
try two.obj -o x.stl --merge --split
try two.obj -o two.obj
try two.obj -o link.ply
try two.obj -o x.stl --json two.obj
try two.obj -o x.stl --json x.stl
try two.obj -o x.nrrd
try two.obj -o x.glb --ascii
try two.obj -o x.glb --frame ras
try two.obj -o x.glb --unit mm --up z
try two.obj -o x.stl --unit parsec
try two.obj -o nowhere/x.stl
try two.obj -o '{name}.stl'
try two.obj -o x.stl --split
try two.obj -o '{name}.stl' --split
try two.obj -o '{part}.xyz' --split
try two.obj -o x.stl --reader ply
try two.obj -o x.stl --max-triangles 1
try two.obj -o x.stl --memory 100
try broken.off -o x.stl
try empty.off -o x.stl
try none.off -o x.stl
try two.obj -o old.stl
cp old.stl older.stl
try two.obj -o old.stl --no-clobber
cmp old.stl older.stl
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.glb -q
(ulimit -f 64; try s.glb -o old.stl; try s.glb -o big.gltf)
cmp old.stl older.stl
mkfifo pipe.stl
try two.obj -o pipe.stl
ls -A
