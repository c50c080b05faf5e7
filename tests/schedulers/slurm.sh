# The recipe for Slurm: an array of jobs makes the parts of a surface. It starts a Slurm of its own,
# on this machine, with ports and folders of its own; 77 where there is none.
# Usage: sh slurm.sh BIN_FOLDER
set -eu
. "$(dirname "$0")/../support/wait.sh"
PATH=$1:/usr/sbin:$PATH
for program in slurmctld slurmd sbatch squeue; do
    command -v $program >/dev/null || { echo "no $program (Debian: slurm-wlm)"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "slurmd is started by root only"; exit 77; }
folder=$(mktemp -d)
host=$(uname -n | cut -d. -f1)
stop() {
    for daemon in slurmd slurmctld; do
        [ -s "$folder/$daemon.pid" ] || continue
        pid=$(cat "$folder/$daemon.pid")
        kill "$pid" 2>/dev/null && wait_until is_over "$pid"
    done
    rm -rf "$folder"
}
trap stop EXIT
mkdir "$folder/state" "$folder/spool" "$folder/work"
port=$((20000 + $$ % 20000))
cat >"$folder/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/none
CredType=cred/none
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
ReturnToService=2
SlurmUser=root
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF="$folder/slurm.conf"
# Nothing here needs control groups. Slurm 24 starts without them when it is told to; 22.05 cannot be told.
case $(slurmd -V) in
*" 22."*) ;;
*) echo CgroupPlugin=disabled >"$folder/cgroup.conf" ;;
esac
slurmctld >"$folder/start.log" 2>&1 && slurmd >>"$folder/start.log" 2>&1 ||
    { echo "Slurm does not start here:"; cat "$folder/start.log"; exit 77; }
has_node_or_none() {
    sinfo -h -o %t 2>/dev/null | grep -q -E 'idle|mix|down|drain|inval|fail' || is_over "$(cat "$folder/slurmd.pid")"
}
wait_until has_node_or_none || true
sinfo -h -o %t | grep -q -E 'idle|mix' ||
    { echo "Slurm has no node here:"; tail -n 5 "$folder"/slurm*.log; exit 77; }
cd "$folder/work"
cubewright make gyroid -o ct.nrrd --dims 60 --type i16 --noise 0.2 -q
cubewright extract ct.nrrd --iso 100 -o whole.ply --name bone --stream never -q
job=$(sbatch --parsable --array=1-8 --output=part-%a.log --wrap \
    'cubewright extract ct.nrrd --iso 100 --part $SLURM_ARRAY_TASK_ID/8 --manifest parts')
has_left_the_queue() {
    squeue -h -j "$job" >queue 2>queue.err && [ ! -s queue ] || grep -q 'Invalid job id' queue.err
}
wait_until has_left_the_queue
cubewright join parts -o bone.ply || { cat part-*.log; exit 1; }
cmp whole.ply bone.ply
echo "Slurm: the same bytes"
