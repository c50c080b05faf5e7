# One volume to every mesh format; the same numbers each time.
cubewright make sphere -o sphere.nrrd -q
for f in glb gltf stl ply obj off 3mf vtp; do
    cubewright extract sphere.nrrd --iso 0 -o "sphere.$f" || exit
done
ls
