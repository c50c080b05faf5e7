# Stores of N5: levels with their sizes and axes, arrays of a group, and what is refused.
array() { # FOLDER DIMENSIONS BLOCK TYPE MORE
    mkdir -p "$1"
    echo "{\"dimensions\": $2, \"blockSize\": $3, \"dataType\": \"$4\"," \
        "\"compression\": {\"type\": \"raw\"}${5:+, $5}}" >"$1/attributes.json"
}
array image.n5/s0 '[4, 2, 2]' '[4, 2, 1]' uint8
array image.n5/s1 '[2, 1, 2]' '[2, 1, 2]' uint8 '"downsamplingFactors": [2, 2, 1]'
echo '{"n5": "2.5.1", "resolution": [8, 8, 40], "units": ["nm", "nm", "nm"]}' >image.n5/attributes.json
mkdir -p image.n5/s0/0/0
printf '\0\0\0\3\0\0\0\4\0\0\0\2\0\0\0\001abcdefgh' >image.n5/s0/0/0/0
printf '\0\0\0\3\0\0\0\4\0\0\0\2\0\0\0\001ABCDEFGH' >image.n5/s0/0/0/1
cubewright info image.n5
cubewright info image.n5 --level 1 --json | sed -n '/"scales"/,/"axes"/p'
cubewright info image.n5 --level 2; echo "exit $?"
echo '{"n5": "2.5.1"}' >several.json
mkdir several && mv several.json several/attributes.json
array several/raw/line '[5]' '[5]' float32
array several/raw/solid '[4, 3, 2]' '[4, 3, 2]' uint16
array several/text '[4, 3, 2]' '[4, 3, 2]' string
cubewright info several
cubewright info several --array text; echo "exit $?"
array packed '[4, 3, 2]' '[4, 3, 2]' uint8
sed -i 's/raw/xz/' packed/attributes.json
cubewright info packed; echo "exit $?"
