# Stores of Zarr: levels with their sizes and axes, arrays of a group, and what is refused.
group() {
    mkdir -p "$1"
    echo '{"zarr_format": 2}' >"$1/.zgroup"
}
array() { # FOLDER SHAPE TYPE
    mkdir -p "$1"
    echo "{\"zarr_format\": 2, \"shape\": $2, \"chunks\": $2, \"dtype\": \"$3\", \"order\": \"C\"," \
        '"fill_value": 7, "filters": null, "compressor": null}' >"$1/.zarray"
}
group image.zarr
cat >image.zarr/.zattrs <<'END2'
{"multiscales": [{"version": "0.4", "axes": [{"name": "c", "type": "channel"},
  {"name": "z", "type": "space", "unit": "micrometer"}, {"name": "y", "type": "space", "unit": "micrometer"},
  {"name": "x", "type": "space", "unit": "micrometer"}],
 "datasets": [
  {"path": "0", "coordinateTransformations": [{"type": "scale", "scale": [1, 2000, 500, 500]}]},
  {"path": "1", "coordinateTransformations": [{"type": "scale", "scale": [1, 4000, 1000, 1000]},
   {"type": "translation", "translation": [0, 1000, 250, 250]}]}]}]}
END2
array image.zarr/0 '[2, 2, 2, 4]' '|u1'
array image.zarr/1 '[2, 1, 1, 2]' '|u1'
printf '0123456789abcdefABCDEFGHIJKLMNOP' >image.zarr/0/0.0.0.0
group image.zarr/labels
echo '{"labels": ["cells"]}' >image.zarr/labels/.zattrs
group image.zarr/labels/cells
echo '{"image-label": {"properties": [{"label-value": 7, "name": "nucleus"}]},
 "multiscales": [{"axes": ["z", "y", "x"], "datasets": [{"path": "0"}]}]}' >image.zarr/labels/cells/.zattrs
array image.zarr/labels/cells/0 '[2, 2, 2]' '<i8'
cubewright info image.zarr
cubewright info image.zarr --level 1 --json | sed -n '/"scales"/,/"axes"/p'
cubewright info image.zarr --level 2; echo "exit $?"
cubewright info image.zarr --array labels/cells
group several
array several/line '[5]' '<f4'
array several/solid '[2, 3, 4]' '<u2'
array several/text '[2, 3, 4]' '<U4'
cubewright info several
cubewright info several --array text; echo "exit $?"
array wide '[2, 2, 2]' '<u8'
printf '%s' '0000000011111111222222223333333344444444555555556666666677777777' >wide/0.0.0
cubewright extract wide --iso 1 -o wide.stl; echo "exit $?"
