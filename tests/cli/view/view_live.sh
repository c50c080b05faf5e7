# The surface while the isovalue moves: by the GPU where that is asked for and can be had, else by
# the CPU; at rest it is the CPU's. The driver may run on the CPU here, which auto leaves alone.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make gyroid -o even.nrrd --dims 40 --type u8 -q
cubewright make gyroid -o wide.nrrd --dims 24 --type f64 -q
cubewright make gyroid -o large.nrrd --dims 100 --type u8 -q
view() {
    cubewright view "$@" -q --hidden --size 320x240 || echo "exit $?"
}
view even.nrrd --iso 128 --live-surface gpu --exec 'print live-surface; wait; print surface; iso 90; mouse 5 5; print message' >probe
if grep -q 'OpenGL 4.3' probe; then
    echo "no OpenGL 4.3 here" >&2
    exit 77
fi
cat probe
echo "gpu, and back"
view even.nrrd --iso 128 --live-surface gpu --exec 'toggle panels off; wait; iso 100; mouse 5 5; print surface; iso 150; capture gpu.png now;
    wait; print surface; print triangles; live-surface cpu; iso 100; mouse 6 6; print surface; wait; iso 150; capture cpu.png now'
echo "other things are drawn beside it: a volume, planes, a cut that is filled"
view even.nrrd --iso 128 --live-surface gpu --exec 'wait; mode composite; iso 100; mouse 5 5; print surface; print message; mode mesh; clip 1,0,0,0;
    cap on; iso 140; mouse 6 6; print surface; print message'
echo "what the GPU does not draw is left to the CPU"
view even.nrrd --iso 128 --live-surface gpu --exec 'wait; wireframe on; iso 100; mouse 5 5; print surface; pick 160 120'
view wide.nrrd --iso 0 --live-surface gpu --exec 'wait; iso 0.3; mouse 5 5; print message; wait; print surface'
view wide.nrrd --iso 0 --exec 'wait; iso 0.3; mouse 5 5; print surface; print message'
view large.nrrd --iso 128 --live-surface cpu --exec 'wait; iso 100; mouse 5 5; print surface; wait; print surface; iso off; wait; print surface'
echo "errors"
view even.nrrd --live-surface fast
view even.nrrd --exec 'capture a.png later'
