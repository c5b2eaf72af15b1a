"""Dask: traces SHARDS parts of a run on the workers of a cluster, and merges them into FOLDER.

Needs: `pip install distributed`, the package asperity, and a file system that the workers share.
Start: python dask_shards.py SHARDS FOLDER [ADDRESS]
Without the address of a scheduler it starts workers on this machine, one per core. dask-jobqueue has clusters of Slurm, PBS and others. The
shards of a worker that is lost are traced by another one, which goes on from where it was.
"""

import sys
from pathlib import Path

import asperity as asp
from distributed import Client, LocalCluster

RUN = {"smoothness": [1, 2, 3], "eta": 1.5, "theta": [30, 60], "models": ["smith"]}


def trace(shard, folder, run):
    """Traces one shard, on a worker."""
    asp.verify(**run, shard=shard, output=folder, threads=1, progress=False)
    return folder


def main(shards, folder, address=None, run=RUN):
    folder = Path(folder).resolve()
    parts = [(k, shards) for k in range(1, shards + 1)]
    folders = [f"{folder}.shards/{k}" for k, _ in parts]
    with Client(address or LocalCluster(threads_per_worker=1)) as client:
        traced = client.map(trace, parts, folders, run=run, retries=3, pure=False)
        return asp.merge(client.gather(traced), output=folder)


if __name__ == "__main__":
    print(main(int(sys.argv[1]), *sys.argv[2:]))
