# What is written on pictures, and slices beside them.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 24 -q
draw() {
    cubewright render t.nrrd --size 160x120 -q "$@"
}

# Each mark changes the picture, and nothing else does.
draw -o plain.png
draw -o again.png
cmp plain.png again.png && echo "same"
for mark in --axes --scale-bar --letters --color-bar --histogram '--caption=a torus'; do
    draw -o mark.png "$mark"
    cmp -s plain.png mark.png || echo "another: $mark"
done
draw -o quad.png --layout quad
od -A n -t u1 -j 16 -N 8 quad.png
cubewright render t.nrrd --iso 0 -o m.png --size 64x64 --scale-bar -q && echo "a mesh"

# What is asked for in vain is said.
draw -o no.png --histogram --iso 0 --mode mesh
draw -o no.png --layout quad --compare 'texture|mip'
draw -o no.png --axes --difference 9 --compare 'texture|composite'
ls no.png
