# Gaussians and medians of slices as they are read: the same bytes as of all voxels in memory.
cubewright make gyroid -o g.nrrd --dims 72 --noise 0.1 -q
for filter in gauss:1vox gauss:2mm median:1 median:2; do
    cubewright extract g.nrrd --iso 0.1 --denoise $filter -o whole.ply --name g -q
    cubewright extract g.nrrd --iso 0.1 --denoise $filter -o slices.ply --name g -q --stream always
    cmp whole.ply slices.ply && echo "same"
done
cubewright extract g.nrrd --iso otsu --denoise gauss:1vox -o whole.ply --name g -q
cubewright extract g.nrrd --iso otsu --denoise gauss:1vox -o slices.ply --name g --stream always
cmp whole.ply slices.ply && echo "same level"
for k in 1/2 2/2; do cubewright extract g.nrrd --iso 0.1 --denoise median:1 --part $k --manifest parts -q; done
cubewright join parts -o joined.ply --name g -q
cubewright extract g.nrrd --iso 0.1 --denoise median:1 -o whole.ply --name g -q && cmp whole.ply joined.ply && echo "same parts"
cubewright extract g.nrrd --iso 0.1 --denoise aniso -o a.ply --stream always
echo "$?"
cubewright extract g.nrrd --iso 0.1 --denoise gauss:1vox --resample iso -o a.ply --stream always
echo "$?"
