"""Files of `asperity export`, opened by programs that are not ours. ASPERITY names the program."""

import csv
import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pyradiance
import pytest
import pywincalc
import xarray
from pyradiance import bsdf

SLAB = "gonio --smoothness 20 --tau 16um --eta 1.5 --thickness 1mm --rays 2e4 --realisations 2 --no-plots --quiet"


def asperity(folder, line):
    program = Path(os.environ["ASPERITY"]).resolve()
    subprocess.run([program, *line.split()], cwd=folder, check=True)


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def klems(tmp_path_factory):
    folder = tmp_path_factory.mktemp("klems")
    light = "--from both --light-spread klems --theta 0,10,20,30,40,50,60,70,82.5 --bins 36x120"
    asperity(folder, f"{SLAB} {light} -o out")
    asperity(folder, "export out --format klems -o slab.xml --quiet")
    return folder


def test_xarray_opens_netcdf_without_options(tmp_path):
    asperity(tmp_path, f"{SLAB} --from both --theta 0,40 -o out")
    asperity(tmp_path, "export out --format netcdf -o out.nc --quiet")
    data = xarray.open_dataset(tmp_path / "out.nc")
    expected = ("from", "theta_i", "phi_i", "side", "theta_o", "phi_o")
    assert data.bsdf.dims == expected
    assert data.bsdf.attrs["units"] == "sr-1"
    assert data.bsdf.attrs["ancillary_variables"] == "bsdf_se"
    one = data.sel({"from": "below", "side": "transmitted"}).sel(theta_i=40)
    measured = [row for row in rows(tmp_path / "out/gonio.csv") if row["from"] == "below"]
    assert float(one.flux[0]) == float(measured[1]["transmitted"])
    theta, phi = (np.radians(data[f"{name}_bounds"].values) for name in ("theta_o", "phi_o"))
    band = 0.5 * (np.sin(theta[:, 1]) ** 2 - np.sin(theta[:, 0]) ** 2)
    weight = band[:, None] * (phi[:, 1] - phi[:, 0])[None, :]
    integral = (data.bsdf * weight).sum(("theta_o", "phi_o"))
    assert np.allclose(integral, data.flux, rtol=0, atol=1e-12)


def test_radiance_finds_the_light_of_both_sides(klems):
    place = Path(pyradiance.__file__).parent
    environment = {**os.environ, "RAYPATH": f".:{place / 'lib'}"}
    check = [place / "bin/checkBSDF", "./slab.xml"]
    done = subprocess.run(check, cwd=klems, env=environment, capture_output=True, text=True, check=True)
    assert "Type: Klems_Full" in done.stdout, done.stdout + done.stderr
    found = dict(re.findall(r"^(.* (?:Refl|Trans)).*?([\d.]+)%", done.stdout, re.MULTILINE))
    measured = rows(klems / "out/gonio.csv")
    for name, side, column in [
        ("Interior Refl", "above", "reflected"),
        ("Exterior Refl", "below", "reflected"),
        ("Int->Ext Trans", "above", "transmitted"),
        ("Ext->Int Trans", "below", "transmitted"),
    ]:
        most = max(float(row[column]) for row in measured if row["from"] == side)
        assert float(found[name]) == pytest.approx(100 * most, abs=0.1), done.stdout


def test_radiance_sees_light_straight_on_and_mirrored(klems):
    data = bsdf.load_file(str(klems / "slab.xml"))
    for phi in (0.0, 54.0):
        straight, back = (bsdf.query(data, 30.0, phi, 150.0, phi + turn)[1] for turn in (180.0, 0.0))
        assert straight > 100 * back
        mirrored, back = (bsdf.query(data, 30.0, phi, 30.0, phi + turn)[1] for turn in (180.0, 0.0))
        assert mirrored > 100 * back


def test_pywincalc_parses_the_file(klems):
    product = pywincalc.parse_bsdf_xml_file(str(klems / "slab.xml"))
    assert product.thickness == pytest.approx(0.001)
