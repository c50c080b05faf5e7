# Closes handles of the surface that is extracted: what is said, reported and recorded, and what is refused.
cubewright version --features | grep -q '^glb *yes' || { echo "this build has no glTF" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 --noise 6 -q
cubewright extract s.nrrd --iso 0 --largest 1 --fill-voids --close-handles 8vox -o v.glb --json r.json
sed -n -e '/"close-handles": /p' -e '/"close_handles_mm"/p' -e '/"handles": {/,/}/p' r.json
sed -n -e 's/.*"name": "\(close_handles\|fill_voids\|normals\)".*/\1/p' r.json
grep -a -o '"closed handles":"[^"]*"' v.glb
cubewright check v.glb | head -n 2
cubewright extract s.nrrd --iso 0 --largest 1 --fill-voids --close-handles auto -o auto.glb -q --no-check
grep -a -o '"closed handles":"[^"]*"' auto.glb
# with the steps behind it
if cubewright version --features | grep -q '^simplify *yes'; then
    cubewright extract s.nrrd --iso 0 --largest 1 --simplify 1k --no-measure -o w.ply 2>&1 | grep -o 'its [0-9]* handles .*'
    cubewright extract s.nrrd --iso 0 --largest 1 --close-handles 5mm --simplify 1k --no-measure -o w.ply 2>&1 | grep -o 'its [0-9]* handles .*'
    cubewright extract s.nrrd --iso 0 --largest 1 --fill-voids --close-handles 20mm --smooth taubin --simplify 1k --no-measure -o w.ply 2>&1 |
        grep -o -e ' [0-9 ]* triangles,' -e 'closed [0-9]* of [0-9]*'
    cubewright extract s.nrrd --iso 0 --largest 1 --fill-voids --close-handles 20mm --lod 2k,1k --no-measure -o l.ply -q && ls l-*
fi
bad() {
    cubewright extract "$@" -q
    echo "$? $*"
}
bad s.nrrd --iso 0 -o bad.ply --close-handles 3
bad s.nrrd --iso 0 -o bad.ply --close-handles some
bad s.nrrd --iso 0 -o bad.ply --close-handles auto --stream always
bad s.nrrd --labels all -o bad.ply --close-handles auto
bad s.nrrd --iso 0 --close-handles auto --part 1/2 --manifest m
ls bad* 2>/dev/null
exit 0
