# Each a one-line error that names file, field and expectation, the right exit code, no output,
# and no memory to speak of: headers that lie are found out before anything is allocated.
ulimit -v 400000
extract() {
    cubewright extract "$1" --iso 1 -o out.glb -q
    echo "$? $1"
}
cubewright make sphere -o sphere.nrrd --dims 16 -q
cubewright make sphere -o sphere.nii.gz --dims 24 --noise 1 -q
: >empty.nrrd
head -c 3000 sphere.nii.gz >cut.nii.gz
printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 2147483648 2147483648 2\nencoding: raw\nendian: little\n\nxxxx' >vast.nrrd
printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 2147483647 2147483647 1\nencoding: gzip\nendian: little\n\nxxxx' >bomb.nrrd
printf 'NRRD0004\ntype: short\ndimension: 3\nsizes: 4 4\nencoding: raw\nendian: little\n\nxxxx' >two.nrrd
gzip -dc sphere.nii.gz >negative.nii
printf '\377\377' | dd of=negative.nii bs=1 seek=44 conv=notrunc 2>/dev/null
cp sphere.nii.gz tail.nii.gz
echo x >>tail.nii.gz
big=2147483647
echo "NDims = 3
DimSize = $big $big 1
ElementType = MET_UCHAR
CompressedData = True
ElementDataFile = LOCAL" >bomb.mha
echo "# vtk DataFile Version 3.0
vast
BINARY
DATASET STRUCTURED_POINTS
DIMENSIONS $big $big 1
POINT_DATA 4611686014132420609
SCALARS s char
LOOKUP_TABLE default" >vast.vtk
echo "<VTKFile type='ImageData' byte_order='LittleEndian' compressor='vtkZLibDataCompressor'>
<ImageData><Piece Extent='0 2147483646 0 2147483646 0 0'><PointData>
<DataArray type='UInt8' format='binary'>AQAAAP///38AAAAAAQAAAAA=</DataArray>
</PointData></Piece></ImageData></VTKFile>" >bomb.vti
printf '#INRIMAGE-4#{\nXDIM=%d\nYDIM=%d\nZDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\n#%162s\n##}\n' \
    $big $big '' >vast.inr
{
    printf '\377\377\377\177\377\377\377\177\1\0\0\0\0\0\0\0'
    head -c 48 /dev/zero
    printf '\1\0\0\0\2\0\0\0\3\0\0\0'
    head -c 132 /dev/zero
    printf 'MAP DD\0\0'
    head -c 2000 /dev/zero
} >vast.mrc
echo hello >unknown.xyz
mkdir folder
mkfifo pipe
for f in missing.nrrd empty.nrrd cut.nii.gz vast.nrrd bomb.nrrd two.nrrd negative.nii tail.nii.gz \
    bomb.mha vast.vtk bomb.vti vast.inr vast.mrc unknown.xyz folder pipe; do
    extract $f
done
ls out.glb
