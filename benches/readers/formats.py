"""Formats of height maps and meshes as asperity reads them, next to independent readers: one line per format and reader.

    python3 benches/readers/formats.py FOLDER... > table.md

Height maps as text (.txt, .csv, .asc, .xyz) and X3P are compared point by point with numpy, SurfaceTopography and surfalize, in the unit
of the file; meshes with trimesh: numbers of vertices and triangles, and extent. The table names the format, the reader, the number of
files that both read, and the largest differences; files that one of them alone reads go to standard error with its reason.
`--program` names the program (target/release/asperity).
"""

import argparse
import contextlib
import io
import json
import subprocess
import sys
import tempfile
import warnings
from collections import defaultdict
from pathlib import Path

import numpy as np

from compare import METRES, Map

FORMATS = {
    ".txt": "text", ".csv": "text", ".asc": "ESRI grid", ".xyz": "points x, y, z", ".x3p": "X3P",
    ".obj": "OBJ", ".ply": "PLY", ".stl": "STL",
}
MESHES = ("OBJ", "PLY", "STL")


def run(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(" ".join(done.stderr.split()))
    return json.loads(done.stdout)


def by_asperity(program, path):
    """The map in metres, or in the numbers of the file if it states no unit."""
    with tempfile.TemporaryDirectory() as folder:
        array = Path(folder) / "heights.npy"
        report = run([program, "inspect", path, "--missing", "fill", "--json", "-o", array])
        heights = np.load(array)
    unit = METRES.get(report["unit"], 1.0)
    return Map(heights * unit, tuple(step * unit for step in report["spacing"]), 0)


def mesh_by_asperity(program, path):
    surface = run([program, "trace", path, "--theta", "0", "--rays", "64", "--json"])["config"]["surface"]
    return surface["triangles"] + surface["triangles_dropped"], np.array(surface["extent"])


def by_numpy(path):
    """A matrix of text, whatever its header; lines of an ESRI grid may end anywhere."""
    lines = [line.replace(";", " ").replace(",", " ") for line in path.read_text("utf-8").splitlines()]
    if any(line.startswith("#") for line in lines):
        raise ValueError("numbers after a heading with units")
    header = {}
    while lines and lines[0][:1].isalpha():
        name, value = lines.pop(0).split()
        header[name.lower()] = value
    rows = [line.split() for line in lines if line[:1] not in ("#", "/")]
    mark = header.get("nodata_value")
    number = lambda word: np.nan if word == mark else float(word)
    if header:
        flat = np.array([number(word) for row in rows for word in row])
        heights = flat.reshape(int(header["nrows"]), int(header["ncols"]))
        with contextlib.suppress(ValueError, TypeError):
            heights[np.float32(heights) == np.float32(mark)] = np.nan
        return Map(heights, (float(header["cellsize"]),) * 2, 0)
    heights = np.array([[number(word) for word in row] for row in rows])
    if heights.shape[1] == 3:
        x, y = (np.unique(heights[:, k]) for k in (0, 1))
        order = np.lexsort((heights[:, 0], heights[:, 1]))
        return Map(heights[order, 2].reshape(len(y), len(x)), (x[1] - x[0], y[1] - y[0]), 0)
    return Map(heights, None, 0)


def by_surface_topography(path):
    from SurfaceTopography import open_topography

    read = open_topography(str(path)).topography()
    unit = METRES.get(read.unit, 1.0)
    heights = np.ma.filled(np.ma.asarray(read.heights()).astype(float), np.nan).T * unit
    sizes = zip(read.physical_sizes, read.nb_grid_pts)
    return Map(heights, tuple(size / count * unit for size, count in sizes), 0)


def by_surfalize(path):
    from surfalize import Surface

    read = Surface.load(str(path))
    return Map(read.data.astype(float) * 1e-6, (read.step_x * 1e-6, read.step_y * 1e-6), 0)


def mesh_by_trimesh(path):
    import trimesh

    read = trimesh.load(str(path), process=False, force="mesh")
    return len(read.faces), np.ptp(read.vertices, axis=0)


READERS = {"numpy": by_numpy, "SurfaceTopography": by_surface_topography, "surfalize": by_surfalize}


def difference(ours, theirs):
    """Largest differences of heights in Sq and of spacings; an error if the maps are of other shapes."""
    if ours.heights.shape != theirs.heights.shape:
        raise ValueError(f"{theirs.heights.shape} numbers, not {ours.heights.shape}")
    both = ~np.isnan(theirs.heights)
    off = np.abs(ours.heights - theirs.heights)[both].max() / np.nanstd(theirs.heights)
    steps = [abs(a - b) / b for a, b in zip(ours.spacing, theirs.spacing or ours.spacing)]
    return off, max(steps)


def mesh_difference(ours, theirs):
    if ours[0] != theirs[0]:
        raise ValueError(f"{theirs[0]} triangles, not {ours[0]}")
    return (np.abs(ours[1] - theirs[1]).max() / theirs[1].max(),)


def compare(program, path, name, found):
    is_mesh = name in MESHES
    try:
        ours = (mesh_by_asperity if is_mesh else by_asperity)(program, path)
    except ValueError as error:
        ours = None
        print(f"{path.name}: asperity: {str(error)[:200]}", file=sys.stderr)
    for reader, read in {"trimesh": mesh_by_trimesh}.items() if is_mesh else READERS.items():
        try:
            with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
                warnings.simplefilter("ignore")
                theirs = read(path)
            if ours is not None:
                found[name, reader].append((mesh_difference if is_mesh else difference)(ours, theirs))
        except Exception as error:
            print(f"{path.name}: {reader}: {str(error)[:80]!r}", file=sys.stderr)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--program", default="target/release/asperity")
    options = parser.parse_args()
    found = defaultdict(list)
    for path in sorted(path for folder in options.folders for path in folder.iterdir()):
        name = FORMATS.get(path.suffix.lower())
        if name:
            compare(options.program, path, name, found)
    print("| format | compared with | files | agreement |")
    print("|---|---|---|---|")
    for (name, reader), all_of in sorted(found.items()):
        worst = np.max(np.array(all_of), axis=0)
        words = ["extent {:.1e}"] if name in MESHES else ["heights {:.1e} Sq", "spacing {:.1e}"]
        agreement = ", ".join(word.format(value) for word, value in zip(words, worst))
        print(f"| {name} | {reader} | {len(all_of)} | {agreement} |")


if __name__ == "__main__":
    main()
