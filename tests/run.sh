#!/bin/sh
# Installs what the tests need, builds, and tests. Safe to run twice.
#
#   sh tests/run.sh            the release stage: about five and a half minutes on two cores, packages not counted
#   sh tests/run.sh all        all stages, about 45 minutes
#   sh tests/run.sh STAGE...   some of them:
#
# release     gcc, as users build it: every room, command and format, and the format of the code
# long        the same build: random tests at full length, drawn windows, real scans, and other people's
#             programs, which say what they think of our files
# sanitizers  clang, address and undefined-behaviour sanitizers: unit tests and fuzz corpora
# mutants     clang, the same: every reader on mutants of its corpus
# threads     clang, thread sanitizer: the tests of code with threads
# rooms       gcc: every room linked with the rooms it may use alone, to prove the walls
# minimal     gcc, debug at -O1, no C++ library: unit tests, an installed copy, the ABI
# fresh       a bare Debian: the quickstart, and builds that lack packages (fresh.sh)
#
# A test that takes longer than 1000 s hangs; on a machine that is very slow, or very busy,
# CUBEWRIGHT_TEST_SLOW=5 allows for five times as much.
set -eu
cd "$(dirname "$0")/.."
stages=${*:-release}
[ "$stages" != all ] || stages="release long rooms sanitizers mutants threads minimal fresh"
set -- # the functions of packages.sh look at $0 alone
. cli/packages.sh
. cli/build.sh
mkdir -p build
started=$(date +%s)
say() { echo "== $* ($(($(date +%s) - started)) s)"; }

# --- what the stages take -----------------------------------------------------------------------

# count_seconds: seconds so far, and those of processors that ended programs had, in $wall and $processors.
count_seconds() {
    times >build/times # not in a subshell, which would tell its own
    processors=$(awk 'NR == 2 { gsub(/[ms]/, " "); print int($1 * 60 + $2 + $3 * 60 + $4) }' build/times)
    wall=$(($(date +%s) - started))
}
start_budget() {
    count_seconds
    wall_before=$wall processors_before=$processors
}
# add_budget STAGE: its line in the table at the end.
add_budget() {
    count_seconds
    printf '   %-11s %5d s, of processors %5d s\n' "$1" $((wall - wall_before)) \
        $((processors - processors_before)) >>build/budget
}

# --- packages -----------------------------------------------------------------------------------

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

# --- building and testing -----------------------------------------------------------------------

# configure_and_build PRESET: with the tests; warnings are errors.
configure_and_build() {
    say "$1: configuring"
    configure_preset "$1" "build/$1-configure.log" -DCUBEWRIGHT_TESTS=ON -DCUBEWRIGHT_WERROR=ON
    say "$1: building"
    build_preset "$1" "build/$1-build.log"
}

check_format() {
    cmake --build --preset release --target format-check >build/format.log 2>&1 ||
        { grep "error:" build/format.log; say "the code is not formatted: cmake --build --preset release --target format"; exit 1; }
    sed -n 's/^the format of the code is not checked/== &/p' build/format.log
}

# Thousands of small files are written and read: in memory, where there is room for them.
use_memory() {
    free=$(df -k --output=avail /dev/shm 2>/dev/null | tail -1)
    if [ -w /dev/shm ] && [ "${free:-0}" -gt 4000000 ]; then
        TMPDIR=/dev/shm
        export TMPDIR
    fi
}

# show_tests LOG: how many have ended, every 15 s, until LOG.ended is there.
show_tests() {
    while [ ! -e "$1.ended" ]; do
        waited=0
        while [ $waited -lt 15 ] && [ ! -e "$1.ended" ]; do
            sleep 1
            waited=$((waited + 1))
        done
        ended=$(sed -n 's,^ *\([0-9]*\)/\([0-9]*\) Test.*,test \1 of \2,p' "$1" | tail -1)
        echo "   ${ended:-tests are running} ($(($(date +%s) - started)) s)"
    done
}

# show_failures LOG: the tests that failed, and then what they printed.
show_failures() {
    sed -n -e '/tests passed/p' -e '/The following tests/,$p' "$1"
    awk '/^ *[0-9]+\/[0-9]+ Test / { failed = !/ Passed / && !/\(Skipped\)/ && !/\*\*\*Skipped/ }
        /^ *Start / || /^[0-9]+% tests passed/ { failed = 0 }
        failed' "$1"
}

# run_tests NAME PRESET [OPTION OF CTEST...]: progress, then the sums, or what the failed tests printed.
run_tests() {
    log=build/$1-tests.log name=$1 preset=$2
    shift 2
    say "$name: testing"
    rm -f "$log.failed" "$log.ended"
    : >"$log"
    show_tests "$log" &
    shown=$!
    (use_memory && ctest --preset "$preset" -j "$(nproc)" --no-tests=error \
        --timeout $((1000 * ${CUBEWRIGHT_TEST_SLOW:-1})) "$@") >"$log" 2>&1 || touch "$log.failed"
    touch "$log.ended"
    wait $shown
    if [ -e "$log.failed" ]; then
        show_failures "$log"
        say "$name: FAILED; the log is $log"
        exit 1
    fi
    sed -n '/tests passed/p; /did not run/,$p' "$log"
}

say "installing packages"
install_packages "what the build needs" needed optional
install_packages "what the tests need" test
case $stages in *sanitizers* | *mutants* | *threads*) install_packages "sanitizers" sanitizer ;; esac
case $stages in *fresh*) install_packages "what makes a bare Debian" fresh || true ;; esac
case $stages in
*long*)
    install_packages "a second opinion on meshes, and MPI" heavy ||
        echo "== CGAL or MPI cannot be had: tests that ask them will be skipped"
    install_packages "the scan that the README shows" data ||
        echo "== mricron-data cannot be had: the README's commands run on a synthetic head"
    ;;
esac

rm -f build/budget
for stage in $stages; do
    start_budget
    case $stage in
    release)
        configure_and_build release
        check_format
        run_tests release release -LE long
        ;;
    long)
        install_validators >build/validators.log 2>&1 & # while the compiler works
        validators=$!
        configure_and_build release
        wait $validators || true
        cat build/validators.log
        export CUBEWRIGHT_TEST_LONG=1
        run_tests long release -L 'long|again'
        unset CUBEWRIGHT_TEST_LONG
        ;;
    rooms)
        configure_and_build rooms
        ;;
    sanitizers)
        configure_and_build fuzz
        run_tests sanitizers fuzz -L 'unit|fuzz'
        ;;
    mutants)
        [ -d build/fuzz/bin ] || configure_and_build fuzz
        say "mutants"
        printf '%s\n' build/fuzz/bin/fuzz_* | xargs -n 1 -P "$(nproc)" sh tests/fuzz/mutants.sh
        ;;
    threads)
        configure_and_build tsan
        run_tests threads tsan -R 'parallel|extract|label_crossings|volume|vbuffer|intensity|quality|render|distance_mesh|oracle|intersections|normals|simplify$|slabs|sparse|irregular|read_ahead|test_stream$'
        ;;
    minimal)
        configure_and_build minimal
        run_tests minimal minimal -R 'unit|fuzz|install|examples|^abi'
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
    add_budget "$stage"
done
cat build/budget
say "passed: $stages"
