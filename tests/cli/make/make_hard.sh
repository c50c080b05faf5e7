# Every hard case can be made by the name that is listed, and is closed and a manifold.
cubewright make --list >list
grep -c '^hard/' list
grep '^hard/' list | while read -r name _ iso _; do
    cubewright make "$name" -o v.nrrd --dims 20 -q || exit
    cubewright extract v.nrrd --iso "$iso" --local -o m.ply >line 2>notes || cat notes
    grep -q 'closed.*, manifold' line || echo "$name: $(cat line)"
done
grep -e mc33 -e nan-islands list
cubewright make hard/mc33 -o cases.nrrd --dims 46
cubewright make hard/ties -o ties.nii --dims 9x8x7 --type u8
# what is random follows the seed, and noise comes on top
for seed in 1 2 1; do
    cubewright make hard/ties -o again.nrrd --dims 9 --seed $seed -q
    cubewright make hard/sheet -o noisy.nrrd --dims 9 --noise 1 --seed $seed -q
    cat again.nrrd noisy.nrrd >$seed.now
    cmp -s $seed.now $seed.was && echo same || echo new
    cp $seed.now $seed.was
done
cubewright make hard/nan-islands -o none.nrrd --type u8
cubewright make hard/chekerboard -o none.nrrd
cubewright make hard/mc33 -o none.nrrd --dims 9 --noise=-1
[ -e none.nrrd ] || echo none
