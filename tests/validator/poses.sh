#!/bin/sh
# Posed glTF scenes (morph targets, skins, instances) of three.js, gltfpack and by hand must have the
# boxes that three.js draws: sh poses.sh BIN_FOLDER VALIDATOR_FOLDER. 77 without node or three.js.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
NODE_PATH=$2/node_modules
export PATH NODE_PATH
command -v node >/dev/null || { echo "skip: no node" >&2; exit 77; }
cubewright version --features | grep -q '^gltf *yes' || { echo "skip: this build has no glTF" >&2; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
pack=$NODE_PATH/gltfpack/cli.js
[ -f "$pack" ] && cubewright version --features | grep -q '^meshopt *yes' || pack=
node "$here/poses.mjs" "$folder" $pack
