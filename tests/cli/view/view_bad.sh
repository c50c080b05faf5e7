# Files that are damaged, and machines that lack what the window needs.
cubewright version --features | grep -q '^window *yes' || { echo "this build has no window" >&2; exit 77; }
cubewright version --features | grep -q '^gl *yes' || { echo "this build has no OpenGL" >&2; exit 77; }
cubewright make sphere -o good.nrrd --dims 16 -q
cubewright extract good.nrrd --iso 0 -o good.ply -q
head -c 500 good.nrrd >cut.nrrd
printf 'NRRD0004\nnonsense\n' >broken.nrrd
head -c 300 good.ply >cut.ply
head -c 100 good.nrrd >named.nii.gz
printf 'hello\n' >text.txt
: >empty.mha
mkdir nothing junk
printf 'x' >junk/a
cubewright make sphere -o one.nrrd --dims 1 -q 2>/dev/null
for bad in cut.nrrd broken.nrrd cut.ply named.nii.gz text.txt empty.mha nothing junk none.nrrd; do
    # As the first, it fails as info does; later it is told of in the window, which goes on.
    cubewright info $bad -q >/dev/null 2>&1
    info=$?
    cubewright view $bad -q --hidden --size 400x80
    [ $? = $info ] && [ $info != 0 ] || echo "$bad: not info's exit code, $info"
    cubewright view good.nrrd -q --hidden --size 400x80 --exec "drop $bad; print message; capture a.png; key M; key Right; key Q;
        wait; drop good.nrrd; print open; wait; capture b.png"
    cubewright view good.ply -q --hidden --size 400x80 --exec "open $bad" 2>/dev/null
    [ $? = $info ] || echo "$bad: opened later, not info's exit code, $info"
done

# No display: what to set, and what works without one.
unset DISPLAY WAYLAND_DISPLAY
export XDG_RUNTIME_DIR="$PWD" # GLFW 3.4 looks for Wayland, which complains where this is not set
cubewright view good.nrrd -q
echo "exit $?"

# Without the module, without a library of it, and without any OpenGL: what to install.
bin=$(dirname "$(command -v cubewright)")
mkdir bare bare/bin bare/lib bare/lib/cubewright
cp "$bin/cubewright" bare/bin
cp "$bin"/../lib/libcubewright.so* bare/lib
LD_LIBRARY_PATH=bare/lib bare/bin/cubewright view good.nrrd -q --hidden
echo "exit $?"
mkdir libraries
: >libraries/libglfw.so.3
LD_LIBRARY_PATH=libraries cubewright view good.nrrd -q --hidden
echo "exit $?"
LD_LIBRARY_PATH=libraries cubewright info good.nrrd | head -n 1
