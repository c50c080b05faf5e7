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
echo hello >unknown.xyz
mkdir folder
mkfifo pipe
for f in missing.nrrd empty.nrrd cut.nii.gz vast.nrrd bomb.nrrd two.nrrd negative.nii unknown.xyz folder pipe; do
    extract $f
done
ls out.glb
