#!/bin/sh
# Configures with optional libraries that do not work: sh features.sh SOURCE_FOLDER CC.
# Each must cost its feature, with the reason, and nothing else.
set -eu
source=$1 cc=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# A header that includes what is not there, and a library without a symbol in it.
mkdir include
echo '#include <nowhere/at_all.h>' >include/lz4.h
echo 'int nothing;' >empty.c
"$cc" -shared -fPIC empty.c -o libempty.so

off=$(sed -n 's/^option(\(CUBEWRIGHT_[A-Z0-9]*\) .*/\1/p' "$source/CMakeLists.txt" | grep -v -e LZ4 -e ISAL | sed 's/.*/-D&=OFF/')
# shellcheck disable=SC2086
cmake -G Ninja -S "$source" -B build -DCMAKE_C_COMPILER="$cc" $off \
    -DLZ4_INCLUDE="$folder/include" -DISAL_LIBRARY="$folder/libempty.so" >log 2>&1 || { cat log; exit 1; }

expect() {
    grep -q "$1" "$2" || { echo "expected in $2: $1"; cat "$2"; exit 1; }
}
expect 'without lz4: liblz4-dev cannot be used: lz4.h:1:10: fatal error: nowhere/at_all.h: No such file' log
expect 'this build reads no .vti that is compressed with LZ4' log
expect 'without isal: libisal-dev cannot be used: .*undefined reference to `isal_inflate' log
expect 'without gltf: switched off by CUBEWRIGHT_GLTF=OFF; this build reads and writes no glTF and no GLB' log
expect '{"lz4", .*"liblz4-dev", "LZ4 (BSD-2-Clause)", "liblz4-dev cannot be used: .*nowhere/at_all.h' build/features_table.c

# Mended, it is there again: failures are not cached.
echo 'int LZ4_versionNumber(void);' >include/lz4.h
cmake build >log 2>&1 || { cat log; exit 1; }
! grep 'without lz4' log || exit 1
expect '{"lz4", .*"liblz4-dev", "LZ4 (BSD-2-Clause)", ""}' build/features_table.c
echo "libraries that do not work cost their features alone"
