#!/bin/sh
# Holds the comments of the sources to plain English: sh comments.sh [FOLDER...]
# Every source opens with a sentence that says what it is; no comment begins with "What" or "Whose",
# a clause without a verb; and none has an expression of riddles.txt.
set -u
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.." || exit 1
[ $# -gt 0 ] || set -- core extract simplify formats viewer cli include tests
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
find "$@" -type f \( -name '*.c' -o -name '*.h' -o -name '*.cpp' -o -name '*.hpp' -o -name '*.inc' \
    -o -name '*.glsl' \) | sort >"$folder/sources"
[ -s "$folder/sources" ] || { echo "no sources"; exit 1; }
bad=0

# shellcheck disable=SC2046
awk 'FNR == 1 && !/^\/[*\/] ?[A-Za-z0-9]/ { print FILENAME ":1: opens with no sentence"; bad = 1 } END { exit bad }' \
    $(cat "$folder/sources") || bad=1

grep -v '^ *\(#\|$\)' "$here/riddles.txt" >"$folder/riddles"
# shellcheck disable=SC2046
awk -f "$here/comments.awk" $(cat "$folder/sources") | sed 's/`[^`]*`//g' >"$folder/comments"
if grep -i -w -E -f "$folder/riddles" "$folder/comments" >"$folder/found"; then
    sed 's/^\([^:]*:[^:]*:\)/\1 a riddle:/' "$folder/found"
    bad=1
fi
# shellcheck disable=SC2046
if grep -n -E '(/\*+|//) (What|Whose)\b' $(cat "$folder/sources") >"$folder/found"; then
    sed 's/^\([^:]*:[^:]*:\)/\1 begins with a clause:/' "$folder/found"
    bad=1
fi

# Python: each file opens with its sentence, and docstrings are too many to tell from code.
find python tests/python -name '*.py' ! -name _declarations.py | sort >"$folder/scripts"
while IFS= read -r script; do
    sed -n '/^#!/d; p; q' "$script" | grep -q '^"""[A-Z]' || { echo "$script:1: opens with no sentence"; bad=1; }
    if grep -n -i -w -E -e '"""(What|Whose)' -f "$folder/riddles" "$script" >"$folder/found"; then
        sed "s|^|$script: a riddle: |" "$folder/found"
        bad=1
    fi
done <"$folder/scripts"
[ $bad = 0 ] && echo "$(wc -l <"$folder/sources") sources, $(wc -l <"$folder/comments") lines of comments"
exit $bad
