# Surfaces of VTK in pieces, and blocks as parts with their names; then lists that lie.
piece() { # NAME X Y Z: a triangle from x to y and z
    cat >"$1" <<END
<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="3" NumberOfPolys="1"><Points>
<DataArray type="Float32" NumberOfComponents="3">$2 $3 $4</DataArray></Points><Polys>
<DataArray type="Int32" Name="connectivity">0 1 2</DataArray>
<DataArray type="Int32" Name="offsets">3</DataArray></Polys></Piece></PolyData></VTKFile>
END
}
list() { # NAME FILE...
    name=$1
    shift
    {
        echo '<VTKFile type="PPolyData"><PPolyData>'
        printf '<Piece Source="%s"/>\n' "$@"
        echo '</PPolyData></VTKFile>'
    } >"$name"
}
mkdir parts
piece parts/a.vtp "0 0 0" "1 0 0" "0 1 0"
piece parts/b.vtp "1 0 0" "1 1 0" "0 1 0"
list two.pvtp parts/a.vtp parts/b.vtp
cubewright convert two.pvtp -o two.off
sed -n 2,99p two.off
cat >all.vtm <<'END'
<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet><DataSet name="bone" file="parts/a.vtp"/>
<Block name="head"><DataSet name="skin" file="parts/b.vtp"/><DataSet name="air"/></Block>
</vtkMultiBlockDataSet></VTKFile>
END
cubewright convert all.vtm -o all.obj
grep '^[of]' all.obj
for file in gone.vtp ../a.vtp parts/a.vtp bad.pvtp; do
    list bad.pvtp parts/a.vtp "$file"
    cubewright convert bad.pvtp -o bad.off -q
    echo "$? $file"
done
cubewright extract all.vtm --iso 1 -o bad.off -q
echo "$? a volume of it"
cubewright convert two.off -o two.pvtp
echo "$? is not written"
