"""Examples: every script of examples/python runs with few rays and finds what it says it finds, and tutorials become notebooks."""

import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

import asperity as asp

EXAMPLES = Path(__file__).parents[3] / "examples/python"
RAYS = 20_000


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Runs a script with few rays in an empty folder; returns its names."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ASPERITY_RAYS", str(RAYS))
    monkeypatch.setenv("MPLBACKEND", "Agg")

    def run(name, *packages):
        for package in packages:
            pytest.importorskip(package, reason=f"the package {package} is not installed")
        return runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__")

    yield run
    if "matplotlib.pyplot" in sys.modules:
        sys.modules["matplotlib.pyplot"].close("all")


TUTORIALS = ("height_map_to_brdf", "which_model_holds", "spectra_of_a_metal", "how_an_error_falls")
ADAPTERS = ("mitsuba_bsdf", "surface_topography", "optiland_scatter")
# The picture of README takes minutes and is drawn by hand
FIGURES = ("atlas", "lobe_solids")
pytestmark = pytest.mark.filterwarnings("ignore:FigureCanvasAgg is non-interactive")


def test_every_script_is_run():
    assert {path.stem for path in EXAMPLES.glob("*.py")} == {*TUTORIALS, *ADAPTERS, *FIGURES}


@pytest.mark.parametrize("name", TUTORIALS)
def test_tutorials_become_notebooks(name, tmp_path):
    jupytext = pytest.importorskip("jupytext", reason="the package jupytext is not installed")
    nbformat = pytest.importorskip("nbformat", reason="the package nbformat is not installed")
    jupytext.write(jupytext.read(EXAMPLES / f"{name}.py"), tmp_path / "tutorial.ipynb")
    notebook = nbformat.read(tmp_path / "tutorial.ipynb", as_version=4)
    nbformat.validate(notebook)
    first, *others = notebook.cells
    assert first.cell_type == "markdown" and first.source.startswith("# ")
    assert {cell.cell_type for cell in others} == {"markdown", "code"} and len(others) > 5
    assert notebook.metadata.kernelspec.language == "python"


def test_height_map_to_brdf(run, tmp_path):
    names = run("height_map_to_brdf", "matplotlib", "pandas")
    assert names["scan"].missing == 300 and names["surface"].missing == 0
    level, filtered = names["table"]["level"], names["table"]["S-filter 2.5 µm"]
    # Noise of 20 nm adds its own variance of slopes, which the filter removes
    assert filtered["sq"] == pytest.approx(level["sq"], rel=0.02) and filtered["sdq"] < 0.95 * level["sdq"]
    assert filtered["sq"] == pytest.approx(0.8, rel=0.15)
    result, sample = names["result"], names["sample"]
    assert abs(result.reflected - sample.reflected) < 5 * np.hypot(result.reflected_se, sample.reflected_se)
    folder = tmp_path / "height_map_to_brdf"
    assert "ScatterType  BRDF" in (folder / "aluminium_brdf.bsdf").read_text()
    assert (folder / "aluminium.html").read_text().startswith("<!")


def test_which_model_holds(run):
    names = run("which_model_holds", "matplotlib", "pandas", "xarray")
    verdicts, energy = names["verdicts"], names["energy"]
    distances = verdicts[(verdicts.model == "smith") & (verdicts.light == "single")].set_index("smoothness").distance
    assert distances[2] > distances[4] > distances[8]
    assert set(verdicts[(verdicts.model == "heitz") & (verdicts.light == "all orders")].verdict) == {"rejected"}
    # Smith's masking is right to 1 % on smooth surfaces, and what several facets reflect is missing
    assert energy["one facet"][8] == pytest.approx(energy["Smith"][8], rel=0.02)
    assert (energy["all"] > energy["Smith"] * 1.04).all() and (abs(energy["Heitz"] / energy["all"] - 1) < 0.06).all()
    theta, brdf, error = names["plane_of"](4)
    model = names["smith_at"](4, theta)
    near = (theta > 40) & (theta < 70)
    assert near.sum() >= 4 and np.all(np.abs(brdf - model)[near] < 0.03 * model[near] + 5 * error[near])


