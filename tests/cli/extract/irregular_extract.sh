# The surface of irregular grids: a pyramid, a wedge and a tetrahedron around a hexahedron.
cat >g.vtu <<'END'
<VTKFile type="UnstructuredGrid"><UnstructuredGrid>
<Piece NumberOfPoints="11" NumberOfCells="4"><PointData Scalars="f">
<DataArray type="Float32" Name="f">9 9 9 9 9 9 0 9 9 9 9</DataArray>
<DataArray type="Float32" Name="x">0 1 1 0 0 1 1 0 .5 2 2</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3">
0 0 0  1 0 0  1 1 0  0 1 0  0 0 1  1 0 1  1 1 1  0 1 1  .5 .5 2  2 0 0  2 0 1
</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity">
0 1 2 3 4 5 6 7  4 5 6 7 8  1 9 2 5 10 6  5 10 6 8 </DataArray>
<DataArray type="Int64" Name="offsets">8 13 19 23</DataArray>
<DataArray type="UInt8" Name="types">12 14 13 10</DataArray></Cells></Piece>
</UnstructuredGrid></VTKFile>
END
cubewright extract g.vtu --iso 4.5 -o f.ply
cubewright extract g.vtu --iso 4.5 --inside below -o below.ply -q
cubewright extract g.vtu --array x --iso 0.5 --open -o open.stl
cubewright extract g.vtu --array x --iso 0.25,0.75 -o '{level}.glb' -q
cubewright extract g.vtu --array x --iso 0.5 --topology simple --normals none -o simple.ply -q
cubewright extract g.vtu --array x --iso 0.5 --simplify 10 -o few.ply -q
cubewright render g.vtu --iso 4.5 -o f.png --size 64x64 | sed 's/;.*//'
for mesh in f.ply below.ply 0.25.glb 0.75.glb simple.ply few.ply; do
    cubewright check $mesh -q || echo "exit $?"
done
cubewright extract g.vtu --iso 10 -o none.ply -q || echo "exit $?"
cubewright extract g.vtu --iso 4.5 --snap 0.3 -o none.ply -q || echo "exit $?"
cubewright extract g.vtu --iso 4.5 --placement cubic -o none.ply -q || echo "exit $?"
cubewright extract g.vtu --iso 4.5 --max-triangles 5 -o none.ply -q || echo "exit $?"
[ ! -e none.ply ]
cubewright info g.vtu --points g.vtu || echo "exit $?"
cubewright info none.q --points none.xyz || echo "exit $?"
