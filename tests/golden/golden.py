#!/usr/bin/env python3
"""Golden files: results of every example configuration and of runs that cover the rest, compared between two builds.

golden.py run PROGRAM FOLDER     runs all cases with a program; writes a folder per case and a digest of each file
golden.py compare OLD NEW        compares two such folders byte by byte, machine-dependent members aside
golden.py digest FOLDER          prints the digest of every compared file, one per line

What depends on the machine or on the time (seconds, threads, instructions, commit) is left out, as are figures in PNG,
checkpoints, result files and manifests. Numbers that differ are reported with the largest difference per column. It stands
outside of the test suite: about three minutes on two cores. Run it from the root of the repository.
"""

import csv
import hashlib
import io
import json
import os
import subprocess
import sys

EXAMPLES = {
    "first_look": ("verify", "--rays 1e5"),
    "brushed": ("verify", "--rays 5e4 --size 128 --tau 24 --tau-y 6"),
    "gold": ("verify", "--rays 5e4"),
    "target_error": ("verify", "--max-time 1h"),
    "pyramids": ("verify", ""),
    "polarised": ("verify", "--rays 5e4 --model-rays 1e5"),
    "visibility": ("attenuation", "--realisations 2 --no-plots"),
    "transmission_paper_fig_7": ("verify", "--rays 2e4 --realisations 8 --size 128"),
    "transmission_paper_figs_5_6_8_9": ("verify", "--rays 2e4 --realisations 8 --size 128 --no-plots"),
    "trace_ripples": ("trace", "--rays 5e4"),
    "terrain_sun": ("gonio", "--rays 5e4"),
    "small_gonio": ("gonio", "--rays 2e4"),
    "translucent_matrix": ("gonio", "--rays 2e3 --realisations 4 --theta 0,50 --no-plots"),
    "small_map": ("map", ""),
    "validity_map": ("map", "--rays 1e4 --realisations 8 --size 64 --tau 8 --theta 0,60 --smoothness 2,8 --no-plots"),
    "geometric_attenuation": ("attenuation", "--realisations 2 --no-plots"),
    "converge": ("converge", "--size 128 --rays 256 --surfaces 2,4 --repeats 2 --reference-rays 256 --reference-surfaces 8"),
    "converge_roughness": ("converge", "--size 128 --rays 256 --surfaces 2,4 --repeats 2 --reference-rays 256 --reference-surfaces 8 --no-plots"),
    "converge_spacing": ("converge", "--size 256 --rays 256 --surfaces 2,4 --repeats 2 --reference-rays 256 --reference-surfaces 8 --no-plots"),
}
SMALL = "--size 64 --tau 8"
TRANSLUCENT = "gonio examples/translucent_matrix.toml --mean-free-path 0.1 --realisations 4"
RUNS = {
    "translucent_albedo": f"{TRANSLUCENT} --albedo 0.3,0.6,0.9,0.99 --theta 70 --rays 2e4",
    "translucent_low_bumps": f"{TRANSLUCENT} --smoothness 18 --theta 60 --bins 30x72 --rays 1e4",
    "translucent_phase": f"{TRANSLUCENT} --g=-0.5,0,0.5,0.8 --theta 70 --rays 2e4 --no-plots",
    "given": "generate --tau 6 --smoothness 2 --size 128 --seed 3 -o {out}/h.exr",
    "open": "trace {given}/h.exr --border open --theta 40 --rays 3e4",
    "mirrored": "trace {given}/h.exr --border mirrored --theta 40 --rays 3e4 --models smith,smith-slopes",
    "smooth_given": "trace {given}/h.exr --cells smooth --theta 20 --rays 3e4",
    "refined": "trace {given}/h.exr --refine --theta 40 --rays 3e4",
    "trace_target": "trace {given}/h.exr --theta 30 --target-error 0.05",
    "trace_layer": "trace {given}/h.exr --theta 30 --rays 2e4 --mean-free-path 5 --albedo 0.9 --thickness 30 --bottom-surface same --bottom interface",
    "trace_stokes": "trace {given}/h.exr --theta 60 --rays 2e4 --polarisation both --stokes 1,0.5,0.2,0.1",
    "trace_mueller": "trace {given}/h.exr --theta 60 --rays 2e4 --polarisation mueller",
    "mesh": "mesh {given}/h.exr -o {out}/h.ply",
    "trace_mesh": "trace {mesh}/h.ply --theta 30 --rays 2e4 --eta 1.5",
    "below": f"verify {SMALL} --smoothness 2 --from below --theta 20 --rays 4e4 --realisations 8",
    "conductor": f"verify {SMALL} --smoothness 2,4 --material conductor --eta 0.2 --kappa 3 --theta 0,70 --rays 4e4 --realisations 8",
    "lambertian": f"verify {SMALL} --smoothness 1.5 --material lambertian --reflectance 0.8 --theta 40 --rays 4e4 --realisations 8",
    "grazing": f"verify {SMALL} --smoothness 4 --material lambertian --reflectance 0.001 --theta 88 --rays 4e4 --realisations 8 --models none",
    "verify_layer": f"verify {SMALL} --smoothness 3 --theta 30 --mean-free-path 5 --albedo 0.9 --thickness 30 --rays 2e4 --realisations 8",
    "structure": f"verify --structure pyramids --size 64 --theta 30 --rays 2e4 --realisations 8 --models none",
    "ggx": f"verify --slopes ggx --ggx-alpha 0.3,0.5 --size 256 --theta 30 --rays 2e4 --realisations 32",
    "verify_target": f"verify {SMALL} --smoothness 2,3 --theta 30 --target-error 0.03",
    "verify_flux_target": f"verify {SMALL} --smoothness 2 --theta 30,60 --target-error 1e-3 --of reflected",
    "verify_mueller": f"verify {SMALL} --smoothness 2 --theta 40 --polarisation mueller --rays 2e4 --realisations 8",
    "verify_both": f"verify {SMALL} --smoothness 2 --theta 40 --polarisation both --rays 2e4 --realisations 8",
    "verify_refine": f"verify {SMALL} --smoothness 2 --theta 40 --refine --rays 2e4 --realisations 8",
    "verify_one": f"verify {SMALL} --smoothness 2 --theta 40 --rays 2e4 --realisations 1",
    "verify_smooth_plain": f"verify {SMALL} --smoothness 30 --theta 40 --target-error 1e-3",
    "albedo": "albedo --alpha 0.3,1 --cosines 3 --eta 1.33,1.5 --rays 2e3 --realisations 4",
    "gonio_given": "gonio --surface {given}/h.exr --directions 3x4 --rays 1e4",
    "gonio_many": f"gonio {SMALL} --smoothness 2,40 --theta 0,30,60 --material mirror --rays 1e4 --realisations 4",
    "gonio_grooves": f"gonio --size 128 --tau 16 --tau-y 4 --sigma 2 --theta 30 --phi 0,90 --rays 1e4 --realisations 4",
    "map_target": f"map {SMALL} --smoothness 2,4 --theta 0,50 --eta 1.5,1/1.5 --models smith,heitz --target-error 0.05",
    "map_both": f"map {SMALL} --smoothness 2,4 --theta 0,50 --models smith --polarisation both --rays 1e4 --realisations 8",
    "model": "model smith --smoothness 2 --theta 30 -o {out}/m.csv",
}
VOLATILE_KEYS = {"seconds", "seconds_min", "seconds_max", "generate_seconds", "build_seconds", "trace_seconds", "setup_seconds", "error_at_one_second",
                 "threads", "instructions", "commit", "version", "dirty", "results_epoch", "epoch", "rustc", "target"}
