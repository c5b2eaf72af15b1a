"""Recipes of docs/recipes.md: their commands with few rays, then their Python as it stands. ASPERITY names the program."""

import os
import re
import subprocess
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs/recipes.md"
SECTIONS = PAGE.read_text().split("\n## ")[1:]


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.splitlines()[0])
def test_python_of_recipes_runs(section, tmp_path, monkeypatch):
    program = Path(os.environ["ASPERITY"]).resolve()
    monkeypatch.chdir(tmp_path)
    scan = "generate --tau 8um --sigma 1um --size 64 --seed 7 -o scan.x3p"
    lines = [line for block in re.findall(r"```sh\n(.*?)```", section, re.DOTALL) for line in block.splitlines()]
    for line in [f"asperity {scan}", *lines]:
        few = ""
        if line.startswith(("asperity gonio", "asperity albedo")):
            few = "--no-plots --rays " + ("1e4" if "--surface" in line else "1e3 --realisations 2")
        subprocess.run([program, *f"{line} {few} --quiet".split()[1:]], check=True)
    for block in re.findall(r"```python\n(.*?)```", section, re.DOTALL):
        exec(block, {})
