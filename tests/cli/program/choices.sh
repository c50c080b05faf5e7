# What is chosen because nobody said: a step, a component, an array; and labels that an isovalue
# joins.
sh "$TESTS/support/steps.sh" 8 >4d.nrrd
cubewright extract 4d.nrrd --iso 0.5 -o a.stl | sed 's/:.*//'
cubewright extract 4d.nrrd --iso 0.5 --step 2 -o a.stl | sed 's/:.*//'
cat >v.vti <<'END'
<VTKFile type="ImageData"><ImageData WholeExtent="0 3 0 1 0 1"><Piece Extent="0 3 0 1 0 1">
<PointData><DataArray type="Float64" Name="flow" NumberOfComponents="2">
0 0 3 4 6 8 9 12  0 0 3 4 6 8 9 12  0 0 3 4 6 8 9 12  0 0 3 4 6 8 9 12</DataArray>
<DataArray type="Int64" Name="id">1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4</DataArray>
<DataArray type="UInt8" Name="t">1 2 3 4 1 2 3 4 1 2 3 4 1 2 3 4</DataArray>
</PointData></Piece></ImageData></VTKFile>
END
cubewright extract v.vti --iso 2.5 -o a.stl | sed 's/:.*//'
cubewright extract v.vti --array flow --iso 2 -o a.stl | sed 's/.*box/box/;s/mm.*//'
cubewright extract v.vti --array flow --component mag --iso 10 -o a.stl --json - -q |
    grep '"component"'
cubewright extract v.vti --array flow --component mag --iso 10 -o a.ply | sed 's/.*box/box/;s/mm.*//'
cubewright extract v.vti --array flow --component 1 --iso 10 -o a.ply -q && echo quiet
cubewright info v.vti
cubewright info v.vti --json | sed -n '/"arrays"/,/^  ]/p'
cubewright info v.vti --array flow --component mag | grep values
cubewright info v.vti --component mag || echo "exit $?"
cubewright info v.vti --array flow --component 2 || echo "exit $?"
cubewright info v.vti --component most || echo "exit $?"
cubewright extract v.vti --array flow --component mag --iso 10 -o a.ply --memory 300 || echo "exit $?"

# Four labels in stripes of four voxels, which skip each other; two of them; and a file that says so.
awk 'BEGIN { print "NRRD0004\ntype: uint8\nencoding: ascii\ndimension: 3\nsizes: 16 8 8\n"
    for (n = 0; n < 1024; n++) print substr("0295", 1 + int(n % 16 / 4), 1) }' >l.nrrd
cubewright extract l.nrrd --iso 0.5 --open -o a.ply | sed 's/:.*//'
cubewright extract l.nrrd --iso 3,8 --open -o 'a{level}.ply' | sed 's/:.*//'
cubewright extract l.nrrd --iso 6 --inside below --open -o a.ply | sed 's/:.*//'
cubewright info l.nrrd | grep note
sed 's/[59]$/2/;s/^encoding.*/&\nSegment0_LabelValue:=2/' l.nrrd >s.nrrd
cubewright info s.nrrd | grep note || echo "one label"
