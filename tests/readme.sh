#!/bin/sh
# Runs what the documents show: sh readme.sh BIN_FOLDER BUILD_FOLDER CC.
# In a `console` block lines after "$ " are commands. Where lines follow, the command must print
# them, '*' and seconds aside. The `c` block of README.md must compile against the library and run,
# and its `cmake` block must be the one of tests/examples.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
bin=$1 build=$2 cc=$3
PATH=$bin:$PATH
export PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0 count=0

has_feature() { cubewright version --features | grep -q "^$1  *yes"; }

# The examples use a head scan: the real one where Debian's package has put it.
scan=/usr/share/mricron/templates/ch2.nii.gz
[ -r "$scan" ] || { scan=$folder/head.nii.gz made=yes
    cubewright make ct-head -o "$scan" --dims 181x217x181 --type u8 -q; }

# What this build is without: commands that match are left out.
missing=none
has_feature simplify || missing="$missing|cubewright simplify|--lod|--simplify|--pixel-error"
has_feature gl && has_feature window || missing="$missing|cubewright view"
has_feature gl || missing="$missing|cubewright render.*--(layout|mode|compare)"
has_feature level-set || missing="$missing|cubewright (hollow|offset)"

for feature in cgal wrap openmpi mpich vdb dicom jpeg2000 gl window gltf draco meshopt simplify tiff blosc isal lz4 bzip2 zstd; do
    has_feature $feature || missing="$missing|--licences"
done

compare_output() { # of the last command with what the document shows, if it shows something
    [ -n "${made:-}" ] || [ ! -s "$folder/wanted" ] && return # another head, other numbers
    sed 's/[0-9.]* s$/* s/' "$folder/wanted" >"$folder/pattern"
    awk -f "$root/tests/cli/match.awk" "$folder/pattern" "$folder/got" ||
        { echo "$document: printed by: $command"; bad=1; }
}

run_document() {
    mkdir "$folder/work"
    cd "$folder/work" || exit 1
    ln -s "$scan" head.nii.gz
    awk '/^```console$/ {on = 1; next} /^```/ {on = 0} on' "$root/$document" >"$folder/console"
    command=
    : >"$folder/wanted"
    while IFS= read -r line; do
        case $line in
        '$ '*)
            [ -n "$command" ] && compare_output
            command=${line#'$ '}
            : >"$folder/wanted"
            printf '%s\n' "$command" | grep -q -E -e "$missing" && { command=; continue; }
            sh -c "$command" >"$folder/got" 2>&1 </dev/null ||
                { echo "$document: failed: $command"; cat "$folder/got"; bad=1; }
            count=$((count + 1))
            ;;
        *) printf '%s\n' "$line" >>"$folder/wanted" ;;
        esac
    done <"$folder/console"
    [ -n "$command" ] && compare_output
    cd "$folder" && rm -r work
}

for document in $(cd "$root" && grep -l '^```console$' ./*.md ./*/*.md ./tests/*/*.md); do
    run_document
done
[ "$count" -gt 0 ] || { echo "the documents show no commands"; bad=1; }

awk '/^```c$/ {on = 1; next} /^```/ {on = 0} on' "$root/README.md" >"$folder/example.c"
ln -sf "$scan" "$folder/head.nii.gz"
"$cc" -std=c99 -Wall -Wextra -Werror -I "$root/include" example.c -L "$build/lib" -lcubewright \
    -Wl,-rpath,"$build/lib" -o example && ./example && [ -s head.stl ] ||
    { echo "the README's C example does not work"; bad=1; }
awk '/^```cmake$/ {on = 1; next} /^```/ {on = 0} on' "$root/README.md" >cmake_lines
grep '^find_package' cmake_lines | grep -q -x -F -f - "$root/tests/examples/CMakeLists.txt" ||
    { echo "the README's find_package is not that of tests/examples"; bad=1; }
echo "$count commands and one C program of the documents ran"
exit $bad
