# Files of labels: each solid is judged by itself, interfaces as a whole, and each beside its label.
cubewright make labels/cells --dims 24 --labels 6 --type u8 -o cells.nrrd -q
for to in cells.glb cells.3mf cells.ply cells.obj; do
  cubewright extract cells.nrrd --labels all -o $to -q
  cubewright check $to -q && echo "$to passes"
done
cubewright check cells.glb
cubewright check cells.glb --deep | grep -e between -e interfaces
cubewright check cells.glb --source cells.nrrd --json c.json | grep -e volumes -e distance -e meets
grep -c voxel_volume c.json
cubewright check cells.ply --source cells.nrrd --tolerance 2mm | grep -e distance -e meets
cubewright check cells.ply --source cells.nrrd --tolerance 0.01mm >fail.txt; echo "exit $?"
grep FAIL fail.txt
# simplified together they still share interfaces
cubewright extract cells.nrrd --labels all --simplify 3000 -o less.glb -q && cubewright check less.glb --deep | grep -e interfaces -e between
# a label of another map, and labels without a surface
cubewright extract cells.nrrd --labels 1-4 -o some.glb -q
cubewright check some.glb --source cells.nrrd | grep 'FAIL\|warn'
cubewright make labels/cells --dims 24 --labels 3 --type u8 -o three.nrrd -q
cubewright check cells.glb --source three.nrrd >fail.txt; echo "exit $?"
grep FAIL fail.txt
# one triangle of a label is turned: that label is named
awk '/^o / { part++ } part == 2 && /^f / && !done { print $1, $2, $4, $3; done = 1; next } { print }' cells.obj >turned.obj
cubewright check turned.obj >fail.txt; echo "exit $?"
grep FAIL fail.txt
# the same solid twice
cubewright make sphere --dims 16 -o ball.nrrd -q
cubewright extract ball.nrrd --iso 0 -o ball.obj -q
awk 'NR == FNR { if (/^v /) n++; print; next } /^o / { $2 = "again" } /^f / { for (i = 2; i < 5; i++) { split($i, a, "/"); $i = a[1] + n }; print; next } /^[ov] / { print }' ball.obj ball.obj >twice.obj
cubewright check twice.obj >fail.txt; echo "exit $?"
grep FAIL fail.txt
# parts that do not touch are one mesh; a volume without labels needs an isovalue
cubewright check ball.obj --source cells.nrrd; echo "exit $?"
