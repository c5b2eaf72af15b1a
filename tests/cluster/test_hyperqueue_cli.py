"""examples/cluster/hyperqueue.sh, where the program hq is installed; the Python package has no such program."""

import os
import signal
import subprocess

import pytest
from conftest import EXAMPLES, LONG, flags, needs, wait_until


@pytest.fixture
def start(environment, tmp_path):
    """Function that starts a command of HyperQueue, and ends it with the test."""
    needs("hq")
    env = {**environment, "HQ_SERVER_DIR": str(tmp_path / "server")}
    started = []

    def start(*line):
        started.append(subprocess.Popen(line, cwd=tmp_path, env=env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL))
        return started[-1]

    yield start
    for process in reversed(started):
        process.kill()
        process.wait()


def test_tasks_of_a_killed_worker_go_on_elsewhere(start, tmp_path, is_whole):
    start("hq", "server", "start")
    wait_until(lambda: list((tmp_path / "server").glob("*/access.json")))
    lost = start("hq", "worker", "start", "--cpus=1")
    job = start("bash", str(EXAMPLES / "hyperqueue.sh"), "3", "out", *flags(LONG))
    wait_until((tmp_path / "out.shards/1").is_dir)
    os.kill(lost.pid, signal.SIGKILL)
    start("hq", "worker", "start", "--cpus=2")
    assert job.wait(90) == 0
    is_whole(tmp_path / "out", LONG)
