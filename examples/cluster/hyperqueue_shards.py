"""HyperQueue from Python: traces SHARDS parts of a run as tasks, and merges them into FOLDER in a task that waits for them.

Needs: `pip install hyperqueue` (it has the server and the workers), and asperity on PATH.
Start: python hyperqueue_shards.py SHARDS FOLDER COMMAND [SETTING...]
It starts a server and a worker on this machine. With HQ_SERVER_DIR it submits to a server that runs, as of `hq server start`, whose workers
share the file system. The same command starts what failed again.
"""

import os
import shutil
import sys
from contextlib import nullcontext
from pathlib import Path

from hyperqueue import Client, Job, LocalCluster
from hyperqueue.cluster import WorkerConfig


def main(shards, folder, *settings):
    asperity = shutil.which("asperity") or sys.exit("asperity is not on PATH")
    folder = Path(folder).resolve()
    parts = [Path(f"{folder}.shards/{k}") for k in range(1, int(shards) + 1)]
    job = Job(name="asperity", max_fails=None)
    tasks = [
        job.program(
            [asperity, *settings, "--shard", f"{k}/{shards}", "-o", str(part), "--threads", "1"],
            stdout=None, stderr=f"{part}.log", crash_limit=20,
        )
        for k, part in enumerate(parts, 1)
    ]
    merge = [asperity, "merge", *map(str, parts), "-o", str(folder)]
    job.program(merge, deps=tasks, stdout=f"{folder}.log", stderr=f"{folder}.log")
    parts[0].parent.mkdir(parents=True, exist_ok=True)

    server = os.environ.get("HQ_SERVER_DIR")
    with nullcontext() if server else LocalCluster(worker_config=WorkerConfig()) as cluster:
        client = Client(server) if server else cluster.client()
        client.wait_for_jobs([client.submit(job)])


if __name__ == "__main__":
    main(*sys.argv[1:])