VOLATILE_PARTS = ("seconds", "efficienc", "speedup", "slope", "fit", "times_longer", "cost")
CONVERGE = ("converge", "converge_roughness", "converge_spacing")
SKIPPED_FOLDERS = {"checkpoints", "cells"}


def run(program, folder):
    program = os.path.abspath(program)
    cases = {name: f"{command} examples/{name}.toml {more}" for name, (command, more) in EXAMPLES.items()} | RUNS
    failed = 0
    for name, line in cases.items():
        out = os.path.join(folder, name)
        os.makedirs(out, exist_ok=True)
        places = {other: os.path.join(folder, other) for other in RUNS} | {"out": out}
        has_output = "{out}" in line
        words = line.format(**places).split()
        words = words if has_output else [*words, "-o", out]
        done = subprocess.run([program, *words], capture_output=True, text=True)
        with open(os.path.join(out, "stdout.txt"), "w") as file:
            file.write(done.stdout.replace(folder, "FOLDER"))
        if done.returncode != 0:
            failed += 1
            print(f"{name}: exit code {done.returncode}: {done.stderr.strip()}")
    print(f"{len(cases)} cases, {failed} failed")
    return failed


def steady(value):
    """A JSON value without what depends on machine or time."""
    if isinstance(value, dict):
        return {key: steady(one) for key, one in value.items()
                if key not in VOLATILE_KEYS and not any(part in key for part in VOLATILE_PARTS)}
    if isinstance(value, list):
        return [steady(one) for one in value]
    return value


