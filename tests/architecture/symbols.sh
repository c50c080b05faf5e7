#!/bin/sh
# Looks at what the shared library exports: sh symbols.sh LIBRARY INCLUDE_FOLDER.
# It exports public functions (cw_) alone, and all of those that the headers declare.
set -eu
library=$1 headers=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
nm -D --defined-only "$library" | awk '{ print $NF }' | sort -u >"$folder/exported"
if grep -v '^cw_' "$folder/exported"; then
    echo "these are exported, and not public"
    exit 1
fi
cat "$headers"/*.h | tr '\n' ' ' | sed 's/CW_API/\n&/g' |
    sed -n 's/^CW_API [^([;]*[ *]\(cw_[a-z0-9_]*\)[([].*/\1/p' | sort -u >"$folder/declared"
[ -s "$folder/declared" ]
if ! comm -3 "$folder/declared" "$folder/exported" >"$folder/differ" || [ -s "$folder/differ" ]; then
    echo "declared but not exported, or (indented) exported but not declared:"
    cat "$folder/differ"
    exit 1
fi
echo "$(wc -l <"$folder/exported") public functions"
