# Simplified while it is extracted: to an error or to a number of triangles.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 48 -q
cubewright extract s.nrrd --iso 0 -o full.ply -q
cubewright extract s.nrrd --iso 0 -o error.ply --simplify 0.2mm
# a surface too large to be had beside the result is not extracted for the comparison
cubewright extract s.nrrd --iso 0 -o error.ply --simplify 0.2mm --memory 2500000 | grep -c "full surface" || true
cubewright check error.ply --reference full.ply --tolerance 0.2mm -q; echo "check: $?"
cubewright extract s.nrrd --iso 0 -o voxels.ply --simplify 0.1vox -q
cubewright extract s.nrrd --iso 0 -o threads.ply --simplify 0.1vox -q --threads 3 --name voxels
cmp voxels.ply threads.ply
cubewright extract s.nrrd --iso 0 -o count.glb --simplify 1k --json - -q |
    sed -n -e '/"simplify_/p' -e '/"to":/p' -e '/"triangles": /p'
strings count.glb | grep -o '"simplified":"[^"]*"'
# both levels, each by itself; without normals
cubewright extract s.nrrd --iso=0,-5 -o '{level}.ply' --simplify 500 --normals none
# what cannot be
for bad in 0.1 0 -5mm 5x "" ; do
    cubewright extract s.nrrd --iso 0 -o bad.ply --simplify "$bad" || echo "exit $?"
done
cubewright extract s.nrrd --iso 0 -o bad.ply --simplify 1mm --snap 0.3 || echo "exit $?"
cubewright extract s.nrrd --iso 0 -o bad.ply --simplify 1mm --max-triangles 1k || echo "exit $?"
cubewright extract s.nrrd --iso 1000 -o bad.ply --simplify 1mm || echo "exit $?"
ls
