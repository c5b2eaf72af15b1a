"""concurrent.futures: traces SHARDS parts of a run in processes, and merges them into FOLDER.

Needs: the package asperity.
Start: python futures_shards.py SHARDS FOLDER
On one machine threads of one run are faster; this is for the executors that have the same interface and reach other machines, such as those
of submitit, mpi4py and executorlib. The same command goes on after an interrupt.
"""

import sys
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import asperity as asp

RUN = {"smoothness": [1, 2, 3], "eta": 1.5, "theta": [30, 60], "models": ["smith"]}


def trace(shard, folder, run):
    """Traces one shard, in a process of the executor."""
    asp.verify(**run, shard=shard, output=folder, threads=1, progress=False)
    return folder


def main(shards, folder, run=RUN):
    folder = Path(folder).resolve()
    executor = ProcessPoolExecutor()
    # Slurm: executor = submitit.AutoExecutor("logs"); executor.update_parameters(cpus_per_task=1, mem_gb=1, timeout_min=60)
    parts = [executor.submit(trace, (k, shards), f"{folder}.shards/{k}", run) for k in range(1, shards + 1)]
    return asp.merge([part.result() for part in parts], output=folder)


if __name__ == "__main__":
    print(main(int(sys.argv[1]), sys.argv[2]))
