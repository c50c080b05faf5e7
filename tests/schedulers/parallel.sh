# The recipe for GNU parallel: it runs the parts of a surface; 77 where it is not installed.
# Usage: sh parallel.sh BIN_FOLDER
set -eu
PATH=$1:$PATH
parallel --version 2>/dev/null | grep -q 'GNU parallel' ||
    { echo "no GNU parallel (Debian: parallel)"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
HOME=$folder
export HOME
cubewright make gyroid -o ct.nrrd --dims 60 --type i16 --noise 0.2 -q
cubewright extract ct.nrrd --iso 100 -o whole.ply --name bone --stream never -q
parallel cubewright extract ct.nrrd --iso 100 --part {}/16 --manifest parts -q ::: $(seq 16)
cubewright join parts -o bone.ply
cmp whole.ply bone.ply
echo "GNU parallel: the same bytes"
