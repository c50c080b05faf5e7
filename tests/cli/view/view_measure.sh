# Distances, angles and areas in mm: typed, clicked in slices, and picked on a surface; on a rotated grid with
# thick slices. They are undone, saved, and refused where they have no value.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
# a ball of 10 mm around (5, -3, 2), on a grid of 1 x 1 x 3 mm that is rotated by 30 degrees about x
awk 'BEGIN {
    c = cos(atan2(0, -1) / 6); s = sin(atan2(0, -1) / 6)
    printf "NRRD0004\ntype: short\ndimension: 3\nsizes: 30 30 11\nspace: left-posterior-superior\n"
    printf "space directions: (1,0,0) (0,%.12f,%.12f) (0,%.12f,%.12f)\n", c, s, -3 * s, 3 * c
    oy = -3 - 14.5 * c + 15 * s; oz = 2 - 14.5 * s - 15 * c
    printf "space origin: (%.12f,%.12f,%.12f)\nencoding: ascii\n\n", 5 - 14.5, oy, oz
    for (k = 0; k < 11; k++) for (j = 0; j < 30; j++) for (i = 0; i < 30; i++) {
        x = i - 14.5; y = (j - 14.5) * c - (k - 5) * 3 * s; z = (j - 14.5) * s + (k - 5) * 3 * c
        printf "%d\n", 1000 - 100 * sqrt(x * x + y * y + z * z)
    }
}' >ball.nrrd
view() {
    cubewright view ball.nrrd -q --hidden --size 640x480 --exec "$*" || echo "exit $?"
}

echo "typed"
view 'measure distance 1 2 3 4 6 15; measure angle 4 0 0 0 0 0 0 0 2; measure area 0 0 5 3 0 5 3 1 5 1 1 5 1 3 5 0 3 5; print measurements;
      undo; print measurements; redo; measure off 1; print measurements; measure off; print measurements; undo; save-state s.txt'
grep measure s.txt
cubewright view -q --hidden --size 640x480 --run s.txt --exec 'print measurements; print command; open ball.nrrd; print measurements' | sed 's/--exec.*measure/... measure/'
echo "doubtful"
view 'measure area 0 0 0.25 2 0 -0.25 2 2 0.25 0 2 -0.25; measure area 0 0 0 2 2 0 2 0 0 0 2 0; print measurements'

# The diameter of the ball, from its picture in front to that behind: seen along the world's y.
echo "picked"
view 'toggle panels off; iso 0; mode mesh; wait; key D; key Shift+D; key Shift+D; key D; measure-pick 320 240; camera back; wait;
      measure-pick 320 240; print measurements; measure-pick 1 1; print message' >picked
awk '/distance/ { printf "%.0f mm at %.1f and %.1f\n", $3, $5, $8 } !/distance/' picked
# A click picks as well, and a drag turns the scene meanwhile.
view 'toggle panels off; iso 0; mode mesh; ortho on; wait; key D; mouse 320 240; press; lift; press; mouse 20 240; lift; print measurements; mouse 320 240;
      wait; press; lift; print measurements' | awk '{ print ($3 > 5 && $3 < 20.1 ? "a chord" : $0) }'

# In slices: what is clicked are points of the world, as the cross-hair's are. A double click or Enter closes an area.
echo "clicked"
two="mouse 160 120; press; lift; mouse 240 120; press; lift;"
clicks="$two mouse 240 180; press; lift;"
view "toggle panels off; layout quad; wait; mouse 160 120; press; lift; print cross; cross 5 -3 2; mouse 240 180; press; lift; print cross; cross 5 -3 2; wait;
      measure-tool angle; $clicks measure-tool distance; $clicks print measurements; capture one.png" >clicked
awk '/cross/ { x[n + 0] = $2; y[n++] = $3 } /angle/ { print "an angle of " $3 }
    /distance/ { print ((sqrt(($8 - $5)^2 + ($9 - $6)^2) - $3)^2 < 1e-6 && $5 == x[0] && $6 == y[0] && $8 == x[1] && $9 == y[0] ? "a side" : $0) }' clicked
view "toggle panels off; layout quad; cross 5 -3 2; wait; measure-tool area; $two mouse 240 180; twice; print measurements; $clicks key Enter; print measurements; $clicks key Escape;
      key Enter; key Escape; $clicks print measurements; cross 5 -3 8; wait; capture faint.png; measure off; wait; capture none.png" >clicked
awk '{ gsub(/,/, ""); printf "%d %s, %.4f of the triangle\n", $1, $2, $3 / (0.5 * ($8 - $5) * ($12 - $9)) }' clicked
cmp -s faint.png none.png && echo "the same, but should not be"
# Saved pictures have them.
view 'layout quad; cross 5 -3 2; screenshot a.png; measure distance 0 -3 2 10 -3 2; screenshot b.png; undo; screenshot c.png'
cmp a.png c.png && ! cmp -s a.png b.png && echo "drawn"
# The panel lists and removes them.
cubewright view ball.nrrd -q --hidden --size 640x1400 --exec 'click Measurements; wait; click Distance; measure-point 0 0 0; measure-point 0 3 4; wait;
      measure distance 0 0 0 0 0 7; wait; click "Remove 1"; print measurements; click "Copy the values"; print message; click "Remove all"; print measurements;
      click "Stop Distance"; measure-point 1 2 3' || echo "exit $?"

echo "refused"
for wrong in 'distance 1 2 3' 'angle 0 0 0 0 0 0 1 1 1' 'area 1 2 3 4 5 6' 'distance 1 2 3 4' 'volume 1 2 3' 'distance 1 2 x 3 4 5' 'off 1' 'off 1 2'; do
    view "measure $wrong"
done
view 'measure-end'
view 'measure-tool length'
view 'measure-tool area; measure-point 1 2 3; measure-end'
cubewright view -q --hidden --size 640x480 --exec 'measure distance 0 0 0 1 1 1' || echo "exit $?"
view 'compare "mip|average"; measure-tool distance; measure-pick 320 240'
