# N5: a surface and labels out of stores, the same as from a file of the voxels.
mkdir -p ball.n5/0/0
awk 'BEGIN { for (z = 0; z < 9; z++) for (y = 0; y < 9; y++) for (x = 0; x < 9; x++) {
    v = 60 - (x - 4) ^ 2 - (y - 4) ^ 2 - (z - 4) ^ 2; printf "%c", (v < 1 ? 1 : v) } }' >voxels
printf '\0\0\0\3\0\0\0\011\0\0\0\011\0\0\0\011' | cat - voxels >ball.n5/0/0/0
echo '{"dimensions": [9, 9, 9], "blockSize": [9, 9, 9], "dataType": "uint8", "compression": {"type": "raw"}}' \
    >ball.n5/attributes.json
cubewright extract ball.n5 --iso 50 -o a.stl -q
cubewright extract voxels --raw dims=9x9x9,type=u8 --iso 50 -o b.stl -q
cmp a.stl b.stl && echo "the same surface"
cubewright extract ball.n5 --crop 2:8,2:8,2:8 --iso 50 -o c.stl -q
mkdir -p map.n5/0/0
printf '\0\0\0\3\0\0\0\3\0\0\0\3\0\0\0\003222222222222212222222222222' >map.n5/0/0/0
sed 's/9, 9, 9/3, 3, 3/g' ball.n5/attributes.json >map.n5/attributes.json
cubewright extract map.n5 --labels all -o '{name}.stl'
ls ./*.stl
