#!/bin/sh
# Makes the documents of the C API, without a warning: sh docs.sh BUILD_FOLDER.
# Then plants mistakes in copies of the headers. Doxygen must report each at its line.
set -u
build=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
command -v doxygen >/dev/null || { echo "no doxygen (apt-get install doxygen)"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
bad=0

make_docs() { # INPUT [SETTING]: prints the warnings
    { cat "$build/docs/Doxyfile"; printf 'INPUT = %s\nOUTPUT_DIRECTORY = %s\n%s\n' "$1" "$folder" "${2:-}"; } | doxygen - 2>&1
}

make_copy_docs() { # the same of mesh.h here, without the main page, which Doxygen 1.9.8 wants among its input
    make_docs "\"$folder/mesh.h\"" 'USE_MDFILE_AS_MAINPAGE ='
}

make_docs "\"$root/include/cubewright\" \"$root/include/docs\"" >warnings || { cat warnings; bad=1; }
pages=$(find html -name '*.html' | wc -l)
for page in index volume_8h structcw__mesh; do
    [ -s html/$page.html ] || { echo "html/$page.html is missing"; bad=1; }
done
# a list of a comment, a usual parameter, a row of a table, and a reference across headers
for words in 'number of vertices at the place of another' 'the reason of a failure; may be NULL' \
    'a memory, voxel or triangle limit would be exceeded' 'as <a class="el" href="volume_8h.html'; do
    grep -q -r -F -e "$words" html || { echo "no page has: $words"; bad=1; }
done
grep -r -l -E '(src|href)="https?://' html | xargs -r grep -h -o -E '(src|href)="https?://[^/"]*' |
    grep -v 'www.doxygen.org' && { echo "these are fetched from a network"; bad=1; }

# Changes a copy of mesh.h by sed. A warning with the words must name a line of the comment or
# declaration around the one that is changed: at most 4 lines away.
plant() { # NAME SED_SCRIPT PATTERN_OF_LINE WORDS
    cp "$root/include/cubewright/mesh.h" mesh.h
    sed -i "$2" mesh.h
    cmp -s mesh.h "$root/include/cubewright/mesh.h" && { echo "$1: nothing was planted"; bad=1; }
    line=$(grep -n -e "$3" mesh.h | head -1 | cut -d: -f1)
    make_copy_docs >warnings && { echo "$1: no error"; bad=1; }
    grep -e "$4" warnings | awk -F: -v line="$line" '$2 - line <= 4 && line - $2 <= 4 { near = 1 } END { exit !near }' ||
        { echo "$1: no warning near line $line: $4"; cat warnings; bad=1; }
}
plant function '/^\/\* Computes the world box/,/\*\//d' 'cw_mesh_bounds(' 'cw_mesh_bounds.*is not documented'
plant field 's| */\* number of vertices \*/||' 'vertex_count;' 'vertex_count.*is not documented'
plant parameter 's/cw_mesh_check(const cw_mesh \*mesh,/cw_mesh_check(const cw_mesh *mesh, int depth,/' \
    '^/\* Checks the properties' 'parameter of cw_mesh_check.*is not documented'
plant name 's/^ \* merged  /& /; s/^ \* merged /\* mergd /; s/^\* mergd/ * mergd/' '^ \* mergd' "argument 'mergd'"
plant result 's/^ \* Returns  CW_ERR_ARGUMENT as cw_mesh_check(); CW_ERR_NO_MEMORY$//' '^/\* Gives the vertices' \
    'return type of member cw_mesh_normals is not documented'
plant struct '/^\/\* Counts and volumes of dropped/d' '^typedef struct cw_drop_counts' 'cw_drop_counts is not documented'

# What is deprecated says what to use.
sed 's/^CW_API void cw_mesh_free/CW_DEPRECATED("use cw_mesh_end()") &/' "$root/include/cubewright/mesh.h" >mesh.h
make_copy_docs >warnings || { cat warnings; bad=1; }
grep -q 'use cw_mesh_end()' html/deprecated.html || { echo "deprecated.html lacks cw_mesh_free"; bad=1; }

[ $bad = 0 ] && echo "$pages pages; six planted mistakes were reported"
exit $bad
