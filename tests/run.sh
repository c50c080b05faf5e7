#!/bin/sh
# Installs what the tests need, builds, and tests. Safe to run twice.
#
#   sh tests/run.sh            the release stage: every test, about five minutes on two cores
#   sh tests/run.sh all        all stages, about 35 minutes
#   sh tests/run.sh STAGE...   some of them:
#
# release     gcc, as users build it: every test, and the format of the code
# sanitizers  clang, address and undefined-behaviour sanitizers: unit tests and fuzz corpora
# mutants     clang, the same: every reader on mutants of its corpus
# threads     clang, thread sanitizer: the tests of code with threads
# rooms       gcc: every room linked with the rooms it may use alone, to prove the walls
# minimal     gcc, debug at -O1, no C++ library: unit tests at their full length, an installed copy, the ABI
# fresh       a bare Debian: the quickstart, and builds that lack packages (fresh.sh)
set -eu
cd "$(dirname "$0")/.."
stages=${*:-release}
[ "$stages" != all ] || stages="release rooms sanitizers mutants threads minimal fresh"
set -- # the functions of packages.sh look at $0 alone
. cli/packages.sh
. cli/build.sh
mkdir -p build
started=$(date +%s)
say() { echo "== $* ($(($(date +%s) - started)) s)"; }

# The readers and validators of other people; tests that need a missing one are skipped.
install_validators() {
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
}

# Thousands of small files are written and read: in memory, where there is room for them.
use_memory() {
    free=$(df -k --output=avail /dev/shm 2>/dev/null | tail -1)
    if [ -w /dev/shm ] && [ "${free:-0}" -gt 4000000 ]; then
        TMPDIR=/dev/shm
        export TMPDIR
    fi
}

# run_tests PRESET [OPTION OF CTEST...]: progress, then the sums, or what the failed tests printed.
run_tests() {
    preset=$1 log=build/$1-tests.log
    shift
    rm -f "$log.failed"
    { use_memory && ctest --preset "$preset" -j "$(nproc)" --no-tests=error "$@" 2>&1 || touch "$log.failed"; } |
        tee "$log" | show_tenths '^ *[0-9]+/[0-9]+ Test' test
    if [ -e "$log.failed" ]; then
        grep -v -e '^ *Start ' -e ' Passed ' -e '(Skipped)' "$log"
        say "$preset: FAILED; the log is $log"
        exit 1
    fi
    sed -n '/tests passed/p; /did not run/,$p' "$log"
}

# configure_and_build PRESET: with the tests; warnings are errors.
configure_and_build() {
    say "$1: configuring"
    configure_preset "$1" "build/$1-configure.log" -DCUBEWRIGHT_TESTS=ON -DCUBEWRIGHT_WERROR=ON
    say "$1: building"
    build_preset "$1" "build/$1-build.log"
}

say "installing packages"
install_packages "what the build needs" needed optional
install_packages "what the tests need" test
case $stages in *sanitizers* | *mutants* | *threads*) install_packages "sanitizers" sanitizer ;; esac
case $stages in *fresh*) install_packages "what makes a bare Debian" fresh || true ;; esac

for stage in $stages; do
    case $stage in
    release)
        install_packages "a second opinion on meshes, and MPI" heavy ||
            echo "== CGAL or MPI cannot be had: tests that ask them will be skipped"
        install_packages "the scan that the README shows" data ||
            echo "== mricron-data cannot be had: the README's commands run on a synthetic head"
        install_validators >build/validators.log 2>&1 & # while the compiler works
        validators=$!
        configure_and_build release
        cmake --build --preset release --target format-check >build/format.log 2>&1 ||
            { grep "error:" build/format.log; say "the code is not formatted: cmake --build --preset release --target format"; exit 1; }
        sed -n 's/^the format of the code is not checked/== &/p' build/format.log
        wait $validators || true
        cat build/validators.log
        say "release: testing"
        run_tests release
        ;;
    rooms)
        configure_and_build rooms
        ;;
    sanitizers)
        configure_and_build fuzz
        say "sanitizers: testing"
        run_tests fuzz -L 'unit|fuzz'
        ;;
    mutants)
        [ -d build/fuzz/bin ] || configure_and_build fuzz
        say "mutants"
        printf '%s\n' build/fuzz/bin/fuzz_* | xargs -n 1 -P "$(nproc)" sh tests/fuzz/mutants.sh
        ;;
    threads)
        say "threads: configuring"
        configure_preset tsan build/tsan-configure.log -DCUBEWRIGHT_TESTS=ON -DCUBEWRIGHT_WERROR=ON
        threaded='parallel|extract|label_crossings|volume|vbuffer|intensity|quality|render|distance_mesh|oracle|intersections|normals|simplify$|slabs|sparse|irregular'
        say "threads: building"
        # shellcheck disable=SC2046 # no more programs than are run
        build_preset tsan build/tsan-build.log --target \
            $(ctest --preset tsan -N -R "$threaded" 2>/dev/null | sed -n 's,.* unit/,,p')
        say "threads: testing"
        run_tests tsan -R "$threaded"
        ;;
    minimal)
        configure_and_build minimal
        say "minimal: testing"
        export CUBEWRIGHT_TEST_LONG=1
        run_tests minimal -R 'unit|fuzz|install|examples|^abi'
        unset CUBEWRIGHT_TEST_LONG
        ;;
    fresh)
        say "fresh"
        code=0
        sh tests/fresh.sh || code=$?
        [ $code = 0 ] || [ $code = 77 ] || exit $code
        ;;
    *)
        echo "run.sh: there is no stage '$stage'" >&2
        exit 2
        ;;
    esac
done
say "passed: $stages"
