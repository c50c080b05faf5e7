#!/bin/sh
# Extracts meshes of several kinds into every format and has other people's readers check them:
# sh run.sh BIN_FOLDER VALIDATOR_FOLDER. 77 when a reader is missing.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
NODE_PATH=$2/node_modules
export PATH NODE_PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

check() { # NAME ISO OPTIONS...: a volume NAME.nrrd
    name=$1 iso=$2
    shift 2
    mkdir "$name"
    for f in glb gltf stl ply obj; do
        cubewright extract "$name.nrrd" --iso "$iso" -o "$name/x.$f" --json "$name/$f.json" -q "$@" ||
            exit 1
    done
    count() { sed -n "s/^    \"$1\": \([0-9]*\),$/\1/p" "$name/glb.json"; }
    sh "$here/check_meshes.sh" "$name" "$(count vertices)" "$(count triangles)" || exit
}

cubewright make sphere -o sphere.nrrd --dims 24 -q         # indices of 16 bits
cubewright make gyroid -o gyroid.nrrd --dims 96 -q         # of 32 bits, capped at the border
cubewright make ct-head -o head.nrrd --dims 64 --type i16 --noise 40 -q
cubewright make marschner-lobb -o lobb.nrrd --dims 64 --type u8 -q # a cube of 2 mm, on samples
check sphere 0
check gyroid 0
check head 300
check lobb 128
