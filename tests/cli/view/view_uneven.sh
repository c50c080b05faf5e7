# Grids that are not evenly spaced in the window: as volumes, in the modes that draw them.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cat >t.vtk <<'END'
# vtk DataFile Version 3.0
two tetrahedra
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 5 double
0 0 0  1 0 0  0 1 0  0 0 1  1 1 1
CELLS 2 10
4 0 1 2 3
4 1 2 3 4
CELL_TYPES 2
10 10
POINT_DATA 5
SCALARS f double 1
LOOKUP_TABLE default
0 1 2 3 4
END
cat >r.vtk <<'END'
# vtk DataFile Version 3.0
a box
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 2 2 3
X_COORDINATES 2 double
0 1
Y_COORDINATES 2 double
0 1
Z_COORDINATES 3 double
0 1 4
POINT_DATA 12
SCALARS f double 1
LOOKUP_TABLE default
0 1 2 3 4 5 6 7 8 9 10 11
END
cubewright make torus -o e.nrrd --dims 12 -q
view() {
    cubewright view "$1" -q --hidden --size 420x320 --exec "$2" || echo "exit $?"
}
for grid in t r; do
    view $grid.vtk 'print mode; screenshot a.png; mode mip; print mode; screenshot b.png; mode reference; iso 2; wait; print triangles'
    view $grid.vtk 'mode composite; print mode'
    view $grid.vtk 'toggle quad; toggle panels; wait; mouse 300 250; press; mouse 340 270; lift; wait; print mode; screenshot c.png; capture d.png'
    cmp -s a.png b.png && echo "the same"
done
# A mode of another file gives way to one that draws the grid.
view e.nrrd 'mode splat; drop t.vtk; print mode; mode mip; drop r.vtk; print mode; drop e.nrrd; print mode'
cubewright view t.vtk --hidden --size 420x320 --mode texture --exec 'print mode'
