#!/bin/sh
# Installs into an empty folder, moves it, and uses what is there: sh install.sh BUILD_FOLDER CC.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$1 cc=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/first" >/dev/null
mv "$folder/first" "$folder/moved prefix"
prefix="$folder/moved prefix"
mkdir "$folder/work"
cd "$folder/work"
version=$(sed -n 's/^#define CW_VERSION "\(.*\)"/\1/p' "$prefix/include/cubewright/core.h")
test -s "$prefix/share/doc/cubewright/LICENSE"
! grep -r "$folder/first" "$prefix" || { echo "the prefix stands in the files above"; exit 1; }

# pkg-config tells where the files were moved to
pc=$(find "$prefix" -name cubewright.pc)
PKG_CONFIG_PATH=$(dirname "$pc")
export PKG_CONFIG_PATH
[ "$(pkg-config --modversion cubewright)" = "$version" ]
lib=$(dirname "$(find "$prefix" -name 'libcubewright.so' | head -1)")
eval "$cc -std=c99 '$here/unit/test_api_is_c.c' $(pkg-config --cflags --libs cubewright) -Wl,-rpath,'$lib' -o program"
./program
if [ -e "$lib/libcubewright.a" ]; then
    mkdir static
    cp "$lib/libcubewright.a" static
    eval "$cc -std=c99 '$here/unit/test_api_is_c.c' -L static $(pkg-config --static --cflags --libs cubewright) -o program"
    ./program
    ! readelf -d program | grep libcubewright
fi

# find_package() takes this version and refuses another
cat >CMakeLists.txt <<END
cmake_minimum_required(VERSION 3.25)
project(user C)
find_package(cubewright \${version} REQUIRED)
add_executable(user "$here/unit/test_api_is_c.c")
target_link_libraries(user PRIVATE cubewright::cubewright)
if(TARGET cubewright::cubewright_static)
  add_executable(user_static "$here/unit/test_api_is_c.c")
  target_link_libraries(user_static PRIVATE cubewright::cubewright_static)
endif()
END
cmake -G Ninja -B user -Dversion="${version%.*}" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" >log || { cat log; exit 1; }
cmake --build user >log || { cat log; exit 1; }
./user/user
[ ! -e user/user_static ] || ./user/user_static
! cmake -G Ninja -B other -Dversion=9.1 -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_COMPILER="$cc" >log 2>&1
grep -q "cubewright-config.cmake, version: $version" log

# the program
"$prefix/bin/cubewright" make sphere -o s.nrrd --dims 16 -q
for mesh in s.glb s.stl; do
    "$prefix/bin/cubewright" extract s.nrrd --iso 0 -o $mesh -q || [ "$mesh $?" = "s.glb 5" ]
done
test -s s.stl
# without its module GLB is an ordinary error; everything else goes on
rm -f "$lib/cubewright/cubewright-gltf.so"
code=0
"$prefix/bin/cubewright" extract s.nrrd --iso 0 -o t.glb -q 2>error || code=$?
[ $code = 5 ] && grep -q 'CUBEWRIGHT_GLTF=ON and the Debian package libtinygltf-dev' error
"$prefix/bin/cubewright" extract s.nrrd --iso 0 -o t.stl -q
cmp s.stl t.stl
# manual pages and completion, where the build could write them
if [ -f "$build/pages" ]; then
    for file in man/man1/cubewright.1 man/man1/cubewright-extract.1 man/man3/cubewright.3 \
        bash-completion/completions/cubewright fish/vendor_completions.d/cubewright.fish; do
        test -s "$prefix/share/$file" || { echo "$file is not installed"; exit 1; }
    done
    find "$prefix/share/zsh" -name _cubewright | grep -q . || { echo "no completion of zsh"; exit 1; }
fi
echo "the installed library and program work"
