"""Shards: parts of a run in Python, merged to the files of the whole."""

import os
import signal
import subprocess
import sys
import zipfile
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

import asperity as asp

SETTINGS = {"tau": 4, "size": 32, "theta": [0, 40], "realisations": 6, "rays": 4000, "models": "smith"}


def trace(number, of, folder):
    """One shard, in a process of its own."""
    return asp.verify(shard=(number, of), output=f"{folder}/{number}", threads=1, **SETTINGS).folder


def members(result):
    """Members of the result file that do not depend on the machine and the moment."""
    with zipfile.ZipFile(result.folder / "results.npz") as file:
        return {name: file.read(name) for name in file.namelist() if name != "machine.json"}


@pytest.fixture(scope="module")
def whole():
    return asp.verify(**SETTINGS)


def test_shards_of_several_processes_merge_to_the_bytes_of_the_whole(whole, tmp_path):
    with ProcessPoolExecutor(2, get_context("spawn")) as pool:
        folders = list(pool.map(trace, (1, 2, 3), (3,) * 3, (tmp_path,) * 3))
    merged = asp.merge(reversed(folders))
    assert members(merged) == members(whole)
    assert (merged.brdf == whole.brdf).all() and merged.command == "verify"


def test_shards_of_the_program_and_of_python_are_merged_by_either(whole, tmp_path):
    one = trace(1, 2, tmp_path)
    flags = "--tau 4 --size 32 --theta 0,40 --realisations 6 --rays 4000 --models smith --quiet".split()
    program = [sys.executable, "-m", "asperity"]
    subprocess.run([*program, "verify", *flags, "--shard", "2/2", "-o", tmp_path / "2"], check=True)
    assert members(asp.merge([one, tmp_path / "2"])) == members(whole)


def test_missing_shards_are_refused_and_marked(tmp_path):
    one = trace(1, 3, tmp_path)
    with pytest.raises(RuntimeError, match="2 shards of 3 are missing"):
        asp.merge([one], tmp_path / "merged")
    assert not (tmp_path / "merged").exists()
    some = asp.merge([one], partial=True)
    assert not some.is_complete
    assert any("missing" in note for note in some.notes)
    with pytest.raises(ValueError, match="shard"):
        asp.verify(shard=(4, 3), output=tmp_path / "4", **SETTINGS)


def test_a_killed_shard_is_traced_again(whole, tmp_path):
    code = f"import test_shards as t; t.SETTINGS['rays'] = 10**9; t.trace(1, 2, {str(tmp_path)!r})"
    here = os.path.dirname(__file__)
    process = subprocess.Popen([sys.executable, "-c", code], cwd=here)
    with pytest.raises(subprocess.TimeoutExpired):
        process.wait(1.5)
    process.send_signal(signal.SIGKILL)
    process.wait()
    folders = [trace(number, 2, tmp_path / "again") for number in (1, 2)]
    assert members(asp.merge(folders)) == members(whole)
