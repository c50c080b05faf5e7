#!/bin/sh
# Holds what users read to plain English: sh words.sh BIN_FOLDER
# The mean sentence of each document, and of the help of all commands, is under 18 words, and
# none has an expression of riddles.txt.
set -u
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
PATH=$1:$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0

check_document() { # NAME FILE
    grep -v '^ *\(#\|$\)' "$here/riddles.txt" >"$folder/riddles"
    sed '/^| instead of/,/^$/s/.*//; s/`[^`]*`//g' "$2" >"$folder/prose"
    if grep -n -i -w -E -f "$folder/riddles" "$folder/prose" >"$folder/found"; then
        sed "s|^|$1: a riddle: |" "$folder/found"
        bad=1
    fi
    awk -f "$here/words.awk" "$2" >"$folder/sentences"
    awk -v name="$1" '{ words += NF } END {
        mean = NR ? words / NR : 0
        printf "%s: %d sentences, %.1f words each\n", name, NR, mean
        exit NR == 0 || mean >= 18 }' "$folder/sentences" ||
        { bad=1; echo "$1: the mean sentence must be under 18 words"; }
}

for document in README.md CONTRIBUTING.md CHANGELOG.md SECURITY.md cli/README.md cli/recipes.md \
    cli/keys.md cli/reports.md tests/bench/README.md python/README.md include/docs/README.md \
    include/docs/volumes_and_meshes.md include/docs/calls.md; do
    check_document "$document" "$root/$document"
done

cubewright help >"$folder/help"
for command in $(cubewright help | sed -n '/^Commands/,/^$/s/^  \([a-z]*\) .*/\1/p'); do
    cubewright help "$command" >>"$folder/help"
done
cubewright help environment >>"$folder/help"
cubewright help library | sed '/^  /d' >>"$folder/help"
check_document help "$folder/help"
exit $bad
