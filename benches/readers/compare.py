"""Files of instruments as asperity reads them, point by point next to independent readers.

    cargo build --release
    cargo test -p asperity-io --lib small_files -- --ignored
    python3 benches/readers/compare.py FOLDER target/readers > table.md

Each file of the folders is read by SurfaceTopography, surfalize and, if it is one of Gwyddion, gwyfile. The table has one
line per file and reader: points that both have, the largest difference of heights in units of Sq, the largest relative
difference of spacings, and missing points. `--program` names the program (target/release/asperity).
"""

import argparse
import contextlib
import io
import json
import re
import subprocess
import sys
import tempfile
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

ENDINGS = {
    ".al3d", ".bcr", ".bcrf", ".dat", ".di", ".gwy", ".opd", ".plu", ".plux", ".sdf", ".spm", ".sur",
} | {f".{k:03}" for k in range(1000)}
# Names of formats that SurfaceTopography does not find out, or reports nothing of
FORMATS = {".bcr": "bcr", ".plu": "plu", ".plux": "plux", ".spm": "di", ".sur": "sur"}
METRES = {"1": 1.0, "m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}


@dataclass
class Map:
    """Heights `[ny, nx]` with NaN for missing points, and spacing `[dx, dy]`, in metres."""

    heights: np.ndarray
    spacing: tuple
    missing: int


def by_asperity(program, path):
    with tempfile.TemporaryDirectory() as folder:
        array = Path(folder) / "heights.npy"
        command = [program, "inspect", str(path), "--missing", "fill", "--json", "-o", str(array)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise ValueError(done.stderr)
        report = json.loads(done.stdout)
        unit = METRES[report["unit"]]
        spacing = tuple(step * unit for step in report["spacing"])
        return Map(np.load(array) * unit, spacing, missing_points(program, path))


def missing_points(program, path):
    """Without a policy for them, missing points are refused and counted."""
    done = subprocess.run([program, "inspect", str(path)], capture_output=True, text=True, check=False)
    counted = re.search(r"(\d+) of \d+ points are missing", " ".join(done.stderr.split()))
    return int(counted[1]) if counted else 0


def by_surface_topography(path):
    from SurfaceTopography import open_topography

    reader = open_topography(str(path), format=FORMATS.get(path.suffix))
    # Channels other than of heights have a pair of units
    height = next(k for k, channel in enumerate(reader.channels) if isinstance(channel.unit, str))
    read = reader.topography(channel_index=height)
    unit = METRES[read.unit]
    heights = np.ma.filled(np.ma.asarray(read.heights()).astype(float), np.nan).T * unit
    spacing = tuple(size / count * unit for size, count in zip(read.physical_sizes, read.nb_grid_pts))
    return Map(heights, spacing, int(np.isnan(heights).sum()))


def by_surfalize(path):
    from surfalize import Surface

    read = Surface.load(str(path))
    heights = read.data.astype(float) * 1e-6
    return Map(heights, (read.step_x * 1e-6, read.step_y * 1e-6), int(np.isnan(heights).sum()))


def by_gwyfile(path):
    import gwyfile

    if path.suffix != ".gwy":
        raise ValueError("reads .gwy alone")
    container = gwyfile.load(str(path))
    fields = {key: field for key, field in container.items() if key.endswith("/data")}
    name, field = next((key, field) for key, field in fields.items() if field["si_unit_z"]["unitstr"] == "m")
    shape = (field["yres"], field["xres"])
    heights = np.array(field["data"], dtype=float).reshape(shape)
    mask = container.get(name.replace("data", "mask"))
    if mask is not None:
        heights[np.asarray(mask["data"]).reshape(shape) > 0.5] = np.nan
    spacing = (field["xreal"] / field["xres"], field["yreal"] / field["yres"])
    return Map(heights, spacing, int(np.isnan(heights).sum()))


READERS = {
    "SurfaceTopography": by_surface_topography,
    "surfalize": by_surfalize,
    "gwyfile": by_gwyfile,
}


def compared(ours, theirs):
    """The columns of the table after file and reader."""
    if ours.heights.shape != theirs.heights.shape:
        return f"shape {theirs.heights.shape} | | | "
    both = ~np.isnan(theirs.heights)
    off = np.abs(ours.heights - theirs.heights)[both].max() / np.nanstd(theirs.heights)
    steps = max(abs(a - b) / b for a, b in zip(ours.spacing, theirs.spacing))
    return f"{both.sum()} | {off:.1e} | {steps:.1e} | {ours.missing}, {theirs.missing}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--program", default="target/release/asperity")
    options = parser.parse_args()
    print("| file | reader | points | heights differ by, Sq | spacing differs by | missing: asperity, reader |")
    print("|---|---|---|---|---|---|")
    files = sorted(path for folder in options.folders for path in folder.iterdir() if path.suffix in ENDINGS)
    for path in files:
        ours = by_asperity(options.program, path)
        for name, read in READERS.items():
            try:
                # Readers print what they think of a file
                with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
                    warnings.simplefilter("ignore")
                    theirs = read(path)
            except Exception as error:
                if name != "gwyfile" or path.suffix == ".gwy":
                    print(f"{path.name}: {name} does not read it: {str(error)[:80]!r}", file=sys.stderr)
                continue
            print(f"| {path.name} | {name} | {compared(ours, theirs)} |", flush=True)


if __name__ == "__main__":
    main()
