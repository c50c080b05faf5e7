#!/bin/sh
# Random input, the same each time, on whatever can be open: sh monkey.sh BIN_FOLDER [INPUTS [SEED...]].
# It must come to its end without an error, of GL neither, and leave no files; in builds with
# sanitizers also without leaks. 77 when this build has no window.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
inputs=${2:-80}
[ $# -gt 2 ] && shift 2 && seeds=$*
failed=0
cubewright version --features | grep -q '^window *yes' || { echo "skip: no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "skip: no OpenGL" >&2; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/work"
cd "$folder/work" || exit 1

cubewright make ct-head -o head.nrrd --dims 24 --type i16 -q
cubewright make torus -o torus.mha --dims 20x24x28 -q
cubewright extract torus.mha --iso 0 -o torus.ply -q
sh "$here/../support/steps.sh" 12 >steps.nrrd
ls >../before

for seed in ${seeds:-1 2}; do
    for file in head.nrrd torus.mha torus.ply steps.nrrd; do
        cubewright view $file -q --hidden --size 480x360 --exec "monkey $seed $inputs; print mode" >out 2>err </dev/null
        code=$?
        [ $code = 0 ] && grep -q '^mode' out && ! [ -s err ] && continue
        echo "monkey $seed $inputs on $file: exit code $code"
        cat out err
        failed=1
    done
done

rm -f out err
ls >../after
cmp ../before ../after || { echo "files were written:" *; failed=1; }
exit $failed
