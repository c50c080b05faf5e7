#!/bin/sh
# Installs into an empty folder and uses what is there: sh install.sh BUILD_FOLDER CC.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1 cc=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/usr" >/dev/null
cd "$folder"
pc=$(find usr -name cubewright.pc)
PKG_CONFIG_PATH=$(dirname "$pc")
export PKG_CONFIG_PATH
flags=$(pkg-config --define-variable=prefix="$folder/usr" --cflags --libs cubewright)
lib=$(dirname "$(find "$folder/usr" -name 'libcubewright.so' | head -1)")
# shellcheck disable=SC2086
"$cc" -std=c99 -I usr/include "$here/unit/test_api_is_c.c" $flags -L "$lib" \
    -Wl,-rpath,"$lib" -o program
./program
usr/bin/cubewright make sphere -o s.nrrd --dims 16 -q
for mesh in s.glb s.stl; do
    usr/bin/cubewright extract s.nrrd --iso 0 -o $mesh -q || [ "$mesh $?" = "s.glb 5" ]
done
test -s s.stl
# without its module GLB is an ordinary error; everything else goes on
rm -f "$lib/cubewright/cubewright-gltf.so"
code=0
usr/bin/cubewright extract s.nrrd --iso 0 -o t.glb -q 2>error || code=$?
[ $code = 5 ] && grep -q 'CUBEWRIGHT_GLTF=ON and the Debian package libtinygltf-dev' error
usr/bin/cubewright extract s.nrrd --iso 0 -o t.stl -q
cmp s.stl t.stl
# manual pages and completion, where the build could write them
if [ -f "$build/pages" ]; then
    for file in man/man1/cubewright.1 man/man1/cubewright-extract.1 man/man3/cubewright.3 \
        bash-completion/completions/cubewright fish/vendor_completions.d/cubewright.fish; do
        test -s "usr/share/$file" || { echo "$file is not installed"; exit 1; }
    done
    find usr/share/zsh -name _cubewright | grep -q . || { echo "no completion of zsh"; exit 1; }
fi
echo "the installed library and program work"
