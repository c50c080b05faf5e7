#!/bin/sh
# Runs one case: sh run_case.sh CASE.sh BIN_FOLDER. The case runs in an empty folder with the
# program first on PATH; $TESTS is this folder's parent. What it prints and its exit code must be
# those of CASE.out, CASE.err and CASE.exit (nothing, nothing and 0 when there is no such file).
# What a case interrupts has CUBEWRIGHT_TEST_GRACE seconds to hear of it, however slow the machine is.
set -u
case=${1%.sh}
TESTS=$(cd "$(dirname "$0")/.." && pwd)
PATH=$2:$PATH
. "$TESTS/support/wait.sh"
CUBEWRIGHT_TEST_GRACE=$limit_s
export TESTS PATH CUBEWRIGHT_TEST_GRACE
unset COLUMNS NO_COLOR
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/work"
cd "$folder/work" || exit 1
sh "$case.sh" >../out 2>../err </dev/null
code=$?
[ $code = 77 ] && { cat ../err; exit 77; }
bad=0
wanted=0
[ -f "$case.exit" ] && wanted=$(cat "$case.exit")
[ "$code" = "$wanted" ] || { echo "exit code $code, expected $wanted"; bad=1; }
for stream in out err; do
    expected=/dev/null
    [ -f "$case.$stream" ] && expected=$case.$stream
    awk -f "$TESTS/cli/match.awk" "$expected" "../$stream" || { echo "in std$stream"; bad=1; }
done
exit $bad
