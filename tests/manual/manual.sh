#!/bin/sh
# Holds the manual pages to the tables: sh manual.sh BUILD_FOLDER CC. Each command has a page that
# names all its options, and roff's checkers have no complaint.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$1 cc=$2
PATH=$build/bin:$PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
bad=0
complain() { echo "$*"; bad=1; }

commands=$(cubewright help | sed -n '/^Commands/,/^$/s/^  \([a-z]*\) .*/\1/p')
[ -n "$commands" ] || exit 1
cubewright help --man cubewright >cubewright.1 || exit 1
cubewright help --man library >cubewright.3 || exit 1
for command in $commands; do
    page=cubewright-$command.1
    cubewright help --man "$command" >"$page" || complain "no page of $command"
    cubewright help --man "cubewright-$command" | cmp - "$page" || bad=1
    cmp "$page" "$build/man/man1/$page" || bad=1
    grep -q "cubewright..$command (1)" cubewright.1 || complain "cubewright.1 lacks $command"
    for section in NAME SYNOPSIS DESCRIPTION OPTIONS EXAMPLES 'EXIT STATUS' 'SEE ALSO'; do
        grep -q "^.SH \"*$section\"*$" "$page" || complain "$page has no section $section"
    done
    cubewright "$command" -h | sed -n 's/^  \(-.,\|   \) --\([a-z-]*\).*/\2/p' >options
    [ -s options ] || complain "$command has no options"
    while read -r option; do
        grep -q -F -e "\\fB\\-\\-$(echo "$option" | sed 's/-/\\-/g')\\fP" "$page" ||
            complain "$page lacks --$option"
    done <options
done
cubewright help --man nonsense 2>error && complain "there is a page of nonsense"
grep -q "'nonsense' is not a command" error || complain "no error for a page that is not there"

# The environment is that which the program and the library read; hooks for tests are no part of it.
grep -rhoE 'getenv\("[A-Z_]*"\)|\{"(OMPI|PMI)_[A-Z_]*SIZE"|"PMI_SIZE"' "$root/cli" "$root/core" "$root/formats" "$root/viewer" --include='*.c' |
    grep -o '[A-Z][A-Z_]*' | grep -v '^CUBEWRIGHT_TEST_' | sort -u >names
while read -r name; do
    cubewright help environment | grep -q -w "$name" || complain "help environment lacks $name"
done <names

# The page of the library has all headers, each with its own first sentence.
cubewright help library >library
for header in "$root"/include/cubewright/*.h; do
    sentence=$(sed '/\*\//q' "$header" | tr '\n' ' ' |
        sed 's|^/\* ||; s|\*/.*||; s| \* | |g; s|  *| |g; s|\. .*||; s|\.* *$||')
    tr '\n' ' ' <library | tr -s ' ' | grep -q -F -e " ${header##*/} $sentence" ||
        complain "help library lacks ${header##*/}: $sentence"
done

# Its program compiles and works.
sed -n '/^  #include/,/^  }/s/^  //p; /^$/p' library | sed -n '/^#include/,/^}/p' >program.c
if "$cc" -std=c99 -Wall -Wextra -Werror -I "$root/include" program.c -L "$build/lib" -lcubewright \
    -Wl,-rpath,"$build/lib" -o program; then
    cubewright make ct-head -o head.nrrd --dims 32 -q
    ./program head.nrrd head.stl && cubewright check head.stl -q || complain "the program fails"
else
    complain "the program does not compile"
fi

checked=''
if command -v groff >/dev/null; then
    checked="$checked groff"
    groff -man -ww -z ./*.1 ./*.3 2>warnings
    [ -s warnings ] && { cat warnings; bad=1; }
fi
if command -v mandoc >/dev/null; then
    checked="$checked mandoc"
    # A date would differ from build to build.
    mandoc -T lint -W warning ./*.1 ./*.3 | grep -v 'missing date' && bad=1
fi
[ $bad = 0 ] || exit 1
[ -n "$checked" ] || { echo "skipped: neither groff nor mandoc is there"; exit 77; }
echo "pages were checked by$checked"
