# Voxels without a value: stated by --nodata, none of them, and slice by slice the same.
awk 'BEGIN { for (z = 0; z < 6; z++) for (y = 0; y < 6; y++) for (x = 0; x < 6; x++)
    printf "%s", (x > 0 && x < 3 && y > 0 && y < 5 && z > 0 && z < 5) ? "d" : (x == 3) ? "0" : "2" }' >x.raw
raw=dims=6x6x6,type=u8,spacing=1x1x1mm
# of the digits 0 is 48, 2 is 50 and d is 100: a slab of 48 stands beside the box
cubewright extract x.raw --raw $raw --iso 75 -o all.stl
cubewright extract x.raw --raw $raw --iso 75 --nodata 48 -o gap.stl
cubewright extract x.raw --raw $raw --iso 75 --nodata 48 -o stream.stl --stream always -q && cmp gap.stl stream.stl && echo "same in slices"
cubewright extract x.raw --raw $raw --iso 75 --nodata none -o none.stl -q && cmp all.stl none.stl && echo "same as without"
cubewright info x.raw --raw $raw --nodata 48 | grep -e 'no value' -e values
cubewright extract x.raw --raw $raw --iso 75 --nodata 48 -o gap.stl --save-config c.json -q && grep nodata c.json
cubewright extract x.raw --raw $raw --iso 75 --nodata none -o gap.stl --save-config c.json -q && grep nodata c.json
bad() {
    cubewright extract x.raw --raw $raw --iso 75 -o bad.stl "$@" -q
    echo "$? $*"
}
bad --nodata 300
bad --nodata 48.5
bad --nodata off
bad --nodata nan
# what hides a surface is told
bad --nodata 100
bad --nodata 100 --stream always
ls bad.stl 2>/dev/null
exit 0
