# Handles of noise keep triangles: closing them lets a budget be reached, and levels of detail differ.
cubewright version --features | grep -q '^simplify *yes' || { echo "this build does not simplify" >&2; exit 77; }
cubewright make sphere -o s.nrrd --dims 32 --noise 6 -q
cubewright extract s.nrrd --iso 0 --largest 1 --fill-voids -o s.ply -q
cubewright simplify s.ply --triangles 1k --no-measure -o less.ply # says the way on
cubewright simplify s.ply --triangles 1k --close-handles auto --no-measure -o auto.ply
cubewright simplify s.ply --triangles 1k --close-handles 20mm --no-measure -o all.ply --json r.json
sed -n -e '/"handles": {/,/}/p' r.json
grep -c '"name": "close_handles"' r.json
cubewright check all.ply --profile print | grep -e 'component' -e closed -e manifold -e intersections
for t in 1 3; do cubewright simplify s.ply --ratio 0.2 --close-handles 5% -t $t --no-measure -o t.ply -q; cksum <t.ply; done | uniq | wc -l
# what has none stays
cubewright make sphere -o ball.nrrd --dims 12 -q
cubewright extract ball.nrrd --iso 0 -o ball.ply -q
cubewright simplify ball.ply --ratio 0.5 --no-measure -o a.ply -q
cubewright simplify ball.ply --ratio 0.5 --no-measure -o b.ply --close-handles 1mm
cubewright simplify ball.ply --ratio 0.5 --no-measure -o c.ply --close-handles 1mm -q --name a && cmp a.ply c.ply && echo "same"
# the same level twice is none
try() {
    cubewright simplify "$@" --no-measure -q
    echo "$? $*"
}
try s.ply --lod 2k,1k -o lod.ply
try s.ply --lod 2k,1k -o lod.ply --close-handles 20mm
try ball.ply --lod 5k,4k,100 -o x.ply
try s.ply --ratio 0.5 -o x.ply --close-handles 3
try s.ply --ratio 0.5 -o x.ply --close-handles 2vox
try s.ply --ratio 0.5 -o x.ply --close-handles 0mm
try s.ply -o x.ply --close-handles auto
ls lod* x* 2>/dev/null
exit 0
