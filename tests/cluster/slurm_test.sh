#!/usr/bin/env bash
# slurm_test.sh PROGRAM [SHARDS] — experiments/render_array.sbatch on a real Slurm of one node, as root.
#
# Starts munge, slurmctld and slurmd of Debian (slurmctld, slurmd, slurm-client, munge) in a folder of their own, renders
# in shards, kills one task in ten with -9 and has one queued again, and holds the merged picture to the bytes of the
# same shards done one after the other. By hand: it needs root, and daemons.
set -euo pipefail
source=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/../.." && pwd)
program=$(realpath -- "$1") shards=${2:-64}
for tool in munged slurmctld slurmd sbatch; do
    command -v "$tool" >/dev/null || { echo "$tool is not installed"; exit 77; }
done
folder=$(mktemp -d /tmp/lensproof-slurm.XXXXXX)
chmod 755 "$folder"
export SLURM_CONF=$folder/slurm.conf LENSPROOF_CACHE=off
export PATH=$folder/bin:$PATH
mkdir "$folder/bin" "$folder/state" "$folder/spool"
ln -s "$program" "$folder/bin/lensproof"

cleanup() {
    kill "$(cat "$folder/slurmctld.pid")" "$(cat "$folder/slurmd.pid")" 2>/dev/null || true
    [[ -z ${munge:-} ]] || kill "$munge" 2>/dev/null || true
    rm -rf "$folder"
}
trap cleanup EXIT
trap 'exit 1' INT TERM

if ! munge -n >/dev/null 2>&1; then
    mkdir -p /run/munge
    chown munge:munge /run/munge
    setpriv --reuid munge --regid munge --clear-groups munged --foreground 2>/dev/null & munge=$!
    sleep 1
fi
cat > "$SLURM_CONF" <<CONF
ClusterName=lensproof
SlurmctldHost=$(hostname)(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
KillWait=30
JobRequeue=1
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
SlurmctldLogFile=$folder/slurmctld.log
SlurmdLogFile=$folder/slurmd.log
SchedulerParameters=requeue_setup_env_fail
NodeName=$(hostname) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld
slurmd
until sinfo -h -o %t | grep -q idle; do sleep 0.5; done

cd "$folder"
scene=$source/experiments/scenes/tessar_checkerboard.toml
options=(--spp $((16 * shards)) --threads 1 --checkpoint-interval 0.5)
array=$(sbatch --parsable --array="1-$shards" "$source/experiments/render_array.sbatch" "$scene" picture.exr "${options[@]}")
merge=$(sbatch --parsable --dependency="afterok:$array" --wrap 'lensproof merge picture.part-*.exr -o picture.exr --quiet')
until [[ -n $(squeue -h -t R) ]]; do sleep 0.2; done
scontrol requeue "$(squeue -h -t R -o %i | head -1)" && echo "one task queued again"
killed=0
while squeue -h -j "$array" | grep -q .; do
    if ((killed < (shards + 9) / 10)) && victim=$(pgrep -f "lensproof render .*--shard" | shuf -n 1); then
        # Slurm sees a task that failed; its owner queues it again.
        job=$(tr '\0' '\n' < "/proc/$victim/environ" 2>/dev/null | sed -n 's/^SLURM_JOB_ID=//p')
        kill -9 "$victim" 2>/dev/null && killed=$((killed + 1))
        sleep 0.2
        scontrol requeue "$job" 2>/dev/null || true
    fi
    sleep 1
done
while squeue -h -j "$merge" | grep -q .; do sleep 1; done

mkdir unbroken
for ((i = 1; i <= shards; i++)); do
    lensproof render "$scene" --spp $((16 * shards)) --threads 1 --shard "$i/$shards" -o "unbroken/part-$i.exr" --quiet
done
lensproof merge unbroken/part-*.exr -o unbroken/picture.exr --quiet
cmp picture.exr unbroken/picture.exr
echo "the same bytes from $shards shards, with $killed tasks killed"
