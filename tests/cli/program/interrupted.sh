# Ctrl-C ends a long run with 130 and leaves nothing behind.
. "$TESTS/support/wait.sh"
# interrupt STEP COMMAND...: sends the signal while that step waits for it.
interrupt() {
    step=$1
    shift
    rm -f ../there
    CUBEWRIGHT_TEST_STEP=$step CUBEWRIGHT_TEST_STEP_FILE=../there "$@" &
    child=$!
    wait_until is_there_or_over ../there $child
    kill -TERM $child
    wait $child
    echo $?
    ls -A
}
for step in sampling writing; do
    interrupt $step cubewright make gyroid --noise 1 --dims 24 -o v.nrrd -q
done
cubewright make gyroid -o v.nrrd --dims 24 -q
for step in reading simplifying; do
    interrupt $step cubewright extract v.nrrd --iso 0 --simplify 1mm -o v.glb -q
done
# a step that does not hear of it is ended from outside
export CUBEWRIGHT_TEST_DEAF=1 CUBEWRIGHT_TEST_GRACE=1
interrupt writing cubewright make gyroid --dims 24 -o w.nrrd -q
