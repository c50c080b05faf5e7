# The mouse on the window, without a display: what it drags, turns and clicks is what it changes.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 40 --type i16 -q
view() {
    cubewright view h.nrrd -q --hidden --size 640x480 --no-lit --no-preintegration --exec "$*" || echo "exit $?"
}
alike() {
    cmp "$1" "$2" && echo "$1 is $2"
}
differ() {
    cmp -s "$1" "$2" && echo "$1 is $2, but should not be"
}

# On the scene: a drag is an orbit, the wheel comes nearer, with keys and buttons it is other things.
echo "scene"
view 'mode mip; mouse 160 240; press; mouse 260 190; lift; mouse 10 300; screenshot orbit.png; wheel 1; screenshot near.png;
      mouse 160 240; press left shift; mouse 200 250; lift; screenshot pan.png; press middle; mouse 160 240; lift middle;
      screenshot back.png; press right; mouse 160 200; lift right; screenshot dolly.png; key Enter; screenshot all.png;
      press left ctrl; mouse 200 160; lift; print shift; print opacity; undo; print shift; print opacity'
view 'mode mip; orbit -40 -20; screenshot o.png; dolly 1.10517; screenshot n.png; pan 40 10; screenshot p.png;
      pan -40 -10; screenshot b.png; dolly 1.2214; screenshot d.png; reset; screenshot front.png'
alike orbit.png o.png
alike near.png n.png
alike pan.png p.png
alike dolly.png d.png
alike all.png front.png
differ near.png pan.png

# On the curve: points are dragged, put in and taken out; so are colours. All is taken back.
echo "curve"
cat >curve.txt <<'COMMANDS'
tf '{"schema": "cubewright-transfer-1", "colors": [[-1000, "#000000"], [995, "#ffffff"]], "opacities": [[-500, 0], [-2.5, 0.5], [500, 1]]}'
screenshot curve.png
COMMANDS
view 'run curve.txt; point-at Curve 0.5 0.5; press; point-at Curve 0.6 0.25; lift; print tf; screenshot dragged.png;
      undo; screenshot undone.png; redo; screenshot redone.png; print tf' >tf
view 'run curve.txt; point 1 196.9 0.747; screenshot point.png'
awk '/opacities/ { gsub(/[][,"]/, ""); printf "%d points, the second at %.0f, %.2f\n", (NF - 1) / 2, $4 / 100, $5 }' tf
alike curve.png undone.png
alike dragged.png redone.png
differ curve.png dragged.png
png_near dragged.png point.png 1 24
view 'run curve.txt; point-at Curve 0.9 0.8; twice; print tf; point-at Curve 0.9 0.8; press right; lift right; print tf;
      point-at Colours 0.25 0.5; twice; print tf; press; point-at Colours 0.4 0.5; lift; print tf;
      press right; lift right; print tf; click Preset; click Preset/ct-bone; print tf; undo; print tf' >tf
