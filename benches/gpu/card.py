"""A GPU next to the CPU engine: equality, rates, and a card without free memory, with date, card and driver.

    python3 benches/gpu/card.py [-o LOG] [--program PROGRAM]

Runs `cargo bench -p asperity-gpu --bench card`, or a program that `cargo bench -p asperity-gpu --bench card --no-run` has built on another
machine, which takes at most ten minutes. Prints what it says, and writes it to LOG too. Needs Python alone; where there is no GPU it says so.
"""

import argparse
import datetime
import subprocess
import sys
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
BENCH = ["cargo", "bench", "-q", "-p", "asperity-gpu", "--bench", "card"]
CARD = ["nvidia-smi", "--query-gpu=name,driver_version,memory.total", "--format=csv,noheader"]


def card():
    """Names of the cards, their drivers and memory, in a sentence."""
    try:
        done = subprocess.run(CARD, capture_output=True, text=True)
    except FileNotFoundError:
        return "no NVIDIA driver is installed"
    return "; ".join(done.stdout.split("\n")).strip("; ") or "nvidia-smi lists no GPU"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", dest="log", type=Path, help="file to write")
    parser.add_argument("--program", type=Path, help="benchmark that was built before, in place of cargo")
    options = parser.parse_args()
    lines = []

    def say(line):
        print(line, end="", flush=True)
        lines.append(line)

    commit = subprocess.run(["git", "rev-parse", "--short=8", "HEAD"], cwd=REPOSITORY, capture_output=True, text=True)
    now = datetime.datetime.now(datetime.timezone.utc)
    say(f"{now:%Y-%m-%d %H:%M} UTC, commit {commit.stdout.strip() or 'unknown'}; {card()}\n\n")
    call = [options.program.resolve()] if options.program else BENCH
    with subprocess.Popen(call, cwd=REPOSITORY, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as run:
        for line in run.stdout:
            say(line)
    if options.log:
        options.log.write_text("".join(lines))
    sys.exit(run.returncode)


if __name__ == "__main__":
    main()
