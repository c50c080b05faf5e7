# Labels that are read slice by slice: the same bytes as in memory.
set -e
cubewright make labels/cells -o cells.nrrd --dims 60x50x90 --labels 40 --type u16 -q
for options in "" "--smooth-labels off" "--open" "--crop 5:40,3:44,10:70" "--coarsen 2" "--simplify 2vox" "--shared-faces"; do
    # shellcheck disable=SC2086
    cubewright extract cells.nrrd --labels all $options -o whole.ply --name a --stream never -q
    for threads in 1 2; do
        # shellcheck disable=SC2086
        cubewright extract cells.nrrd --labels all $options -o slices.ply --name a --stream always --threads $threads -q
        cmp whole.ply slices.ply
    done
    echo "${options:-as it is}: the same"
done
cubewright extract cells.nrrd --labels 3,5-9,900 -o whole.3mf --name a --stream never -q
cubewright extract cells.nrrd --labels 3,5-9,900 -o slices.3mf --name a --stream always
cmp whole.3mf slices.3mf
# a map that does not fit --memory
head -c 125000000 /dev/zero >large.raw
printf '\007' | dd of=large.raw bs=1 seek=62375250 conv=notrunc 2>/dev/null
cubewright extract large.raw --raw dims=500x500x500,type=u8 --labels all --memory 90M -o seven.ply
cubewright extract large.raw --raw dims=500x500x500,type=u8 --labels all --memory 90M --stream never -o no.ply || echo "exit $?"
cubewright extract cells.nrrd --iso 3 --labels all --stream always -o no.ply || echo "exit $?"
ls no.* 2>/dev/null || echo "nothing is left behind"
