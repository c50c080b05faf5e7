# Gaussians and medians of slices as they are read: the same bytes as of all voxels in memory.
cubewright make gyroid -o g.nrrd --dims 72 --noise 0.1 -q
for filter in gauss:1vox gauss:2mm median:1 median:2; do
    cubewright extract g.nrrd --iso 0.1 --denoise $filter -o whole.ply --name g -q
    cubewright extract g.nrrd --iso 0.1 --denoise $filter -o slices.ply --name g -q --stream always
    cmp whole.ply slices.ply && echo "same"
done
for type in u8 i16 i32; do
    cubewright make gyroid -o $type.nrrd --dims 40x40x70 --type $type --noise 0.1 -q
    cubewright extract $type.nrrd --iso otsu --denoise gauss:1vox -o whole.ply --name g -q
    cubewright extract $type.nrrd --iso otsu --denoise gauss:1vox -o slices.ply --name g -q --stream always -t 3
    cmp whole.ply slices.ply && echo "same $type"
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
# where memory is short, what is needed is told, and what goes slice by slice
cubewright make gyroid -o big.nrrd --dims 200x200x240 --type u8 -q # 9.6 MB
for way in "--denoise gauss:1vox" "--denoise median:1" "--denoise aniso" "--denoise nlm" "--crop auto" "--mask-open 1vox"; do
    cubewright extract big.nrrd --iso 127.5 $way -o a.ply -q --memory 36M
    echo "$? $way"
done
cubewright make gyroid -o bigger.nrrd --dims 200x200x260 -q # 41.6 MB
for way in "--denoise nlm" "--crop auto" "--resample 2mm" "--remove-table"; do
    cubewright extract bigger.nrrd --iso 0 $way -o a.ply -q --memory 36M
    echo "$? $way"
done
cubewright extract bigger.nrrd --iso 0 --coarsen 10 -o small.ply -q
cubewright check small.ply --source bigger.nrrd --iso 0 --memory 36M -q
echo "$? check"
