"""Recipes of docs/recipes/exports.md: their commands with few rays, then their Python as it stands, and what it found. ASPERITY names the program."""

import csv
import os
import re
import subprocess
from pathlib import Path

import mitsuba
import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs/recipes/exports.md"
SECTIONS = PAGE.read_text().split("\n## ")[1:]


def reflected(folder, theta, phi):
    """Measured reflectance of light from a direction."""
    with open(f"{folder}/gonio.csv", newline="") as file:
        found = (row for row in csv.DictReader(file) if (float(row["theta_i_deg"]), float(row["phi_i_deg"])) == (theta, phi))
        return float(next(found)["reflected"])


def check_netcdf(names):
    light = names["data"].flux.sel(side="reflected", theta_i=40, phi_i=90)
    assert float(light) == reflected("bsdf", 40, 90)


def check_numpy(names):
    assert (names["bsdf"] * names["weight"]).sum() == pytest.approx(reflected("arrays", 40, 0), rel=1e-9)


def check_film(names):
    through, scattered = (names["bsdf"].query(names["film"], 30, 0, 150, turn)[1] for turn in (180, 0))
    assert through > 10 * scattered


def check_glass(names):
    # Slopes of the surface have a deviation of about sqrt(2) sigma / tau, and alpha is sqrt(2) times that
    alpha = names["transmitted"][names["law"]]["parameters"]["alpha"]
    assert alpha == pytest.approx(0.25, rel=0.3)


def check_gold(names):
    point = mitsuba.SurfaceInteraction3f()
    point.wi = mitsuba.Vector3f(0.5, 0, np.sqrt(0.75))
    red, green, blue = names["gold"].eval(mitsuba.BSDFContext(), point, mitsuba.Vector3f(-0.5, 0, np.sqrt(0.75)))
    assert red > green > 1.5 * blue > 0


def check_energy(names):
    ratio = names["reflected"] / names["single"]
    assert ratio.min() > 0.9 and ratio[-1].max() > 1.1


CHECKS = {
    "How do I use measured rough glass in Mitsuba or pbrt?": check_glass,
    "How do I use measured rough metal in Mitsuba or pbrt?": check_gold,
    "How do I make a Klems matrix of a film for WINDOW or Radiance?": check_film,
    "How do I read a BRDF in xarray, as NetCDF?": check_netcdf,
    "How do I read a BRDF as NumPy arrays?": check_numpy,
    "How do I compensate the energy that microfacet models lose without multiple scattering?": check_energy,
}


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
    names = {}
    for block in re.findall(r"```python\n(.*?)```", section, re.DOTALL):
        exec(block, names)
    if names:
        CHECKS[section.splitlines()[0]](names)
