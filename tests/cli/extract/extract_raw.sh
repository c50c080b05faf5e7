# The same voxels behind a header of 100 bytes, and as another format: the same mesh.
cubewright make sphere -o s.nii --dims 21x20x19 --type u16 -q
head -c 100 /dev/zero >s.raw
tail -c +353 s.nii >>s.raw
layout=dims=21x20x19,type=u16le,offset=100
cubewright extract s.raw --raw $layout --iso 32767.5 -o a.stl
cubewright extract s.raw --raw $layout --spacing 4,4,4mm --iso 32767.5 -o b.stl
cubewright extract s.nii --iso 32767.5 -o c.stl -q
cubewright extract s.raw --raw $layout --spacing 500um --iso 32767.5 -o d.stl
for spacing in 0.5mm 500000nm 0.05cm 0.0005m; do
    cubewright extract s.raw --raw $layout --spacing $spacing --iso 32767.5 -o e.stl -q
    cmp d.stl e.stl && echo "500um is $spacing"
done
# three numbers are parted by 'x' or by commas
cubewright extract s.raw --raw dims=21,20,19,type=u16le,offset=100 --spacing 4x4x4mm --iso 32767.5 -o e.stl -q
cmp b.stl e.stl && echo same file
cubewright extract s.nii --crop 0:9x0:9x0:9 --iso 32767.5 -o e.stl -q
cubewright extract s.nii --crop 0:9,0:9,0:9 --iso 32767.5 -o f.stl -q
cmp e.stl f.stl && echo same box
cubewright make sphere -o s4.nii --dims 4,5,6 -q
cubewright info s4.nii | sed -n 2p
for spacing in 4x4,4mm 4x4mm 0x4x4mm 4x4x4x4mm 4x4xx4mm 4x4xmm 4x4x4 4mmx4x4; do
    cubewright extract s.nii --spacing $spacing --iso 1 -o e.stl 2>/dev/null
    echo "$? $spacing"
done
rm e.stl
wc -c <b.stl >b
wc -c <c.stl | cmp - b && echo same size
cubewright extract s.raw --raw dims=21x20x20,type=u16le,offset=100 --iso 1 -o e.stl
echo $?
cubewright extract s.raw --raw dims=21x20,type=u16le --iso 1 -o e.stl
echo $?
cubewright extract s.raw --iso 1 -o e.stl
echo $?
ls e.stl
