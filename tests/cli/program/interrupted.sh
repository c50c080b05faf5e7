# Ctrl-C ends a long run with 130 and leaves nothing behind.
interrupt() {
    "$@" &
    child=$!
    sleep 0.7
    kill -TERM $child
    wait $child
    echo $?
    ls -A
}
interrupt cubewright make gyroid --noise 1 --dims 600 -o v.nrrd -q
cubewright make gyroid --noise 1 --dims 120 -o v.nrrd -q
interrupt cubewright extract v.nrrd --iso 0 --simplify 1mm -o v.glb -q
