#!/bin/sh
# Irregular grids that VTK writes, in every dialect, held against what it says of them: sh grids.sh
# GRID, where GRID is the program that prints what we read. 77 when VTK is missing.
set -u
grid=$1
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=
for p in /usr/bin/python3 python3; do # Debian's has the packages
    [ -z "$python" ] && $p -c 'import vtk, numpy' 2>/dev/null && python=$p
done
[ -n "$python" ] || { echo "skip: VTK for Python is not there" >&2; exit 77; }

$python "$here/vtk_grids.py" "$folder" >"$folder/theirs" || exit 1
# and a simulation's, where the scans are
tubes=${CUBEWRIGHT_DATA:-}/data/irregular/tubes_cfd.vtu
if [ -f "$tubes" ]; then
    cp "$tubes" "$folder"
    $python "$here/vtk_grids.py" --read "$folder/tubes_cfd.vtu" >>"$folder/theirs" || exit 1
fi
while read -r row _; do
    "$grid" "$folder/${row%%:*}" "${row#*:}" || echo "$row failed"
done <"$folder/theirs" >"$folder/ours"
# counts to the last one, sums within rounding; NaN is where a sample has no cells
paste -d ' ' "$folder/theirs" "$folder/ours" | awk '
    {
        ok = NF == 12
        for (i = 1; i <= 6 && ok; i++) {
            d = $i - $(i + 6)
            ok = i < 4 ? $i == $(i + 6) : $i == $(i + 6) || d * d <= 1e-18 * ($i * $i + 1)
        }
        if (!ok) { print "VTK says: " $0; failed = 1 }
    }
    END { print NR " arrays of irregular grids that VTK reads, too"; exit failed || NR < 100 }'
