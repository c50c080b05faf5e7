# Printability: what is measured, painted, reported and refused.
plate() { # plate HEIGHT: a box of 30 x 20 mm
    cat <<E
v 0 0 0
v 30 0 0
v 0 20 0
v 30 20 0
v 0 0 $1
v 30 0 $1
v 0 20 $1
v 30 20 $1
f 1 3 2
f 2 3 4
f 5 6 7
f 6 8 7
f 1 2 5
f 2 6 5
f 3 7 4
f 4 7 8
f 1 5 3
f 3 5 7
f 2 4 6
f 4 8 6
E
}
plate 0.5 >thin.obj
plate 8 >thick.obj
cubewright check thin.obj --profile print
cubewright check thick.obj --profile print --plate 25x30x10mm --wall 9mm -q && echo "fits turned"
cubewright check thick.obj --profile print --plate 25x25x10mm || echo "exit $?"
cubewright check thin.obj --profile print --defects painted.ply -q && echo "painted"
cubewright convert painted.ply -o painted.obj -q 2>/dev/null && grep -c '^v ' painted.obj
cubewright check thin.obj --profile print --json - -q | sed -n -e '/"params"/,/}/p' -e '/"print": {/,/"tip_deg"/p'
# two boxes: a gap, a part in the air
{ plate 8; plate 3 | awk '/^v/ { $4 += 8.3 } /^f/ { $2 += 8; $3 += 8; $4 += 8 } { print }'; } >two.obj
cubewright check two.obj --profile print | grep -A 1 -e ' gaps ' -e ' islands '
bad() {
    cubewright check "$@" -q
    echo "$? $*"
}
bad thick.obj --wall 1mm
bad thick.obj --profile fem --plate 1x1x1mm
bad thick.obj --profile print --wall 1vox
bad thick.obj --profile print --layer 0.1%
bad thick.obj --profile print --overhang 90
bad thick.obj --profile print --overhang 0
bad thick.obj --profile print --plate 20x20
bad thick.obj --profile print --gap 0mm
sed '$d' thick.obj >open.obj
cubewright check open.obj --profile print | grep -c walls
exit 0
