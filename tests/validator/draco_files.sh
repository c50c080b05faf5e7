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
cubewright convert g.ply -o ours.drc -q --compress draco --tolerance 1e-9mm # positions as they are
draco_decoder -i ours.drc -o decoded.ply >/dev/null || fail "Draco does not read our floats"
cubewright check decoded.ply --reference g.ply --tolerance 0.000001mm -q >/dev/null || fail "Draco reads our floats wrongly"
# a fragment of Neuroglancer's meshes has integers as positions
cubewright convert g.ply -o folder --format neuroglancer --compress draco --tolerance 0.1mm -q
draco_decoder -i folder/1 -o fragment.obj >/dev/null || fail "Draco does not read our fragment"
grep '^v ' fragment.obj | awk '{ for (n = 2; n < 5; n++) if ($n != int($n) || $n < 0 || $n > 65535) exit 1 }' ||
    fail "Draco reads no integers from 0 to 65535 from our fragment"
draco_encoder -point_cloud -i g.ply -o points.drc >/dev/null
cubewright convert points.drc -o points.stl -q 2>said && fail "a point cloud is a mesh"
grep -q 'a point cloud, not a mesh' said
