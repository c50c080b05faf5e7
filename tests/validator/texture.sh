#!/bin/sh
# Texture coordinates in written glTF: Khronos' validator must find no error and no warning, and three.js those of the OBJ
# file beside: sh texture.sh BIN_FOLDER VALIDATOR_FOLDER. 77 without node or three.js.
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

cubewright make torus -o torus.nrrd --dims 24 -q
cubewright make labels/cells -o cells.nrrd --dims 24 --labels 5 --type u16 -q
cubewright extract torus.nrrd --iso 0 -o torus.ply -q
cubewright extract cells.nrrd --labels all -o cells.obj -q
mkdir uv packed
for file in torus.ply cells.obj; do
    stem=${file%.*}
    cubewright uv $file -o uv/$stem.obj -q || exit 1
    cubewright uv $file -o uv/$stem.glb -q || exit 1
    cubewright uv $file -o uv/$stem-quantize.glb --compress quantize -q || exit 1
    for kind in draco meshopt; do
        cubewright uv $file -o packed/$stem-$kind.glb -q --compress $kind 2>said ||
            grep -q 'not in this build' said || { cat said; exit 1; }
    done
done
# assets: levels that share a texture, in every compression
cubewright make ct-head -o head.nrrd --dims 48 --noise 30 -q
cubewright extract head.nrrd --iso 300 --largest 1 -o head.ply -q
mkdir assets
for profile in game web mobile; do
    if cubewright version --features | grep -q '^simplify *yes'; then
        for kind in none quantize draco meshopt; do
            cubewright extract head.nrrd --iso 300 --profile $profile --lod 2k,800 --atlas 256 --compress $kind \
                -o assets/$profile-$kind.glb -q 2>said || grep -q 'not in this build' said || { cat said; exit 1; }
        done
        cubewright convert head.ply --profile $profile --compress none --pivot base -o assets/convert-$profile.glb -q || exit 1
    fi
done
node "$here/validate_glb.mjs" uv/*.glb packed/*.glb assets/*.glb >issues
[ $? = 77 ] && exit 77
grep -E ': (error|warning) ' issues && exit 1 # it informs of coordinates that no texture uses yet
node "$here/texture.mjs" uv/*.glb
