#!/bin/sh
# Compiles and runs what the pages of include/docs show: sh guide.sh BUILD_FOLDER CC.
# A `c` block is a program, or has functions of a cw_error that must return CW_OK. Those of one
# page are run in its order.
set -u
build=$1 cc=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
bad=0 count=0

compile() { # NAME
    "$cc" -std=c99 -Wall -Wextra -Werror -I "$root/include" "$1.c" -L "$build/lib" -lcubewright \
        -Wl,-rpath,"$build/lib" -o "$1"
}

for page in "$root"/include/docs/*.md; do
    name=$(basename "$page" .md)
    awk -v name="$name" '/^```c$/ {on = 1; next} /^```/ {on = 0; print ""} on' "$page" >blocks.c
    [ -s blocks.c ] || { echo "$name shows no C"; bad=1; continue; }
    if grep -q '^int main' blocks.c; then
        cp blocks.c "$name.c"
    else
        functions=$(sed -n 's/^static cw_status \([a-z_]*\)(cw_error \*err)$/\1/p' blocks.c)
        {
            printf '#include <cubewright/cubewright.h>\n#include <stdio.h>\n\n'
            cat blocks.c
            printf 'int main(void)\n{\n    cw_error err = {0};\n    int bad = 0;\n'
            for function in $functions; do
                count=$((count + 1))
                printf '    if (%s(&err) != CW_OK) {\n        printf("%s: %%s\\n", err.message);\n        bad = 1;\n    }\n' \
                    "$function" "$function"
            done
            printf '    return bad;\n}\n'
        } >"$name.c"
    fi
    compile "$name" && "./$name" >"$name.out" 2>&1 || { cat "$name.out"; echo "$name.md: its C does not work"; bad=1; }
done

# What the pages say about what is made.
grep -q '^[0-9]* triangles, 1 handle$' README.out || { cat README.out; echo "a torus has one handle"; bad=1; }
for file in torus.stl ramp.nrrd ball.stl; do
    [ -s $file ] || { echo "$file was not written"; bad=1; }
done
grep -q '^level 2 ends 2[78]\.[0-9] mm' volumes_and_meshes.out || { cat volumes_and_meshes.out; bad=1; }
grep -q '^348 bytes of PLY, 284 of STL$' volumes_and_meshes.out || { cat volumes_and_meshes.out; bad=1; }
grep -q '^unreadable: missing.nrrd' calls.out && grep -q '^usage: snap is ' calls.out ||
    { cat calls.out; echo "the errors are not as calls.md says"; bad=1; }
[ $bad = 0 ] && echo "$count functions and a program of the pages ran"
exit $bad
