# What is inside is masked, opened, closed and cropped before a surface is made, and its largest
# components are kept.
cubewright make sphere -o ball.nrrd --dims 40 -q
cubewright make gyroid -o gyroid.nrrd --dims 24x20x16 --type i16 -q
cubewright make labels/spheres -o mask.nrrd --dims 24x20x16 --type u8 --labels 9 -q

# A mask in another grid.
cubewright extract ball.nrrd --iso 0 --mask mask.nrrd -o masked.stl --json r.json
grep -A4 '"params"' r.json
grep '"mask"' r.json
cubewright check masked.stl --source ball.nrrd --iso 0 --mask mask.nrrd 2>&1 | grep -e ' ok ' -e masked
cubewright extract ball.nrrd --iso 0,5 --mask mask.nrrd -o 'masked-{level}.stl' -q && ls masked-*

# Opening and closing.
cubewright extract gyroid.nrrd --iso 0 --mask-open 2vox -o opened.stl
cubewright extract gyroid.nrrd --iso 0 --mask-close 6mm --mask-open 1vox -o closed.stl --json r.json
grep -e mask_open -e mask_close r.json
cubewright extract gyroid.nrrd --iso 0 --mask-open 0.5vox -o same.stl -q
cubewright extract gyroid.nrrd --iso 0 -o plain.stl -q
cmp same.stl plain.stl && echo same

# A crop leaves the surface as it is.
cubewright extract ball.nrrd --iso 20 -o whole.stl --json w.json
cubewright extract ball.nrrd --iso 20 --crop auto -o auto.stl --json r.json
cubewright extract ball.nrrd --iso 20 --crop auto:1 -o one.stl
grep crop_auto r.json
cubewright check auto.stl --reference whole.stl --tolerance 0.00001mm -q && echo same

# The largest components, with --min-volume too.
cubewright make sphere -o noisy.nrrd --dims 24x24x12 --type i16 --noise 4 --seed 3 -q
cubewright extract noisy.nrrd --iso 0 -o largest.stl --largest 1 --json r.json
cubewright extract noisy.nrrd --iso 0 -o three.stl --largest 3 --min-volume 20mm3 -q
# A cut that follows may part what was kept.
cubewright make gyroid -o g.nrrd --dims 40 -q
cubewright extract g.nrrd --iso 0 -o parted.stl --largest 1 --cut-plane z=97% | grep -o '[0-9]* component[s]*'
cubewright check largest.stl --source noisy.nrrd --iso 0 --largest 1 2>&1 | grep topology
grep '"largest"' r.json

# Refused.
try() {
    cubewright "$@" -q
    echo "$? $*"
}
try extract ball.nrrd --iso 0 -o no.stl --mask missing.nrrd
try extract ball.nrrd --iso 0 -o no.stl --mask-open 2%
try extract ball.nrrd --iso 0 -o no.stl --mask-open 300vox
try extract ball.nrrd --iso 0,5 -o 'no{level}.stl' --mask-close 1vox
try extract ball.nrrd --iso 0 -o no.stl --crop auto:0
try extract ball.nrrd --iso 99 -o no.stl --crop auto
try extract ball.nrrd --iso 0 -o no.stl --largest 1 --stream always
try extract ball.nrrd --iso 0 -o no.stl --crop auto --stream always
try extract gyroid.nrrd --labels all -o no.stl --mask ball.nrrd
try info ball.nrrd --crop auto
try check plain.stl --largest 2
ls no.stl 2>&1 | sed 's/.*: No/No/'
