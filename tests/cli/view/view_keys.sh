# Keys alone: they walk through panels and menus.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make ct-head -o h.nrrd --dims 24 --type i16 -q
view() {
    cubewright view h.nrrd -q --hidden --size 640x480 --exec "$*" || echo "exit $?"
}

# The mode, out of its list; M belongs to the panel meanwhile, and to the scene afterwards.
view 'wait; key F6; key Down; key Space; key Down; key Enter; print mode; key M; print mode; key Escape; key M; print mode'
# F6 again goes on; with one panel to the same, with a dialog to the next.
view 'key Ctrl+P; key F6; key F6; key F6; key Escape; key Escape; toggle save-picture; key P; print tf' | grep -c schema
# A menu: File/Open.
view 'key F10; key Down; key Enter; wait; place Open/Filter' | grep -c place
view 'focus sideways' 2>&1
cubewright view -q --hidden --exec 'focus next; key Space; wait; place Path' | grep -c place
