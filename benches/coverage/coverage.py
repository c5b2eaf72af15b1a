"""Coverage of standard errors: how often results of many seeds lie two or three of their errors off, and p values of models that are right.

    python3 benches/coverage/coverage.py PROGRAM --jobs 16 --seeds 1:60 --tables cases,few,pictures,p -o FOLDER > coverage.md

Each result is compared with the mean of the results of the other seeds: z = (x_i - mean) / sqrt(se_i^2 + se_mean^2). Its variance should be
that of Student's distribution with one degree of freedom less than there are surfaces, or passes of a picture.

| table | runs |
|---|---|
| cases | 24 cases of `verify` on random surfaces: totals, rings, and bins of 20 rays and more |
| few | `verify` where few rays or few surfaces carry the light: every column with an error, bins of few rays included |
| pictures | `render`: pixels, means of blocks of pixels, and means of whole pictures |
| p | p values of `trace` and `verify` where the model is right, which should be uniform |

Tables are printed as Markdown, and written as FOLDER/TABLE.csv; the processor time of each row goes to standard error. Python's standard
library is enough.
"""

import argparse
import array
import csv
import itertools
import json
import math
import resource
import struct
import subprocess
import sys
import tempfile
import zlib
from functools import partial
from multiprocessing import Pool
from pathlib import Path

SURFACES = 32
# Least number of results of one place, over the seeds, that are compared with each other
LEAST_RESULTS = 3

EFFORT = "--no-plots --threads 1 --quiet"
VERIFY = f"verify --realisations {SURFACES} --models none {EFFORT} -o {{folder}}"
CASES = {
    f"{s}, {n}, {theta}": f"{VERIFY} --smoothness {s} --eta {n} --theta {theta} --rays 100000 --bins 18x36"
    for s, n, theta in itertools.product(["0.5", "1", "2", "4"], ["1.5", "1/1.5"], ["10", "40", "70"])
}

COARSE = f"{VERIFY} --rays 32000 --bins 6x12 --theta 30"
SMALL = f"{COARSE} --size 64 --tau 4 --spacing 1"
ORDERS = ("flux", "flux_order_1", "flux_order_2", "flux_order_3", "flux_order_4_and_above")
SPLIT = {"theta": ORDERS, "in_plane": ORDERS, "histogram": ("flux", "flux_single", "flux_multiple")}
# Runs of which every column is tried: arguments, tables and columns
FEW = {
    "glass": (f"{SMALL} --smoothness 1", SPLIT),
    "a medium": (
        f"{SMALL} --smoothness 2 --mean-free-path 4 --albedo 0.9 --thickness 12 --bottom absorbing",
        {"theta": ("flux_unscattered", "flux_once", "flux_more"), "histogram": ("flux_once", "flux_more")},
    ),
    "Mueller ratios": (
        f"{SMALL} --smoothness 3 --polarisation mueller",
        {"mueller": ("flux", "m10", "m11", "m12", "m21", "m33"), "mueller_theta": ("m10", "m11", "m33")},
    ),
    "tracked less averaged, out of glass": (
        f"{SMALL} --smoothness 3 --eta 1/1.5 --polarisation both",
        {"histogram": ("flux_tracked_less_averaged",), "theta": ("flux_tracked_less_averaged",)},
    ),
    "V grooves of rare light": (
        f"{COARSE} --structure v-grooves --randomness 0.5 --width 16 --spacing 1 --size 256x64",
        SPLIT,
    ),
    "GGX slopes": (f"{COARSE} --size 128 --tau 4 --spacing 1 --slopes ggx --ggx-alpha 0.3 --insist", SPLIT),
}

SURFACE = "generate --smoothness 3 --tau 4 --size 64 --spacing 1 --seed 1 --quiet -o {folder}/map.npy"
RENDER = "render {folder}/map.npy --spacing 1 --border periodic --size 48x32 --samples 16 --threads 1 --quiet -o {folder}/picture.exr"
SEQUENCES = 4
PICTURES = {
    "glass under the sky": f"{RENDER} --sun 0 --sky 1",
    "a mirror under the sun": f"{RENDER} --material mirror",
    "a matt surface under a small sun": f"{RENDER} --material lambertian --reflectance 0.5 --sun-radius 0.27",
    "a medium below glass": f"{RENDER} --mean-free-path 4 --albedo 0.9 --thickness 12",
}
BLOCK = 8

