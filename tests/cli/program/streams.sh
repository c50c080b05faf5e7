# `-` is standard input and output: the bytes and codes are those of files, messages go to standard error,
# and nothing is left behind.
for feature in simplify glb level-set; do
    cubewright version --features | grep -q "^$feature *yes" || { echo "this build has no $feature" >&2; exit 77; }
done
. "$TESTS/support/wait.sh"
TMPDIR=$PWD/temporary
export TMPDIR
mkdir temporary
cubewright make torus -o t.nrrd --dims 32 -q
cubewright make torus -o t.nii.gz --dims 32 -q
cubewright extract t.nrrd --iso 0 -o mesh.stl -q
cubewright extract t.nrrd --iso 0 -o mesh.ply -q
cubewright extract t.nrrd --iso 0 -o mesh.glb -q
cubewright extract t.nrrd --iso 0 -o mesh.gltf -q
cubewright extract t.nrrd --iso 0 -o mesh.3mf -q
cubewright simplify mesh.ply --triangles 500 -o small.ply -q
cubewright make torus --dims 32 -q -o - --format nrrd | cubewright info - --json | grep -c '"dims"'

# three commands, by pipes alone
cat t.nrrd | cubewright extract - --iso 0 -o - --format ply 2>/dev/null |
    cubewright simplify - --triangles 500 -o - --format ply 2>/dev/null |
    cubewright check - 2>/dev/null | tail -1

same() {
    name=$1
    shift
    "$@" 2>/dev/null >out.bin
    echo "$? $(cmp out.bin "$name" && echo same) $name"
}
# a pipe, a file that is read as it is, and one from its middle on, which is no file of its own
for f in stl ply glb gltf 3mf; do
    cat t.nrrd | same mesh.$f cubewright extract - --iso 0 -o - --format $f --name mesh
done
same mesh.stl cubewright extract - --iso 0 -o - --format stl <t.nrrd
{
    printf 123
    cat t.nrrd
} >behind
{
    dd bs=1 count=3 of=/dev/null 2>/dev/null
    same mesh.stl cubewright extract - --iso 0 -o - --format stl
} <behind
cubewright extract t.nii.gz --iso 0 -o packed.stl -q
cat t.nii.gz | same packed.stl cubewright extract - --iso 0 -o - --format stl
cubewright extract t.nrrd --reader nrrd --stream always --iso 0 -o slices.stl -q
cat t.nrrd | same slices.stl cubewright extract - --reader nrrd --stream always --iso 0 -o - --format stl
cubewright convert mesh.glb -o again.glb -q
cat mesh.glb | same again.glb cubewright convert - -o - --format glb
cubewright render mesh.stl -o picture.png --size 100x80 -q
cat mesh.stl | same picture.png cubewright render - -o - --size 100x80
for command in repair smooth 'remesh --edge 4mm' 'hollow --wall 2mm'; do
    cat mesh.stl | cubewright $command - -o - --format stl -q | cubewright check - >/dev/null 2>&1
    echo "$? $command"
done
cat mesh.stl | cubewright voxelize - --spacing 2mm -o - --format nrrd -q | cubewright info - 2>/dev/null |
    sed -n 2p
cat t.nrrd | cubewright check mesh.stl --source - --iso 0 -q >/dev/null
echo "$? source"
cat mesh.stl | cubewright boolean mesh.stl - --op union -o - --format ply -q 2>/dev/null | head -c 3
echo

# messages are on standard error, results of -o - too
cat t.nrrd | cubewright extract - --iso 0 -o - --format stl 2>said >/dev/null
cut -d';' -f1 said

# a file of that name
cp t.nrrd ./-
cubewright info ./- | sed -n 2p
cubewright info - <mesh.stl 2>&1 | cut -c1-60
rm ./-

# JSON of a run by streams
cat t.nrrd | cubewright extract - --iso 0 -o s.stl --json - -q | grep -c '"sha256"'
cat t.nrrd | cubewright extract - --iso 0 -o - --format stl --json r.json -q | wc -c
grep -c '"bytes": 225684,' r.json

# a pipe that is closed early: quietly, with the code of an output that is not written
{
    cubewright extract t.nrrd --iso 0 -o - --format obj -q 2>said
    echo "$?" >code
} | true
cat code said

# a signal while a pipe is read: the run ends, and leaves nothing
mkfifo slow
cubewright extract - --iso 0 -o never.stl -q <slow 2>said &
run=$!
exec 3>slow
printf NRRD >&3
is_reading() { ls -l /proc/$run/fd 2>/dev/null | grep -q 'temporary.*deleted'; }
wait_until is_reading
kill -TERM $run
wait $run
echo "$? $(cat said)"
exec 3>&-
[ -e never.stl ] && echo "it was written"
ls temporary
