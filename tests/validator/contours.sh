#!/bin/sh
# Surfaces of irregular grids beside VTK's contours of the same files: sh contours.sh BIN_FOLDER.
# 77 when VTK is missing.
set -u
PATH=$1:$PATH
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=
for p in /usr/bin/python3 python3; do # Debian's has the packages
    [ -z "$python" ] && $p -c 'import vtk' 2>/dev/null && python=$p
done
[ -n "$python" ] || { echo "skip: VTK for Python is not there" >&2; exit 77; }

# and a simulation's, where the scans are
tubes=${CUBEWRIGHT_DATA:-}/data/irregular/tubes_cfd.vtu
set --
if [ -f "$tubes" ]; then
    cp "$tubes" "$folder"
    set -- "$folder/tubes_cfd.vtu" Umag 0.2 "$folder/tubes_cfd.vtu" u 0.05
fi
$python "$here/vtk_contours.py" "$folder" "$@" >"$folder/theirs" || exit 1
# As many triangles but for ambiguous cells, of which these have few; places within single
# precision. Quadrangles that are not flat have another area across the other diagonal.
bad=0
while read -r name array iso triangles area x y z; do
    cubewright extract "$folder/$name" --array "$array" --iso "$iso" --open -o "$folder/o.ply" -q &&
        cubewright check "$folder/o.ply" --json - -q >"$folder/o.json" 2>/dev/null || [ -s "$folder/o.json" ] || bad=1
    $python - "$folder/o.json" "$triangles" "$area" "$x" "$y" "$z" <<'END' || { echo "$name $array $iso"; bad=1; }
import json, sys
mesh = json.load(open(sys.argv[1]))["mesh"]
triangles, area, *sides = map(float, sys.argv[2:])
box = mesh["box"]
ok = abs(mesh["triangles"] - triangles) <= 0.001 * triangles
ok = ok and abs(mesh["area"] - area) <= 0.001 * area
ok = ok and all(abs(box[3 + a] - box[a] - sides[a]) <= 1e-5 * max(sides) for a in range(3))
ok = ok and mesh["nonmanifold_edges"] == 0 and mesh["nonmanifold_vertices"] == 0
if not ok:
    print("ours:", mesh["triangles"], mesh["area"], box, "VTK:", sys.argv[2:])
sys.exit(not ok)
END
done <"$folder/theirs"
echo "$(wc -l <"$folder/theirs") contours of irregular grids compared with VTK's"
exit $bad
