#!/bin/sh
# Colours of faces in written glTF: Khronos' validator must find no issue, and three.js the colour of
# every triangle: sh face_colors.sh BIN_FOLDER VALIDATOR_FOLDER. 77 without node or three.js.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
NODE_PATH=$2/node_modules
export PATH NODE_PATH
command -v node >/dev/null || { echo "skip: no node" >&2; exit 77; }
cubewright version --features | grep -q '^gltf *yes' || { echo "skip: this build has no glTF" >&2; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

strip() { # COLOURS: a strip of 600 triangles, whose colours run from one end to the other
    awk -v colors="$1" 'BEGIN {
        print "OFF"; print 602, 600, 0
        for (v = 0; v < 602; v++) print int(v / 2), v % 2, 0
        for (t = 0; t < 600; t++) {
            n = int(t * colors / 600)
            print 3, t, t + 1 + t % 2, t + 2 - t % 2, n % 250, 255 - int(n / 250), 64, 255
        }
    }'
}
for colors in 1 5 128 300; do
    strip $colors >$colors.off
    cubewright convert $colors.off -o $colors.glb -q || exit 1
    cubewright convert $colors.off -o q$colors.glb --compress quantize -q || exit 1
done
node "$here/validate_glb.mjs" ./*.glb >issues
case $? in
0) ;;
77) exit 77 ;;
*) cat issues; exit 1 ;;
esac
node "$here/face_colors.mjs" ./*.glb
