#!/bin/sh
# Animated glTF in other people's hands: sh animated.sh BIN_FOLDER VALIDATOR_FOLDER. Khronos'
# validator must find nothing in it (of compressed files, no error or warning), and three.js in
# Chromium must show at every time what it shows of that step's own file: a sphere, nothing, a torus,
# a gyroid. 77 when neither is there.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
NODE_PATH=$2/node_modules
export PATH NODE_PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
command -v node >/dev/null || { echo "skip: node is not installed" >&2; exit 77; }

sh "$here/../support/steps.sh" 32 >4d.nrrd
for step in 0 2 3; do
    cubewright extract 4d.nrrd --iso 0.5 --step $step -o $step.glb -q || exit 1
done
cubewright extract 4d.nrrd --iso 0.5 --animate -o none.glb -q || exit 1
for kind in quantize draco meshopt; do
    cubewright extract 4d.nrrd --iso 0.5 --animate -o $kind.glb -q --compress $kind 2>said ||
        grep -q 'not in this build\|the most there are' said || { cat said; exit 1; }
done

failed=0
node "$here/validate_glb.mjs" none.glb || { [ $? = 77 ] && validated=no || failed=1; }
node "$here/validate_glb.mjs" [dmq]*.glb >issues
grep ': \(error\|warning\) ' issues && failed=1

# in the middle of each step, and on its first moment
steps=0=0.glb,0.3=0.glb,0.5=,0.9=,1=2.glb,1.4=2.glb,1.5=3.glb,1.99=3.glb
for file in none quantize draco meshopt; do
    [ -f $file.glb ] || continue
    node "$here/three.mjs" --steps $steps $file.glb >played
    case $? in
    0)
        grep -q ' 2.000 s$' played || { cat played; failed=1; }
        [ $file = none ] && grep ' s: [1-9]' played && failed=1 # to the pixel
        ;;
    77) [ "${validated-yes}" = no ] && exit 77 ;;
    *) cat played; failed=1 ;;
    esac
done
exit $failed
