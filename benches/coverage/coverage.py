"""Coverage of standard errors: how often results of many seeds lie two or three of their errors off.

Runs `asperity verify` for 24 cases with 60 seeds each and prints a Markdown table. Each result is compared with the mean
of the results of the other seeds: z = (x_i - mean) / sqrt(se_i^2 + se_mean^2). Errors come from 32 surfaces, so that z follows
Student's distribution with 31 degrees of freedom, whose variance and tails head the table.

    python3 benches/coverage/coverage.py > table.md

Python's standard library is enough. `--program` names the program (target/release/asperity), `--seeds` the number of seeds,
`--jobs` how many runs go at a time.
"""

import argparse
import csv
import itertools
import json
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SURFACES = 32
RAYS = 100_000
CASES = list(itertools.product(["0.5", "1", "2", "4"], ["1.5", "1/1.5"], ["10", "40", "70"]))
# Least number of results of one place, over the seeds
LEAST_RESULTS = 10


def run(program, case, seed):
    """Values and errors of one run by kind of result, keyed by place."""
    smoothness, eta, theta = case
    with tempfile.TemporaryDirectory() as folder:
        command = [
            program, "verify", "--smoothness", smoothness, "--eta", eta, "--theta", theta,
            "--realisations", str(SURFACES), "--rays", str(RAYS), "--bins", "18x36", "--seed", str(seed),
            "--models", "none", "--no-plots", "--threads", "1", "--quiet", "-o", folder,
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"{' '.join(command)}: {done.stderr}")
        summary = json.loads((Path(folder) / "summary.json").read_text())
        with open(Path(folder) / "histogram.csv") as file:
            bins = list(csv.DictReader(file))
        with open(Path(folder) / "theta.csv") as file:
            rings = list(csv.DictReader(file))
    totals = {side: (summary["energy"][side]["mean"], summary["energy"][side]["se"]) for side in ("reflected", "transmitted")}
    place = lambda row, *names: tuple(row[name] for name in ("side", *names))
    return {
        "totals": totals,
        "rings": {
            place(row, "theta_min_deg"): (float(row["flux"]), float(row["flux_se"]))
            for row in rings
            if row["flux_se"] and float(row["flux_se"]) > 0
        },
        "bins": {
            place(row, "theta_min_deg", "phi_min_deg"): (float(row["flux"]), float(row["flux_se"]))
            for row in bins
            # Bins are averaged with their mirror images: one of both is enough
            if row["few_rays"] == "no" and float(row["phi_min_deg"]) < 180
        },
    }


def deviations(runs, kind):
    """z of every result that half of the seeds have, at least ten."""
    places = set().union(*(run[kind] for run in runs))
    found = []
    for place in places:
        results = [run[kind][place] for run in runs if place in run[kind]]
        n = len(results)
        if n < max(LEAST_RESULTS, len(runs) // 2):
            continue
        total = math.fsum(x for x, _ in results)
        variance = math.fsum(se * se for _, se in results)
        for x, se in results:
            mean = (total - x) / (n - 1)
            error = math.sqrt(se * se + (variance - se * se) / (n - 1) ** 2)
            found.append((x - mean) / error)
    return found


def described(z):
    """Variance of z, and the percentages beyond two and three."""
    beyond = lambda limit: 100 * sum(abs(x) > limit for x in z) / len(z)
    return f"{math.fsum(x * x for x in z) / len(z):.2f}, {beyond(2):.1f}, {beyond(3):.2f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--seeds", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    if options.seeds < LEAST_RESULTS:
        parser.error(f"--seeds {options.seeds}: {LEAST_RESULTS} are needed at least")

    kinds = ("totals", "rings", "bins")
    print("| s, n, theta | totals | rings | bins |\n|---|---|---|---|")
    print("| Student, 31 degrees of freedom | 1.07, 5.4, 0.53 | 1.07, 5.4, 0.53 | 1.07, 5.4, 0.53 |")
    everything = {kind: [] for kind in kinds}
    with ThreadPoolExecutor(options.jobs) as pool:
        for case in CASES:
            seeds = range(1, options.seeds + 1)
            runs = list(pool.map(lambda seed: run(options.program, case, seed), seeds))
            z = {kind: deviations(runs, kind) for kind in kinds}
            for kind in kinds:
                everything[kind] += z[kind]
            smoothness, eta, theta = case
            print(f"| {smoothness}, {eta}, {theta} | " + " | ".join(described(z[kind]) for kind in kinds) + " |", flush=True)
    print("| all | " + " | ".join(described(everything[kind]) for kind in kinds) + " |")


if __name__ == "__main__":
    main()
