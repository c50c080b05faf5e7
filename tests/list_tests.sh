#!/bin/sh
# Writes the list of tests at the end of tests/README.md, with the stage that runs them and the seconds
# they took in the last runs of the stages release and long: run those on an idle machine first.
# sh tests/list_tests.sh
# With --names BUILD: adds the new tests of that build without seconds (-), and removes those that are gone.
# With --check BUILD: is every test of that build in the list?
set -eu
cd "$(dirname "$0")/.."
list=tests/README.md heading='## Tests and their seconds' # the last of the page
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

find_tests() { # CTEST_OPTION...: group and name of each test
    ctest "$@" -N | sed -n -e 's/^ *Test *#[0-9]*: //p' | sed -e 's,^[^/]*$,&/&,' -e 's,/, ,'
}

if [ "${1:-}" = --check ]; then
    code=0
    find_tests --test-dir "$2" >"$work/all"
    while read -r row name; do
        grep -q -e "^| $row |.* $name [-0-9]" $list || {
            echo "$list: the test $row/$name is not in the list: sh tests/list_tests.sh --names $2"
            code=1
        }
    done <"$work/all"
    exit $code
elif [ "${1:-}" = --names ]; then
    find_tests --test-dir "$2" >"$work/all"
    find_tests --test-dir "$2" -L 'long|again' >"$work/long"
    [ -s "$work/all" ] || { echo "$2 has no tests" >&2; exit 1; }
    awk -F ' *[|] *' -v heading="$heading" '
        function add(names, test) { count++; return names (names ? ", " : "") test }
        FILENAME ~ /all$/ { there[$0] = 1; next }
        FILENAME ~ /long$/ { long[$0] = 1; next }
        FNR == 1 { # the list: once for what it has, once to change it
            pass++
        }
        { found = $0 == heading || (found && FNR > 1) }
        !found || NF != 7 || $2 == "group" || $2 ~ /^-/ { if (pass == 2) print; next }
        {
            names = ""
            count = 0
            n = split($6, tests, ", ")
            for (i = 1; i <= n; i++) {
                test = $2 " " tests[i]
                sub(/ [-0-9.]+$/, "", test)
                listed[test] = 1
                if (test in there)
                    names = add(names, tests[i])
            }
            if (pass == 1)
                next
            for (test in there)
                if (!listed[test] && index(test, $2 " ") == 1 && $3 == (test in long ? "long" : "release")) {
                    names = add(names, substr(test, length($2) + 2) " -")
                    placed[test] = 1
                }
            if (count)
                printf "| %s | %s | %d | %s | %s |\n", $2, $3, count, $5, names
        }
        END {
            for (test in there)
                if (!listed[test] && !placed[test]) {
                    group = name = test
                    sub(/ .*/, "", group)
                    sub(/^[^ ]* /, "", name)
                    printf "| %s | %s | 1 | 0 | %s - |\n", group, test in long ? "long" : "release", name
                }
        }' "$work/all" "$work/long" $list $list >"$work/list"
    cat "$work/list" >$list
    exit
fi

for stage in release long; do
    [ -s build/$stage-tests.log ] || { echo "build/$stage-tests.log is not there: sh tests/run.sh $stage" >&2; exit 1; }
done
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
    END { end_row() }' >"$work/list"
sed -i -e "/^$heading/,\$d" $list
sed -i -e :end -e '/^\n*$/{$d;N;b end' -e '}' $list # no empty lines before it
cat "$work/list" >>$list
