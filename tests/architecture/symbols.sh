#!/bin/sh
# Looks at what the shared library exports: sh symbols.sh LIBRARY INCLUDE_FOLDER.
# It exports public functions (cw_), all of those that the headers declare and no other; what is internal
# (cwi_) has a version that names one release.
set -eu
library=$1 headers=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
nm -D --defined-only "$library" | awk '$2 != "A" { print $NF }' | sort -u >"$folder/all"
release=$(sed -n 's/^#define CW_VERSION "\(.*\)"/\1/p' "$headers/core.h")
if grep -v -e '^cw_[a-z0-9_]*@@CUBEWRIGHT_0$' -e "^cwi_[a-z0-9_]*@@CUBEWRIGHT_INTERNAL_$release\$" "$folder/all"; then
    echo "these are exported, and neither public nor of the version of internal ones"
    exit 1
fi
sed -n 's/^\(cw_.*\)@@.*/\1/p' "$folder/all" >"$folder/exported"
cat "$headers"/*.h | tr '\n' ' ' | sed 's/CW_API/\n&/g' |
    sed -n 's/^CW_API [^([;]*[ *]\(cw_[a-z0-9_]*\)[([].*/\1/p' | sort -u >"$folder/declared"
[ -s "$folder/declared" ]
if ! comm -3 "$folder/declared" "$folder/exported" >"$folder/differ" || [ -s "$folder/differ" ]; then
    echo "declared but not exported, or (indented) exported but not declared:"
    cat "$folder/differ"
    exit 1
fi
echo "$(wc -l <"$folder/exported") public functions"