def test_spectra_of_a_metal(run):
    names = run("spectra_of_a_metal", "matplotlib", "pandas", "xarray")
    flat, light, error = names["flat"], names["light"], names["error"]
    assert light.sizes["wavelength"] == len(names["WAVELENGTHS"]) and bool((error < 0.01).all())
    # A flat surface of the same gold, traced
    traced = names["asp"].trace(flat=True, material="gold", wavelength=500, theta=names["THETA"], rays=1000)
    assert float(flat.sel(wavelength=500)) == pytest.approx(float(traced.reflected), rel=1e-4)
    assert bool((light < flat).all())
    # Light of several facets is redder
    table = names["table"]
    single, several = (table[name][460] / table[name][640] for name in ("reflected_single", "reflected_multiple"))
    assert several < 0.6 * single


def test_how_an_error_falls(run):
    names = run("how_an_error_falls", "matplotlib", "pandas")
    slopes = names["slopes"]
    assert slopes["controlled, 1024 rays per surface"] == pytest.approx(-0.5, abs=0.2)
    assert slopes["plain, 1024 rays per surface"] == pytest.approx(-0.5, abs=0.2)
    assert 0 < names["error"] < 1.06 * names["TARGET"]
    plain, controlled = (group.error.to_numpy() for _, group in sorted(names["table"].groupby("estimator"), reverse=True))
    assert np.all(controlled < 0.2 * plain) and np.all(np.diff(plain) < 0)


def test_mitsuba_bsdf(run):
    names = run("mitsuba_bsdf", "mitsuba", "xarray")
    for angle, measured, error, rendered, noise in names["rows"]:
        assert abs(rendered - measured) < 4 * np.hypot(error, noise), angle
        assert noise < 0.005
    # The lobe, with the light turned by 70 degrees, to what interpolation between cells changes
    mi, result, at = sys.modules["mitsuba"], names["result"], 3
    direction = names["asp"].models.direction
    point = names["dr"].zeros(mi.SurfaceInteraction3f)
    point.wi = mi.Vector3f(direction(45, 70).tolist())
    bsdf = mi.load_dict({"type": "rough_gold"})
    theta, phi = np.meshgrid(result.bins["theta"].mean(1), result.bins["phi"].mean(1), indexing="ij")
    towards = direction(theta, phi + 70).reshape(-1, 3).tolist()
    found = np.array([bsdf.eval(mi.BSDFContext(), point, mi.Vector3f(wo))[0] for wo in towards]).reshape(theta.shape)
    expected = result.brdf[at] * np.cos(np.radians(theta))
    weight = np.sin(np.radians(theta))
    assert np.sum(weight * np.abs(found - expected)) < 0.04 * np.sum(weight * expected)


def test_surface_topography(run):
    names = run("surface_topography", "SurfaceTopography")
    theirs, ours = np.transpose(names["heights"])
    # Points that are missing were interpolated
    np.testing.assert_allclose(ours, theirs, rtol=2e-3)
    scans, container = names["scans"], names["container"]
    assert all(scan.shape == (96, 128) and scan.unit == "um" and scan.spacing == (0.5, 0.5) for scan in scans)
    assert all(topography.has_undefined_data for topography in container)
    assert 0.8 < names["result"].reflected < 0.9165


def test_optiland_scatter(run):
    names = run("optiland_scatter", "optiland", "xarray")
    assert names["rays"].i.mean() == pytest.approx(names["result"].reflected[2], rel=1e-9)
    assert abs(names["mean"] - names["measured"]) < 4 * names["error"]
    # A mirror that is tilted by 30 degrees turns light by 60, and a lobe is spread about that
    mean = np.array([names["rays"].L.mean(), names["rays"].M.mean(), names["rays"].N.mean()])
    mean /= np.linalg.norm(mean)
    assert mean @ [0, np.sqrt(0.75), -0.5] > np.cos(np.radians(2))


def test_the_atlas_is_drawn_from_maps(run, tmp_path, monkeypatch):
    grid = dict(smoothness=[3, 10], theta=[0, 60], tau=4, size=32, realisations=8, rays=RAYS, bins="18x12")
    asp.map(**grid, models=["xu-sun", "smith", "v-cavity", "heitz"], model_rays=RAYS).save(tmp_path / "map")
    monkeypatch.setattr(sys, "argv", ["atlas.py", "map", "-o", "atlas.png", "--csv", "atlas.csv"])
    run("atlas", "matplotlib", "pandas")
    assert (tmp_path / "atlas.png").stat().st_size > 10_000
    # Cells, models and comparisons, below the names of columns
    assert len((tmp_path / "atlas.csv").read_text().splitlines()) == 1 + 4 * 4 * 2
