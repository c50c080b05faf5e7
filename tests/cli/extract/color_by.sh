# Colours by another volume or another array: what is said, reported, kept and refused.
cubewright make sphere -o s.nrrd --dims 32 -q
cubewright make torus -o t.nrrd --dims 20 -q
cubewright extract s.nrrd --iso 0 --color-by t.nrrd -o c.ply
cubewright convert c.ply -o text.ply --ascii -q
grep -a '^property' text.ply
# vertices on the torus' axis are far from it, those at its ring inside: the ends of the map
sed '1,/end_header/d' text.ply | awk 'NF > 8 { if ($3 > 29.9) print "top", $7, $8, $9 }' | sort -u | head -1
cubewright extract s.nrrd --iso 0 --color-by t.nrrd --range -10:0 --colormap gray -o g.ply --json - -q | sed -n -e '/color_by/p' -e '/colormap/p' -e '/"range"/p'
# an array of the same file, by its name, its component and its magnitude
cat >two.vtk <<'E'
# vtk DataFile Version 3.0
two arrays
ASCII
DATASET STRUCTURED_POINTS
DIMENSIONS 3 3 3
ORIGIN 0 0 0
SPACING 1 1 1
POINT_DATA 27
SCALARS ball float 1
LOOKUP_TABLE default
0 0 0 0 1 0 0 0 0
0 1 0 1 9 1 0 1 0
0 0 0 0 1 0 0 0 0
VECTORS wind float
E
for n in 0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26; do echo "3 4 $n"; done >>two.vtk
cubewright extract two.vtk --array ball --iso 5 --color-by wind:1 -o w.ply
cubewright extract two.vtk --array ball --iso 5 --color-by wind:mag -o m.ply
cubewright extract s.nrrd --iso 0 --color-by t.nrrd --lod 500,100 -o lod.ply -q && grep -a -c 'uchar red' lod-lod1.ply
for t in 1 3; do cubewright extract s.nrrd --iso 0 --color-by t.nrrd -o t$t.ply -t $t --name t -q; done
cmp t1.ply t3.ply && echo "same"
bad() {
    cubewright extract "$@" -q
    echo "$? $*"
}
bad s.nrrd --iso 0 -o bad.ply --colormap gray
bad s.nrrd --iso 0 -o bad.ply --range 0:1
bad s.nrrd --iso 0 -o bad.ply --color-by t.nrrd --range 1:0
bad s.nrrd --iso 0 -o bad.ply --color-by t.nrrd --range 1
bad s.nrrd --iso 0 -o bad.ply --color-by t.nrrd --colormap jet
bad s.nrrd --iso 0 -o bad.ply --color-by none.nrrd
bad two.vtk --array ball --iso 5 -o bad.ply --color-by rain
bad two.vtk --array ball --iso 5 -o bad.ply --color-by wind:9
bad s.nrrd --iso 0 -o bad.ply --color-by t.nrrd --stream always
bad s.nrrd --labels all -o bad.ply --color-by t.nrrd
sed 's/ORIGIN 0/ORIGIN 900/' two.vtk >far.vtk
bad s.nrrd --iso 0 -o bad.ply --color-by far.vtk
ls bad* 2>/dev/null
exit 0
