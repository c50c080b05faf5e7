# Limits stop before memory is spent; nothing is written.
cubewright make gyroid --dims 64 -o v.nrrd -q
cubewright extract v.nrrd --iso 0 -o m.glb --max-triangles 100k -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --memory 900k -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --memory 2M -q
echo $?
cubewright extract v.nrrd --iso 0 -o m.glb --memory 64M --max-triangles 1M -q
echo $?
ls
