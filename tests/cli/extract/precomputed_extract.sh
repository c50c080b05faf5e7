# Neuroglancer's precomputed volumes: a surface and labels out of chunks, and meshes beside them.
mkdir -p ball/s
awk 'BEGIN { for (z = 0; z < 9; z++) for (y = 0; y < 9; y++) for (x = 0; x < 9; x++) {
    v = 60 - (x - 4) ^ 2 - (y - 4) ^ 2 - (z - 4) ^ 2; printf "%c", (v < 1 ? 1 : v) } }' >ball/s/0-9_0-9_0-9
echo '{"type": "image", "data_type": "uint8", "num_channels": 1, "scales": [{"key": "s", "size": [9, 9, 9],
 "resolution": [1e6, 1e6, 1e6], "chunk_sizes": [[9, 9, 9]], "encoding": "raw"}]}' >ball/info
cubewright extract ball --iso 50 -o a.stl -q
printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 9 9 9\nencoding: raw\nspace dimension: 3\n%s\n%s\n\n' \
    'space directions: (1,0,0) (0,1,0) (0,0,1)' 'space origin: (0.5,0.5,0.5)' | cat - ball/s/0-9_0-9_0-9 >ball.nrrd
cubewright extract ball.nrrd --iso 50 -o b.stl -q
cmp a.stl b.stl && echo "the same surface"
cubewright extract ball --crop 2:8,2:8,2:8 --iso 50 -o c.stl -q
mkdir -p map/s map/names
sed 's/"image"/"segmentation", "segment_properties": "names"/; s/9/3/g' ball/info >map/info
echo '{"inline": {"ids": ["49", "50"], "properties": [{"id": "n", "type": "label", "values": ["core", "shell"]}]}}' >map/names/info
printf '222222222222212222222222222' >map/s/0-3_0-3_0-3
cubewright extract map --labels all -o '{name}.stl'
ls ./*.stl
rm ./*.stl
for n in $(seq 27); do
    if [ "$n" = 14 ]; then printf '\001\0\0\0\0\001\0\0'; else printf '2\0\0\0\0\0\0\0'; fi
done >map/s/0-3_0-3_0-3
sed -i 's/uint8/uint64/' map/info
sed -i 's/"49"/"1099511627777"/' map/names/info
cubewright extract map --labels all -o '{label}_{name}.stl' -q
ls ./*.stl
