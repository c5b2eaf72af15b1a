#!/usr/bin/env python3
"""Compares asperity with other ray tracers on the same height fields, and prints one Markdown table.

Each program traces the same number of rays on one thread. The programs take turns, so that what else the machine does
falls on all of them alike; figures are medians over the turns. README.md says what is counted and how to install the others.
"""

import argparse
import datetime
import json
import math
import os
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
BUILD = ROOT / "target" / "peers"
ASPERITY = ROOT / "target" / "release" / "asperity"

SIDE = 2048  # rays along either side of the tile
RAYS = SIDE * SIDE
BRANCHINGS = ["pick", "split"]
# What programs that do the same work may differ by
MAX_DEVIATION = 4.0  # of the reflected flux, in standard errors
MAX_EXCESS = 0.01  # of segments per ray, relative


class Failed(Exception):
    """A program that does not run; its text says why in one sentence."""


@dataclass(frozen=True)
class Task:
    """Light on one surface: the peer that traces it, and the angles of incidence in degrees."""

    peer: str
    size: int
    smoothness: int
    thetas: tuple

    def heights(self):
        return BUILD / f"heights_{self.size}_s{self.smoothness}.npy"


TASKS = [
    Task("Embree", 1024, 6, (30, 70)),
    Task("Embree", 1024, 2, (30, 70)),
    Task("Embree", 1024, 1, (30, 70)),
    Task("Mitsuba", 512, 2, (0, 60)),
]


@dataclass
class Run:
    """Turns of one program at one task and angle."""

    build: list = field(default_factory=list)
    segments: list = field(default_factory=list)  # per second
    rays: list = field(default_factory=list)  # per second
    per_ray: list = field(default_factory=list)
    reflected: list = field(default_factory=list)
    variance: list = field(default_factory=list)

    def add(self, turn):
        rays, seconds = turn["rays"], turn["trace_seconds"]
        self.build.append(turn["build_seconds"])
        self.segments.append(turn["segments"] / seconds)
        self.rays.append(rays / seconds)
        self.per_ray.append(turn["segments"] / rays)
        self.reflected.append(turn["reflected"])
        self.variance.append(turn["variance"])

    def reflectance(self):
        """Mean of the turns and its variance."""
        turns = len(self.reflected)
        return sum(self.reflected) / turns, sum(self.variance) / turns**2


def execute(command, **options):
    """Output of a program; the last line on its standard error if it fails."""
    try:
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, **options)
    except OSError as error:
        raise Failed(f"{command[0]} does not start: {error.strerror}") from error
    if done.returncode != 0:
        lines = done.stderr.strip().splitlines() or [f"{command[0]} ended with status {done.returncode}"]
        raise Failed(lines[-1])
    return done.stdout


def trace_asperity(branching, task, seed, versions):
    """Traces with every tally. Segments include those that are known to escape without a search."""
    for theta in task.thetas:
        command = [ASPERITY, "trace", task.heights(), "--eta", 1.5, "--theta", theta, "--rays", RAYS, "--seed", seed]
        # The peers average s and p at every facet.
        command += ["--estimator", "plain", "--branching", branching, "--polarisation", "averaged"]
        # The file states no border; the peers continue the tile.
        command += ["--border", "periodic"]
        command += ["--threads", 1, "--json", "--quiet"]
        summary = json.loads(execute(command))
        work, reflected = summary["work"], summary["energy"]["reflected"]
        versions["asperity"] = f"{summary['version']} ({summary['commit'][:7]}, {work['instructions']})"
        yield {
            "build_seconds": work["build_seconds"],
            "trace_seconds": work["trace_seconds"],
            "rays": work["rays"],
            "segments": work["segments"] + work["segments_skipped"],
            "reflected": reflected["mean"],
            "variance": reflected["se"] ** 2,
        }


def trace_peer(task, seed, versions):
    """Traces with a peer, whose Dr.Jit finds no kernel that an earlier run has compiled."""
    command = {"Embree": [BUILD / "embree"], "Mitsuba": [sys.executable, HERE / "mitsuba_paths.py"]}[task.peer]
    with tempfile.TemporaryDirectory() as home:
        lines = execute([*command, task.heights(), seed, SIDE, *task.thetas], env=os.environ | {"HOME": home})
    for turn in map(json.loads, lines.splitlines()):
        versions[task.peer] = turn["version"]
        if "compile_seconds" in turn:
            versions["compiling"].append(turn["compile_seconds"])
        reflected = turn["reflected"] / turn["rays"]
        yield turn | {"reflected": reflected, "variance": reflected * (1 - reflected) / turn["rays"]}


def compile_embree():
    command = ["g++", "-std=c++17", "-O3", "-march=native", HERE / "embree.cpp", "-lembree3", "-o", BUILD / "embree"]
    try:
        execute(command)
    except Failed as error:
        raise Failed("embree.cpp does not compile: install g++ and Embree 3 (Debian: libembree-dev)") from error


def prepare():
    """Draws the surfaces and compiles. Returns the tasks that can be done, and what cannot by peer."""
    BUILD.mkdir(parents=True, exist_ok=True)
    for task in TASKS:
        command = [ASPERITY, "generate", "--tau", 16, "--smoothness", task.smoothness, "--size", task.size]
        execute([*command, "--seed", 1, "--quiet", "-o", task.heights()])
    left_out = {}
    try:
        compile_embree()
    except Failed as error:
        left_out["Embree"] = str(error)
    return left_out


