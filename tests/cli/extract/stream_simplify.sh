# Simplified slice by slice: the same bytes as in memory, for errors and numbers of triangles.
set -e
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make gyroid -o g.nrrd --dims 40x30x44 --type i16 --noise 0.05 --seed 3 -q
compare() { # FILE OPTIONS...
    cubewright extract "$@" --iso 100 -o memory.ply --name a --stream never --no-check -q
    cubewright extract "$@" --iso 100 -o slices.ply --name a --stream always --no-check -q --slab 5 --threads 1
    cmp memory.ply slices.ply
    cubewright extract "$@" --iso 100 -o slices.ply --name a --stream always --no-check -q --threads 2
    cmp memory.ply slices.ply
    echo "$*: the same"
}
for goal in 0.3mm 0.5vox 0.2vox 2k; do
    compare g.nrrd --simplify $goal
done
compare g.nrrd --simplify 0.3mm --open
compare g.nrrd --simplify 0.3mm --normals none
compare g.nrrd --simplify 0.3mm --placement cubic --inside below
compare g.nrrd --simplify 0.3mm --crop 5:36,3:28,10:40
compare g.nrrd --simplify 2k --coarsen 2
# normals that part at creases
for way in never always; do
    mkdir $way
    cubewright extract g.nrrd --iso 100 -o $way/a.obj --simplify 2k --crease-angle 40 --stream $way --no-check -q
done
cmp never/a.obj always/a.obj
cubewright make gyroid -o g.nii.gz --dims 40x30x44 --type i16 --seed 3 -q
compare g.nii.gz --simplify 0.3mm
if cubewright version --features | grep -q '^draco *yes'; then
    cubewright extract g.nrrd --iso 100 -o memory.glb --name a --simplify 2k --compress draco --stream never -q
    cubewright extract g.nrrd --iso 100 -o slices.glb --name a --simplify 2k --compress draco --stream always -q
    cmp memory.glb slices.glb
fi
# the mesh is measured, its distances are not
cubewright extract g.nrrd --iso 100 -o all.ply --simplify 2k --stream always --json always.json
cubewright extract g.nrrd --iso 100 -o all.ply --simplify 2k --stream never --json never.json -q
sed -n '/"mesh": {/,/}/p' always.json >always.txt
sed -n '/"mesh": {/,/}/p' never.json | cmp - always.txt && grep -c : always.txt
grep -c distance always.json || true
# several isovalues
cubewright extract g.nrrd --iso 100,300 -o '{level}.ply' --simplify 1k --stream always -q
ls 100.ply 300.ply
# larger than the limit: by itself, or not at all
head -c 64000000 /dev/zero >big.raw
printf '\377' | dd of=big.raw bs=1 seek=32200200 conv=notrunc 2>/dev/null
cubewright extract big.raw --raw dims=400x400x400,type=u8 --iso 100 --memory 40M --simplify 0.1mm -o big.ply
head -c 3000000 /dev/urandom >noise.raw
cubewright extract noise.raw --raw dims=100x100x300,type=u8 --iso 128 --memory 60M --stream always --simplify 0.1mm -o no.ply ||
    echo "exit $?"
# what slices cannot do
cubewright extract g.nrrd --iso 100 --stream always --simplify 1vox --min-volume 5mm3 -o no.ply || echo "exit $?"
cubewright extract g.nrrd --iso 100 --stream always --max-error 50% -o no.ply || echo "exit $?"
cubewright extract g.nrrd --iso 1e6 --stream always --simplify 1k -o no.ply || echo "exit $?"
ls no.* .cubewright* 2>/dev/null || echo "nothing is left behind"
