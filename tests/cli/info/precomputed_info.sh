# Neuroglancer's precomputed volumes: scales with their sizes, names of segments, and what is refused.
mkdir -p image/8_8_40 image/16_16_40
cat >image/info <<'END2'
{"@type": "neuroglancer_multiscale_volume", "type": "image", "data_type": "uint8", "num_channels": 1, "scales": [
 {"key": "8_8_40", "size": [4, 2, 2], "resolution": [8, 8, 40], "voxel_offset": [10, 0, 0],
  "chunk_sizes": [[2, 2, 2]], "encoding": "raw"},
 {"key": "16_16_40", "size": [2, 1, 2], "resolution": [16, 16, 40], "voxel_offset": [5, 0, 0],
  "chunk_sizes": [[2, 2, 2]], "encoding": "raw"}]}
END2
printf 'abcdefgh' >image/8_8_40/10-12_0-2_0-2
printf 'ABCDEFGH' >image/8_8_40/12-14_0-2_0-2
cubewright info image
cubewright info image/info --level 1 --json | sed -n '/"scales"/,/"axes"/p'
cubewright info image --array 16_16_40 | sed -n 2p
cubewright info image --level 2; echo "exit $?"
mkdir -p organs/names organs/s
echo '{"type": "segmentation", "data_type": "uint16", "num_channels": 1, "segment_properties": "names",
 "scales": [{"key": "s", "size": [2, 2, 1], "resolution": [1e6, 1e6, 1e6], "chunk_sizes": [[64, 64, 64]],
 "encoding": "raw"}]}' >organs/info
echo '{"@type": "neuroglancer_segment_properties", "inline": {"ids": ["7"],
 "properties": [{"id": "label", "type": "label", "values": ["liver"]}]}}' >organs/names/info
printf '\0\0\007\0\007\0\0\0' >organs/s/0-2_0-2_0-1
cubewright info organs
sed 's/"raw"/"jpeg"/' organs/info >image/info
cubewright info image; echo "exit $?"
echo '{"@type": "neuroglancer_multilod_draco", "vertex_quantization_bits": 16}' >image/info
cubewright info image; echo "exit $?"
