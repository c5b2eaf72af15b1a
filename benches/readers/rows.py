"""Rows of a table: files that other programs write, as asperity and independent readers read them.

A row is a title, a function that writes files into a folder and yields their paths, a function that reads one as asperity should, the name
of the program behind it, and, but for height maps, a function that compares both.
"""

import argparse
import sys
import warnings
from pathlib import Path

import numpy as np
from compare import Map, by_asperity

# Single precision, in which some files keep what others compute in double: 2^-24 of the largest height and of the sum of a few
SINGLE = 2e-7


def scaled(values, spacing):
    return Map(values, spacing, int(np.isnan(values).sum()))


def problem(program, path, read, most=1e-15):
    """What differs between a height map as asperity and as `read` give it, or None. `most`: the largest difference of heights, in units of
    the largest height."""
    ours, theirs = by_asperity(program, path), read(path)
    both = ~np.isnan(theirs.heights)
    if ours.heights.shape != theirs.heights.shape or ours.missing != theirs.missing:
        return f"shape {ours.heights.shape}, missing {ours.missing}: {theirs.heights.shape}, {theirs.missing}"
    off = np.abs(ours.heights - theirs.heights)[both].max() / np.abs(theirs.heights[both]).max()
    if off > most:
        return f"heights differ by {off:.1e}"
    if theirs.spacing and any(abs(a / b - 1) > max(most, 1e-14) for a, b in zip(ours.spacing, theirs.spacing)):
        return f"spacing {ours.spacing}: {theirs.spacing}"
    return None


def print_rows(description, rows):
    warnings.simplefilter("ignore")
    parser = argparse.ArgumentParser(description=description.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--rows", default=range(len(rows)), type=int, nargs="+", help="rows to make, from 0 on")
    options = parser.parse_args()
    print("| format | compared with | files | agreement |\n|---|---|---|---|")
    for number in options.rows:
        name, write, read, library, *compare = rows[number]
        folder = options.folder / str(number)
        folder.mkdir(parents=True, exist_ok=True)
        count, problems = 0, 0
        for path in write(folder):
            count += 1
            try:
                found = (compare[0] if compare else problem)(options.program, path, read)
            except Exception as error:
                found = str(error)
            if found:
                problems += 1
                print(f"{path}: {found}", file=sys.stderr)
        print(f"| {name} | {library} | {count} | {'all' if not problems else count - problems} |", flush=True)
