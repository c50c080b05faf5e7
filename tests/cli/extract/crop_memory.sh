# A part may be taken of a volume that is larger than the memory allowed: the same surface, byte
# for byte, as with room for the whole.
cubewright make gyroid --dims 96 -o v.nrrd -q # 3.5 MB
box=10:40,20:50,60:95
cubewright extract v.nrrd --iso 0 -o no.stl --memory 3M
echo $?
cubewright extract v.nrrd --iso 0 -o room.stl --name part --crop $box -q
cubewright extract v.nrrd --iso 0 -o tight.stl --name part --crop $box --memory 2M
cmp room.stl tight.stl && echo same
cubewright extract v.nrrd --iso 0 -o no.stl --crop $box --memory 100k -q
echo $?
# Where a spacing is asked for, the part stands where it was in the stretched volume.
cubewright extract v.nrrd --iso 0 -o part.stl --spacing 2,3,4mm --crop 10:40,20:50,60:95 -vv 2>&1 |
    grep affine
ls
