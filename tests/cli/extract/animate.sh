# One file that shows the steps of a series one after another.
cubewright version --features | grep -q '^glb *yes' || { echo "this build writes no glTF" >&2; exit 77; }
sh "$TESTS/support/steps.sh" 16 >4d.nrrd
cubewright extract 4d.nrrd --iso 0.5 --animate -o '{stem}.glb' --json r.json
echo $?
sed -n '/"surfaces"/,$p' r.json | grep -e '"step"' -e '"time"' -e '"triangles"' -e '"status"' -e '"path"' -e '"name"' -e nothing
# the first that can be seen is what readers without animations see
cubewright extract 4d.nrrd --iso 0.5 -o first.glb -q --name 'step 0'
cubewright check 4d.glb --reference first.glb --tolerance 0.000001mm --no-deep | tail -n 1
cubewright extract 4d.nrrd --iso 0.5 --animate --steps 1:3 --fps 4 -o '{stem}-{level}.gltf' --no-check
cubewright check 4d-0.5.gltf | head -n 1
# files have no times
for n in 1 2; do cubewright make sphere -o f$n.nrrd --dims 2$n -q; done
cubewright extract f?.nrrd --iso 0 --animate -o f.glb
cubewright extract 'f?.nrrd' --iso 0 --animate -o f-16.glb --compress quantize -q
cubewright extract 4d.nrrd --iso 99 --animate -o none.glb -q
echo $?
try() {
    cubewright extract "$@" -q
    echo "$? $*"
}
try 4d.nrrd --iso 0.5 --animate -o x.stl
try 4d.nrrd --iso 0.5,1 --animate -o x.glb
try 4d.nrrd --iso 0.5 --animate --steps 2 -o x.glb
try f1.nrrd --iso 0.5 --animate -o x.glb
try 4d.nrrd --iso 0.5 --animate --step 2 -o x.glb
try 4d.nrrd --iso 0.5 --animate --fps 0 -o x.glb
try 4d.nrrd --iso 0.5 --animate --fps 1e-300 -o x.glb
try 4d.nrrd --iso 0.5 --fps 4 -o x.glb
try 4d.nrrd --iso 0.5 --animate -o '{lod}.glb'
try 4d.nrrd --iso 0.5 --animate -o f.glb --no-clobber
try 4d.nrrd --iso 0.5 --animate -o x.glb --memory 64k
ls
