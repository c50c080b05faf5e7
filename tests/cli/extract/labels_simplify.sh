# Labels are simplified together, so that interfaces stay shared, or each by itself.
cubewright make labels/cells -o cells.nrrd --dims 32 --labels 8 --type u8 -q
cubewright extract cells.nrrd --labels all --simplify 2k -o count.ply --name x --json - | grep simplify
cubewright extract cells.nrrd --labels all --simplify 0.5vox -o error.ply --name x
cubewright extract cells.nrrd --labels all --simplify 2k --shared-faces -o faces.ply
cubewright extract cells.nrrd --labels all --simplify 2k -o one.ply --name x -q -t 1
cmp count.ply one.ply && echo same
# more than there are changes nothing
cubewright extract cells.nrrd --labels all --simplify 1M -o all.ply | sed 's/;.*;/;/'
if cubewright version --features | grep -q '^simplify *yes'; then
    cubewright extract cells.nrrd --labels all --simplify 4k --per-label -o apart.ply >line
    grep -o 'each label by itself: interfaces of neighbours part' line
fi
# a label's rms is that of its file beside the file before simplification, both ways
cubewright extract cells.nrrd --labels 3 -o full.ply -q
cubewright extract cells.nrrd --labels 3 --simplify 300 --table table.csv -o small.ply -q
cubewright check small.ply --reference full.ply --json check.json -q
awk -F, '/"rms"/ { sub(".*: ", ""); sum += $1 * $1 } FILENAME != "check.json" && FNR == 2 { wanted = $NF }
    END { rms = sqrt(sum / 2); print (rms - wanted) ^ 2 < 1e-10 ? "rms agrees" : rms " " wanted }' \
    check.json table.csv
# levels of detail: a file each, and one with all
cubewright extract cells.nrrd --labels all --lod 4k,1k -o lod.obj --name x --json lod.json
ls lod*
grep -c '"status": "ok"' lod.json
if cubewright version --features | grep -q '^glb *yes\|^gltf *yes'; then
    cubewright extract cells.nrrd --labels all --lod 4k,1k -o lod.glb | sed -n '3s/.* in 16/16/p' >line
    grep -q '16 levels; .*all levels of detail' line || cat line
fi
bad() { cubewright extract cells.nrrd --labels all -o bad.ply "$@" || echo "exit $?"; }
bad --per-label
bad --per-label --simplify 1k --shared-faces
bad --simplify 0
bad --lod 1k,2k
bad --lod 1k --simplify 2k
bad --lod 1k -o 'bad-{label}.ply'
