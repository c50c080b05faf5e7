# What simplify refuses, before the input is read or after; nothing is written then.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o s.off -q
echo 'OFF 9 9 9' >broken.off
printf 'OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n' >empty.off
printf 'OFF\n3 1 0\n900 0 0\n901 0 0\n900 1 0\n3 0 1 2\n' >far.off
ln s.off link.ply
try() {
    cubewright simplify "$@" -q
    echo "$? $*"
}
try s.off -o x.stl
try s.off --triangles 50
try s.off -o x.stl --error 0.5vox
try s.off -o x.stl --error 0mm
try s.off -o x.stl --error=-1mm
try s.off -o x.stl --error 5kg
try s.off -o x.stl --triangles 0
try s.off -o x.stl --triangles 1.5
try s.off -o x.stl --ratio 1
try s.off -o x.stl --ratio=-0.5
try s.off -o x.stl --ratio half
try s.off -o x.stl --ratio 0.5 --iso 0
try s.off -o x.stl --ratio 0.5 --source s.nrrd --iso 0 --no-measure
try s.off -o x.stl --ratio 0.5 --tolerance 1mm
try s.off -o x.stl --ratio 0.5 --compress draco
try s.off -o x.xyz --ratio 0.5
try s.off -o nowhere/x.stl --ratio 0.5
try s.off -o s.off --ratio 0.5
try s.off -o link.ply --ratio 0.5
try s.off -o s.nrrd --format off --ratio 0.5 --source s.nrrd
try s.off -o x.stl --ratio 0.5 --json s.off
try s.off -o x.stl --ratio 0.5 --json s.nrrd --source s.nrrd
try s.off -o x.stl --ratio 0.5 --json x.stl
try s.off -o x.stl --ratio 0.5 --max-triangles 9
try s.off -o x.stl --ratio 0.5 --source none.nrrd
try s.off -o x.stl --ratio 0.5 --source s.off
try far.off -o x.stl --ratio 0.5 --source s.nrrd
try broken.off -o x.stl --ratio 0.5
try empty.off -o x.stl --ratio 0.5
try none.off -o x.stl --ratio 0.5
try s.off s.off -o x.stl --ratio 0.5
try s.off -o x.stl --triangels 5
try s.off -o x.stl --ratio 0.5 --drop-components 1vox
try s.off -o x.stl --ratio 0.5 --drop-components 101%
try s.off -o x.stl --ratio 0.5 --attributes color:1
try s.off -o x.stl --ratio 0.5 --attributes colour:1
try s.off -o x.stl --ratio 0.5 --attributes normal
try s.off -o x.stl --ratio 0.5 --attributes normal:0
try s.off -o x.stl --ratio 0.5 --attributes normal:1,normal:2
try s.off -o x.stl --ratio 0.5 --attributes normal:1,
ls -A
