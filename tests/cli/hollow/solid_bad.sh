# What hollow and offset refuse, before the input is read or after; nothing is written then.
cubewright version --features | grep -q '^level-set *yes' || { echo "this build has no OpenVDB" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright extract s.nrrd --iso 0 -o s.off -q
printf 'OFF\n4 3 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n' >open.off
printf 'OFF\n4 4 0\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 1 2\n3 0 3 1\n3 0 2 3\n3 1 3 2\n' >inward.off
try() {
    cubewright "$@" -q
    echo "$? $*"
}
try hollow s.off -o x.stl
try hollow s.off --wall 2mm
try hollow s.off -o x.stl --wall 2vox
try hollow s.off -o x.stl --wall 0mm
try hollow s.off -o x.stl --wall 40mm
try hollow s.off -o x.stl --wall 2mm --voxel 1.5mm
try hollow s.off -o x.stl --wall 2mm --voxel fine
try hollow s.off -o x.stl --wall 0.01mm --memory 100M
try hollow s.off -o x.stl --wall 2mm --drain 4mm
try hollow s.off -o x.stl --wall 2mm --drain 4mm@w
try hollow s.off -o x.stl --wall 2mm --drain 4mm@-zz
try hollow s.off -o x.stl --wall 2mm --drain wide@z
try hollow s.off -o x.stl --wall 2mm --drain 4mm@z,
try hollow s.off -o x.stl --wall 2mm --drain 0.1mm@z --voxel 1mm
try hollow s.off -o s.off --wall 2mm
try hollow s.off -o x.xyz --wall 2mm
try hollow s.off -o x.stl --wall 2mm --json x.stl
try hollow s.off -o x.stl --wall 2mm --compress draco
try hollow open.off -o x.stl --wall 0.5mm
try hollow inward.off -o x.stl --wall 0.5mm
try hollow none.off -o x.stl --wall 2mm
try hollow s.off -o x.stl --wall 2mm --by 1mm
try offset s.off -o x.stl
try offset s.off --by 1mm
try offset s.off -o x.stl --by 1vox
try offset s.off -o x.stl --by --1mm
try offset s.off -o x.stl --by 0kg
try offset s.off -o x.stl --by -31mm --voxel 2mm
try offset s.off -o x.stl --by 1mm --voxel 0.0001mm
try offset open.off -o x.stl --by 1mm
ls -A
