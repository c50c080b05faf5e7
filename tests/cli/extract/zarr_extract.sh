# Zarr: a surface and labels out of stores, the same as from a file of the voxels.
mkdir -p ball/c/0/0 map/0
awk 'BEGIN { for (z = 0; z < 9; z++) for (y = 0; y < 9; y++) for (x = 0; x < 9; x++) {
    v = 60 - (x - 4) ^ 2 - (y - 4) ^ 2 - (z - 4) ^ 2; printf "%c", (v < 1 ? 1 : v) } }' >ball/c/0/0/0
cat >ball/zarr.json <<'END2'
{"zarr_format": 3, "node_type": "array", "shape": [9, 9, 9], "data_type": "uint8", "fill_value": 0,
 "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [9, 9, 9]}},
 "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
 "codecs": [{"name": "bytes"}]}
END2
cubewright extract ball --iso 50 -o a.stl -q
cubewright extract ball/c/0/0/0 --raw dims=9x9x9,type=u8 --iso 50 -o b.stl -q
cmp a.stl b.stl && echo "the same surface"
cubewright extract ball --crop 2:8,2:8,2:8 --iso 50 -o c.stl -q
echo '{"zarr_format": 2}' >map/.zgroup
echo '{"image-label": {"colors": [{"label-value": 49, "rgba": [255, 0, 0, 255]}],
  "properties": [{"label-value": 49, "name": "core"}, {"label-value": 50, "name": "shell"}]},
 "multiscales": [{"axes": ["z", "y", "x"], "datasets": [{"path": "0"}]}]}' >map/.zattrs
echo '{"zarr_format": 2, "shape": [3, 3, 3], "chunks": [3, 3, 3], "dtype": "|u1", "order": "C",
 "fill_value": 0, "filters": null, "compressor": null}' >map/0/.zarray
printf '222222222222212222222222222' >map/0/0.0.0
cubewright extract map --labels all -o '{name}.stl'
ls ./*.stl
