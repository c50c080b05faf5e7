# A part of the volume, by voxels or by millimetres: the surface stays where it was.
cubewright make sphere -o s.nrrd --dims 41 -q # 2 mm a voxel, centred on zero
cubewright extract s.nrrd --iso 0 -o half.stl --crop 0:20,0:40,0:40
cubewright extract s.nrrd --iso 0 -o same.stl --crop=-40mm:0mm,-40mm:40mm,-4cm:4cm -q
cmp half.stl same.stl && echo same
for box in 0:40 0:40,0:40,50:60 40:0,0:40,0:40 0:40,0:40,0mm:40mm 3:3,0:40,0:40; do
    cubewright extract s.nrrd --iso 0 -o no.stl --crop $box -q
    echo $?
done
ls
