# A mesh where a volume is expected, a volume where a mesh is, volumes that are no series, and lists
# and folders that are.
cubewright make sphere -o s.nrrd --dims 10 -q
cubewright extract s.nrrd --iso 0 -o s.stl -q
for format in ply obj off glb 3mf vtp; do
    cubewright convert s.stl -o s.$format -q
    cubewright extract s.$format --iso 0 -o x.ply || echo "exit $?"
done
cp s.stl scan.vtk
cubewright info scan.vtk || echo "exit $?"
cubewright info s.stl || echo "exit $?"
cubewright make sphere -o s.nii.gz --dims 10 -q
cubewright make sphere -o s.mha --dims 10 -q
cubewright check s.nrrd || echo "exit $?"
cubewright convert s.nii.gz -o x.ply || echo "exit $?"
cubewright simplify s.mha -o x.ply --ratio 0.5 || echo "exit $?"
cubewright extract s.nrrd s.stl --iso 0 -o 'x{step}.ply' || echo "exit $?"

# steps FILES: image data of so many values, a file each.
mkdir run
for n in 1 2 10; do
    {
        echo '<VTKFile type="ImageData"><ImageData WholeExtent="0 1 0 1 0 1">'
        echo '<Piece Extent="0 1 0 1 0 1"><PointData><DataArray type="Int16" Name="t">'
        echo "0 $n 0 0 0 0 0 0</DataArray></PointData></Piece></ImageData></VTKFile>"
    } >run/t_$n.vti
done
echo "not a volume" >run/notes.txt
cubewright info run
cubewright extract run --iso 0.5 -o '{stem}-{step}.vtp' -q && ls ./*.vtp
cubewright extract run --iso 0.5 -o x.ply || echo "exit $?"
# list TIME FILE ...: a .pvd file
list() {
    echo '<VTKFile type="Collection" version="0.1"><Collection>'
    while [ $# -gt 0 ]; do
        echo "<DataSet timestep=\"$1\" group=\"\" part=\"0\" file=\"$2\"/>"
        shift 2
    done
    echo '</Collection></VTKFile>'
}
list 2.5 run/t_1.vti 1 run/t_10.vti -1 run/t_2.vti >run.pvd
cubewright info run.pvd
cubewright extract run.pvd --iso 0.5 -o 'p{step}.vtp' --pvd p.pvd | sed 's/:.*; at/: at/;s/ s;.*/ s/'
grep DataSet p.pvd
cubewright extract run.pvd --iso 0.5 --steps 1 -o 'one{step}.ply' -q && ls one*
cubewright extract run.pvd --iso 0.5 --animate -o run.glb -q && ls run.glb

# What cannot be.
try() {
    cubewright "$@" || echo "exit $?"
}
try extract p.pvd --iso 0 -o 'x{step}.ply'
try convert p.pvd -o x.ply
try check s.stl --source run.pvd --iso 0
try info run.pvd s.nrrd
for files in "1 run/none.vti" "1 ../run/t_1.vti" "1 run/t_1.vti 1 run/t_2.vti" "x run/t_1.vti" ""; do
    # shellcheck disable=SC2086
    list $files >bad.pvd
    try info bad.pvd
done
cp s.nrrd run
try info run
