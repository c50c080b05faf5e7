# An irregular grid: two pieces with a seam, of which one has a cell of each shape; values at
# points and cells. What is made for grids in rows says so.
cat >g.vtu <<'END'
<VTKFile type="UnstructuredGrid"><UnstructuredGrid>
<Piece NumberOfPoints="11" NumberOfCells="5"><PointData Scalars="f">
<DataArray type="Float32" Name="f">0 1 2 3 4 5 6 7 8 9 10</DataArray>
<DataArray type="Int16" Name="flow" NumberOfComponents="2">
0 0 1 2 2 4 3 6 4 8 5 10 6 12 7 14 8 16 9 18 10 20</DataArray></PointData>
<CellData><DataArray type="UInt8" Name="region">1 2 3 4 9</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3">
0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  .5 .5 2  2 0 0  2 0 1
</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity">
0 1 2 3 4 5 6 7  4 5 6 7 8  1 9 2 5 10 6  1 9 2 10  0 1 2 </DataArray>
<DataArray type="Int64" Name="offsets">8 13 19 23 26</DataArray>
<DataArray type="UInt8" Name="types">12 14 13 10 5</DataArray></Cells></Piece>
<Piece NumberOfPoints="4" NumberOfCells="1"><PointData Scalars="f">
<DataArray type="Float32" Name="f">0 1 3 -5</DataArray>
<DataArray type="Int16" Name="flow" NumberOfComponents="2">0 0 1 2 3 6 7 7</DataArray></PointData>
<CellData><DataArray type="UInt8" Name="region">7</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3">
0 0 0  1 0 0  0 1 0  0 0 -1</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity">0 2 1 3</DataArray>
<DataArray type="Int64" Name="offsets">4</DataArray>
<DataArray type="UInt8" Name="types">10</DataArray></Cells></Piece>
</UnstructuredGrid></VTKFile>
END
cubewright info g.vtu
cubewright info g.vtu --array region | sed -n 2,12p
cubewright info g.vtu --array flow --component 1 | sed -n -e 2p -e /values/p
cubewright info g.vtu --json | sed -n -e '/"dims"/,/"frame"/p' -e '/"notes"/,/]/p'
cubewright info g.vtu g.vtu
cubewright info g.vtu --array none || echo "exit $?"
cubewright info g.vtu --crop 0:1,0:0,0:0 || echo "exit $?"
cubewright info g.vtu --spacing 1mm || echo "exit $?"
cubewright info g.vtu --max-voxels 12 || echo "exit $?"
cubewright info g.vtu --memory 500 || echo "exit $?"
sed 's/>12 14/>42 14/' g.vtu >poly.vtu
cubewright info poly.vtu || echo "exit $?"
cubewright extract g.vtu --iso 2 -o none.ply --preview -q || echo "exit $?"
cubewright extract g.vtu --iso 2 -o none.ply --crop 0:1,0:0,0:0 -q || echo "exit $?"
cubewright make sphere -o s.nrrd --dims 8 -q && cubewright extract s.nrrd --iso 0 -o s.ply -q
cubewright check s.ply --source g.vtu --iso 0 -q || echo "exit $?"
cubewright info g.vtu --iso 2 || echo "exit $?"
[ ! -e none.ply ]
