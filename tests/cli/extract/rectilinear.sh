# A rectilinear grid: 1.5 - x^2 - y^2 - 1.3 z^2 at points, another array at cells.
awk 'BEGIN {
    n = split("-3 -1.5 -1 -0.75 -0.5 -0.25 0 0.25 0.5 0.75 1 1.5 3", at, " ")
    for (i = 1; i <= n; i++)
        line = line " " at[i]
    array = "<DataArray type=\"Float64\">" line "</DataArray>"
    print "<VTKFile type=\"RectilinearGrid\"><RectilinearGrid WholeExtent=\"0 12 0 12 0 12\">"
    print "<Piece Extent=\"0 12 0 12 0 12\"><Coordinates>" array array array "</Coordinates>"
    print "<PointData><DataArray type=\"Float32\" Name=\"bowl of points\">"
    for (k = 1; k <= n; k++)
        for (j = 1; j <= n; j++)
            for (i = 1; i <= n; i++)
                print 1.5 - at[i] * at[i] - at[j] * at[j] - 1.3 * at[k] * at[k]
    print "</DataArray></PointData><CellData><DataArray type=\"UInt8\" Name=\"layer\">"
    for (k = 1; k < n; k++)
        for (i = 0; i < (n - 1) * (n - 1); i++)
            print k
    print "</DataArray></CellData></Piece></RectilinearGrid></VTKFile>"
}' >g.vtr
cubewright info g.vtr
cubewright info g.vtr --array layer | sed -n 2,8p
cubewright info g.vtr --json | sed -n -e '/"spacing"/,/"unit"/p'
cubewright extract g.vtr --iso 0 -o closed.ply
cubewright extract g.vtr --iso 0 -o open.ply --open --name closed -q
cmp closed.ply open.ply # it does not meet the border
cubewright extract g.vtr --iso 0 -o slices.ply --stream always --slab 2 --name closed -q
cmp closed.ply slices.ply
cubewright extract g.vtr --iso 0 -o crop.ply --crop 6:12,0:12,0:12 --json - -q |
    sed -n -e '/"rectilinear"/p' -e '/"euler"/p' -e '/"open_edges"/p'
cubewright extract g.vtr --iso 6.5 --array layer -o layer.ply -q && ls layer.ply
cubewright extract g.vtr --iso 0 --array bowl -o none.ply || echo "exit $?"
cubewright make sphere -o s.nrrd --dims 8 -q
cubewright extract s.nrrd --iso 0 --array bowl -o none.ply || echo "exit $?"
# what is made for even grids
cubewright extract g.vtr --iso 0 -o none.ply --snap 0.3 -q || echo "exit $?"
cubewright extract g.vtr --iso 0 -o none.ply --placement cubic -q || echo "exit $?"
cubewright extract g.vtr --iso 0 -o none.ply --preview -q || echo "exit $?"
cubewright check closed.ply --source g.vtr --iso 0 -q || echo "exit $?"
