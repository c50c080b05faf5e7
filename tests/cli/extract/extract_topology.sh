# Noise is full of ambiguous cells: the field's topology is one thing, one table's another.
cubewright make gyroid -o noise.nrrd --dims 24 --noise 1 -q
for t in field simple; do
    cubewright extract noise.nrrd --iso 0 -o $t.ply --topology $t --json - -q |
        grep -e '"topology"' -e '"components"' -e '"euler"' -e '"open_edges"'
done
