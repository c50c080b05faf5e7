# What is said of an input's unit and axes, where the file does not say it or says otherwise.
size() {
    sed -n -e 's/.*box /box /' -e 's/ mm.*/ mm/' -e '/^box/p' "$@"
}
# volumes: image data name neither
cat >v.vti <<'END'
<VTKFile type="ImageData"><ImageData WholeExtent="0 2 0 3 0 4" Origin="1 2 3" Spacing="1 2 4">
<Piece Extent="0 2 0 3 0 4"><PointData><DataArray type="UInt8" Name="t">
0 0 0 0 0 0 0 0 0 0 0 0  0 0 0 0 1 0 0 1 0 0 0 0  0 0 0 0 1 0 0 1 0 0 0 0
0 0 0 0 1 0 0 1 0 0 0 0  0 0 0 0 0 0 0 0 0 0 0 0
</DataArray></PointData></Piece></ImageData></VTKFile>
END
frame() {
    cubewright info "$@" | sed -n -e 2p -e /frame/p
}
frame v.vti
frame v.vti --input-unit m
frame v.vti --input-unit cm --input-up y
frame v.vti --input-up y --input-frame ras
frame v.vti --input-frame ras --crop 0:1,0:1,0:1
cubewright info v.vti --json --input-unit m --input-frame ras | grep -e '"unit"' -e '"frame"'
cubewright extract v.vti --iso 0.5 --input-unit m -o m.stl -q --json - | sed -n '/"box"/p'
cubewright render v.vti --mode mip --input-unit m -o m.png -q --json - | grep -c schema
# a format that can state a frame, and does not
head='type: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n'
printf "NRRD0005\n${head}space dimension: 3\nspace units: \"mm\" \"mm\" \"mm\"\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\n0 0 0 0 1 1 1 1\n" >u.nrrd
printf "NRRD0005\n${head}space: left-posterior-superior\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n\n0 0 0 0 1 1 1 1\n" >f.nrrd
cubewright extract u.nrrd --iso 0.5 -o u.stl 2>&1 | sed -n 's/.*u8, //p'
cubewright extract u.nrrd --iso 0.5 -o u.stl --input-frame ras 2>&1 | sed -n 's/.*u8, //p'
cubewright extract f.nrrd --iso 0.5 -o u.stl 2>&1 | sed -n 's/.*u8, //p'
# an irregular grid has its points turned
cat >g.vtk <<'END'
# vtk DataFile Version 3.0
a tetrahedron
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 1 0 0 0 2 0 0 0 3
CELLS 1 5
4 0 1 2 3
CELL_TYPES 1
10
POINT_DATA 4
SCALARS s float
LOOKUP_TABLE default
0 1 2 3
END
frame g.vtk --input-unit m --input-up y
cubewright extract g.vtk --iso 1.5 --input-unit in --input-up y -o g.stl | size
# those that say something
cubewright make sphere -o s.nii.gz --dims 10 -q
try() {
    cubewright "$@" || echo "exit $?"
}
frame s.nii.gz --input-unit mm --input-frame ras --input-up z
try info s.nii.gz --input-unit m
try info s.nii.gz --input-frame lps
try info s.nii.gz --input-up y
frame s.nii.gz --input-unit um --input-frame lps --input-override
try info s.nii.gz --input-unit mm --spacing 1mm
try info v.vti --input-unit furlong
# meshes
printf 'v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >t.obj
cubewright check t.obj --input-unit m --input-up y | size
cubewright convert t.obj -o t.stl --input-unit in --input-up y | size
cubewright check t.stl | size
cubewright convert t.obj -o t.ply --input-unit m --input-frame ras --unit cm --ascii -q && sed -n -e '/^comment/p' -e '/^-/p' t.ply
cubewright convert t.obj -o t.off --input-unit m --input-up y -q --json - | sed -n '/"input"/,/}/p' | grep -v sha256
cubewright simplify t.obj -o x.ply --error 100mm --input-unit m --input-up y | size
try check t.ply --input-unit m
try check t.ply --input-unit cm --input-frame ras | size
cubewright convert t.ply -o x.off --input-unit mm --input-override | size
cubewright convert t.obj -o t.glb -q
try check t.glb --input-unit mm
try check t.glb --input-up z
cubewright check t.glb --input-unit mm --input-up z --input-override | size
cubewright check t.glb | size
# a source, and a reference, beside the mesh
cubewright extract v.vti --iso 0.5 --input-unit m -o m.ply -q
cubewright check m.ply --source v.vti --iso 0.5 --source-unit m --tolerance 200mm | tail -n 1 | sed 's/; [0-9.]* s$//'
cubewright check t.obj --input-unit m --reference t.obj --tolerance 1um | tail -n 1 | sed 's/; [0-9.]* s$//'
cubewright check t.obj --input-unit m --input-frame ras --reference t.ply --tolerance 1um | tail -n 1 | sed 's/; [0-9.]* s$//'
