# Slice by slice: the same bytes as in memory, for any layers and threads, in every format that
# can be; volumes that exceed --memory are extracted so by themselves.
set -e
cubewright make gyroid -o g.nrrd --dims 70x60x50 --type i16 --noise 0.2 --seed 3 -q
for format in ply stl obj off vtp glb gltf 3mf; do
    cubewright extract g.nrrd --iso 100 -o memory.$format --name a --stream never -q
    for slab in 1 7 16 64; do
        cubewright extract g.nrrd --iso 100 -o slices.$format --name a --stream always --slab $slab \
            --threads $((1 + slab % 2)) -q
        cmp memory.$format slices.$format
    done
    echo "$format: the same"
done
# crops, previews, compressed files

cubewright extract g.nrrd --iso 100 --crop 5:60,3:50,10:40 -o a.ply --name a --stream never -q
cubewright extract g.nrrd --iso 100 --crop 5:60,3:50,10:40 -o b.ply --name a --stream always -q
cmp a.ply b.ply && echo "crop: the same"
cubewright extract g.nrrd --iso 100 --coarsen 2 -o a.ply --name a --stream never -q
cubewright extract g.nrrd --iso 100 --coarsen 2 -o b.ply --name a --stream always -q
cmp a.ply b.ply && echo "preview: the same"
cubewright make gyroid -o g.nii.gz --dims 70x60x50 --type i16 --noise 0.2 --seed 3 -q
cubewright extract g.nii.gz --iso 100 -o a.ply --name a --stream never -q
cubewright extract g.nii.gz --iso 100 -o b.ply --name a --stream always --slab 5 -q
cmp a.ply b.ply && echo "gzip: the same"
# the surface is measured on its way: the same line and report
cubewright extract g.nrrd --iso 100 -o all.ply --stream always --json always.json
cubewright extract g.nrrd --iso 100 -o all.ply --stream never --json never.json
sed -n '/"mesh": {/,/}/p' always.json >always.txt
sed -n '/"mesh": {/,/}/p' never.json | cmp - always.txt && grep -c : always.txt
cubewright extract g.nrrd --iso 100 -o all.ply --stream always --open --slab 3
cubewright extract g.nrrd --iso 100 -o all.ply --stream never --open
cubewright extract g.nrrd --iso 100 -o all.ply --stream always --no-check
# larger than the limit
head -c 64000000 /dev/zero >big.raw
printf '\377' | dd of=big.raw bs=1 seek=32200200 conv=notrunc 2>/dev/null
cubewright extract big.raw --raw dims=400x400x400,type=u8 --iso 100 --memory 40M -o big.ply
cubewright extract big.raw --raw dims=400x400x400,type=u8 --iso 100 --memory 40M --stream never -o no.ply ||
    echo "exit $?"
cubewright extract big.raw --raw dims=400x400x400,type=u8 --iso 100 --memory 40M --snap 0.3 -o no.ply ||
    echo "exit $?"
# the front of a rough surface may need more than slices leave
head -c 1000000 /dev/urandom >noise.raw
cubewright extract noise.raw --raw dims=400x500x5,type=u8 --iso 128 --memory 24M --stream always -o no.ply ||
    echo "exit $?"
# what slices cannot do
cubewright extract g.nrrd --iso 100 --stream always --snap 0.3 -o no.ply || echo "exit $?"
cubewright extract g.nrrd --iso 1e6 --stream always -o no.ply || echo "exit $?"
ls no.* .cubewright* 2>/dev/null || echo "nothing is left behind"
# the folder of temporary files is named where they do not fit; a limit of 512-byte blocks stands for a full disk
mkdir full
for o in "" "--min-volume 5mm3"; do
    sh -c 'trap "" XFSZ; ulimit -f 400; cubewright extract g.nrrd --iso 100 --stream always -o full/x.ply -q $1' sh "$o" ||
        echo "exit $?"
done
ls full
