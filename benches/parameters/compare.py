#!/usr/bin/env python3
"""Compares areal parameters of asperity with those of surfalize and SurfaceTopography, and prints one Markdown table per file.

asperity reads each file, fills missing points and removes a parabola; all programs then measure the same heights.

    python3 -m venv target/parameters
    target/parameters/bin/pip install -r benches/parameters/requirements.txt
    target/parameters/bin/python benches/parameters/compare.py target/debug/asperity FILE...
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from surfalize import Surface
from SurfaceTopography import Topography

SYMBOLS = "Sq Sa Ssk Sku Sp Sv Sz Sk Spk Svk Smr1 Smr2 Vmp Vmc Vvc Vvv Sdq Sdr Sal Str Std".split()
AGREE = 1e-6


def run(program, *arguments):
    """The JSON that asperity prints; its sentence and an end if it refuses."""
    done = subprocess.run([program, *map(str, arguments), "--json"], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(done.stderr.strip())
    return json.loads(done.stdout)


def compare(program, file, options):
    with tempfile.TemporaryDirectory() as folder:
        heights = Path(folder) / "heights.npy"
        reading = ["--remove", "parabola", "--missing", "fill", "--border", "open", *options]
        ours = run(program, "inspect", file, *reading, "-o", heights)
        z = np.load(heights).astype(np.float64)
        # What the file holds, in case it rounds: both measure the same numbers
        spacing = ",".join(map(repr, ours["spacing"]))
        ours = run(program, "inspect", heights, "--spacing", spacing, "--border", "open")
    dx, dy = ours["spacing"]
    surface = Surface(z, dx, dy)
    # SurfaceTopography holds x first
    ny, nx = z.shape
    topography = Topography(z.T, (nx * dx, ny * dy))
    other = {"Sq": topography.rms_height_from_area(), "Sdq": topography.rms_gradient()}

    print(f"| {file.name} | asperity | surfalize | relative difference | SurfaceTopography | relative difference |")
    print("|---|---|---|---|---|---|")
    for symbol in SYMBOLS:
        own = ours[symbol.lower()]
        cells = [symbol, text(own)]
        for value in (float(getattr(surface, symbol)()), other.get(symbol)):
            cells += [text(value), difference(own, value)]
        print("| " + " | ".join(cells) + " |")
    print()


def text(value):
    return "-" if value is None or value != value else f"{value:.8g}"


def difference(own, value):
    if own is None or value is None or value != value:
        return ""
    relative = abs(own - value) / max(abs(own), 1e-300)
    return "agree" if relative < AGREE else f"{relative:.1e}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path)
    parser.add_argument("files", type=Path, nargs="+")
    parser.add_argument("--unit", help="convert lengths of the files into this unit")
    options = parser.parse_args()
    for file in options.files:
        compare(options.program, file, ["--unit", options.unit] if options.unit else [])


if __name__ == "__main__":
    main()
