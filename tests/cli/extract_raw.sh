# The same voxels behind a header of 100 bytes, and as another format: the same mesh.
cubewright make sphere -o s.nii --dims 21x20x19 --type u16 -q
head -c 100 /dev/zero >s.raw
tail -c +353 s.nii >>s.raw
layout=dims=21x20x19,type=u16le,offset=100
cubewright extract s.raw --raw $layout --iso 32767.5 -o a.stl
cubewright extract s.raw --raw $layout --spacing 4,4,4 --iso 32767.5 -o b.stl
cubewright extract s.nii --iso 32767.5 -o c.stl -q
cubewright extract s.raw --raw $layout --spacing 500um --iso 32767.5 -o d.stl
wc -c <b.stl >b
wc -c <c.stl | cmp - b && echo same size
cubewright extract s.raw --raw dims=21x20x20,type=u16le,offset=100 --iso 1 -o e.stl
echo $?
cubewright extract s.raw --raw dims=21x20,type=u16le --iso 1 -o e.stl
echo $?
cubewright extract s.raw --iso 1 -o e.stl
echo $?
ls e.stl
