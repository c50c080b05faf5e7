#!/bin/sh
# Zarr stores of other writers: those that zarr-python makes here, and those of CUBEWRIGHT_DATA:
# sh zarr.sh VOXELS. Every number must be the same. 77 when there is neither.
set -u
voxels=$1
here=$(cd "$(dirname "$0")" && pwd)
stores=${CUBEWRIGHT_DATA:-}/conformance/zarr/neuroglancer/zarr
failed=0 asked=0
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1

# expect WHAT GOT WANTED
expect() {
    asked=$((asked + 1))
    [ "$2" = "$3" ] || { echo "$1: got ${2:-nothing}, expected $3"; failed=1; }
}
# numbers KIND PATH: as od prints them
numbers() { "$voxels" "$2" | od -An -v -w2000 -t"$1" | tr -s ' ' | sed 's/^ //'; }
count_to() { seq -s " " "$1" "$2"; }

python=
for p in /usr/bin/python3 python3; do # Debian's has the packages
    [ -z "$python" ] && $p -c 'import zarr, numcodecs' 2>/dev/null && python=$p
done
if [ -n "$python" ]; then
    $python "$here/zarr_stores.py" >count || exit 1
    for raw in store*.raw; do
        asked=$((asked + 1))
        "$voxels" "${raw%.raw}" >got && cmp got "$raw" || { echo "${raw%.raw}: $(cat "${raw%.raw}/.zarray")"; failed=1; }
    done
else
    echo "without python3-zarr no stores of zarr-python are read"
fi
if [ -d "$stores" ]; then
    for version in zarr_v2/from_zarr-python zarr_v3/from_zarrita; do
        for path in "$stores/$version"/data.zarr/*/; do
            name=$(basename "$path")
            case $name in
            *.S7 | *.U7 | *.U13.* | *.O) expect "$name" "$("$voxels" "$path" 2>&1 | grep -c "'dtype' is")" 1 ;;
            *filled*) ;; # below
            3d.chunked.compressed.sharded.i2) expect "$name" "$(numbers d2 "$path")" "$(count_to 0 63)" ;;
            3d.*) expect "$name" "$(numbers d2 "$path")" "$(count_to 0 26)" ;;
            2d.*.ragged.*) expect "$name" "$(numbers d2 "$path")" "$(count_to 1 9)" ;;
            2d.chunked.compressed.sharded.i2) expect "$name" "$(numbers d2 "$path")" "$(count_to 1 16)" ;;
            2d.*) expect "$name" "$(numbers d2 "$path")" "$(count_to 1 4)" ;;
            1d.*ragged*) expect "$name" "$(numbers d2 "$path")" "$(count_to 1 5)" ;;
            1d.*.i2) expect "$name" "$(numbers d2 "$path")" "$(count_to 1 4)" ;;
            1d.*.i4) expect "$name" "$(numbers d4 "$path")" "$(count_to 1 4)" ;;
            1d.*.u1) expect "$name" "$(numbers u1 "$path")" "255 0 255 0" ;;
            1d.*.b1) expect "$name" "$(numbers u1 "$path")" "1 0 1 0" ;;
            1d.*.f8) expect "$name" "$(numbers f8 "$path")" "1.5 2.5 3.5 4.5" ;;
            1d.*.f4*) expect "$name" "$(numbers f4 "$path")" "-1000.5 0 1000.5 0" ;;
            *) echo "$name: nothing is known of it" ;;
            esac
        done
    done
    sharded=$stores/zarr_v3/from_zarrita/data.zarr
    expect "missing inner chunks" "$(numbers d2 "$sharded/1d.chunked.filled.compressed.sharded.i2")" "1 2 0 0"
    for version in 4 5; do
        expect "OME-Zarr 0.$version" "$(numbers u2 "$stores/ome_zarr/simple_0.$version")" "$(count_to 0 99)"
    done
fi
[ $asked -gt 0 ] || { echo "skip: neither python3-zarr is there nor CUBEWRIGHT_DATA/conformance/zarr" >&2; exit 77; }
[ $failed = 0 ] && echo "$asked stores of other writers hold the same numbers"
exit $failed