def content(path, folder):
    with open(path, "rb") as file:
        data = file.read()
    name = os.path.basename(path)
    if name == "stdout.txt" or name == "report.txt":
        lines = data.decode().splitlines()
        if any(f"/{case}/" in path for case in CONVERGE):
            return b""
        kept = [line for line in lines if not line.startswith("results in ") and " M segments/s" not in line
                and not (" s" in line and ("traced in" in line or "segments" in line))]
        return "\n".join(kept).encode()
    if name.endswith(".json"):
        text = json.dumps(steady(json.loads(data)), indent=1)
        return text.replace(folder, "FOLDER").encode()
    if name.endswith(".csv"):
        rows = list(csv.reader(io.StringIO(data.decode())))
        keep = [i for i, key in enumerate(rows[0]) if not any(part in key for part in VOLATILE_PARTS)]
        return "\n".join(",".join(row[i] for i in keep) for row in rows).encode()
    return data.replace(folder.encode(), b"FOLDER")


def compared(folder):
    """Relative path and content of every file that is compared."""
    out = {}
    for place, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name not in SKIPPED_FOLDERS)
        for name in sorted(names):
            path = os.path.join(place, name)
            relative = os.path.relpath(path, folder)
            kept = not name.endswith((".png", ".npz", ".journal")) and name != "manifest.json"
            checkpoint = os.sep + "directions" + os.sep in path and name.endswith(".json")
            timed = relative.split(os.sep)[0] in CONVERGE and name.endswith(".svg")
            if kept and not checkpoint and not timed:
                out[relative] = content(path, folder)
    return out


def numbers(text):
    words = text.replace(",", " ").replace("[", " ").replace("]", " ").split()
    found = []
    for word in words:
        try:
            found.append(float(word.strip('"')))
        except ValueError:
            pass
    return found


def compare(old, new):
    a, b = compared(old), compared(new)
    different = 0
    for name in sorted(a.keys() | b.keys()):
        if name not in a or name not in b:
            different += 1
            print(f"{name}: only in {'the new' if name not in a else 'the old'}")
        elif a[name] != b[name]:
            different += 1
            note = ""
            if not name.endswith((".npy", ".exr")):
                x, y = numbers(a[name].decode(errors="replace")), numbers(b[name].decode(errors="replace"))
                if len(x) == len(y):
                    worst = max((abs(p - q) for p, q in zip(x, y)), default=0.0)
                    note = f": numbers differ by at most {worst:.2e}"
                else:
                    note = f": {len(x)} numbers, now {len(y)}"
            print(f"{name}{note}")
    print(f"{len(a)} files, {different} differ")
    return different


def main():
    if sys.argv[1:2] == ["run"] and len(sys.argv) == 4:
        return run(sys.argv[2], sys.argv[3])
    if sys.argv[1:2] == ["compare"] and len(sys.argv) == 4:
        return compare(sys.argv[2], sys.argv[3])
    if sys.argv[1:2] == ["digest"] and len(sys.argv) == 3:
        for name, data in compared(sys.argv[2]).items():
            print(hashlib.md5(data).hexdigest(), name)
        return 0
    print(__doc__)
    return 2


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
