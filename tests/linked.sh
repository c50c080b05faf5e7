#!/bin/sh
# Compares what `cubewright version --licences` lists with what the built files link: sh linked.sh BUILD_FOLDER.
set -eu
build=$1
command -v readelf >/dev/null || { echo "no readelf"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$build/bin/cubewright" version --licences | tail -n +2 >"$folder/list"

# The names that libraries have in the list; a library of the same project has its name.
name_library() {
    case $1 in
    libz.*) echo zlib ;;
    libisal.*) echo ISA-L ;;
    libzstd.*) echo Zstandard ;;
    libbz2.*) echo bzip2 ;;
    libpng16.*) echo libpng ;;
    libdcm* | libof*) echo DCMTK ;;
    libopenjp2.*) echo OpenJPEG ;;
    libmpi.*) echo Open MPI ;;
    libhdf5_serial.*) echo HDF5 ;;
    *) echo "$1" | sed 's/^lib//; s/Core\.so.*//; s/-[0-9_]*\.so.*//; s/\.so.*//' ;;
    esac
}

# check_file NAME FILE: what it needs is in that line of the list.
bad=0
check_file() {
    # a line of the list, with the lines that continue it
    awk -v name="$1" '/^[^ ]/ {on = $1 == name} on' "$folder/list" >"$folder/line"
    readelf -d "$2" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' >"$folder/needed"
    while read -r library; do
        case $library in libc.so* | libm.so* | libdl.so* | ld-linux* | libcubewright.so* | libstdc++* | libgcc_s* | libpthread*) continue ;; esac
        name=$(name_library "$library")
        grep -q -i -F -e "$name" "$folder/line" "$folder/common" ||
            { echo "$2 links $library, and 'version --licences' does not list '$name'"; bad=1; }
    done <"$folder/needed"
}

: >"$folder/common"
check_file library "$build/lib/libcubewright.so"
check_file library "$build/bin/cubewright"
cp "$folder/line" "$folder/common" # what modules may link, too
for module in "$build"/lib/cubewright/cubewright-*.so; do
    [ -e "$module" ] || continue
    name=${module##*/cubewright-}
    check_file "${name%.so}" "$module"
done
# and nothing of the library's line but what is linked
for name in $(tr '\n' ' ' <"$folder/common" | sed 's/([^)]*)//g; s/^library//; s/,/ /g'); do
    for file in "$build/lib/libcubewright.so" "$build/bin/cubewright"; do
        readelf -d "$file" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p'
    done | while read -r library; do name_library "$library"; done | grep -q -i -x -e "$name" -e "${name#lib}" ||
        { echo "'version --licences' lists $name, and nothing links it"; bad=1; }
done
[ $bad = 0 ] && echo "the list of licences has what is linked"
exit $bad
