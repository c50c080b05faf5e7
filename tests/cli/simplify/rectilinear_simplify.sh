# Simplified on a rectilinear grid: what is refused is the distance to its field alone.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
{
    echo "# vtk DataFile Version 3.0
x squared
ASCII
DATASET RECTILINEAR_GRID
DIMENSIONS 4 9 9
X_COORDINATES 4 float
0 1 3 4
Y_COORDINATES 9 int
0 1 2 3 4 5 7 8 9
Z_COORDINATES 9 int
0 1 2 3 4 5 7 8 10
POINT_DATA 324
SCALARS s float"
    awk 'BEGIN { for (i = 0; i < 81; i++) print 0, 1, 9, 16 }'
} >g.vtk
cubewright extract g.vtk --iso 5 --inside below -o cut.ply --simplify 0.01mm
cubewright extract g.vtk --iso 5 --inside below -o count.ply --simplify 20 --json - -q |
    sed -n -e '/"simplify_/p' -e '/"to_field"/p' -e '/"warnings"/,/]/p'