GAUSSIAN = "generate --smoothness 10 --tau 4 --size 128 --spacing 1 --quiet --seed {seed} -o {folder}/map.npy"
PITS = "generate --structure pits --width 12 --depth 0.15 --size 128 --spacing 1 --insist --quiet --seed {seed} -o {folder}/map.npy"
TRACE = f"trace {{folder}}/map.npy --border periodic --spacing 1 --theta 30 --rays 20000 {EFFORT} -o {{folder}}/out"
GENTLE = f"verify --realisations {SURFACES} --estimator plain --bins 9x12 {EFFORT} -o {{folder}}/out"
MIRROR = "--material mirror"
# Commands whose last one compares a model that is right
TRUE_MODELS = {
    "trace: smith, bins that meet at the mirror direction": (GAUSSIAN, f"{TRACE} {MIRROR} --bins 9x12 --models smith"),
    "trace: smith, bins around the lobe": (GAUSSIAN, f"{TRACE} {MIRROR} --models smith"),
    "trace: smith, glass": (GAUSSIAN, f"{TRACE} --eta 1.5 --bins 9x12 --models smith"),
    "trace: smith-slopes, pits between level facets": (PITS, f"{TRACE} {MIRROR} --bins 9x12 --models smith-slopes"),
    "verify: smith": (
        f"{GENTLE} --smoothness 20 --tau 4 --size 64 --spacing 1 --theta 30 {MIRROR} --rays 32000 --models smith",
    ),
    "verify: heitz, which follows rays": (
        f"{GENTLE} --smoothness 20 --tau 4 --size 64 --spacing 1 --theta 30 --eta 1.5 --rays 32000 --models heitz --model-rays 32000",
    ),
    "verify: smith-slopes of GGX": (
        f"{GENTLE} --slopes ggx --ggx-alpha 0.02 --tau 6 --size 128 --spacing 1 --insist --theta 20 {MIRROR} --rays 32000 --models smith-slopes",
    ),
    "verify: smith-slopes, pits between level facets": (
        f"{GENTLE} --structure pits --width 12 --depth 0.15 --size 64 --spacing 1 --insist --theta 30 {MIRROR} --rays 32000 --models smith-slopes",
    ),
}


class RunError(Exception):
    """A command that failed, with what it said."""


def execute(program, command, folder, seed):
    """Runs a command of the program; `{seed}` in it is the seed, which is appended where there is none."""
    if "--seed" not in command:
        command += " --seed {seed}"
    words = [word.format(folder=folder, seed=seed) for word in command.split()]
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    if done.returncode:
        raise RunError(f"{' '.join(words)}: {done.stderr}")


