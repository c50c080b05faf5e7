# Options that --lod cannot be combined with are named, and nothing is written.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 16 -q
cubewright make sphere -o t.nrrd --dims 16 -q
cubewright make gyroid -o labels.nrrd --dims 8 -q
try() {
    cubewright extract "$@" -q
    echo "$? $*"
}
lod() { try s.nrrd --iso 0 --lod 200,100 -o x.ply "$@"; }
lod --simplify 1mm
lod --max-error 1mm
lod --camera cam.json --pixel-error 1
lod --pixel-error 1
lod --cull
lod --size 100x100
lod --shading 3
lod --snap 0.3
lod --steps all
lod --animate
lod --fps 3
lod --pvd x.pvd
lod --crop 0:7,0:15,0:15 --prove-crop
lod --stream always
try s.nrrd --iso 0 --lod 200,100 --part 1/2 --manifest parts
lod --memory 1kB
lod --labels all
lod --json x-lod1.ply
try s.nrrd --iso 0,1 --lod 200,100 -o x.ply
try s.nrrd t.nrrd --iso 0 --lod 200,100 -o x.ply
try s.nrrd --iso 0 --lod 100,200 -o x.ply
try s.nrrd --iso 0 --lod 0 -o x.ply
try s.nrrd --iso 0 --lod 200,100 -o 'x-{level}.ply'
try s.nrrd --iso 0 --lod 200,100 -o s.nrrd
try s.nrrd --iso 99 --lod 200,100 -o x.ply
try s.nrrd --iso 0 --max-error 1mm -o x.ply --no-measure
try s.nrrd --iso 0 -o x.ply --no-measure
try labels.nrrd --labels all -o x.ply --no-measure
ls
# levels that were done are removed when a later file fails; a limit of 512-byte blocks stands for a full disk
sh -c 'trap "" XFSZ; ulimit -f 70; cubewright extract s.nrrd --iso 0 --lod 1000,900 -o x.glb -q' || echo "exit $?"
ls
