# The window without a display, by commands: modes, saving and finding again, what goes wrong.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 40 --type i16 -q
view() {
    cubewright view h.nrrd -q --hidden --size 640x480 --exec "$*" || echo "exit $?"
}
alike() {
    cmp "$1" "$2" && echo "$1 is $2"
}
near() {
    png_near "$1" "$2" 0.3 24
}
differ() {
    cmp -s "$1" "$2" && echo "$1 is $2, but should not be"
}

# As a picture has it: the scene is what panels and bars leave of the window.
size_of() {
    od -A n -t u1 -j 18 -N 6 "$1" | awk '{ print 256 * $1 + $2 "x" 256 * $5 + $6 }'
}

# What is seen first is what render draws, of the same size.
echo "first"
view 'screenshot first.png; mode mip; screenshot mip.png; iso 300; mode mesh; screenshot mesh.png; print triangles; save-camera c.json;
      toggle panels off; screenshot wide.png; capture window.png'
[ "$(size_of first.png)" = "$(size_of mesh.png)" ] || echo "other sizes"
size_of wide.png
size_of window.png
size=$(size_of first.png)
cubewright render h.nrrd -q -o r.png --size "$size"
near first.png r.png
cubewright render h.nrrd -q -o r.png --size "$size" --mode mip --camera c.json
alike mip.png r.png
cubewright render h.nrrd -q -o r.png --size "$size" --mode mesh --iso 300 --camera c.json --backend egl --samples 2
alike mesh.png r.png
cubewright view h.nrrd -q --size "$size" -o o.png --mode mip --exec 'orbit 0'
cubewright render h.nrrd -q -o r.png --size "$size" --mode mip
alike o.png r.png

# Keys and menus do the same.
echo "keys and menus"
view 'key M; print mode; key Shift+M; print mode; click Scene; capture a.png; click "Scene/Next mode"; print mode;
      click Mode; click Mode/average; print mode; key L; print lit; click Scene; click Scene/Light; print lit;
      key Q; print quad; print layout; click View; click "View/Slices beside the scene"; print layout;
      key Space; print playing; key H; capture help.png; key Escape; print help; key ?; print help; key Escape;
      key 3; wait; screenshot right.png; key Ctrl+1; screenshot back.png; key 5; screenshot ortho.png; print ortho;
      key Enter; key Left; screenshot left.png; key Tab; print panels; capture bare.png'
cubewright render h.nrrd -q -o r.png --size "$size" --mode average --camera right
alike right.png r.png
cubewright render h.nrrd -q -o r.png --size "$size" --mode average --camera back
alike back.png r.png
cubewright render h.nrrd -q -o r.png --size "$size" --mode average --camera back --ortho
alike ortho.png r.png
differ help.png a.png
differ left.png ortho.png
view 'key H; click Keys/close; print help; click Help; click Help/About; print about; capture about.png; key Escape; print about;
      click File; click "File/Copy as a command line"; print message; key Ctrl+C; print message'

# What was done can be taken back.
echo "undo"
view 'iso 300; wait; print triangles; key ]; print iso; key [; key Ctrl+Z; print iso; undo; print iso; redo; print iso;
      key Ctrl+Shift+Z; print iso; key Backspace; print iso; print mode; undo; print mode; lit off; undo; print lit'
view 'tf ct-bone; screenshot bone.png; next-preset; screenshot next.png; undo; screenshot again.png; print tf'
alike bone.png again.png
differ bone.png next.png

# A session comes back: as a file, and as a command line through a shell.
echo "sessions"
view "mode composite; tf ct-skin; iso 300; orbit 30 20; dolly 1.3; clip-face 0 -20; cross 1 2 3; window -100 500;
      background #102030,white; zoom-slices 2; layout quad; point 1 0 0.7; letters on; toggle panels off;
      save-state s.txt; print command; screenshot a.png single; key Escape; capture wa.png; save-tf tf.json; save-camera c.json" >line
cubewright view -q --hidden --size 640x480 --run s.txt --exec 'toggle panels off; screenshot b.png single; key Escape; capture wb.png; save-state t.txt; key Ctrl+S; print message'
alike a.png b.png
alike wa.png wb.png
sort s.txt >a.txt
sort t.txt >b.txt
alike a.txt b.txt
alike t.txt cubewright-state.txt
sed -e 's/^cubewright view/& -q --hidden --size 640x480/' -e "s/'\$/toggle panels off; screenshot c.png single; key Escape; capture wc.png'/" line >line.sh
sh line.sh
alike a.png c.png
alike wa.png wc.png
cubewright render h.nrrd -q -o d.png --mode composite --size "$(size_of a.png)" --tf tf.json --camera c.json --iso 300 --clip-box=-20mm:120mm,-120mm:120mm,-120mm:120mm \
    --background '#102030,white' --letters
near a.png d.png
sed -n 1,2p s.txt
mkdir "it's a folder; #1"
cp h.nrrd "it's a folder; #1/a b.nrrd"
cubewright view "it's a folder; #1/a b.nrrd" -q --hidden --size 640x480 --exec 'print open; save-state q.txt; print command; screenshot e.png' >line
cubewright view -q --hidden --size 640x480 --run q.txt --exec 'print open; screenshot f.png'
alike e.png f.png
sed -n '$p' line | sed -e 's/^cubewright view/& -q --hidden --size 640x480/' -e "s/\$/ --exec 'print open'/" | sh

# Pictures by the way: names that are free, and all round.
echo "pictures"
view "key F12; print message; screenshot; print message; turntable 4 'turn-{turn:02d}.png'; orbit 90; screenshot quarter.png;
      turntable 3 a.png"
cmp cubewright-001.png first.png
cmp cubewright-002.png first.png
alike turn-00.png first.png
ls turn-*.png
alike turn-01.png quarter.png

