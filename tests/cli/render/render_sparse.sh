# Sparse grids are drawn as dense ones, with what tiles and the background say.
cubewright formats --json | grep -A7 '"vdb"' | grep -q '"in_this_build": true' || { echo "this build has no OpenVDB" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
make_vdb sphere s.vdb
cubewright render s.vdb --mode composite -o s.png --size 64x64 --no-preintegration
# Inside is solid: a slab of it looks like the whole from near, and half of it does from afar.
draw() {
    cubewright render s.vdb --mode composite --size 64x64 --no-lit --ortho --no-preintegration -q "$@"
}
draw -o near.png --zoom 9
draw -o slab.png --zoom 9 --clip '0,1,0,-7;0,-1,0,-2'
draw -o outside.png --clip 0,1,0,1e6
draw -o empty.png --opacity 0
cmp near.png slab.png && echo "same"
cmp outside.png empty.png && echo "same"
cmp -s near.png empty.png || echo "another"
cubewright render s.vdb --mode composite -o x.png --max-voxels 100 -q || echo "exit $?"
ls
