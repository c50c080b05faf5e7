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
(
    export CUBEWRIGHT_TEST_DEAF=1 CUBEWRIGHT_TEST_GRACE=1
    interrupt writing cubewright make gyroid --dims 24 -o w.nrrd -q
)
# A batch begins no other input. The first one cannot end before the signal, since nobody reads what it says.
for name in a b c; do cubewright make sphere --dims 16 -o $name.nrrd -q; done
mkfifo said
exec 3<>said
dd if=/dev/zero of=said bs=512 oflag=nonblock 2>/dev/null # until the pipe is full
cubewright extract a.nrrd b.nrrd c.nrrd --iso 0 -o '{stem}.stl' --json-lines log.jsonl >&3 2>&3 3>&- &
batch=$!
wait_until is_there_or_over log.jsonl $batch
kill -TERM $batch
cat said >heard 3>&- &
exec 3>&-
wait $batch
echo $?
wait
grep -a -c 'cubewright: interrupted' heard
cat log.jsonl heard | grep -a -c -e b.nrrd -e c.nrrd
ls b.* c.*
