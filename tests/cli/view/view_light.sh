# Materials, shadows and smoothed gradients in the window: a mode without shadows draws without, and
# a saved state repeats the picture.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 24 -q
view() {
    cubewright view "$@" -q --hidden --size 320x240 || echo "exit $?"
}
view t.nrrd --tf metals --shadow light --light 1,1,1 --gradient-smoothing 1 --pixel-area \
    --exec 'wait; screenshot a.png; mode projection; wait; print mode; mode composite; wait; screenshot b.png; save-state s.txt'
cmp a.png b.png && echo "the same after another mode"
view --run s.txt --exec 'wait; screenshot c.png'
cmp a.png c.png && echo "the same from a state"
view t.nrrd --tf metals --light 1,1,1 --gradient-smoothing 1 --exec 'wait; screenshot d.png'
cmp -s a.png d.png && echo "shadows change nothing"
view t.nrrd --tf metals --light 1,1,1 --shadow light --exec 'wait; screenshot e.png'
cmp -s a.png e.png && echo "smoothing changes nothing"
true
