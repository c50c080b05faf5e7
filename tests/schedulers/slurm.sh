# The recipe for Slurm: an array of jobs makes the parts of a surface. It starts a Slurm of its own,
# on this machine, with ports and folders of its own; 77 where there is none.
# Usage: sh slurm.sh BIN_FOLDER
set -eu
PATH=$1:/usr/sbin:$PATH
for program in slurmctld slurmd sbatch squeue; do
    command -v $program >/dev/null || { echo "no $program (Debian: slurm-wlm)"; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "slurmd is started by root only"; exit 77; }
folder=$(mktemp -d)
host=$(uname -n | cut -d. -f1)
stop() {
    [ -s "$folder/slurmd.pid" ] && kill "$(cat "$folder/slurmd.pid")" 2>/dev/null
    [ -s "$folder/slurmctld.pid" ] && kill "$(cat "$folder/slurmctld.pid")" 2>/dev/null
    sleep 0.5
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
for wait in $(seq 100); do
    sinfo -h -o %t 2>/dev/null | grep -q -E 'idle|mix' && break
    sleep 0.2
done
sinfo -h -o %t | grep -q -E 'idle|mix' ||
    { echo "Slurm has no node here:"; tail -n 5 "$folder"/slurm*.log; exit 77; }
cd "$folder/work"
cubewright make gyroid -o ct.nrrd --dims 60 --type i16 --noise 0.2 -q
cubewright extract ct.nrrd --iso 100 -o whole.ply --name bone --stream never -q
job=$(sbatch --parsable --array=1-8 --output=part-%a.log --wrap \
    'cubewright extract ct.nrrd --iso 100 --part $SLURM_ARRAY_TASK_ID/8 --manifest parts')
while squeue -h -j "$job" 2>/dev/null | grep -q .; do
    sleep 0.3
done
cubewright join parts -o bone.ply || { cat part-*.log; exit 1; }
cmp whole.ply bone.ply
echo "Slurm: the same bytes"
