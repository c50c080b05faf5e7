# A label map in the window: its labels, their names where they are picked, and the way back.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
{
    printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 9 12 12\nencoding: ascii\n\n'
    awk 'BEGIN { for (n = 0; n < 9 * 12 * 12; n++) { i = n % 9; k = int(n / 108); print (i > 1 && k > 2 ? (i > 5 ? 4 : 9) : 0) } }'
} >map.nrrd
printf 'LabelValue,Name,Color_R,Color_G,Color_B\n4,Left Lung,20,200,30\n9,Heart,200,20,30\n' >map.csv
view() {
    cubewright view map.nrrd -q --hidden --size 640x480 --exec "$*" || echo "exit $?"
}
view 'print mode; wait; print triangles; toggle panels off; wait; pick 300 240; print message; pick 430 240; print message;
      labels 4; wait; print triangles; pick 300 240; print message; undo; wait; print triangles; labels heart; screenshot heart.png'
cubewright view map.nrrd -q --size 640x480 -o o.png --labels 9 --exec 'orbit 0; toggle panels off'
cubewright view map.nrrd -q --size 640x480 -o p.png --exec 'label-opacity Heart:0.5; toggle panels off; save-state s.txt'
cmp -s o.png p.png && echo "the same, but should not be"
grep label s.txt
view 'mode composite; print mode; labels all; print mode; iso 5; print mode; wait; print triangles; iso off; print mode;
      labels off; mode mesh; wait; print triangles; print iso; tf ct-bone; print iso'
for wrong in 'labels 3' 'labels lung' 'label-opacity 4' 'label-opacity all:0; wait' 'smooth-labels 9mm; wait' 'names none.csv'; do
    view "$wrong"
done
view 'screenshot plain.png; legend on; screenshot legend.png; labels 9; iso 5; screenshot iso.png; print legend'
cmp -s plain.png legend.png && echo "the same, but should not be"
# slices: of the map itself, and over another volume
sed '/^[0-9]$/s/.*/3/' map.nrrd >scan.nrrd
view 'labels 4; layout quad; cross 7 5 5; mouse 630 470; wait; print probe; cross 4 5 5; wait; print probe; mode slices; wait; screenshot four.png;
      labels 9; wait; screenshot nine.png; labels default; tf grey; wait; print probe'
cmp -s four.png nine.png && echo "the same, but should not be"
over() { cubewright view scan.nrrd -q --hidden --size 640x480 --overlay map.nrrd --exec "$*" || echo "exit $?"; }
over 'print mode; layout quad; cross 7 5 5; mouse 630 470; wait; print probe; labels 9; wait; print probe; mode slices; wait; screenshot a.png;
      overlay-opacity 0; wait; screenshot b.png; labels default; overlay off; wait; screenshot c.png; print message'
cmp b.png c.png && ! cmp -s a.png b.png && echo "an overlay"
over 'overlay none.nrrd'
over 'overlay-opacity 3'
