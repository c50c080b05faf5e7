# Quantised gradients: more directions are nearer to the reference, and each setting shows.
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 24 -q
for normals in 16 128 1024; do
    cubewright render h.nrrd --size 64x48 -q --json r.json -o x.png \
        --compare "shaded-texture,normals=$normals,step-length=0.25|reference"
    grep -o '"rmse": [0-9.e-]*' r.json
done | awk '{ print (NR == 1 || $2 < last ? "less" : "more: " $2 " after " last); last = $2 }'
draw() { cubewright render h.nrrd --size 64x48 -q --mode shaded-texture --normals 64 "$@"; }
draw -o a.png --json r.json
grep -e '"direction_filter"' -e '"material_table"' r.json
for setting in '--direction-filter nearest' --material-table --boundary --colors-first; do
    draw -o s.png $setting
    cmp -s a.png s.png && echo "$setting changes nothing"
done
ls
