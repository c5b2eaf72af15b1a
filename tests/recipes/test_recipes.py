"""Recipes of docs/recipes: their commands and Python as they stand, and what these print.

ASPERITY names the program, PYTHONPATH the folder of the Python package. With UPDATE_DOCS=1 the pages get what is printed
(without -n, so that one process writes a page).
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# tests/foreign and tests/program run exports.md, which takes other programs and more rays
PAGES = sorted({*ROOT.glob("docs/recipes/*.md")} - {ROOT / "docs/recipes/README.md", ROOT / "docs/recipes/exports.md"})
RECIPES = [(page, heading) for page in PAGES for heading in re.findall(r"^## (.*)", page.read_text(), re.MULTILINE)]


def blocks(text):
    """Blocks of a page: its kind, sh, python or text, and its lines."""
    return re.findall(r"^```(sh|python|text)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def fits(printed, expected):
    """Whether a text is the expected one, in which `...` stands for any lines."""
    pattern = re.escape(expected).replace(re.escape("...\n"), r"(?:.*\n)*")
    return re.fullmatch(pattern, printed)


def shortened(printed, old):
    """A text with as many lines before and after the gap as the old one has."""
    if "...\n" not in old:
        return printed
    lines, before, after = printed.splitlines(True), *(part.count("\n") for part in old.split("...\n"))
    return "".join([*lines[:before], "...\n", *lines[len(lines) - after :]])


def test_index_lists_every_recipe():
    index = (ROOT / "docs/recipes/README.md").read_text()
    exports = re.findall(r"^## (.*)", (ROOT / "docs/recipes/exports.md").read_text(), re.MULTILINE)
    assert [heading for heading in [*exports, *(heading for _, heading in RECIPES)] if f"[{heading}](" not in index] == []


@pytest.fixture
def run(tmp_path):
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin/asperity").symlink_to(Path(os.environ["ASPERITY"]).resolve())
    (tmp_path / "work").mkdir()
    path = f"{tmp_path / 'bin'}:{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "CLONE": str(ROOT), "MPLBACKEND": "Agg"}

    def run(kind, code):
        command = {"sh": ["bash", "-euc", code], "python": [sys.executable, "-c", code]}[kind]
        done = subprocess.run(command, cwd=tmp_path / "work", env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return re.sub(r" +$", "", done.stdout, flags=re.MULTILINE)

    return run


@pytest.mark.parametrize(("page", "heading"), RECIPES, ids=[f"{page.stem}: {heading}" for page, heading in RECIPES])
def test_recipe_prints_what_it_says(page, heading, run):
    head, *sections = re.split(r"^(?=## )", page.read_text(), flags=re.MULTILINE)
    section = next(section for section in sections if section.startswith(f"## {heading}\n"))
    of_recipe = blocks(section)
    assert of_recipe[-1][0] == "text", "a recipe ends in what it prints"
    for kind, code in blocks(head) + of_recipe:
        if kind != "text":
            printed = run(kind, code)
        elif os.environ.get("UPDATE_DOCS"):
            new = section.replace(f"```text\n{code}```", f"```text\n{shortened(printed, code)}```")
            page.write_text(page.read_text().replace(section, new))
            section = new
        else:
            assert fits(printed, code), f"printed:\n{printed}\nexpected:\n{code}"
