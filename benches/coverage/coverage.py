"""Coverage of standard errors: how often results of many seeds lie two or three of their errors off, and p values under true models.

Runs `asperity verify` for 24 cases with 60 seeds each and prints a Markdown table. Each result is compared with the mean
of the results of the other seeds: z = (x_i - mean) / sqrt(se_i^2 + se_mean^2). Errors come from 32 surfaces, so that z follows
Student's distribution with 31 degrees of freedom, whose variance and tails head the table.

A second table has every column with an error of runs in which few rays or few surfaces carry the light, few-ray bins included; a third the p values of
`trace --models` and `verify` where the model is right, which should be uniform.

    python3 benches/coverage/coverage.py > table.md

Python's standard library is enough. `--program` names the program (target/release/asperity), `--seeds` the number of seeds,
`--jobs` how many runs go at a time, `--tables` which of the three tables are made (1,2,3).
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
        execute(command)
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
            error = math.sqrt(se * se + max(0.0, variance - se * se) / (n - 1) ** 2)
            if error > 0:
                found.append((x - mean) / error)
    return found


def described(z):
    """Variance of z, and the percentages beyond two and three."""
    beyond = lambda limit: 100 * sum(abs(x) > limit for x in z) / len(z)
    return f"{math.fsum(x * x for x in z) / len(z):.2f}, {beyond(2):.1f}, {beyond(3):.2f}"


SMALL = "--size 64 --tau 4 --spacing 1 --bins 6x12 --theta 30"
COMMON = f"verify --realisations {SURFACES} --rays 32000 --models none"
# Runs whose columns are all tried: arguments, tables and columns
FEW = {
    "orders and components, glass": (f"{COMMON} {SMALL} --smoothness 1", {
        "theta": ("flux", "flux_order_1", "flux_order_2", "flux_order_3", "flux_order_4_and_above"),
        "in_plane": ("flux", "flux_order_1", "flux_order_2", "flux_order_3"),
        "histogram": ("flux", "flux_single", "flux_multiple"),
    }),
    "components of a medium": (
        f"{COMMON} {SMALL} --smoothness 2 --mean-free-path 4 --albedo 0.9 --thickness 12 --bottom absorbing",
        {"theta": ("flux_unscattered", "flux_once", "flux_more"), "histogram": ("flux_once", "flux_more")},
    ),
    "Mueller ratios": (f"{COMMON} {SMALL} --smoothness 3 --polarisation mueller", {
        "mueller": ("flux", "m10", "m11", "m12", "m21", "m33"),
        "mueller_theta": ("m10", "m11", "m33"),
    }),
    "tracked less averaged, out of glass": (f"{COMMON} {SMALL} --smoothness 3 --eta 1/1.5 --polarisation both", {
        "histogram": ("flux_tracked_less_averaged",),
        "theta": ("flux_tracked_less_averaged",),
    }),
    "V grooves of rare light": (
        f"{COMMON} --structure v-grooves --randomness 0.5 --width 16 --spacing 1 --size 256x64 --bins 6x12 --theta 30",
        {"theta": ("flux", "flux_order_1", "flux_order_2", "flux_order_3"), "histogram": ("flux",)},
    ),
    "GGX slopes": (f"{COMMON} {SMALL} --smoothness 3 --slopes ggx", {"theta": ("flux",), "histogram": ("flux",)}),
}


def columns(program, arguments, wanted, seed):
    """Values and errors of the wanted columns of one run, by table and column, keyed by row."""
    with tempfile.TemporaryDirectory() as folder:
        execute([program, *arguments.split(), "--seed", str(seed), "--no-plots", "--threads", "1", "--quiet", "-o", folder])
        found = {}
        for table, names in wanted.items():
            with open(Path(folder) / f"{table}.csv") as file:
                rows = list(csv.DictReader(file))
            for name in names:
                known = {i: row for i, row in enumerate(rows) if row[name] and row[f"{name}_se"]}
                found[table, name] = {i: (float(row[name]), float(row[f"{name}_se"])) for i, row in known.items()}
        return found


def execute(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}: {done.stderr}")


def p_of_trace(program, seed):
    """p value of a Gaussian map against the model of its slopes, whose bins meet at the mirror direction."""
    with tempfile.TemporaryDirectory() as folder:
        common = ["--spacing", "1", "--seed", str(seed), "--quiet"]
        path = f"{folder}/map.npy"
        execute([program, "generate", "--smoothness", "10", "--tau", "4", "--size", "128", *common, "-o", path])
        options = "--border periodic --material mirror --theta 30 --rays 20000 --bins 9x12 --models smith --no-plots --threads 1"
        execute([program, "trace", path, *options.split(), *common, "-o", f"{folder}/out"])
        return p_value(f"{folder}/out")


def p_of_verify(program, seed):
    """p value of Gaussian surfaces so gentle that the model of single scattering is right."""
    with tempfile.TemporaryDirectory() as folder:
        options = "--smoothness 20 --tau 4 --size 64 --spacing 1 --theta 30 --material mirror --bins 9x12 --estimator plain"
        effort = f"--realisations {SURFACES} --rays 32000 --models smith --no-plots --threads 1 --quiet"
        execute([program, "verify", *options.split(), *effort.split(), "--seed", str(seed), "-o", folder])
        return p_value(folder)


def p_value(folder):
    summary = json.loads((Path(folder) / "summary.json").read_text())
    return summary["comparison"]["models"][0]["single"]["p"]


def uniform(p):
    """Median, Kolmogorov's distance from a uniform distribution, and percentages below .05 and .01."""
    p, n = sorted(p), len(p)
    distance = max(max((i + 1) / n - x, x - i / n) for i, x in enumerate(p))
    below = lambda level: 100 * sum(x < level for x in p) / n
    return f"{p[n // 2]:.2f}, {distance:.3f} (95 %: {1.36 / math.sqrt(n):.3f}), {below(0.05):.1f}, {below(0.01):.1f}"


