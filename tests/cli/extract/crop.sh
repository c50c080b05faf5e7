# A part of the volume, by voxels or by millimetres: the surface stays where it was.
cubewright make sphere -o s.nrrd --dims 41 -q # 2 mm a voxel, centred on zero
cubewright extract s.nrrd --iso 0 -o half.stl --crop 0:20,0:40,0:40
cubewright extract s.nrrd --iso 0 -o same.stl --crop=-40mm:0mm,-40mm:40mm,-4cm:4cm -q
cmp half.stl same.stl && echo same
# what it left is the whole surface's, to a few roundings, and what it saved is told
cubewright extract s.nrrd --iso 0 -o half.ply --crop 0:20,5:40,0:40 --prove-crop --json - 2>note |
    sed -n -e '/"crop": {/,/}/p'
grep -o '^s.nrrd: the same .* triangles as in the whole surface: .* % of its .*, from .* % of the voxels' note
cubewright extract s.nrrd --iso 0 -o no.stl --prove-crop || echo "exit $?"
cubewright extract s.nrrd --iso 0 -o no.stl --crop 0:20,0:40,0:40 --prove-crop --preview || echo "exit $?"
cubewright extract s.nrrd --iso 0 -o no.stl --crop 0:20,0:40,0:40 --prove-crop --snap 0.3 || echo "exit $?"
rm note
for box in 0:40 0:40,0:40,50:60 40:0,0:40,0:40 0:40,0:40,0mm:40mm 3:3,0:40,0:40; do
    cubewright extract s.nrrd --iso 0 -o no.stl --crop $box -q
    echo $?
done
ls
