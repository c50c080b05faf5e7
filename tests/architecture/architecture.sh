#!/bin/sh
# Holds the walls of the house: sh architecture.sh [ROOT]
#
# 1. Every #include of our own leads to the same room, or to one that rooms.txt allows.
# 2. Every folder of sources is a room of rooms.txt, with 30 files at most, C and C++ alone.
# 3. No two sources have one base name.
# 4. No two definitions have one internal name (cwi_, CWI_).
# 5. No message of a library names an option of the command line: it names a field, as desc->max_bytes.
set -u
here=$(cd "$(dirname "$0")" && pwd)
cd "${1:-$here/../..}" || exit 1
bad=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
find core extract simplify formats viewer cli -type f \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.inc' \) | sort >"$folder/sources"
[ -s "$folder/sources" ] || { echo "no sources"; exit 1; }

# shellcheck disable=SC2046
awk -v rooms="$here/rooms.txt" -f "$here/includes.awk" $(cat "$folder/sources") || bad=1

sed 's|/[^/]*$||' "$folder/sources" | sort | uniq -c | awk '$1 > 30 {
    print $2 ": " $1 " files; a room has 30 at most"; found = 1 } END { exit found }' || bad=1

sed 's|.*/||' "$folder/sources" | sort | uniq -d >"$folder/twice"
while IFS= read -r name; do
    echo "two sources are named $name: $(grep "/$name\$" "$folder/sources" | tr '\n' ' ')"
    bad=1
done <"$folder/twice"

# What is absent from a build has a stub of the same functions.
# shellcheck disable=SC2046
awk -f "$here/names.awk" $(grep -v -e '_stub\.c$' -e '^cli/' "$folder/sources") | sort >"$folder/names"
[ -s "$folder/names" ] || { echo "no internal names"; exit 1; }
awk '{ count[$1]++; places[$1] = places[$1] " " $2 }
    END { for (name in count) if (count[name] > 1) { print name " is defined twice:" places[name]; found = 1 }
    exit found }' "$folder/names" || bad=1

# The window is a program's; its help names keys.
# shellcheck disable=SC2046
grep -nE '^[^/]*"[^"]*--[a-z]' $(grep -v -e '^cli/' -e '^viewer/window/' "$folder/sources") /dev/null |
    sed 's/$/: a library names no option of the command line/' >"$folder/options"
[ ! -s "$folder/options" ] || { cat "$folder/options"; bad=1; }

[ $bad = 0 ] && echo "$(wc -l <"$folder/sources") sources in $(sed 's|/[^/]*$||' "$folder/sources" | sort -u | wc -l) rooms"
exit $bad
