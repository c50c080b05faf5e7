# The same voxels under a frame and under its mirror image: two heads that mirror each other,
# both right side out, each in its own place.
cubewright make ct-head -o head.mha --dims 40 --type i16 -q
cubewright make ct-head -o n.nii --dims 40 --type i16 -q
tail -c 128000 n.nii >voxels.raw
header() {
    printf 'NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 40 40 40\nspace directions: (%s,0,0) (0,6,0) (0,0,6)\nspace origin: (%s,0,0)\nencoding: raw\nendian: little\ndata file: voxels.raw\n' "$1" "$2"
}
header 6 0 >plain.nhdr
header -6 0 >mirrored.nhdr
for f in plain mirrored; do
    cubewright extract $f.nhdr --iso -300 -o $f.ply --json - -q |
        grep -e '"box"' -e '"volume"' -e '"misoriented' | sed 's/\(\.[0-9][0-9]\)[0-9]*/\1/g'
done
