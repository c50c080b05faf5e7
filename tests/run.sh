#!/bin/sh
# Installs what the tests need, builds, and runs every test. Safe to run twice.
#
# release  gcc, as users build it: all tests
# fuzz     clang, address and undefined sanitizers: unit tests and the fuzz corpora
# tsan     clang, thread sanitizer: the tests of code with threads
# minimal  gcc, debug at -O1, no C++ library: unit tests, an installed copy
set -eu
cd "$(dirname "$0")/.."
. cli/packages.sh

mkdir -p build
install_packages "what the build needs" needed optional
install_packages "what the tests need" test
install_packages "a second opinion on meshes" heavy ||
    echo "== CGAL cannot be had: what asks it will be skipped"
install_packages "the scan that the README shows" data ||
    echo "== mricron-data cannot be had: the README's commands run on a made head"
install_packages "other people's readers" validator ||
    echo "== some readers are missing: their tests will be skipped"
validator=build/validator
if command -v npm >/dev/null && [ ! -d $validator/node_modules/three ]; then
    echo "== installing the glTF validator and three.js (npm) in $validator"
    mkdir -p $validator
    cp tests/validator/package.json $validator/
    npm install --prefix $validator --no-audit --no-fund --no-package-lock --silent ||
        echo "== the glTF validator cannot be had: its tests will be skipped"
fi

# Runs a command and shows what it printed only if it fails.
quietly() {
    "$@" >build/log 2>&1 || { cat build/log; exit 1; }
}

# A quickstart may have configured without tests; no build may warn.
configure() {
    echo "== $1"
    quietly cmake --preset "$1" -DCUBEWRIGHT_TESTS=ON -DCUBEWRIGHT_WERROR=ON
}

# run_tests PRESET [OPTIONS OF CTEST]
run_tests() {
    preset=$1
    shift
    quietly ctest --preset "$preset" -j "$(nproc)" --no-tests=error "$@"
    sed -n '/tests passed/,/^Total/p' build/log
}

build_and_test() {
    configure "$1"
    quietly cmake --build --preset "$1"
    run_tests "$@"
}

build_and_test release
quietly cmake --build --preset release --target format-check
build_and_test fuzz -L 'unit|fuzz'
echo "== mutants"
printf '%s\n' build/fuzz/bin/fuzz_* | xargs -n 1 -P "$(nproc)" sh tests/fuzz/mutants.sh
configure tsan
threaded='extract|volume|vbuffer|intensity|quality|render|distance_mesh|oracle|intersections|normals|simplify$|slabs|sparse|irregular'
# shellcheck disable=SC2046 # no more programs than are run
quietly cmake --build --preset tsan --target \
    $(ctest --preset tsan -N -R "$threaded" 2>/dev/null | sed -n 's,.* unit/,,p')
run_tests tsan -R "$threaded"
build_and_test minimal -R 'unit|fuzz|install'
echo "== all tests passed"
