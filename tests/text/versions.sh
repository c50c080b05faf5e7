#!/bin/sh
# Looks for the version of core.h in all files that state it: sh versions.sh
# The soname's number must be that of the Debian package. Each check is then tried with a wrong version.
set -u
root=$(cd "$(dirname "$0")/../.." && pwd)
files="include/cubewright/core.h CITATION.cff cli/debian/changelog cli/debian/control CHANGELOG.md README.md
    cli/help/library.txt include/docs/README.md tests/examples/CMakeLists.txt CMakeLists.txt
    cli/debian/README.md core/add_feature.cmake"

check_versions() { # ROOT: prints what differs
    version=$(sed -n 's/^#define CW_VERSION "\([0-9.]*\)"/\1/p' "$1/include/cubewright/core.h")
    minor=${version%.*}
    wrong=0
    state() { # ROOT PATTERN_OF_A_LINE FILE
        grep -q -e "$2" "$1/$3" || { echo "$3 lacks '$2'; core.h has version $version"; wrong=1; }
    }
    state "$1" "^version: $version\$" CITATION.cff
    state "$1" "^## $version, " CHANGELOG.md
    state "$1" "^This is version $minor\." README.md
    for file in README.md cli/help/library.txt include/docs/README.md tests/examples/CMakeLists.txt; do
        state "$1" "find_package(cubewright $minor REQUIRED)" $file
    done
    # both begin with the newest version
    head -1 "$1/cli/debian/changelog" | grep -q "^cubewright ($version)" ||
        { echo "cli/debian/changelog does not begin with $version"; wrong=1; }
    grep '^## ' "$1/CHANGELOG.md" | head -1 | grep -q "^## $version, " ||
        { echo "CHANGELOG.md does not begin with $version"; wrong=1; }
    number=$(sed -n 's/.* SOVERSION \([0-9]*\)).*/\1/p' "$1/CMakeLists.txt")
    state "$1" "^Package: libcubewright$number\$" cli/debian/control
    for file in cli/debian/control cli/debian/README.md core/add_feature.cmake; do
        grep -o 'libcubewright[0-9][0-9]*' "$1/$file" | grep -q -v -x "libcubewright$number" &&
            { echo "$file has another number than SOVERSION, $number"; wrong=1; }
    done
    # a release has one date
    released=$(sed -n "s/^## $version, \([0-9-]*\)\$/\1/p" "$1/CHANGELOG.md")
    [ -z "$released" ] || state "$1" "^date-released: $released\$" CITATION.cff
    return $wrong
}

for field in 'cff-version: 1.2.0' 'title: ' 'date-released: 20[0-9][0-9]-[01][0-9]-[0-3][0-9]$' 'license: MIT$' '  - name: ' 'message: '; do
    grep -q "^$field" "$root/CITATION.cff" || { echo "CITATION.cff lacks '$field'"; exit 1; }
done
grep -q "^Copyright (c) [0-9-]* $(sed -n 's/^  - name: "\(.*\)"/\1/p' "$root/CITATION.cff")\$" "$root/LICENSE" ||
    { echo "CITATION.cff names other authors than LICENSE"; exit 1; }
check_versions "$root" || exit 1
[ -f "$root/cli/debian/libcubewright$number.install" ] || { echo "cli/debian lacks libcubewright$number.install"; exit 1; }
stated=$version stated_minor=$minor

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for planted in $files; do
    for file in $files; do
        mkdir -p "$folder/$(dirname "$file")"
        cp "$root/$file" "$folder/$file"
    done
    sed -i "s/$stated/9.9.9/g; s/version $stated_minor\./version 9.9./; s/cubewright $stated_minor /cubewright 9.9 /; s/libcubewright[0-9]/libcubewright9/; s/SOVERSION [0-9]*/SOVERSION 9/" "$folder/$planted"
    check_versions "$folder" >/dev/null && { echo "a wrong version in $planted is not seen"; exit 1; }
done
echo "version $stated in $(echo "$files" | wc -w) files"
