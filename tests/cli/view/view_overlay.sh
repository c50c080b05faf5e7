# Values of another volume over slices, in colours: on another grid, rotated and with thick slices; the value of both under the mouse.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
# make_field FILE SIZES DIRECTIONS ORIGIN: 100 + 2 x - y + 3 z of the world
make_field() {
    printf 'NRRD0004\ntype: float\ndimension: 3\nsizes: %s\nspace: left-posterior-superior\nspace directions: %s\nspace origin: (%s)\nencoding: ascii\n\n' "$2" "$3" "$4"
    echo "$2 $3 $4" | tr '(),' '   ' | awk '{
        for (k = 0; k < $3; k++) for (j = 0; j < $2; j++) for (i = 0; i < $1; i++) {
            for (a = 0; a < 3; a++) w[a] = $(13 + a) + i * $(4 + a) + j * $(7 + a) + k * $(10 + a)
            printf "%.6f\n", 100 + 2 * w[0] - w[1] + 3 * w[2] } }'
} >"$1"
make_field scan.nrrd '20 20 20' '(1,0,0) (0,1,0) (0,0,1)' '0,0,0'
make_field field.nrrd '9 8 7' '(1.6,1.2,0) (-1.2,1.6,0) (0,0,3)' '8,2,-1'
make_field far.nrrd '9 8 7' '(1,0,0) (0,1,0) (0,0,1)' '100,0,0'
sed '/^[0-9.-][0-9.-]*$/s/.*/7/' field.nrrd >flat.nrrd
view() {
    cubewright view scan.nrrd -q --hidden --size 640x480 --exec "toggle panels off; layout quad; $*" || echo "exit $?"
}
# Under the mouse both have the value of the field there, wherever the grid of the overlay lies.
view 'overlay field.nrrd; cross 10 9 8; mouse 630 470; wait; print probe; cross 9.5 11 10.3; wait; print probe; cross 1 1 1; wait; print probe;
      mouse 160 120; wait; print overlay-map; print overlay-range' >probe
awk '/overlay [0-9]/ { print ($3 - $NF < 1e-3 && $NF - $3 < 1e-3 ? "both are " $NF : $0); next } { print }' probe
# Colours, range and opacity change the slices, and come back.
view 'screenshot 0.png; overlay field.nrrd; screenshot a.png; overlay-map inferno; screenshot b.png; overlay-range 110,130; screenshot c.png; overlay-opacity 0; 
      screenshot d.png; overlay-opacity 0.6; overlay-map default; overlay-range default; screenshot e.png; save-state s.txt; overlay off; screenshot f.png'
cmp a.png e.png && cmp 0.png f.png && ! cmp -s a.png b.png && ! cmp -s b.png c.png && ! cmp -s a.png 0.png && echo "colours, and back"
grep overlay s.txt
cubewright view -q --hidden --size 640x480 --run s.txt --exec 'toggle panels off; screenshot g.png' && cmp a.png g.png && echo "saved"
# Of a linear field the same colours come from any grid: those of the scan itself.
render() { cubewright render scan.nrrd --size 96x72 --mode slices --overlay-range 100,160 --overlay-opacity 1 "$@" || echo "exit $?"; }
render --overlay field.nrrd --clip-box 9:11,8:12,6:10 -o a.png -q
render --overlay scan.nrrd --clip-box 9:11,8:12,6:10 -o b.png -q
render -o plain.png --overlay-opacity 0 --overlay scan.nrrd --clip-box 9:11,8:12,6:10 -q
cmp -s a.png plain.png && echo "nothing is drawn"
png_near a.png b.png 1 0 && echo "the same from another grid"
cubewright render scan.nrrd --size 96x72 --layout quad --overlay field.nrrd --overlay-map cool-warm -o quad.png
for wrong in 'far.nrrd; wait; print message' 'flat.nrrd' 'none.nrrd' 'field.nrrd; overlay-range 3' 'field.nrrd; overlay-range 3,2' 'field.nrrd; overlay-map red' 'field.nrrd; overlay-map viridis; labels 3'; do
    view "overlay $wrong"
done
bad() { cubewright render scan.nrrd --size 96x72 -q -o bad.png "$@" || echo "exit $?"; }
bad --mode slices --overlay far.nrrd
bad --mode slices --overlay flat.nrrd
bad --mode slices --overlay field.nrrd --legend
bad --mode slices --overlay field.nrrd --overlay-map inferno --labels all
bad --overlay-map inferno
bad --overlay-range 3,4
bad --mode mip --overlay field.nrrd
ls bad.png 2>/dev/null || echo none
