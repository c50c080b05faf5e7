#!/bin/sh
# Writes the list of tests at the end of tests/README.md, with the stage that runs them and the seconds
# they took in the last runs of the stages release and long: run those on an idle machine first.
# sh tests/list_tests.sh
# With --check FOLDER: is every test of that build in the list?
set -eu
cd "$(dirname "$0")/.."
list=tests/README.md heading='## Tests and their seconds' # the last of the page

if [ "${1:-}" = --check ]; then
    code=0
    for test in $(ctest --test-dir "$2" -N | sed -n 's/^ *Test *#[0-9]*: //p'); do
        row=${test%%/*} name=${test#*/}
        grep -q -e "^| $row |.* $name [0-9]" $list || {
            echo "$list: the test $test is not in the list; run it, and then: sh tests/list_tests.sh"
            code=1
        }
    done
    exit $code
fi

# stage, group, name and seconds of each test
for stage in release long; do
    sed -n "s,^ *[0-9]*/[0-9]* Test *#[0-9]*: \([^ ]*\) .* \([0-9.]*\) sec\$,$stage \1 \2,p" build/$stage-tests.log
done | awk '
    { group = $2; sub("/.*", "", group); name = $2; sub("^[^/]*/", "", name); print $1, group, name, $3 }' |
    sort -k 1,1r -k 2,2 -k 4,4nr |
    awk -v heading="$heading" '
    function end_row() { if (row) printf "| %s | %s | %d | %.0f |%s |\n", group, stage, count, sum, names }
    BEGIN {
        print "\n" heading "\n"
        print "Seconds of wall time on two idle cores, two tests at a time. `sh tests/list_tests.sh` makes this list.\n"
        print "| group | stage | tests | seconds | each |"
        print "| --- | --- | --- | --- | --- |"
    }
    $1 " " $2 != row { end_row(); row = $1 " " $2; stage = $1; group = $2; count = sum = 0; names = "" }
    { count++; sum += $4; names = names sprintf("%s %s %.1f", count > 1 ? "," : "", $3, $4) }
    END { end_row() }' >build/list
sed -i -e "/^$heading/,\$d" $list
sed -i -e :end -e '/^\n*$/{$d;N;b end' -e '}' $list # no empty lines before it
cat build/list >>$list
