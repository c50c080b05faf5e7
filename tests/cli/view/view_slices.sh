# Slices: their numbers and places, greys by the names of radiology, and the outline of the surface.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 40 --type i16 -q
view() {
    cubewright view h.nrrd -q --hidden --size 640x480 --exec "$*" || echo "exit $?"
}
# make_grid FILE COSINE SINE: voxels of 0.5 x 2 x 3 mm, rotated about x
make_grid() {
    printf 'NRRD0004\ntype: uchar\ndimension: 3\nsizes: 8 6 4\nspace: left-posterior-superior\nspace origin: (10,-20,30)\nencoding: ascii\n'
    awk -v c="$2" -v s="$3" 'BEGIN { printf "space directions: (0.5,0,0) (0,%.9g,%.9g) (0,%.9g,%.9g)\n\n", 2 * c, 2 * s, -3 * s, 3 * c
        for (n = 0; n < 192; n++) print n }'
} >"$1"

echo "captions"
make_grid straight.nrrd 1 0
make_grid flipped.nrrd -1 0
make_grid askew.nrrd 0.8 0.6
for grid in straight flipped askew; do
    cubewright view $grid.nrrd -q --hidden --size 320x240 --exec 'cross 10.5 -20 33; print captions'
done
cubewright view straight.nrrd -q --hidden --size 320x240 --exec 'cross 13.4 -12.9 30; print captions'

echo "greys"
view 'layout quad; wait; screenshot a.png; window bone; print window; screenshot b.png; window lung; window 10 20; print window; undo; print window;
      window auto; print window; screenshot c.png'
cmp a.png c.png && ! cmp -s a.png b.png && echo "others and back"
cubewright view h.nrrd -q --hidden --size 640x1000 --exec 'click Settings/Scene; click Slices; click Greys; click Greys/lung; print window; point-at Window; press; mouse 700 0; lift; print window' |
    awk '{ print; } END { print ($3 - $2 != 1500 && ($2 + $3) / 2 == -600 ? "wider or narrower" : "as before") }' | sed '$!s/.*-1350.*/lung/; 2d'
for wrong in bran bones 'high low' '3 3' ''; do
    view "window $wrong"
done
cubewright view straight.nrrd -q --hidden --size 320x240 --exec 'window bone' || echo "exit $?"

echo "isolines"
view 'iso bone; print iso; iso otzu'
cubewright view straight.nrrd -q --hidden --size 320x240 --exec 'iso bone' || echo "exit $?"
view 'layout quad; mode composite; iso 300; wait; screenshot a.png; isolines on; wait; screenshot b.png; iso 200; screenshot c.png; isolines off; iso 300;
      screenshot d.png; isolines on; mode slices; iso off; screenshot e.png'
cmp a.png d.png && ! cmp -s a.png b.png && ! cmp -s b.png c.png && echo "an outline that moves"
render() { cubewright render h.nrrd --size 96x72 -q "$@" || echo "exit $?"; }
render --iso 300 --layout quad -o a.png
render --iso 300 --layout quad --isolines -o b.png
render --iso bone --layout quad --isolines --mode mip -o c.png
render --mode slices -o d.png
render --mode slices --iso 300 --hide mesh --isolines -o e.png
! cmp -s a.png b.png && ! cmp -s d.png e.png && echo "outlines"
render --isolines -o no.png
render --isolines --iso 300 -o no.png
render --isolines --iso 300 --mode slices -o no.png
ls no.png 2>/dev/null || echo none
