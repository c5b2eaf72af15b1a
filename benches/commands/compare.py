"""Whole commands of two programs: processor time of one thread, in interleaved pairs.

    python3 benches/commands/compare.py OLD NEW [--pairs 7] [COMMAND..]

Prints, for each command, the median seconds of both programs, the median of the ratios old / new, and their quartiles. Files are written into
a temporary folder. Needs Python alone, on Linux or macOS.
"""

import argparse
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

# Surfaces that commands read: file, and arguments of `generate`.
SURFACES = {
    "1024.npy": ["--size", "1024"],
    "2048.npy": ["--size", "2048"],
    "4096.npy": ["--size", "4096"],
}

COMMANDS = {
    "first_look": ["verify", EXAMPLES / "first_look.toml"],
    "verify": "verify --smoothness 2 --theta 30 --realisations 16 --rays 1600000".split(),
    "verify_rough": "verify --smoothness 1 --realisations 100 --models none --no-plots".split(),
    "map": ["map", EXAMPLES / "small_map.toml"],
    "gonio": ["gonio", EXAMPLES / "small_gonio.toml"],
    "trace": "trace 1024.npy --rays 1e6".split(),
    "trace_models": "trace 1024.npy --rays 1e6 --models smith,heitz".split(),
    "trace_start": "trace 4096.npy --rays 1000 --no-plots".split(),
    "inspect": "inspect 2048.npy".split(),
    "render": "render 1024.npy --size 240x160 --samples 16".split(),
    "generate_npy": "generate --size 4096".split(),
    "generate_exr": "generate --size 4096".split(),
}

# Endings of commands that write a file in place of a folder.
ENDINGS = {"render": ".png", "generate_npy": ".npy", "generate_exr": ".exr"}


def seconds(program, arguments, folder, output):
    """Processor time of one run, user and system."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    call = [program, *arguments, "--threads", "1", "-o", output]
    done = subprocess.run(call, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, call))}\n{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("programs", nargs=2, type=Path, metavar=("OLD", "NEW"), help="programs, the old one first")
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=", ".join(COMMANDS))
    parser.add_argument("--pairs", type=int, default=7)
    options = parser.parse_intermixed_args()
    programs = [path.resolve() for path in options.programs]
    print(f"{'command':13} {'old s':>7} {'new s':>7} {'ratio':>6}  quartiles")
    with tempfile.TemporaryDirectory() as folder:
        for file, arguments in SURFACES.items():
            seconds(programs[0], ["generate", *arguments], folder, file)
        for name in options.commands or COMMANDS:
            # A folder of its own for each run, which would resume another
            output = f"{name}_{{}}{ENDINGS.get(name, '')}".format
            runs = [
                [seconds(program, COMMANDS[name], folder, output(2 * pair + i)) for i, program in enumerate(programs)]
                for pair in range(options.pairs)
            ]
            ratios = [old / new for old, new in runs]
            old, new = (statistics.median(times) for times in zip(*runs))
            first, _, third = statistics.quantiles(ratios, n=4)
            print(f"{name:13} {old:7.3f} {new:7.3f} {statistics.median(ratios):6.2f}  {first:.2f} to {third:.2f}", flush=True)


if __name__ == "__main__":
    main()
