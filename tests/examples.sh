#!/bin/sh
# Builds the examples against an installed library, runs them and checks what they write:
# sh examples.sh BUILD_FOLDER CC GENERATOR.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1 cc=$2 generator=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cmake --install "$build" --prefix usr >/dev/null
cmake -S "$here/examples" -B build -G "$generator" -DCMAKE_PREFIX_PATH="$folder/usr" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS="-Wall -Wextra -Werror" \
    >configured 2>&1 || { cat configured; exit 1; }
cmake --build build >built 2>&1 || { cat built; exit 1; }
PATH=$folder/build:$folder/usr/bin:$PATH
cubewright version --features >features

has() { grep -q "^$1 *yes" features; }
fail() { echo "$*"; exit 1; }
# Runs a command that needs a feature. Without it the exit code must be 5.
needs() {
    feature=$1
    shift
    code=0
    "$@" >printed 2>error || code=$?
    cat printed error
    if has "$feature"; then
        [ $code = 0 ] || fail "exit code $code: $*"
    else
        [ $code = 5 ] && [ -s error ] || fail "exit code $code without $feature: $*"
        return 1
    fi
}
# Checks that a mesh is a closed manifold.
closed() {
    cubewright check "$1" >checked 2>/dev/null || { cat checked; fail "check fails on $1"; }
    grep -q '^ *ok *closed' checked || { cat checked; fail "$1 is not closed"; }
}

volume_from_memory torus.stl
closed torus.stl
grep -q '1 component, 1 handle;' checked || fail "a torus has one handle"

cubewright make sphere -o sphere.nrrd --dims 48 -q
mkdir again
several_isovalues sphere.nrrd level 0.2 0.4 1e6 | tee printed
grep -q '1e6: no surface' printed || fail "an isovalue beyond all values has a surface"
[ ! -e level_1e6.ply ] || fail "an empty surface was written"
for value in 0.2 0.4; do
    closed level_$value.ply
    cubewright extract sphere.nrrd --iso $value -o again/level_$value.ply -q
    cmp level_$value.ply again/level_$value.ply
done

moving_surface moving.ply | tee printed
closed moving.ply
grep -q '^ball 7: [1-9][0-9]* of 343 bricks replaced' printed || fail "no brick was replaced"
awk '/in the whole surface/ { exit $1 != $6 }' printed || fail "bricks are not the surface"
grep -q '2 components' checked || fail "the wave and the ball are two components"

if needs simplify simplify_and_check sphere.nrrd 0 0.05 small.stl; then
    grep -q '^closed manifold' printed || fail "the simplified sphere is not closed"
    closed small.stl
fi

if needs draco convert_with_draco torus.stl cm torus.glb; then
    [ "$(wc -c <torus.glb)" -lt "$(wc -c <torus.stl)" ] || fail "Draco did not make it smaller"
    closed torus.glb
fi

# Once with what the machine has, once where no driver of OpenGL can be found.
picture_size() { od -A n -t u1 -j 16 -N 8 "$1" | tr -s ' '; }
render_to_png sphere.nrrd any.png
[ "$(picture_size any.png)" = " 0 0 1 64 0 0 0 240" ] || fail "any.png is not 320 x 240"
__EGL_VENDOR_LIBRARY_DIRS=/nowhere render_to_png sphere.nrrd cpu.png >printed
grep -q 'drawn by CPU' printed || fail "without a driver the processor should draw"
[ "$(picture_size cpu.png)" = " 0 0 1 64 0 0 0 240" ] || fail "cpu.png is not 320 x 240"
# A picture of one colour compresses to almost nothing; the sphere must be in it.
[ "$(wc -c <cpu.png)" -gt 5000 ] || fail "cpu.png shows nothing"

# What goes wrong is told, with the exit code of the command line.
code=0
render_to_png missing.nrrd none.png 2>error || code=$?
[ $code = 3 ] && grep -q 'missing.nrrd' error || fail "a missing file gives exit code $code"
[ ! -e none.png ] || fail "a picture of a missing file"
# Bytes in memory and streams are those of files, in sanitized programs too where the compiler has them.
serve() { "$1"serve_upload scan.nrrd "${2-ply}" <sphere.nrrd >served.mesh 2>served || fail "$(cat served)"; }
stream() { "$1"stream_through 0.2 ply <sphere.nrrd >through.ply 2>through || fail "$(cat through)"; }
cubewright extract sphere.nrrd --iso 0.2 -o file.ply --name surface -q
sanitize='-fsanitize=address,undefined -fno-sanitize-recover=undefined'
echo 'int main(void) { return 0; }' >tiny.c
places=$folder/build/
if "$cc" $sanitize tiny.c -o tiny 2>/dev/null && ./tiny 2>/dev/null; then
    cmake -S "$here/examples" -B sanitized -G "$generator" -DCMAKE_PREFIX_PATH="$folder/usr" \
        -DCMAKE_C_COMPILER="$cc" -DCMAKE_C_FLAGS="$sanitize" >configured 2>&1 || { cat configured; exit 1; }
    cmake --build sanitized --target serve_upload stream_through >built 2>&1 || { cat built; exit 1; }
    places="$places $folder/sanitized/"
fi
for place in $places; do
    serve "$place"
    closed served.mesh
    grep -q "^200: $(wc -c <served.mesh) bytes for $(wc -c <sphere.nrrd)$" served || fail "$(cat served)"
    stream "$place"
    cmp through.ply file.ply
    grep -q "^Content-Length: $(wc -c <file.ply)$" through || fail "$(cat through)"
    for bytes in 0 20 2000; do # uploads that break off
        code=0
        head -c $bytes sphere.nrrd | "$place"serve_upload scan.nrrd ply >none 2>error || code=$?
        [ $code = 3 ] && [ ! -s none ] && grep -q '^422: scan.nrrd: ' error || fail "$bytes bytes: $code"
    done
    code=0
    "$place"stream_through 0.2 stl <sphere.nrrd >/dev/full 2>error || code=$?
    [ $code = 6 ] && grep -q "(memory): the receiver is gone" error || fail "a full disk gives exit code $code"
done

echo "eight examples were built against the installed library, and they work"
