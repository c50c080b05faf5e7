#!/bin/sh
# Compressed glTF in other people's hands: sh compressed.sh BIN_FOLDER VALIDATOR_FOLDER. Khronos'
# validator must find neither errors nor warnings (it does not know Draco and meshopt, and says
# so), and three.js in Chromium must find the triangles and the box of the plain file, and the box
# that the file states. 77 when neither is there.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
NODE_PATH=$2/node_modules
export PATH NODE_PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
command -v node >/dev/null || { echo "skip: node is not installed" >&2; exit 77; }

cubewright make gyroid -o g.nrrd --dims 64 -q
cubewright make sphere -o s.nrrd --dims 24 -q
for mesh in g s; do
    cubewright extract $mesh.nrrd --iso 0 -o $mesh-none.glb -q || exit 1
    for kind in quantize draco meshopt; do
        cubewright extract $mesh.nrrd --iso 0 -o $mesh-$kind.glb -q --compress $kind 2>said ||
            grep -q 'not in this build\|the most there are' said || { cat said; exit 1; }
    done
    cubewright extract $mesh.nrrd --iso 0 -o $mesh-meshopt-20.glb -q --compress meshopt --bits 20 \
        2>said || grep -q 'not in this build' said || { cat said; exit 1; }
done

# levels of detail, of which the validator does not know the extension
mkdir lod
if cubewright version --features | grep -q '^simplify *yes'; then
    for kind in none quantize; do
        cubewright simplify g-none.glb --lod 8k,2k,500 -o lod/$kind.glb --compress $kind --no-measure -q || exit 1
    done
else
    cp s-none.glb lod
fi

failed=0
node "$here/validate_glb.mjs" ./*.glb lod/*.glb >issues
[ $? = 77 ] && { echo "skip: no gltf-validator" >&2; validated=no; }
grep ': \(error\|warning\) ' issues && failed=1

node "$here/three.mjs" ./*.glb >drawn
case $? in
0) ;;
77) [ "${validated-yes}" = no ] && exit 77 ;;
*) cat drawn; failed=1 ;;
esac
# name, nodes, triangles, box: as of the plain file, to a thousandth of a millimetre
awk '{ split($1, part, "[-.]"); mesh = part[1] }
    part[2] == "none" { for (i = 2; i <= NF; i++) plain[mesh, i] = $i }
    { for (i = 2; i <= NF; i++) got[$1, i] = $i; of[$1] = mesh; fields = NF }
    END { for (file in of) for (i = 2; i <= fields; i++) {
        d = got[file, i] - plain[of[file], i]
        if (d > 0.000005 || d < -0.000005) { print file ": field " i ": " got[file, i] ", plain " plain[of[file], i]; bad = 1 } }
        exit bad }' drawn || failed=1
exit $failed