def take_turns(turns, left_out, versions):
    """Runs all programs at all tasks, in another order each turn. Returns runs by task, program and angle."""
    runs = {}
    for turn in range(turns):
        for number, task in enumerate(TASKS):
            if task.peer in left_out:
                continue
            # asperity's random numbers are functions of seed, path and step: no two tasks share them
            seed = 1 + turn * len(TASKS) + number
            programs = [task.peer, *BRANCHINGS]
            for program in programs[turn % 3 :] + programs[: turn % 3]:
                print(f"turn {turn + 1} of {turns}: N = {task.size}, s = {task.smoothness}, {program}", file=sys.stderr)
                is_peer = program == task.peer
                trace = trace_peer(task, seed, versions) if is_peer else trace_asperity(program, task, seed, versions)
                try:
                    for theta, measured in zip(task.thetas, trace):
                        runs.setdefault((task, program, theta), Run()).add(measured)
                except Failed as error:
                    if not is_peer:
                        raise
                    left_out[task.peer] = str(error)
                    break
    return {key: run for key, run in runs.items() if key[0].peer not in left_out}


def deviation(run, other):
    """Difference of the reflected fluxes in standard errors."""
    (mean, variance), (other_mean, other_variance) = run.reflectance(), other.reflectance()
    return (mean - other_mean) / math.sqrt(variance + other_variance)


def row(runs, task, program):
    """One program at one task, its angles side by side."""
    cases = [(runs[task, program, theta], runs[task, task.peer, theta], runs[task, "pick", theta]) for theta in task.thetas]

    def ratio(kind):
        return [median(a / b for a, b in zip(getattr(run, kind), getattr(peer, kind))) for run, peer, _ in cases]

    def cell(form, values):
        return " / ".join(format(value, form) for value in values)

    name = program if program == task.peer else f"asperity, {program}"
    return [
        f"{task.size} | {task.smoothness} | {cell('d', task.thetas)}",
        name,
        format(median(t for run, _, _ in cases for t in run.build), ".2g"),
        cell(".2f", [median(run.segments) / 1e6 for run, _, _ in cases]),
        cell(".2f", ratio("segments")),
        cell(".2f", [median(run.rays) / 1e6 for run, _, _ in cases]),
        cell(".2f", ratio("rays")),
        cell(".3f", [median(run.per_ray) for run, _, _ in cases]),
        cell(".5f", [run.reflectance()[0] for run, _, _ in cases]),
        "" if program == "pick" else cell("+.1f", [deviation(run, pick) for run, _, pick in cases]),
    ]


def check(runs):
    """Fails if a peer does other work than `pick`."""
    for (task, program, theta), run in runs.items():
        if program != task.peer:
            continue
        pick = runs[task, "pick", theta]
        is_same_light = abs(deviation(run, pick)) <= MAX_DEVIATION
        if not is_same_light or abs(median(run.per_ray) / median(pick.per_ray) - 1) > MAX_EXCESS:
            sys.exit(f"{task.peer} does other work than asperity at s = {task.smoothness}, theta = {theta}: see R and z")


def processor():
    """Name of the processor and its widest vector instructions."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    values = {key.strip(): value.strip() for key, _, value in (line.partition(":") for line in lines)}
    flags = values.get("flags", "").split()
    widest = next((name for flag, name in [("avx512f", "AVX-512"), ("avx2", "AVX2")] if flag in flags), "no AVX2")
    identity = ", ".join(f"{key} {values[key]}" for key in ["cpu family", "model"] if key in values)
    return f"{values.get('model name', 'unknown processor')} ({identity}, {widest})"


def report(runs, turns, left_out, versions):
    if not runs:
        sys.exit("nothing to compare: " + "; ".join(left_out.values()))
    compiling = versions.pop("compiling")
    print(f"{datetime.date.today()}, {processor()}, one thread each, {RAYS} rays, medians over {turns} turn{'s' * (turns > 1)}.")
    print("; ".join(f"{name} {version}" for name, version in versions.items()) + ".\n")
    print("| N | s | theta | program | build s | 10^6 segments per s | ratio | 10^6 rays per s | ratio | segments per ray | R | z |")
    print("|" + "---|" * 12)
    for task in dict.fromkeys(task for task, _, _ in runs):
        for program in [task.peer, *BRANCHINGS]:
            print("| " + " | ".join(row(runs, task, program)) + " |")
    print("\nRatios are to the peer. z: difference of R, the reflected flux, to `pick`, in standard errors.")
    if compiling:
        print(f"Mitsuba's kernels take another {median(compiling):.1f} s to compile, once per process.")
    for peer, reason in left_out.items():
        print(f"Left out: {peer}: {reason}.")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--turns", type=int, default=5, help="turns of each program (default: 5)")
    turns = parser.parse_args().turns
    if turns < 1:
        parser.error("--turns must be at least 1")
    versions = {"compiling": []}
    try:
        left_out = prepare()
        runs = take_turns(turns, left_out, versions)
    except Failed as error:
        sys.exit(f"asperity: {error}")
    report(runs, turns, left_out, versions)
    check(runs)


if __name__ == "__main__":
    main()
