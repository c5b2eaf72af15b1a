"""Undivided runs to compare with, and engines that run shards on this machine. ASPERITY names the program."""

import json
import os
import shutil
import socket
import subprocess
import sys
import time
import zipfile
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples/cluster"
# Folder with the package in Python.
PACKAGE = os.environ.get("ASPERITY_PACKAGE", "")

RUN = {"smoothness": [1, 2, 3], "theta": [30, 60], "eta": 1.5, "tau": 8, "size": 64, "realisations": 8, "bins": "9x18", "models": ["smith"], "no_plots": True}
SHORT = {**RUN, "rays": 20_000}  # half a second
LONG = {**RUN, "rays": 400_000}  # some seconds, so that it can be stopped on its way


def flags(run):
    """Command line of a run, as the examples take it."""
    words = ["verify"]
    for name, value in run.items():
        flag = f"--{name.replace('_', '-')}"
        if value is True:
            words.append(flag)
        else:
            words += [flag, ",".join(map(str, value)) if isinstance(value, list) else str(value)]
    return words


@pytest.fixture(scope="session")
def environment(tmp_path_factory):
    """Variables of the environment in which `asperity` is the program, and `import asperity` the package."""
    folder = tmp_path_factory.mktemp("bin")
    (folder / "asperity").symlink_to(Path(os.environ["ASPERITY"]).resolve())
    path = os.pathsep.join([str(folder), str(Path(sys.executable).parent), os.environ["PATH"]])
    return {**os.environ, "PATH": path, "PYTHONPATH": os.pathsep.join([str(PACKAGE), str(EXAMPLES)]), "PYTHONDONTWRITEBYTECODE": "1"}


@pytest.fixture
def run(environment, tmp_path):
    """Function that runs a command to its end, in the folder of the test."""

    def run(*line, check=True, timeout=120, env=None):
        # Not to a pipe, which processes that outlive the command would keep open
        with open(tmp_path / "output.txt", "w+") as output:
            code = subprocess.run(line, cwd=tmp_path, env=env or environment, stdout=output, stderr=subprocess.STDOUT, timeout=timeout).returncode
            output.seek(0)
            text = output.read()
        assert not check or code == 0, text
        return text

    return run


@pytest.fixture(scope="session")
def whole(environment, tmp_path_factory):
    """Function that makes the results of an undivided run, once."""
    made = {}

    def whole(run):
        key = json.dumps(run)
        if key not in made:
            folder = made[key] = tmp_path_factory.mktemp("whole") / "results"
            subprocess.run(["asperity", *flags(run), "--quiet", "-o", folder], env=environment, check=True)
        return made[key]

    return whole


@pytest.fixture
def is_whole(whole):
    """Function that compares merged results with those of an undivided run, but for times, machine and command line."""

    def is_whole(merged, run):
        expected, found = content(whole(run)), content(Path(merged))
        assert sorted(found) == sorted(expected)
        assert [name for name in expected if found[name] != expected[name]] == []

    return is_whole


def content(folder):
    """Content of the files of a result folder, and of the members of results.npz, without what depends on the machine."""
    files = {str(path.relative_to(folder)): path for path in folder.rglob("*") if path.is_file() and path.name != "manifest.json"}
    assert {"results.npz", "summary.json", "report.txt"} <= set(files)
    found = {}
    for name, path in files.items():
        if name == "results.npz":
            with zipfile.ZipFile(path) as members:
                found |= {f"{name}/{member}": members.read(member) for member in members.namelist() if member != "machine.json"}
        else:
            found[name] = without_machine(json.loads(path.read_text())) if path.suffix == ".json" else path.read_bytes()
    return found


# Members of summaries that say when and where a run was traced.
OF_MACHINE = {"machine", "seconds", "build_seconds", "generate_seconds", "trace_seconds", "threads", "instructions"}


def without_machine(value):
    if isinstance(value, dict):
        return {name: without_machine(member) for name, member in value.items() if name not in OF_MACHINE}
    return [without_machine(member) for member in value] if isinstance(value, list) else value


def wait_until(condition, seconds=60):
    """Waits for a condition, and returns its value."""
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, f"still waiting after {seconds} s"
        time.sleep(0.05)
    return value


def needs(*programs):
    """Skips the test where a program is not installed."""
    path = os.pathsep.join([os.environ["PATH"], "/usr/sbin"])
    for program in programs:
        if not shutil.which(program, path=path):
            pytest.skip(f"{program} is not installed")


def free_port():
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


@contextmanager
def daemon(log, *line, env=None):
    """Process of a service, with its output in a file."""
    with open(log, "w") as output:
        process = subprocess.Popen(line, stdout=output, stderr=subprocess.STDOUT, env=env)
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


CREDENTIALS = 3  # seconds
SLURM_CONF = """
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket,cred_expire={credentials}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,sched_min_interval=0,batch_sched_delay=0
KillWait=5
NodeName={host} NodeAddr=127.0.0.1 CPUs=2 RealMemory=4000
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


@pytest.fixture(scope="session")
def slurm(environment, tmp_path_factory):
    """Environment of a Slurm of one node with two cores."""
    needs("munged", "slurmctld", "slurmd", "sbatch", "srun")
    if os.geteuid() != 0:
        pytest.skip("the daemons of Slurm need root")
    folder = tmp_path_factory.mktemp("slurm")
    for name in ("state", "spool"):
        (folder / name).mkdir()
    key = folder / "munge.key"
    key.write_bytes(os.urandom(1024))
    key.chmod(0o400)
    host = socket.gethostname().split(".")[0]
    (folder / "slurm.conf").write_text(SLURM_CONF.format(host=host, folder=folder, credentials=CREDENTIALS, ports=[free_port(), free_port()]))
    (folder / "cgroup.conf").write_text("CgroupPlugin=cgroup/v1\n")  # else slurmd wants to mount cgroups

    sbin = {**environment, "PATH": environment["PATH"] + os.pathsep + "/usr/sbin", "SLURM_CONF": str(folder / "slurm.conf")}
    munge = {"socket": "munge.socket", "key-file": "munge.key", "log-file": "munge.log", "pid-file": "munge.pid", "seed-file": "munge.seed"}
    with ExitStack() as services:

        def start(*line):
            services.enter_context(daemon(folder / f"{line[0]}.out", *line, env=sbin))

        start("munged", "--foreground", "--force", *(f"--{option}={folder / name}" for option, name in munge.items()))
        wait_until((folder / "munge.socket").exists)
        start("slurmctld", "-D")
        start("slurmd", "-D")
        state = ["sinfo", "--noheader", "--format=%T"]

        def is_idle():
            return subprocess.run(state, env=sbin, capture_output=True, text=True).stdout.strip() == "idle"

        wait_until(is_idle)
        yield sbin
        # Jobs of tests that failed would outlive the daemons
        subprocess.run(["scancel", "--user=root"], env=sbin, check=True)
        wait_until(is_idle)
