# Isovalues by name: the numbers that info prints, of the range, and of a CT.
cubewright make ct-head -o ct.nii.gz --dims 48 --noise 20 -q
cubewright info ct.nii.gz | grep level
for level in otsu dark medium bright bone skin soft lung; do
    number=$(cubewright info ct.nii.gz | sed -n "s/.*level *$level *--iso //p")
    cubewright extract ct.nii.gz --iso $level -o 'name-{level}.stl' --name head 2>&1 | grep iso
    cubewright extract ct.nii.gz --iso "$number" -o number.stl --name head -q
    cmp "name-$level.stl" number.stl && echo "same as $number"
done
cubewright extract ct.nii.gz --iso 40%,half,half:-100:300 -o '{level}.stl' 2>&1 | grep iso
ls ./*%.stl 100.stl

# The same slice by slice, and in all commands.
cubewright extract ct.nii.gz --iso otsu -o slices.stl --name head --stream always -q
cmp slices.stl name-otsu.stl && echo same
cubewright extract ct.nii.gz --iso bone -o bone.ply -q
cubewright check bone.ply --source ct.nii.gz --iso bone 2>&1 | grep isovalue
cubewright simplify bone.ply --ratio 0.5 --source ct.nii.gz --iso bone -o half.ply 2>&1 | grep isovalue
cubewright render ct.nii.gz --iso skin -o skin.png 2>&1 | grep isovalue
cubewright info ct.nii.gz --iso bone 2>&1 | grep -e '226.*triangles'

# Refused: names of tissues without Hounsfield units, what is no name, parts, and equal values.
cubewright make sphere -o sphere.nrrd --dims 12 -q
try() {
    cubewright extract "$@"
    echo "$?"
}
try sphere.nrrd --iso bone -o no.stl -q
try ct.nii.gz --iso bonee -o no.stl
try ct.nii.gz --iso 101% -o no.stl
try ct.nii.gz --iso half:1 -o no.stl
try ct.nii.gz --iso bone,bone -o '{level}-no.stl'
try ct.nii.gz --iso otsu --part 1/2 --manifest parts -q
head -c 1000 /dev/zero >zero.raw
try zero.raw --raw dims=10x10x10,type=u8 --iso bright -o no.stl -q
