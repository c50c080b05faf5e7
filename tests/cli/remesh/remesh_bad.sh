# Refused: missing and wrong values, and meshes that are no manifolds.
printf 'v 0 0 0\nv 9 0 0\nv 9 1 0\nv 0 1 1\nv 0 1 -1\nf 1 2 3\nf 1 2 4\nf 2 1 5\n' >fin.obj
try() {
    cubewright remesh "$@"
    echo "exit $?"
}
try fin.obj -o out.obj
try fin.obj --edge 1mm
try fin.obj --edge 1mm -o fin.obj
try fin.obj --edge 0mm -o out.obj
try fin.obj --edge 1vox -o out.obj
try fin.obj --edge 1mm --shortest 0.1mm -o out.obj
try fin.obj --edge 1mm --min-angle 60 -o out.obj
try fin.obj --edge 1mm --features 0 -o out.obj
try fin.obj --edge 1mm --iterations 1000 -o out.obj
try fin.obj --edge 1mm -o out.obj
printf 'v 0 0 0\nv 9 0 0\nv 9 1 0\nf 1 2 3\n' >one.obj
try one.obj --edge 0.0001mm -o out.obj
try one.obj --edge 0.0000001mm -o out.obj
ls out.obj 2>/dev/null
echo "nothing written: $?"
