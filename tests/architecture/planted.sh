#!/bin/sh
# Plants faults in a small house, and looks whether architecture.sh names each: sh planted.sh
set -u
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
bad=0

build_house() {
    rm -rf "$folder/house"
    mkdir -p "$folder/house"
    cd "$folder/house" || exit 1
    mkdir -p core/base core/mesh extract/dense simplify formats/stl viewer/scene cli/framework
    echo 'int cwi_one(void);' >core/base/one.h
    printf '#include "core/base/one.h"\nint cwi_one(void)\n{\n}\n' >core/base/one.c
    printf '#include "core/base/one.h"\n' >extract/dense/two.c
}

expect_fault() { # TEXT
    if sh "$here/architecture.sh" "$folder/house" >"$folder/out"; then
        echo "not found: $1"
        bad=1
    elif ! grep -q -F -e "$1" "$folder/out"; then
        echo "expected: $1"
        cat "$folder/out"
        bad=1
    fi
}

build_house
sh "$here/architecture.sh" "$folder/house" >"$folder/out" || { cat "$folder/out"; bad=1; }

printf '#include "extract/dense/two.h"\n' >core/base/three.c
expect_fault 'core/base/three.c:1: the room core/base may not include extract/dense/two.h'

build_house
printf '\n#include "extract/dense/two.h"\n' >formats/stl/three.c
expect_fault 'formats/stl/three.c:2: the room formats/stl may not include extract/dense/two.h'

build_house
mkdir extract/attic
echo 'int x;' >extract/attic/three.c
expect_fault 'extract/attic/three.c: the folder extract/attic is no room'

build_house
touch simplify/one.c
expect_fault 'two sources are named one.c'

build_house
printf 'typedef struct cwi_one {\n    int x;\n} cwi_one;\n' >simplify/four.h
expect_fault 'cwi_one is defined twice'

build_house
printf 'enum {\n    CWI_FIVE = 1,\n};\n' >simplify/five.h
printf '#define CWI_FIVE 2\n' >extract/dense/six.h
expect_fault 'CWI_FIVE is defined twice'

build_house
for n in $(seq 31); do touch "viewer/scene/file_$n.c"; done
expect_fault 'viewer/scene: 31 files'

build_house
echo 'static const char hint[] = "say --memory 8G";' >core/base/three.c
expect_fault 'core/base/three.c:1:'

build_house
echo 'int cwi_one(void);' >core/mesh/seven.h
python3 -B "$here/declarations.py" "$folder/house" >"$folder/out" && { echo "not found: seven.h"; bad=1; }
grep -q 'core/mesh/seven.h declares cwi_one, which core/base defines' "$folder/out" || { cat "$folder/out"; bad=1; }
exit $bad