awk '/colors/ { colors = gsub(/#/, "#") } /^  \[/ { colors += gsub(/#/, "#") }
    /opacities/ { print colors " colours, " gsub(/\[/, "[") - 1 " points" }' tf
view 'click Colours 0.01 0.5; click "Colour of the point"; capture color.png; print message; color-point 0 #00ff00; print tf' | grep -c '#00ff00'
view 'point-at Shift 0.5 0.5; press; point-at Shift 0.75 0.5; lift; print shift; undo; print shift;
      point-at Opacity 0.5 0.5; press; point-at Opacity 0.25 0.5; lift; print opacity'

# The surface: by its box, its slider, keys, and the line in the curve.
echo "surface"
view 'mouse 600 400; wheel -10; click "Show the surface"; print mode; wait; print triangles; point-at Isovalue 0.5 0.5; press;
      point-at Isovalue 0.7 0.5; wait; point-at Isovalue 0.6 0.5; lift; print iso; wait; print triangles; key ]; print iso;
      key [; key Ctrl+Z; key Ctrl+Z; key Ctrl+Z; print iso; mouse 600 400; wheel 20; point-at Curve 0.25 0.5; press;
      point-at Curve 0.75 0.5; lift; print iso; key Backspace; print mode'
view 'iso 196.9; mode composite; wait; print triangles; point-at Curve 0.6 0.9; press; point-at Curve 0.7 0.9; lift; print iso; print mode'

# Slices: the cross-hair is dragged, the value under the mouse told, greys and size changed.
echo "slices"
view 'toggle panels off; layout quad; cross 0 0 0; wait; mouse 160 120; print probe; press; mouse 200 80; print cross; lift; print probe;
      mouse 480 120; print probe; wheel 2; print cross; wheel 1 ctrl; mouse 160 360; press right; mouse 200 340; lift right; print window;
      undo; print window; save-state s.txt'
grep -e zoom -e cross s.txt
view 'layout quad; cross 0 0 0; wait; capture a.png; cross 0 0 40; capture b.png; print cross'
differ a.png b.png
view 'wait; mouse 160 200; twice; print cross'

# Cuts: handles are dragged, the wheel cuts along an axis, faces have sliders.
echo "cuts"
view 'toggle panels off; mode mip; toggle handles on; reset; wait; mouse 497 240; press; mouse 438 240; lift; print clip-box;
      screenshot cut.png; undo; print clip-box; screenshot whole.png; key B; mouse 497 240; press; mouse 438 240; lift;
      print clip-box; key Enter; key X; wheel 5; print clip-box; wheel -5; print clip-box; key Z; wheel 5; print clip-box; key Escape;
      wheel 1; print clip-box; key Shift+B; print clip-box'
differ cut.png whole.png

# Two modes side by side, and how far they are apart.
echo "comparison"
view 'toggle panels off; compare "mip|average"; wait; print compare; mouse 320 240; press; mouse 160 240; lift; print split;
      screenshot split.png; difference 20; screenshot difference.png; print compare; compare off; print compare' 2>&1
differ split.png difference.png
view 'mouse 600 400; wheel -20; click Compare; mouse 600 400; wheel -20; click "Compare with the exact picture"; wait; print compare;
      mouse 600 400; wheel -20; click Left; click Left/mip; wait; print compare; click "Show the difference"; wait; print difference; capture typed.png
      click "Settings/Options"; write "cell-steps"; key Enter; wait; print compare; click "Copy the numbers"; print message; click End; print compare
      compare "mip,cell-steps|reference"; mouse 300 300; mouse 301 300; print compare; wait; print compare'

# A field has the title of the section it is in.
echo "fields"
cubewright view h.nrrd -q --hidden --size 640x1100 --exec 'click Light; wait; point-at Ambient 0.1 -1; press; lift; write 1,0,0; key Enter;
    print light; key M; print mode; write x; key M; print mode'

# Time: keys, the slider, playing.
echo "time"
sh "$TESTS/support/steps.sh" 16 >4d.nrrd
cubewright view 4d.nrrd -q --hidden --size 640x480 --exec 'mode mip; print step; screenshot 0.png; key .; print step; key ,; key ,; print step; screenshot 3.png;
    click Settings/Scene; mouse 600 300; wheel -20; point-at Step 0.1; press; point-at Step 0.66; lift; print step; screenshot 2.png; step 0; save-state s.txt;
    screenshot again.png; step 4' || echo "exit $?"
differ 0.png 3.png
differ 3.png 2.png
alike 0.png again.png
cubewright view 4d.nrrd -q --hidden --size 640x480 --exec 'step 3; save-state t.txt'
cubewright view -q --hidden --size 640x480 --run t.txt --exec 'print step'

# Small windows, and large ones; nothing open.
echo "sizes"
view 'resize 40 40; wait; resize 1 1; wait; capture one.png; resize 900 300; toggle panels off; screenshot large.png; layout quad; resize 50 700; wait; key H; capture tall.png'
for picture in one large tall; do
    od -A n -t u1 -j 18 -N 6 $picture.png
done
cubewright view -q --hidden --size 300x200 --exec 'key M; key Q; key F12; print message; mouse 50 50; press; mouse 90 90; lift; wheel 3; click Scene; capture nothing.png;
    monkey 5 20; drop h.nrrd; print open; drop 4d.nrrd; print open; print step; key ]; print iso'
