#!/usr/bin/env bash
# HyperQueue: traces SHARDS parts of a run as one task array, on whatever workers there are, and merges them into FOLDER.
#
# Needs: hq and asperity on PATH, and FOLDER on a file system that the workers share. For hyperqueue_shards.py pip is enough.
# Start a server once, and workers; allocations of Slurm and PBS may be mixed:
#     hq server start &
#     hq worker start &                        # this machine
#     hq alloc add slurm --time-limit 1h       # Slurm, as long as tasks wait
#     hq alloc add pbs --time-limit 1h -- -q QUEUE
# Then:   bash hyperqueue.sh SHARDS FOLDER COMMAND [SETTING...]
#
# The tasks of a worker that is lost start again on another one, and go on from where they were. The same command starts what failed again.
set -euo pipefail
shards=$1 folder=$(realpath --canonicalize-missing "$2")
shift 2

mkdir -p "$folder.shards"
hq submit --name=asperity --array="1-$shards" --cpus=1 --crash-limit=20 --wait \
    --stdout=none --stderr="$folder.shards/%{TASK_ID}.log" -- \
    bash -c 'exec "$0" "${@:3}" --shard "$HQ_TASK_ID/$1" -o "$2/$HQ_TASK_ID" --threads 1' \
    "$(command -v asperity)" "$shards" "$folder.shards" "$@"
seq -f "$folder.shards/%g" "$shards" | tr '\n' '\0' | xargs -0 sh -c 'exec asperity merge "$@" -o "$0"' "$folder"