def cases_table(program, seeds, pool):
    """Totals, rings and bins of random surfaces."""
    kinds = ("totals", "rings", "bins")
    print("| s, n, theta | totals | rings | bins |\n|---|---|---|---|")
    print("| Student, 31 degrees of freedom | 1.07, 5.4, 0.53 | 1.07, 5.4, 0.53 | 1.07, 5.4, 0.53 |")
    everything = {kind: [] for kind in kinds}
    for case in CASES:
        runs = list(pool.map(lambda seed: run(program, case, seed), seeds))
        z = {kind: deviations(runs, kind) for kind in kinds}
        for kind in kinds:
            everything[kind] += z[kind]
        smoothness, eta, theta = case
        print(f"| {smoothness}, {eta}, {theta} | " + " | ".join(described(z[kind]) for kind in kinds) + " |", flush=True)
    print("| all | " + " | ".join(described(everything[kind]) for kind in kinds) + " |")


def few_table(program, seeds, pool):
    """Every column with an error, of runs of few rays and few surfaces."""
    print("| run | table | column | variance of z, % beyond 2, beyond 3 |\n|---|---|---|---|")
    for name, (arguments, wanted) in FEW.items():
        runs = list(pool.map(lambda seed: columns(program, arguments, wanted, seed), seeds))
        for table, column in runs[0]:
            z = deviations(runs, (table, column))
            print(f"| {name} | {table} | {column} | {described(z) if z else '-'} |", flush=True)


def p_table(program, seeds, pool):
    """p values of models that are right."""
    print("| command | median, distance from uniform, % below .05, .01 |\n|---|---|")
    for name, p in (("trace --models smith", p_of_trace), ("verify --models smith", p_of_verify)):
        found = list(pool.map(lambda seed: p(program, seed), seeds))
        print(f"| {name} | {uniform(found)} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default="target/release/asperity")
    parser.add_argument("--seeds", type=int, default=60)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--tables", default="1,2,3")
    options = parser.parse_args()
    if options.seeds < LEAST_RESULTS:
        parser.error(f"--seeds {options.seeds}: {LEAST_RESULTS} are needed at least")

    seeds = range(1, options.seeds + 1)
    with ThreadPoolExecutor(options.jobs) as pool:
        tables = [cases_table, few_table, p_table]
        for number, table in enumerate(tables, 1):
            if str(number) in options.tables.split(","):
                table(options.program, seeds, pool)
                print()


if __name__ == "__main__":
    main()
