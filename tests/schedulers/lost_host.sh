# A host is lost in the middle of a job of Open MPI: the job ends soon, with a message and with the parts
# that were made. Two network namespaces stand for the hosts. 77 where they cannot be had.
# Usage: sh lost_host.sh BIN_FOLDER
set -eu
. "$(dirname "$0")/../support/wait.sh"
PATH=$1:$PATH
cubewright version --features | grep -q '^openmpi *yes' || { echo "no module openmpi"; exit 77; }
command -v mpirun.openmpi >/dev/null && command -v ip >/dev/null || { echo "no Open MPI, or no ip (iproute2)"; exit 77; }
a=cubewright-a-$$ b=cubewright-b-$$ wire=cubewright-w-$$
folder=$(mktemp -d)
clean() {
    for space in $a $b $wire; do
        ip netns pids $space 2>/dev/null | xargs -r kill -KILL 2>/dev/null || true
        ip netns del $space 2>/dev/null || true
    done
    rm -rf "$folder"
}
trap clean EXIT
{ ip netns add $wire && ip netns add $a && ip netns add $b &&
    ip netns exec $wire ip link add bridge type bridge; } 2>/dev/null ||
    { echo "no network namespaces here (they need root)"; exit 77; }
ip netns exec $wire ip link set bridge up
n=1
for space in $a $b; do
    ip link add eth netns $space type veth peer name port$n netns $wire
    ip netns exec $wire ip link set port$n master bridge
    ip netns exec $wire ip link set port$n up
    ip netns exec $space ip addr add 10.77.0.$n/24 dev eth
    ip netns exec $space ip link set eth up
    ip netns exec $space ip link set lo up
    n=$((n + 1))
done
cd "$folder"
HOME=$folder TMPDIR=$folder # folders of sessions stay after a kill, and would be in the way of a later one
export HOME TMPDIR OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
cat >rsh <<END
#!/bin/sh
host=\$1
shift
exec ip netns exec \$host unshare --uts sh -c "hostname \$host; \$*"
END
chmod +x rsh
net=10.77.0.0/24
# run_job OPTION...: on both hosts, two ranks each. Open MPI 5 finds a host only by the name that it has itself.
run_job() {
    ip netns exec $a unshare --uts sh -c 'hostname "$0"; exec "$@"' $a timeout --verbose -s KILL "$limit_s" mpirun.openmpi \
        --mca plm_rsh_agent "$folder/rsh" --mca plm_rsh_no_tree_spawn 1 --mca pml ob1 --mca btl tcp,self \
        --mca btl_tcp_if_include $net --mca oob_tcp_if_include $net -n 4 --host $a:2,$b:2 \
        cubewright extract "$@"
}
cubewright make gyroid -o ct.nrrd --dims 60 --type i16 --noise 0.2 -q
cubewright extract ct.nrrd --iso 100 -o whole.ply --name bone --stream never -q
code=0
run_job ct.nrrd --iso 100 -o bone.ply -q 2>log || code=$?
[ $code = 0 ] || { cat log; echo "no job across namespaces here"; exit 77; }
cmp whole.ply bone.ply
echo "two hosts: the same bytes"

cubewright make gyroid -o large.nrrd --dims 400x400x400 --type u16 -q
cut_host_off() {
    # no address is asked for: as behind a router, what is sent to the lost host gives no error
    ip -n $a neigh change 10.77.0.2 dev eth nud permanent
    ip -n $b neigh change 10.77.0.1 dev eth nud permanent
    ip netns exec $wire ip link set port2 down
}
is_part_made_or_is_over() {
    [ -n "$(find parts -name '*.cwpart' 2>/dev/null)" ] || is_over "$1"
}
run_job large.nrrd --iso 30000 -o bone.ply --manifest parts --parts 100 --threads 1 --progress none >log 2>&1 &
job=$!
wait_until is_part_made_or_is_over $job
cut_host_off
code=0
wait $job || code=$?
[ $code != 0 ] || { echo "the job was done before its host was lost"; exit 77; }
grep -a 'on host .* has not been heard of' log >told || { cat log; exit 1; }
sed "s/$a/A/; s/$b/B/" told
! grep -a '^timeout: ' log || exit 1 # it ends by itself: 11 s later on a machine at rest
has_no_temporaries() {
    [ -z "$(find . -name '.*.part')" ]
}
wait_until has_no_temporaries || { find . -name '.*.part'; exit 1; } # the lost host ends, too
made=$(find parts -name '*.cwpart' | wc -l)
[ "$made" -gt 0 ]
[ "$made" -lt 100 ]
for k in $(seq 100); do cubewright extract large.nrrd --iso 30000 --part $k/100 --manifest parts -q; done
cubewright join parts -o bone.ply --no-check -q
cubewright extract large.nrrd --iso 30000 -o whole.ply --name bone --stream always --no-check -q
cmp whole.ply bone.ply
echo "the parts that were made were kept: the same bytes"
