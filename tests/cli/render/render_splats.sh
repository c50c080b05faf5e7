# Splats of any kernel and width; a tree without error is flat.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 24 -q
draw() {
    cubewright render t.nrrd --size 64x48 --tf fog -q "$@"
}
draw --mode splat -o usual.png
draw --mode splat --splat-kernel gaussian --splat-width 0.6 -o same.png
cmp usual.png same.png && echo "same"
for kernel in polygon tent b-spline; do
    draw --mode splat --splat-kernel $kernel -o $kernel.png
    draw --mode splat-tree --splat-kernel $kernel -o tree.png
    draw --mode splat-tree --splat-kernel $kernel --tree-error 0.3 -o rough.png
    draw --mode splat --splat-kernel $kernel --splat-width 1 -o wide.png
    cmp $kernel.png tree.png && echo "same"
    for other in usual rough wide; do
        cmp -s $kernel.png $other.png && echo "$kernel and $other are the same"
    done
done
cubewright render t.nrrd --size 64x48 --tf fog --mode splat --splat-kernel tent -o t.png --json - -q | grep splat_
