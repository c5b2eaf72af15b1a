"""examples/cluster/slurm.sh on a Slurm of one node, and submitit with it."""

import time

from conftest import CREDENTIALS, EXAMPLES, LONG, SHORT, flags, wait_until


def submit(run, slurm, shards, settings):
    """Submits a run to be merged into `out`, and returns the id of its array job."""
    text = run("bash", str(EXAMPLES / "slurm.sh"), str(shards), "out", *flags(settings), env=slurm)
    return text.split()[-1]


def wait_for_all(run, slurm):
    """Waits until no job is left. Jobs that were queued again start when their old credentials are void; Slurm waits for two minutes."""
    advanced = set()

    def is_empty():
        lines = run("squeue", "--noheader", "--array", "--format=%i %r", env=slurm).splitlines()
        for job, reason in map(str.split, lines):
            if reason == "BeginTime" and job not in advanced:
                run("scontrol", "update", f"JobId={job}", f"StartTime=now+{CREDENTIALS + 1}", env=slurm)
                advanced.add(job)
        return not lines

    wait_until(is_empty, 90)


def test_merged_array_is_the_run(run, slurm, tmp_path, is_whole):
    submit(run, slurm, 3, SHORT)
    wait_for_all(run, slurm)
    is_whole(tmp_path / "out", SHORT)


def test_tasks_go_on_after_a_time_limit_and_a_preemption(run, slurm, tmp_path, is_whole):
    array = submit(run, slurm, 2, LONG)
    wait_until(lambda: all((tmp_path / f"out.shards/{k}").is_dir() for k in (1, 2)))
    time.sleep(0.5)
    run("scancel", "--signal=TERM", f"{array}_1", env=slurm)  # what --signal does ahead of the time limit
    run("scontrol", "requeue", f"{array}_2", env=slurm)
    wait_for_all(run, slurm)
    assert "interrupted; what was traced so far is kept" in (tmp_path / "out.shards/1.log").read_text()
    is_whole(tmp_path / "out", LONG)


def test_cancelled_tasks_are_not_merged_and_resume(run, slurm, tmp_path, is_whole):
    submit(run, slurm, 2, LONG)
    wait_until((tmp_path / "out.shards/1").is_dir)
    assert run("squeue", "--noheader", "--name=asperity-merge", "--format=%r", env=slurm).strip() == "Dependency"
    run("scancel", "--name=asperity", env=slurm)
    wait_for_all(run, slurm)
    assert not (tmp_path / "out").exists()
    submit(run, slurm, 2, LONG)
    wait_for_all(run, slurm)
    is_whole(tmp_path / "out", LONG)


def test_submitit_replaces_the_executor(run, slurm, tmp_path, is_whole):
    lines = (EXAMPLES / "futures_shards.py").read_text().splitlines()
    (comment,) = [line for line in lines if line.strip().startswith("# Slurm: executor =")]
    plain = next(line for line in lines if "ProcessPoolExecutor()" in line)
    source = "\n".join(lines).replace(plain, "").replace("# Slurm: executor", "executor")
    (tmp_path / "on_slurm.py").write_text(f"import submitit\n{source}\n")
    (tmp_path / "driver.py").write_text(f"import on_slurm\non_slurm.main(2, 'out', {SHORT})\n")
    run("python", "driver.py", env={**slurm, "PYTHONPATH": f"{slurm['PYTHONPATH']}:{tmp_path}"})
    is_whole(tmp_path / "out", SHORT)