def table(folder, name):
    with open(Path(folder) / f"{name}.csv", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def estimates(rows, name):
    """Value and error of a column by row, where it has both."""
    known = ((i, row) for i, row in enumerate(rows) if row[name] and row[f"{name}_se"])
    return {i: (float(row[name]), float(row[f"{name}_se"])) for i, row in known}


def of_case(program, case, seed):
    """Totals, rings and bins of a run."""
    with tempfile.TemporaryDirectory() as folder:
        execute(program, CASES[case], folder, seed)
        energy = json.loads((Path(folder) / "summary.json").read_text())["energy"]
        totals = {side: (energy[side]["mean"], energy[side]["se"]) for side in ("reflected", "transmitted")}
        rings = {i: (x, se) for i, (x, se) in estimates(table(folder, "theta"), "flux").items() if se > 0}
        rows = table(folder, "histogram")
        # Bins are averaged with their mirror images: one of both is enough.
        kept = {i for i, row in enumerate(rows) if row["few_rays"] == "no" and float(row["phi_min_deg"]) < 180}
        bins = {i: found for i, found in estimates(rows, "flux").items() if i in kept}
        return {"totals": totals, "rings": rings, "bins": bins}


def of_few(program, run, seed):
    """All columns of a run that are tried, by table and column."""
    command, wanted = FEW[run]
    with tempfile.TemporaryDirectory() as folder:
        execute(program, command, folder, seed)
        tables = {name: table(folder, name) for name in wanted}
        return {(name, column): estimates(tables[name], column) for name in wanted for column in wanted[name]}


def channels(path):
    """Channels of a picture, which are of single precision in blocks of 16 lines, compressed by ZIP."""
    data = path.read_bytes()
    at, header = 8, {}
    while data[at]:
        name, kind, _ = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        size = struct.unpack_from("<i", data, at)[0]
        header[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    names = [name for name in (b"A", b"Y", b"error") if name + b"\0" in header[b"channels"]]
    left, top, right, bottom = struct.unpack("<4i", header[b"dataWindow"])
    width, lines = right - left + 1, bottom - top + 1
    blocks = -(-lines // 16)
    found = {name: array.array("f") for name in names}
    for (offset,) in struct.iter_unpack("<q", data[at + 1 : at + 1 + 8 * blocks]):
        first, size = struct.unpack_from("<2i", data, offset)
        count = min(16, bottom + 1 - first)
        raw = data[offset + 8 : offset + 8 + size]
        if size < 4 * width * count * len(names):
            raw = unfiltered(zlib.decompress(raw))
        for line in range(count):
            for number, name in enumerate(names):
                start = 4 * width * (line * len(names) + number)
                found[name].frombytes(raw[start : start + 4 * width])
    return width, {name.decode(): values for name, values in found.items()}


def unfiltered(data):
    """Bytes before the differences and the halves of ZIP compression in EXR."""
    values, last = bytearray(len(data)), 0
    for i, byte in enumerate(data):
        last = byte if i == 0 else (last + byte - 128) & 255
        values[i] = last
    half = (len(values) + 1) // 2
    out = bytearray(len(values))
    out[0::2], out[1::2] = values[:half], values[half:]
    return bytes(out)


def of_picture(program, picture, seed):
    """Pixels, blocks of pixels and the mean of a picture, with errors as of independent pixels."""
    with tempfile.TemporaryDirectory() as folder:
        execute(program, SURFACE, folder, seed)
        execute(program, PICTURES[picture], folder, seed)
        width, found = channels(Path(folder) / "picture.exr")
    pixels = list(zip(found["Y"], found["error"]))

    def mean(some):
        error = math.sqrt(math.fsum(se * se for _, se in some))
        return math.fsum(x for x, _ in some) / len(some), error / len(some)

    blocks = {}
    for i, pixel in enumerate(pixels):
        blocks.setdefault((i // width // BLOCK, i % width // BLOCK), []).append(pixel)
    return {
        "pixels": {i: pixel for i, pixel in enumerate(pixels) if pixel[1] > 0},
        "blocks": {place: mean(some) for place, some in blocks.items()},
        "picture": {0: mean(pixels)},
    }


def p_value(program, test, seed):
    """The p value of single scattering of the model; `None` if nothing could be tested."""
    with tempfile.TemporaryDirectory() as folder:
        for command in TRUE_MODELS[test]:
            execute(program, command, folder, seed)
        summary = json.loads((Path(folder) / "out" / "summary.json").read_text())
    return summary["comparison"]["models"][0]["single"].get("p")


def deviations(runs, kind):
    """z of every result that half of the seeds have."""
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
    if not z:
        return ["", "", "", 0]
    beyond = [100 * sum(abs(x) > limit for x in z) / len(z) for limit in (2, 3)]
    return [f"{math.fsum(x * x for x in z) / len(z):.2f}", f"{beyond[0]:.1f}", f"{beyond[1]:.2f}", len(z)]


SPREAD = ["variance of z", "% beyond 2", "% beyond 3", "results"]
KINDS = ("totals", "rings", "bins")
PARTS = ("pixels", "blocks", "picture")


def student(freedom):
    """What errors of `freedom + 1` surfaces or sequences should show, by integration of Student's density."""
    log = math.lgamma((freedom + 1) / 2) - math.lgamma(freedom / 2) - math.log(freedom * math.pi) / 2
    density = lambda t: math.exp(log - (freedom + 1) / 2 * math.log1p(t * t / freedom))
    step = 1e-3
    beyond = lambda limit: 100 * (1 - 2 * step * math.fsum(density((i + 0.5) * step) for i in range(round(limit / step))))
    return [f"{freedom / (freedom - 2):.2f}", f"{beyond(2):.1f}", f"{beyond(3):.2f}", ""]


def uniform(p):
    """Median, Kolmogorov's distance from a uniform distribution with its limit at 95 %, and percentages below .05 and .01."""
    p = sorted(x for x in p if x is not None)
    n = len(p)
    if not n:
        return ["", "", "", "", "", 0]
    distance = max(max((i + 1) / n - x, x - i / n) for i, x in enumerate(p))
    below = [100 * sum(x < level for x in p) / n for level in (0.05, 0.01)]
    return [f"{p[n // 2]:.2f}", f"{distance:.3f}", f"{1.36 / math.sqrt(n):.3f}", f"{below[0]:.1f}", f"{below[1]:.1f}", n]


def cases_table(runs):
    yield ["s, n, theta", "kind", *SPREAD]
    yield ["Student", "any", *student(SURFACES - 1)]
    everything = {kind: [] for kind in KINDS}
    for case in CASES:
        found = runs(of_case, case)
        for kind in KINDS:
            z = deviations(found, kind)
            everything[kind] += z
            yield [case, kind, *described(z)]
    for kind in KINDS:
        yield ["all", kind, *described(everything[kind])]


def few_table(runs):
    yield ["run", "column", *SPREAD]
    yield ["Student", "any", *student(SURFACES - 1)]
    for run in FEW:
        found = runs(of_few, run)
        for kind in found[0] if found else ():
            yield [run, ": ".join(kind), *described(deviations(found, kind))]


def pictures_table(runs):
    yield ["picture", "mean over", *SPREAD]
    yield ["Student", "a pixel", *student(SEQUENCES - 1)]
    for picture in PICTURES:
        found = runs(of_picture, picture)
        for part in PARTS:
            yield [picture, part, *described(deviations(found, part))]


def p_table(runs):
    yield ["command and model", "median", "distance from uniform", "of which 95 % lie below", "% below .05", "% below .01", "runs"]
    for test in TRUE_MODELS:
        yield [test, *uniform(runs(p_value, test))]


TABLES = {"cases": cases_table, "few": few_table, "pictures": pictures_table, "p": p_table}


def seed_range(text):
    first, _, count = text.rpartition(":")
    return range(int(first or 1), int(first or 1) + int(count))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program", nargs="?", default="target/release/asperity")
    parser.add_argument("--seeds", type=seed_range, default=seed_range("1:60"), help="FIRST:COUNT, or COUNT from 1")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time, one thread each")
    parser.add_argument("--tables", default=",".join(TABLES))
    parser.add_argument("-o", "--output", type=Path, default=Path("coverage"), help="folder of the CSV files")
    options = parser.parse_args()
    names = options.tables.split(",")
    if unknown := [name for name in names if name not in TABLES]:
        parser.error(f"--tables {','.join(unknown)}: {', '.join(TABLES)} are allowed")
    if len(options.seeds) < LEAST_RESULTS:
        parser.error(f"--seeds: {LEAST_RESULTS} are needed at least")
    options.output.mkdir(parents=True, exist_ok=True)

    with Pool(options.jobs) as pool:

        def runs(of, name):
            found = pool.map(partial(timed, of, options.program, name), options.seeds, chunksize=1)
            seconds = sum(time for _, time in found) / len(found)
            print(f"{name}: {seconds:.2f} s of processor time per seed", file=sys.stderr, flush=True)
            kept = [one for one, _ in found if not isinstance(one, RunError)]
            for error in (one for one, _ in found if isinstance(one, RunError)):
                print(f"{name}: left out: {error}", file=sys.stderr, flush=True)
            return kept

        for name in names:
            with open(options.output / f"{name}.csv", "w", newline="", encoding="utf-8") as file:
                writer = csv.writer(file)
                for number, row in enumerate(TABLES[name](runs)):
                    writer.writerow(row)
                    print("| " + " | ".join(map(str, row)) + " |", flush=True)
                    if number == 0:
                        print("|---" * len(row) + "|")
            print()


def timed(of, program, name, seed):
    """What a run shows, or why it failed, and the processor time of its commands."""
    used = lambda: sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])
    before = used()
    try:
        result = of(program, name, seed)
    except RunError as error:
        result = error
    return result, used() - before


if __name__ == "__main__":
    main()
