#!/usr/bin/env bash
# Slurm: traces SHARDS parts of a run as an array job, and merges them into FOLDER in a job that waits for all of it.
#
# Needs: asperity on PATH, and FOLDER on a file system that the nodes share.
# Start, on a login node:   bash slurm.sh SHARDS FOLDER COMMAND [SETTING...]
#                           bash slurm.sh 1000 map map --smoothness 1:6:0.1 --eta 1.3,1.5,2 --theta 0:80:5
#
# A task that reaches its time limit, is preempted or loses its node is queued again, and goes on from where it was.
# The same command starts what failed again. MaxArraySize limits SHARDS, to 1000 by default.
# The lines of #SBATCH are what one shard gets.
#SBATCH --job-name=asperity
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1G
#SBATCH --time=1:00:00
#SBATCH --signal=TERM@120
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
shards=$1 folder=$2
shift 2

if [ -z "${SLURM_ARRAY_TASK_ID:-}" ]; then
    mkdir -p "$folder.shards"
    parts=$(for k in $(seq "$shards"); do printf '%q ' "$folder.shards/$k"; done)
    array=$(sbatch --parsable --array="1-$shards" --output="$folder.shards/%a.log" "$0" "$shards" "$folder" "$@")
    merge=$(sbatch --parsable --dependency="afterok:$array" --kill-on-invalid-dep=yes --output="$folder.log" --open-mode=append \
        --job-name=asperity-merge --cpus-per-task=2 --wrap "asperity merge $parts -o $(printf %q "$folder")")
    echo "merge $merge waits for the array $array"
    exit
fi

# Exit code 3: SIGTERM came, 120 s before the time limit, and what was traced is kept
srun --cpus-per-task="$SLURM_CPUS_PER_TASK" asperity "$@" --shard "$SLURM_ARRAY_TASK_ID/$shards" \
    -o "$folder.shards/$SLURM_ARRAY_TASK_ID" --threads "$SLURM_CPUS_PER_TASK" || code=$?
[ "${code:-0}" != 3 ] || scontrol requeue "${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID"
exit "${code:-0}"
