# Rectilinear and irregular grids in pictures. An even grid has the same picture as a rectilinear
# one with even coordinates, and as hexahedra.
awk 'function head(kind) { return "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET " kind "\n" }
function axis(name,   i, line) {
    line = name "_COORDINATES 7 double\n"
    for (i = 0; i < 7; i++) line = line i - 3 " "
    return line "\n"
}
BEGIN {
    values = "POINT_DATA 343\nSCALARS f double 1\nLOOKUP_TABLE default\n"
    for (k = -3; k < 4; k++) for (j = -3; j < 4; j++) for (i = -3; i < 4; i++) {
        values = values sprintf("%.6f\n", sqrt(i * i + 1.3 * j * j + k * k) + 0.3 * i)
        points = points i " " j " " k "\n"
    }
    printf "%sDIMENSIONS 7 7 7\nORIGIN -3 -3 -3\nSPACING 1 1 1\n%s", head("STRUCTURED_POINTS"), values >"even.vtk"
    printf "%sDIMENSIONS 7 7 7\n%s%s%s%s", head("RECTILINEAR_GRID"), axis("X"), axis("Y"), axis("Z"), values >"rect.vtk"
    printf "%sDIMENSIONS 7 7 7\nPOINTS 343 double\n%s%s", head("STRUCTURED_GRID"), points, values >"cells.vtk"
}'
# draw OPTIONS...: all three grids; says so if the pictures are the same.
draw() {
    for grid in even rect cells; do
        cubewright render $grid.vtk -o $grid.png --size 48x48 -q --backend cpu "$@" || echo "exit $?"
    done
    cmp even.png rect.png && cmp even.png cells.png && echo "same: $*"
}
draw --mode reference --no-lit
draw --mode mip
draw --mode minip
draw --mode average
draw --mode reference --depth-cue 0.5 --clip 0,1,0,-1
draw --mode vbuffer --depth-cue 0.5 --depth-cue-range 0.2,0.6 --depth-cue-form exponential
draw --mode reference --lit --clip-box -1mm:2mm,-2mm:3mm,-9mm:1mm --cut-away
for grid in rect cells; do
    cubewright render $grid.vtk -o $grid.png --size 48x48
    cubewright render $grid.vtk -o $grid.png --size 48x48 --iso 2 --mode vbuffer -q || echo "exit $?"
    cubewright render $grid.vtk -o s.png --size 48x48 --iso 2 -q || echo "exit $?"
    for mode in composite splat texture slices; do
        cubewright render $grid.vtk -o x.png --mode $mode -q --size 8x8 || echo "exit $?"
    done
done
cubewright render even.vtk -o even.png --size 48x48 -q --mode vbuffer --clip-box 1:3,0:5.5,2:4
cubewright render rect.vtk -o rect.png --size 48x48 -q --mode vbuffer --clip-box 1:3,0:5.5,2:4
cmp even.png rect.png && echo "same: clip box"
cubewright render cells.vtk -o x.png --clip-box 1:3,0:5.5,2:4 -q || echo "exit $?"
cubewright render cells.vtk -o x.png --tf ct-bone --size 8x8 -q --save-tf tf.json || echo "exit $?"
# Projection of cells: near the reference.
for grid in rect cells; do
    cubewright render $grid.vtk -o p.png --mode vbuffer --pixel-area -q --size 8x8 || echo "exit $?"
    cubewright render $grid.vtk -o p.png --mode projection --linear-opacity -q --size 8x8 || echo "exit $?"
    cubewright render $grid.vtk -o p.png --compare 'projection|reference' --size 48x48 --no-lit -q --json - |
        awk '/"rmse"/ { print ($2 + 0 < 3 ? "near" : "far: " $2) }'
done
ls ./*.png tf.json
