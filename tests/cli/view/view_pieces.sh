# The window shows a surface cut to pieces, and writes nothing.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make torus -o t.nrrd --dims 32 -q
cubewright extract t.nrrd --iso 0 -o t.stl -q
mkdir apart
cd apart
view() { cubewright view "$1" -q --hidden --size ${3:-400x300} --exec "$2" 2>&1 || echo "exit $?"; }
view ../t.stl 'print triangles; pieces --plane x=50% --pegs 1; print message; screenshot p.png; copy-pieces; print message;
    save-mesh whole.stl; print message; save-state s; pieces off; print triangles; screenshot q.png'
cmp p.png q.png >/dev/null || echo "other pictures"
tail -1 s
cubewright view -q --hidden --size 400x300 --run s --exec 'print message'
echo "of a volume: dowels; another isovalue hides them"
view ../t.nrrd 'iso 0; pieces --plane z=50%,x=50% --pegs 1 --peg-kind dowel; print message; copy-pieces; print message;
    orbit 30; wait; screenshot p.png; iso -1; wait; screenshot q.png; copy-pieces'
echo "by the panel"
view ../t.stl 'click "Pieces to print"; click Planes; write x=50%; key Enter; wait; click "Show the pieces"; wait; print message;
    click "Show the whole"; wait; copy-pieces' 800x900
echo "what is wrong"
view ../t.stl 'pieces --pegs 2'
view ../t.stl 'pieces --plane x=50% --pegs 2 --peg-diameter 0mm'
view ../t.stl 'pieces --plane x=5000mm'
view ../t.stl 'pieces --plane sideways'
view ../t.nrrd 'mode mip; pieces --plane x=50%'
view ../t.stl 'copy-pieces'
cubewright view -q --hidden --exec 'pieces off' 2>&1 || echo "exit $?"
ls
