# Limits stop before memory is spent; nothing is written.
cubewright make gyroid --dims 64 -o v.nrrd -q
cubewright extract v.nrrd --iso 0 -o m.glb --max-triangles 100k -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --memory 900KiB -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --memory 2M -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --memory 64M --max-triangles 1M -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --max-voxels 200k -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --max-voxels 200k --crop 0:63,0:63,0:63 -q
echo $?
cubewright extract v.nrrd --iso 0 -o part.glb --max-voxels 200k --crop 0:63,0:63,0:40 -q
echo $?
limited() {
    cubewright "$@" --max-voxels 1 -q 2>&1 | grep -c 'asks for 262144 voxels; the limit is 1 (--max-voxels)'
}
limited extract v.nrrd --iso 0 -o no.glb
limited info v.nrrd
limited render v.nrrd --iso 0 -o no.png
limited check m.glb --source v.nrrd --iso 0
ls
