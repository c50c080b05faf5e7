# The ranks of an MPI make a surface together: the same bytes for any number of them, and after one was
# killed. 77 where that MPI, or our module for it, is not there.
# Usage: sh mpi.sh BIN_FOLDER openmpi|mpich
set -eu
. "$(dirname "$0")/../support/wait.sh"
PATH=$1:$PATH
mpi=$2
cubewright version --features | grep -q "^$mpi *yes" || { echo "no module $mpi"; exit 77; }
command -v "mpirun.$mpi" >/dev/null || { echo "no mpirun.$mpi"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
HOME=$folder
export HOME OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# more ranks than cores, as Open MPI 4 and 5 call it
export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
formats="ply stl vtp obj"
! cubewright version --features | grep -q '^gltf *yes' || formats="$formats glb"
cubewright make gyroid -o ct.nrrd --dims 60 --type i16 --noise 0.2 -q
for format in $formats; do
    cubewright extract ct.nrrd --iso 100 -o whole.$format --name bone --stream never -q
done
for n in 1 2 3 4 8; do
    for format in $formats; do
        mpirun.$mpi -n $n cubewright extract ct.nrrd --iso 100 -o bone.$format -q
        cmp whole.$format bone.$format
        rm bone.$format
    done
    echo "$n ranks: the same bytes"
done
# parts that are kept: the ranks of this test are killed, and another number of ranks goes on
cubewright make gyroid -o large.nrrd --dims 160 --type i16 --noise 0.2 -q
cubewright extract large.nrrd --iso 100 -o whole.ply --name bone --stream never -q
has_parts_or_is_over() {
    [ "$(find parts -name '*.cwpart' 2>/dev/null | wc -l)" -ge "$1" ] || is_over "$2"
}
for parts in 1 7 13; do
    mpirun.$mpi -n 3 cubewright extract large.nrrd --iso 100 -o bone.ply --manifest "$folder/parts" --parts 20 -q \
        >killed.log 2>&1 &
    job=$!
    wait_until has_parts_or_is_over $parts $job
    pkill -KILL -f "manifest $folder/parts" || true
    wait $job || true
    rm -f bone.ply
done
mpirun.$mpi -n 2 cubewright extract large.nrrd --iso 100 -o bone.ply --manifest "$folder/parts" --parts 20 -q
cmp whole.ply bone.ply
echo "killed three times: the same bytes"
mkdir failed
cd failed
# a failure ends all ranks, is told once, and leaves nothing
code=0
mpirun.$mpi -n 3 cubewright extract none.nrrd --iso 100 -o bone.stl >log 2>&1 || code=$?
[ $code = 3 ]
[ "$(grep -c 'cubewright: none.nrrd: cannot be opened' log)" = 1 ]
code=0
mpirun.$mpi -n 3 cubewright extract ../ct.nrrd --iso 1e9 -o bone.stl >log 2>&1 || code=$?
[ $code != 0 ]
grep -q 'no surface at isovalue' log
[ ! -e bone.stl ]
[ -z "$(find . -name '*.part')" ]
echo "failures are told once"
