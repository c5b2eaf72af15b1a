"""Benchmarks of the package: a call beside the program, memory of large arrays, import time, and leaks.

    python crates/python/benches/calls.py [REPEATS]

Prints medians over repeats. The program is that of the environment variable ASPERITY, or `asperity` on the path.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import asperity as asp

REPEATS = int(sys.argv[1]) if len(sys.argv) > 1 else 7


def rss() -> float:
    """Resident memory of this process, MB."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 1e6


def of_process(code: str) -> str:
    """Output of a new interpreter."""
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout.strip()


def beside_the_program() -> None:
    """Wall time of one trace, in turns with the program, whose start and files count as well."""
    program = os.environ.get("ASPERITY", "asperity")
    for rays in (1_000_000, 4_000_000):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "surface.npy")
            surface = asp.Surface.gaussian(size=1024, tau=16, smoothness=2, seed=7)
            np.save(file, surface.heights)
            ours, theirs = [], []
            for number in range(REPEATS):
                began = time.perf_counter()
                surface.trace(eta=1.5, theta=30, rays=rays, progress=False)
                ours.append(time.perf_counter() - began)
                command = [program, "trace", file, "--eta", "1.5", "--theta", "30", "--rays", str(rays), "--no-plots",
                           "--border", "periodic", "-q", "-o", str(Path(folder, str(number)))]
                began = time.perf_counter()
                subprocess.run(command, check=True)
                theirs.append(time.perf_counter() - began)
        ratios = [a / b for a, b in zip(ours, theirs)]
        print(f"trace of {rays:.0e} rays: call {statistics.median(ours):.3f} s, program {statistics.median(theirs):.3f} s, "
              f"ratio {statistics.median(ratios):.3f} ({min(ratios):.3f} to {max(ratios):.3f})")


def memory() -> None:
    """Peak memory of a 4096 x 4096 array that is traced, in copies of the array (134 MB)."""
    code = """
import resource, sys, numpy as np, asperity as asp
peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
heights = np.random.default_rng(1).standard_normal((4096, 4096), dtype=TYPE)
asp.trace(flat=True, eta=1.5, rays=1000)
before = peak()
surface = asp.Surface(heights, spacing=40.0, border="periodic")
made = peak()
surface.heights
out = peak()
surface.trace(eta=1.5, rays=1000, progress=False)
print(f"array {heights.nbytes / 1e6:.0f} MB; Surface +{made - before:.0f} MB, heights +{out - made:.0f} MB, trace +{peak() - out:.0f} MB")
"""
    for kind in ("np.float64", "np.float32"):
        print(f"{kind}: {of_process(code.replace('TYPE', kind))}")


def import_time() -> None:
    """Time of `import asperity`, and that of `import numpy` within."""
    timed = "import time; t = time.perf_counter(); import {}; print(time.perf_counter() - t)"
    for module in ("numpy", "asperity"):
        times = [float(of_process(timed.format(module))) for _ in range(REPEATS)]
        print(f"import {module}: {statistics.median(times):.3f} s")


def leaks() -> None:
    """Resident memory over 1000 calls."""
    surface = asp.Surface.gaussian(size=64, tau=4, smoothness=3, seed=1)
    smith = asp.models.smith(smoothness=3, eta=1.5)
    directions = np.broadcast_to(asp.models.direction(30), (1000, 3))
    seen = []
    for number in range(1001):
        result = surface.trace(eta=1.5, rays=200, progress=False)
        result.brdf, result.summary, asp.Surface(result.brdf).heights, smith.eval(directions, directions)
        if number % 250 == 0:
            seen.append(f"{rss():.0f}")
    print(f"resident memory every 250 calls: {', '.join(seen)} MB")


def models() -> None:
    """Evaluations per second."""
    smith = asp.models.smith(smoothness=3, eta=1.5)
    wi, wo = asp.models.direction(np.full(1_000_000, 30.0)), asp.models.direction(np.linspace(0, 89, 1_000_000), 180)
    for name, call in {"eval": lambda: smith.eval(wi, wo), "pdf": lambda: smith.pdf(wi, wo), "sample": lambda: smith.sample(wi, 1)}.items():
        times = []
        for _ in range(3):
            began = time.perf_counter()
            call()
            times.append(time.perf_counter() - began)
        print(f"models.smith {name}: {1.0 / statistics.median(times):.1f} million directions per second")


if __name__ == "__main__":
    import_time()
    beside_the_program()
    memory()
    leaks()
    models()
