#!/usr/bin/env python3
"""Compares Mueller matrices of single scattering on an explicit surface with SCATMECH's facet model, bin by bin.

Light scattered once into a direction has met the facet of that half vector, so that elements over the first one do not
depend on the statistics of the surface, nor on shadowing.
"""

import argparse
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

from pySCATMECH.brdf import BRDF_Model

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target" / "release" / "asperity"

# Elements of each bin that are compared, but the first, over which the others are.
ELEMENTS = [(row, column) for row in range(4) for column in range(4)][1:]

# Places in a bin, from one edge to the other.
NODES = [-1.0, -0.5, 0.0, 0.5, 1.0]

CASES = [
    ("glass", ["--eta", "1.5"], "(1.5,0)", "0"),
    ("glass", ["--eta", "1.5"], "(1.5,0)", "1"),
    ("gold", ["--material", "conductor", "--eta", "0.43", "--kappa", "2.455"], "(0.43,2.455)", "0"),
]


def facets(substrate, kind, smoothness):
    """SCATMECH's model of reflection (kind 0) or transmission (1) by facets of Gaussian slopes."""
    slopes = {None: "Gaussian_Slope_Distribution_Function", "s": str(2 / smoothness)}
    parameters = {"lambda": "0.55", "substrate": substrate, "type": kind, "sdf": slopes}
    return BRDF_Model("Facet_BRDF_Model", {**parameters, "stack": "No_StackModel"})


def range_over_bin(model, theta_i, thetas, phis):
    """Least and largest value of each element over the first one in a bin: degrees from the normal of its side, and of azimuth."""
    found = []
    for x in NODES:
        theta = math.radians(0.5 * (thetas[0] + thetas[1] + x * (thetas[1] - thetas[0])))
        for y in NODES:
            phi = math.radians(0.5 * (phis[0] + phis[1] + y * (phis[1] - phis[0])))
            matrix = model.MuellerBRDF(math.radians(theta_i), theta, phi, coords="psps")
            first = float(matrix[0][0])
            if first == 0:
                return None
            found.append([float(matrix[row][column]) / first for row, column in ELEMENTS])
    return [(min(values), max(values)) for values in zip(*found)]


def trace(heights, material, theta, rays, folder):
    """Rows of mueller.csv of light that is scattered once and travels towards azimuth 0."""
    subprocess.run(
        [PROGRAM, "trace", heights, "--border", "periodic", *material, "--theta", str(theta), "--phi", "180", "--rays", str(rays)]
        + ["--max-order", "1", "--estimator", "plain", "--polarisation", "mueller", "--bins", "90x180"]
        + ["-o", folder, "--no-plots", "--quiet"],
        check=True,
    )
    with open(folder / "mueller.csv", newline="") as file:
        return list(csv.DictReader(file))


def compare(rows, model, theta, side):
    """Elements of bins away from the pole: their number, by how many errors they lie outside of the model's range in their bin
    (root mean square, largest), and the mean width of that range. Where in its bin light goes depends on the surface."""
    count, squares, worst, widths = 0, 0.0, 0.0, 0.0
    for row in rows:
        thetas = [float(row["theta_min_deg"]), float(row["theta_max_deg"])]
        if side == "transmitted":
            thetas = [180 - edge for edge in reversed(thetas)]
        phis = [float(row["phi_min_deg"]), float(row["phi_max_deg"])]
        if row["side"] != side or not row["m11"] or thetas[0] < 20 or thetas[1] > 80:
            continue
        if float(row["flux_se"]) > 0.1 * float(row["flux"]):
            continue
        ranges = range_over_bin(model, theta, thetas, phis)
        if ranges is None:
            continue
        for (i, j), (low, high) in zip(ELEMENTS, ranges):
            value, error = float(row[f"m{i}{j}"]), float(row[f"m{i}{j}_se"])
            outside = max(low - value, value - high, 0.0) / max(error, 1e-6)
            count, squares, worst = count + 1, squares + outside**2, max(worst, outside)
            widths += high - low
    return count, math.sqrt(squares / max(count, 1)), worst, widths / max(count, 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rays", type=int, default=16_000_000)
    parser.add_argument("--smoothness", type=float, default=2.0)
    arguments = parser.parse_args()
    failed = False
    print("| material | theta | side | elements | outside: rms | largest | mean width of a range |")
    print("|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as temporary:
        temporary = pathlib.Path(temporary)
        heights = temporary / "heights.npy"
        size = ["--tau", "16", "--smoothness", str(arguments.smoothness), "--size", "512", "--seed", "1"]
        subprocess.run([PROGRAM, "generate", *size, "-o", heights, "--quiet"], check=True)
        for theta in (30, 60):
            for name, material, substrate, kind in CASES:
                side = ["reflected", "transmitted"][int(kind)]
                folder = temporary / f"{name}{theta}{side}"
                rows = trace(heights, material, theta, arguments.rays, folder)
                model = facets(substrate, kind, arguments.smoothness)
                count, outside, worst, width = compare(rows, model, theta, side)
                failed |= count < 1000 or worst > 5
                print(f"| {name} | {theta} | {side} | {count} | {outside:.2f} | {worst:.1f} | {width:.3f} |", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
