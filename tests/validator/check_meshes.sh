#!/bin/sh
# Reads what we wrote with other people's readers: check_meshes.sh FOLDER VERTICES TRIANGLES
# for a folder with x.glb x.gltf x.stl x.ply x.obj of one closed mesh.
# Exit: 0 all agree, 1 with a line for each thing that does not, 2 usage, 77 a tool is missing.
set -u

if [ $# -ne 3 ]; then
    echo "usage: check_meshes.sh FOLDER VERTICES TRIANGLES" >&2
    exit 2
fi
folder=$1
vertices=$2
triangles=$3
here=$(dirname "$0")
failed=0

for tool in node admesh assimp; do
    if ! command -v "$tool" >/dev/null; then
        echo "skip: $tool is not installed" >&2
        exit 77
    fi
done

# expect FILE WHAT GOT WANTED
expect() {
    if [ "$3" != "$4" ]; then
        echo "$1: $2: got ${3:-nothing}, expected $4"
        failed=1
    fi
}

# field LABEL: the first number behind a label at the start of a line of $report
field() {
    printf '%s\n' "$report" | sed -n "s/^$1 *: *\([0-9][0-9]*\).*/\1/p" | head -n 1
}

node "$here/validate_glb.mjs" "$folder/x.glb" "$folder/x.gltf"
case $? in
0) ;;
77) exit 77 ;;
*) failed=1 ;;
esac

report=$(admesh "$folder/x.stl" 2>&1) || failed=1
expect x.stl facets "$(field 'Number of facets')" "$triangles"
for label in 'Total disconnected facets' 'Degenerate facets' 'Facets reversed' \
    'Backwards edges' 'Normals fixed'; do
    expect x.stl "$label" "$(field "$label")" 0
done

for file in x.ply x.obj x.glb; do
    report=$(assimp info "$folder/$file" 2>&1) || failed=1
    expect "$file" vertices "$(field Vertices)" "$vertices"
    expect "$file" faces "$(field Faces)" "$triangles"
    expect "$file" kind "$(printf '%s\n' "$report" | sed -n 's/^Primitive Types: *//p')" triangles
done

[ $failed -eq 0 ] && echo "all readers agree: $vertices vertices, $triangles triangles"
exit $failed
