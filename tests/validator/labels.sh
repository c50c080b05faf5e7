#!/bin/sh
# Labels in other people's hands: sh labels.sh BIN_FOLDER VALIDATOR_FOLDER. three.js in Chromium must
# find each label's name and its colour, to the byte, plain and compressed; Khronos' validator no
# error; VTK the labels of both sides; assimp the materials of OBJ. 77 when none of them is there.
set -u
here=$(cd "$(dirname "$0")" && pwd)
PATH=$1:$PATH
NODE_PATH=$2/node_modules
export PATH NODE_PATH
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
failed=0 looked=0

cubewright make labels/cells -o cells.nrrd --dims 24 --labels 3 --type u8 -q
cat >names.csv <<'END'
LabelValue,Name,Color_R,Color_G,Color_B,Color_A
1,liver,1,128,254,255
2,left_kidney,0,9,200,51
3,spine,255,250,3,255
END
cubewright extract cells.nrrd --labels all --names names.csv -o plain.glb -q || exit 1
for kind in quantize draco meshopt; do
    cubewright extract cells.nrrd --labels all --names names.csv -o $kind.glb -q --compress $kind 2>said ||
        grep -q 'not in this build' said || { cat said; exit 1; }
done
cubewright extract cells.nrrd --labels all --names names.csv -o faces.vtp --shared-faces -q || exit 1
cubewright extract cells.nrrd --labels all --names names.csv -o faces.obj -q || exit 1

if command -v node >/dev/null; then
    cat >wanted <<'END'
  liver #0180fe 1.000 1
  left_kidney #0009c8 0.200 2
  spine #fffa03 1.000 3
END
    node "$here/validate_glb.mjs" plain.glb quantize.glb >issues
    case $? in
    0) looked=1 ;;
    77) ;;
    *) cat issues; failed=1 ;;
    esac
    node "$here/three.mjs" --names ./*.glb >seen
    case $? in
    0)
        looked=1
        for f in ./*.glb; do
            sed -n "/^$(basename "$f") /,/^[^ ]/p" seen | grep '^  ' | cmp -s - wanted ||
                { echo "$f: names or colours are not those of names.csv"; cat seen; failed=1; }
        done
        ;;
    77) ;;
    *) cat seen; failed=1 ;;
    esac
fi

python3=/usr/bin/python3 # of Debian, whose VTK it is
if [ -x $python3 ] && $python3 -c 'import vtk' 2>/dev/null; then
    looked=1
    cubewright extract cells.nrrd --labels all -o faces.ply --shared-faces -q
    $python3 - <<'END' || failed=1
import vtk
reader = vtk.vtkXMLPolyDataReader()
reader.SetFileName("faces.vtp")
reader.Update()
mesh = reader.GetOutput()
sides = mesh.GetCellData().GetArray("BoundaryLabels")
assert sides.GetNumberOfComponents() == 2 and sides.GetNumberOfTuples() == mesh.GetNumberOfPolys()
pairs = {sides.GetTuple2(n) for n in range(sides.GetNumberOfTuples())}
assert {(1, 0), (2, 0), (3, 0)} <= pairs <= {(1, 0), (2, 0), (3, 0), (1, 2), (1, 3), (2, 3)}, pairs
END
fi

if command -v assimp >/dev/null; then
    looked=1
    assimp info faces.obj >info 2>&1
    for name in liver_1 left_kidney_2 spine_3; do
        grep -q "'$name'" info || { echo "faces.obj: assimp finds no material $name"; cat info; failed=1; }
    done
fi
[ $looked = 1 ] || { echo "skip: no reader of other people is installed" >&2; exit 77; }
exit $failed
