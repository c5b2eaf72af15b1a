"""Interrupts: Ctrl-C ends a call with the results so far, and processes that are forked can trace."""

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import asperity as asp

RUN = """
import json, signal
import asperity as asp
signal.signal(signal.SIGINT, signal.default_int_handler)
surface = asp.Surface.gaussian(size=256, tau=8, smoothness=3, seed=7)
print("begun", flush=True)
try:
    surface.trace(eta=1.5, theta=30, rays=10_000_000_000, progress=False)
except asp.Interrupted as interrupted:
    result = interrupted.result
    rays = result and result.summary["work"]["rays"]
    transmitted = float(result.transmitted)
    result.report(result.folder / "page.html")
    kept = asp.load(result.folder).transmitted == transmitted
    print(json.dumps([rays, bool(result.is_complete), transmitted, bool(kept)]))
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_ends_a_call_with_the_results_so_far():
    run = subprocess.Popen([sys.executable, "-c", RUN], stdout=subprocess.PIPE, text=True)
    assert run.stdout.readline() == "begun\n"
    time.sleep(2.0)
    run.send_signal(signal.SIGINT)
    try:
        out, _ = run.communicate(timeout=30)
    finally:
        run.kill()
    rays, is_complete, transmitted, kept = json.loads(out)
    assert run.returncode == 0
    assert rays > 1000 and not is_complete and 0.9 < transmitted < 1
    # A page of unfinished results traces nothing more
    assert kept


def test_an_interrupted_run_is_resumed(tmp_path):
    """A run of a folder goes on where an interrupt ended it."""
    surface = asp.Surface.gaussian(size=128, tau=8, smoothness=3, seed=7)
    options = dict(eta=1.5, theta=30, rays=3_000_000, output=tmp_path / "out")

    def interrupt():
        time.sleep(0.4)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    try:
        surface.trace(**options)
    except asp.Interrupted as interrupted:
        assert interrupted.result is None or not interrupted.result.is_complete
    except KeyboardInterrupt:
        pass
    whole = surface.trace(**options)
    assert whole.is_complete
    again = surface.trace(**{**options, "output": None})
    assert again.transmitted == whole.transmitted


def test_an_interrupt_of_another_call_is_raised(tmp_path):
    surface = asp.Surface.gaussian(size=64, tau=8, smoothness=3, seed=7)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        surface.render(tmp_path / "picture.png", eta=1.5, samples=1_000_000)
    smith = asp.models.smith(smoothness=3, eta=1.5)
    threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        smith.albedo(asp.models.direction(np.linspace(0, 80, 100_000)))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="fork of POSIX")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_leaves_results_to_its_parent():
    result = asp.trace(flat=True, eta=1.5, rays=1000)
    child = os.fork()
    if child == 0:
        del result
        os._exit(0)
    os.waitpid(child, 0)
    assert 0 < result.reflected < 1


def _traced(seed):
    return float(asp.trace(flat=True, eta=1.5, rays=1000, seed=seed).reflected)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="fork of POSIX")
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_a_forked_process_traces():
    here = _traced(1)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map(_traced, [1, 1]) == [here, here]


def test_threads_trace_at_the_same_time():
    surfaces = [asp.Surface.gaussian(size=64, tau=8, smoothness=3, seed=seed) for seed in range(4)]
    alone = [float(surface.trace(eta=1.5, rays=20_000).reflected) for surface in surfaces]
    found = [None] * 4

    def trace(number):
        found[number] = float(surfaces[number].trace(eta=1.5, rays=20_000).reflected)

    threads = [threading.Thread(target=trace, args=[number]) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == alone
