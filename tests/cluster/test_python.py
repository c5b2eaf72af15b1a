"""Examples that trace shards from Python: Dask, concurrent.futures and HyperQueue."""

import os
import signal
import subprocess
from pathlib import Path

import pytest
from conftest import EXAMPLES, LONG, PACKAGE, SHORT, flags, wait_until

needs_package = pytest.mark.skipif(not (Path(PACKAGE) / "asperity").is_dir(), reason="the package in Python is not built: ASPERITY_PACKAGE")


@pytest.fixture
def start(environment, tmp_path):
    """Function that starts a command in a session of its own, which ends with the test."""
    started = []

    def start(*line):
        process = subprocess.Popen(line, cwd=tmp_path, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        started.append(process)
        return process

    yield start
    for process in started:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def driver(module, shards, run):
    """Command that runs an example with settings of the test."""
    return ["python", "-c", f"import {module}\nif __name__ == '__main__': {module}.main({shards}, 'out', run={run})"]


def tracing(folder):
    """Processes that trace shards of a folder, and therefore have one open."""
    found = []
    for link in Path("/proc").glob("[0-9]*/fd/*"):
        try:
            if os.readlink(link).startswith(f"{folder}.shards/") and link.resolve().is_dir():
                found.append(int(link.parts[2]))
        except OSError:
            continue
    return found


def worker(folder):
    """Process of Python that traces a shard."""
    return wait_until(lambda: tracing(folder))[0]


@pytest.mark.parametrize("module", ["dask_shards", "futures_shards"])
def test_merged_shards_are_the_run(run, tmp_path, is_whole, module):
    run(*driver(module, 3, SHORT))
    is_whole(tmp_path / "out", SHORT)


def test_dask_traces_the_shards_of_a_killed_worker_elsewhere(start, tmp_path, is_whole):
    process = start(*driver("dask_shards", 3, LONG))
    lost = worker(tmp_path / "out")
    assert lost != process.pid
    os.kill(lost, signal.SIGKILL)
    assert process.wait(90) == 0
    is_whole(tmp_path / "out", LONG)


def test_futures_go_on_after_a_killed_process(start, run, tmp_path, is_whole):
    process = start(*driver("futures_shards", 3, LONG))
    os.kill(worker(tmp_path / "out"), signal.SIGKILL)
    assert process.wait(90) != 0
    assert not (tmp_path / "out").exists()
    run(*driver("futures_shards", 3, LONG))
    is_whole(tmp_path / "out", LONG)


def hyperqueue(shards, settings):
    return ["python", str(EXAMPLES / "hyperqueue_shards.py"), str(shards), "out", *flags(settings)]


def test_hyperqueue_merges_in_a_task_that_depends_on_the_others(run, tmp_path, is_whole):
    run(*hyperqueue(3, SHORT))
    is_whole(tmp_path / "out", SHORT)


def test_hyperqueue_goes_on_after_its_server_and_worker_were_killed(start, run, tmp_path, is_whole):
    process = start(*hyperqueue(3, LONG))
    wait_until(lambda: tracing(tmp_path / "out"))
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    wait_until(lambda: not tracing(tmp_path / "out"), 10)  # the tasks end with their worker
    run(*hyperqueue(3, LONG))
    is_whole(tmp_path / "out", LONG)
