#!/bin/sh
# Draco files in both directions: sh draco_files.sh BIN_FOLDER. Draco's own decoder reads ours and
# its encoder writes what we read; 77 when they are not there.
set -eu
PATH=$1:$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
command -v draco_decoder >/dev/null && command -v draco_encoder >/dev/null || { echo "skip: no draco" >&2; exit 77; }
cubewright version --features | grep -q '^draco *yes' || { echo "skip: this build has no Draco" >&2; exit 77; }

fail() { echo "$*" >&2; exit 1; }
cubewright make gyroid -o g.nrrd --dims 24 -q
cubewright extract g.nrrd --iso 0 -o g.ply -q
for bits in 16 19 22; do
    cubewright convert g.ply -o ours.drc -q --compress draco --bits $bits
    draco_decoder -i ours.drc -o decoded.ply >/dev/null || fail "Draco does not read ours of $bits bits"
    cubewright check decoded.ply --reference g.ply --tolerance 0.05% -q >/dev/null || fail "Draco reads ours of $bits bits wrongly"
    draco_encoder -i g.ply -o theirs.drc -qp $bits >/dev/null
    cubewright check theirs.drc --reference g.ply --tolerance 0.05% -q >/dev/null || fail "we read Draco's of $bits bits wrongly"
done
draco_encoder -point_cloud -i g.ply -o points.drc >/dev/null
cubewright convert points.drc -o points.stl -q 2>said && fail "a point cloud is a mesh"
grep -q 'a point cloud, not a mesh' said
