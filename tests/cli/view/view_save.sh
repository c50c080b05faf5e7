# What the window saves: meshes and pictures; and what it opens: recent files, samples, a filtered list.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make gyroid -o g.nrrd --dims 24 -q
size_of() {
    od -A n -t u1 -j 18 -N 6 "$1"
}
view() {
    cubewright view g.nrrd -q --hidden --size 640x480 --exec "$*" || echo "exit $?"
}

echo "meshes"
view 'save-mesh a.stl' 2>&1
view 'iso 0; save-mesh a.stl; print message; save-mesh b.ply 500; print message; measure-mesh; save-mesh a.fish' 2>&1
view 'iso 0; save-mesh g.nrrd' 2>&1
view 'iso 0; save-mesh none/a.stl' 2>&1
view 'iso 0; save-mesh a.stl many' 2>&1
cubewright check a.stl -q && echo "it is closed"
view 'iso 0; key Ctrl+M; capture panel.png; click "Save mesh/Measure it"; click Format; click Format/.obj; click "Save mesh/Save"; print message'
view 'iso 0; key Ctrl+M; key Escape; click "Save mesh/Save"' 2>&1
ls -- *.obj *.ply *.stl

echo "pictures"
view 'screenshot s.png 300x200; screenshot q.png 301x200 quad; layout quad; screenshot r.png single; screenshot w.png; print message'
for picture in s q; do
    size_of $picture.png
done
cmp s.png q.png >/dev/null || echo "they differ"
view 'screenshot a.png 3; print message' 2>&1
view 'screenshot a.png 3x3 quad; print message' 2>&1
cubewright view a.stl -q --hidden --exec 'screenshot a.png quad' 2>&1 || echo "exit $?"
view 'key Ctrl+P; click "Save picture/2 x the window"; click "Save picture/Save"; print message'

echo "recent files"
mkdir folder
cp g.nrrd 'folder/it is one.nrrd'
for file in g.nrrd a.stl 'folder/it is one.nrrd' g.nrrd; do
    cubewright view "$file" -q --hidden --recent list
done
sed 's|.*/||' list
cubewright view -q --hidden --recent list --exec 'click "it is one.nrrd"; print open; screenshot o.png' | sed 's|[^ ]*/||'
sed 's|.*/||' list
cubewright view g.nrrd -q --hidden --recent none/such/list/file && ls none

echo "the list of files"
cp g.nrrd x.unknown
cubewright view g.nrrd -q --hidden --exec 'key O; wait; place x.unknown' 2>&1 || echo "exit $?"
cubewright view g.nrrd -q --hidden --exec 'key O; click "All files"; wait; point-at x.unknown; click Filter; write stl; wait; place x.unknown' 2>&1 || echo "exit $?"
cubewright view g.nrrd -q --hidden --exec 'key O; click Filter; write stl; key Enter; wait; print open' | sed 's|[^ ]*/||'
cubewright view g.nrrd -q --hidden --exec 'key O; click a.stl; print open; click a.stl; wait; print open' | sed 's|[^ ]*/||'
cubewright view g.nrrd -q --hidden --exec 'key O; click Path; key Ctrl+A; write folder; key Enter; click "it is one.nrrd"; click "it is one.nrrd"; wait; print open' | sed 's|[^ ]*/||'

echo "samples"
XDG_CACHE_HOME=$PWD cubewright view -q --hidden --exec 'click Torus; print open; print mode' | sed 's|[^ ]*/||'
ls cubewright
cubewright view -q --hidden --exec 'sample fish' 2>&1 || echo "exit $?"

# Light panels are light; the picture is the same.
echo "themes"
view 'mode mip; screenshot d.png; toggle light-theme; screenshot l.png; capture light.png; print light-theme; toggle light-theme; capture dark.png'
cmp d.png l.png && echo "the same picture"
cmp light.png dark.png >/dev/null || echo "other panels"

# The panel's left border is dragged: from 0.6 of the window to 180 pixels; the picture has the rest.
echo "the panel"
view 'place Settings; mouse 385 300; wait; press; mouse 360 300; mouse 300 300; lift; wait; place Settings; screenshot p.png;
      mouse 301 300; wait; press; mouse 0 300; lift; wait; place Settings; mouse 257 200; wait; press; mouse 630 200; lift; wait; place Settings'
size_of p.png
