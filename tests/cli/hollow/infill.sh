# Lattices inside of prints: what is made, what is said of it, and what is refused.
cubewright version --features | grep -q '^level-set *yes' || { echo "this build has no OpenVDB" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 24 -q
cubewright extract s.nrrd --iso 0 -o s.off -q
cubewright hollow s.off -o h.stl --wall 3mm --infill gyroid:20mm:3mm --drain 6mm@-z
cubewright check h.stl --profile print --json - -q | grep -e '"components"' -e open_edges
cubewright hollow s.off -o d.stl --wall 3mm --infill diamond:24mm:3mm:5mm --infill-by depth:8mm --no-measure
cubewright hollow s.off -o v.stl --wall 3mm --infill schwarz-p:24mm:3mm:5mm --infill-by s.nrrd -q --json - |
    sed -n -e '/"infill": {/,/}/p' -e '/"drains": [0-9]/,/}/p'
for t in 1 3; do
    cubewright hollow s.off -o t$t.stl --wall 3mm --infill gyroid:20mm:3mm --drain 6mm@x -t $t -q
done
cmp t1.stl t3.stl && echo "same"
try() {
    cubewright "$@" -q
    echo "$? $*"
}
try hollow s.off -o x.stl --wall 3mm --infill gyroid:2mm:3mm
try hollow s.off -o x.stl --wall 3mm --infill honeycomb:8mm:1mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:0mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8:1
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:1mm:2mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:1mm --infill-by depth:2mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:1mm:2mm --infill-by depth:2
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:1mm:2mm --infill-by none.nrrd
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:1mm:2mm --infill-by s.off
try hollow s.off -o x.stl --wall 3mm --infill-by depth:2mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:1mm --voxel 0.5mm
try hollow s.off -o x.stl --wall 3mm --infill gyroid:8mm:0.1mm --memory 100M
try hollow s.off -o s.nrrd --wall 3mm --infill gyroid:8mm:1mm:2mm --infill-by s.nrrd
test ! -e x.stl && echo "none is written"
