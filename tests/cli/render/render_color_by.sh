# Surfaces and meshes drawn in the colours of a volume, and what is refused.
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright make torus -o t.nrrd --dims 32 -q
cubewright extract s.nrrd --iso 0 -o s.stl -q
plain='--size 80x60 --background none'
cubewright render s.nrrd --iso 0 --color-by t.nrrd -o a.png $plain
cubewright render s.stl --color-by t.nrrd -o b.png $plain
cubewright render s.nrrd --iso 0 --color-by t.nrrd --colormap gray --range -5:5 -o c.png $plain
cubewright render s.nrrd --iso 0 -o d.png $plain -q
cmp -s a.png d.png || echo "coloured"
cmp -s a.png c.png || echo "by another map"
bad() {
    cubewright render "$@" -o bad.png -q
    echo "$? $*"
}
bad s.nrrd --color-by t.nrrd
bad s.nrrd --iso 0 --colormap gray
bad s.nrrd --iso 0 --color-by none.nrrd
bad s.nrrd --iso 0 --color-by t.nrrd --range 5:1
bad s.nrrd --iso 0 --color-by t.nrrd --color red
bad s.stl --color-by s.stl
ls bad.png 2>/dev/null
exit 0
