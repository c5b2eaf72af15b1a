"""Plugins of examples/mitsuba in Mitsuba: sampling, energy and reciprocity. ASPERITY names the program."""

import csv
import importlib
import os
import subprocess
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "examples/mitsuba"))
# Compiled variants of Mitsuba need it; older versions cannot compile the minima of floating-point numbers
LLVM = sorted(Path("/usr/lib").glob("*/libLLVM-17.so")) + sorted(Path("/usr/lib").glob("*/libLLVM.so.[12][0-9].*"))
if LLVM:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(LLVM[-1]))
NO_LLVM = "libLLVM of version 17 or later is not installed (apt-get install libllvm19)"
VARIANTS = ["scalar_rgb", pytest.param("llvm_ad_rgb", marks=pytest.mark.skipif(not LLVM, reason=NO_LLVM))]
ETA = 1.4


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Measurements of a rough interface, `glass`, and of a slab, `pane`."""
    program = Path(os.environ["ASPERITY"]).resolve()
    folder = tmp_path_factory.mktemp("mitsuba")
    common = "--from both --rays 2e4 --realisations 2 --no-plots --quiet"
    for line in (
        f"gonio --smoothness 3 --eta {ETA} --theta 0:80:20 --bins 45x72 {common} -o glass",
        f"gonio --smoothness 3 --eta {ETA} --theta 0,40,80 --bins 18x36 --thickness 200 {common} -o pane",
        *(f"export {name} --format netcdf -o {name}.nc --quiet" for name in ("glass", "pane")),
    ):
        subprocess.run([program, *line.split()], cwd=folder, check=True)
    return folder


def export(folder, flags):
    """A measurement with few rays as `out.nc`."""
    program = Path(os.environ["ASPERITY"]).resolve()
    line = f"gonio --eta {ETA} {flags} --rays 200 --realisations 1 --no-plots --quiet -o out"
    for line in (line, "export out --format netcdf -o out.nc --quiet"):
        subprocess.run([program, *line.split()], cwd=folder, check=True)


def plugin(variant, description):
    mi.set_variant(variant)
    sys.modules.pop("asperity_bsdf", None)
    importlib.import_module("asperity_bsdf")
    return mi.load_dict(description)


def table(variant, folder, name="glass"):
    return plugin(variant, {"type": "asperity_table", "filename": str(folder / f"{name}.nc")})


def direction(theta, phi):
    theta, phi = np.radians(theta), np.radians(phi)
    return [float(x) for x in (np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta))]


def seen_from(wi):
    point = dr.zeros(mi.SurfaceInteraction3f)
    point.wi = mi.Vector3f(wi)
    return point


def values(bsdf, wi, towards, mode="Radiance"):
    """What `eval` returns for rows of `towards`."""
    context = mi.BSDFContext(getattr(mi.TransportMode, mode))
    if "scalar" in mi.variant():
        return np.array([bsdf.eval(context, seen_from(wi), mi.Vector3f(one))[0] for one in towards.tolist()])
    return np.array(bsdf.eval(context, seen_from(wi), mi.Vector3f(np.float32(towards.T))).x)


def sphere(count):
    """Directions of equal projected solid angle, `2 pi / len` each, of both hemispheres: the upper one first."""
    turns = (np.arange(count) + 0.5) / count
    projected = np.sqrt(turns)
    azimuths = 2 * np.pi * ((np.arange(count) * 0.6180339887498949) % 1)
    upper = np.array([projected * np.cos(azimuths), projected * np.sin(azimuths), np.sqrt(1 - turns)]).T
    return np.concatenate([upper, upper * [1, 1, -1]])


def measured_flux(folder, name, source, theta, side):
    with open(folder / name / "gonio.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if (row["from"], float(row["theta_i_deg"])) == (source, theta)]
    return float(rows[0][side])


@pytest.mark.parametrize("variant", VARIANTS)
def test_integral_of_eval_is_the_measured_flux(folder, variant):
    towards = sphere(3000)
    # A sum over 3000 points of lobes that are wider than 0.2
    for name, eta in (("glass", ETA), ("pane", 1.0)):
        bsdf = table(variant, folder, name)
        for source, polar in (("above", 40), ("below", 140)):
            light = values(bsdf, direction(polar, 70), towards, "Importance") / np.abs(towards[:, 2]) * np.pi / 3000
            upper, lower = light[:3000].sum(), light[3000:].sum()
            reflected, transmitted = (upper, lower) if source == "above" else (lower, upper)
            assert reflected == pytest.approx(measured_flux(folder, name, source, 40, "reflected"), rel=0.01)
            assert transmitted == pytest.approx(measured_flux(folder, name, source, 40, "transmitted"), rel=0.01)
            radiance = values(bsdf, direction(polar, 70), towards) / np.abs(towards[:, 2]) * np.pi / 3000
            scale = eta**-2 if source == "above" else eta**2
            side = radiance[3000:] if source == "above" else radiance[:3000]
            assert side.sum() == pytest.approx(transmitted * scale, rel=1e-4)


@pytest.mark.parametrize("variant", VARIANTS)
def test_eval_is_the_measured_bsdf(folder, variant):
    bsdf = table(variant, folder)
    with open(folder / "glass/bsdf.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["theta_i_deg"] == "40"]
    for setting, source in enumerate(("above", "below")):
        of_source = [row for row in rows if row["setting"] == str(setting)]
        angles = np.array([[float(row["theta_o_deg"]), float(row["phi_o_deg"])] for row in of_source])
        towards = np.array([direction(theta, phi + 70) for theta, phi in angles])
        towards *= [1, 1, 1 if source == "above" else -1]
        expected = np.abs(towards[:, 2]) * [float(row["bsdf"]) for row in of_source]
        found = values(bsdf, direction(40 if source == "above" else 140, 70), towards, "Importance")
        # Interpolation between bins smooths their noise: 1.4 % of the light from above, 4 % from below, at three seeds
        solid_angles = np.sin(np.radians(angles[:, 0]))
        assert np.sum(solid_angles * np.abs(found - expected)) < 0.06 * np.sum(solid_angles * expected), source


@pytest.mark.parametrize("variant", VARIANTS)
def test_samples_have_the_weights_of_eval_and_pdf(folder, variant):
    bsdf, context, random = table(variant, folder), mi.BSDFContext(), np.random.default_rng(1).random((200, 3))
    cases = [(direction(theta, 20), u) for theta in (0.0, 33.0, 85.0, 120.0, 179.0) for u in random.tolist()]
    if "scalar" not in variant:
        cases = [[np.float32(part).T for part in zip(*cases)]]
    for wi, u in cases:
        point = seen_from(wi)
        sample, weight = bsdf.sample(context, point, mi.Float(u[0]), mi.Point2f(u[1], u[2]), True)
        value, pdf = bsdf.eval_pdf(context, point, sample.wo, True)
        # Floats give directions to 1e-6, near the horizon to 1e-3
        assert dr.allclose(pdf, sample.pdf, rtol=1e-2)
        assert dr.allclose(value[0], weight[0] * pdf, rtol=1e-5)
        # Nothing is absorbed, and radiance scales by the square of the index
        assert dr.allclose(weight[0] * sample.eta**2, 1, atol=1e-4)


@pytest.mark.parametrize("variant", VARIANTS)
def test_transmission_is_reciprocal(folder, variant):
    """Of measured directions of the light, between which interpolation is no more than a guess, to the noise of both: 0.5 % at two seeds."""
    bsdf = table(variant, folder)
    angles = [(above, below, turn) for above, below in ((20, 20), (40, 20), (40, 40), (60, 40)) for turn in (165, 180, 195)]
    pairs = [(direction(above, 0), direction(180 - below, turn)) for above, below, turn in angles]
    there = [values(bsdf, above, np.array([below]))[0] / abs(below[2]) for above, below in pairs]
    back = [values(bsdf, below, np.array([above]), "Importance")[0] / abs(above[2]) for above, below in pairs]
    assert np.sum(there) == pytest.approx(np.sum(back), rel=0.02)


@pytest.mark.skipif(not LLVM, reason=NO_LLVM)
@pytest.mark.parametrize("kind", ["asperity_table", "xu_sun"])
@pytest.mark.parametrize("polar", [30, 125])
def test_samples_follow_their_density(folder, tmp_path, monkeypatch, kind, polar):
    # Where Mitsuba leaves the histograms of a test that fails
    monkeypatch.chdir(tmp_path)
    of_kind = {"asperity_table": {"filename": str(folder / "glass.nc")}, "xu_sun": {"s": 3.0, "eta": ETA}}
    description = {"type": kind, **of_kind[kind]}
    plugin("llvm_ad_rgb", description)
    sample, pdf = mi.chi2.BSDFAdapter(kind, description, wi=direction(polar, 20))
    test = mi.chi2.ChiSquareTest(mi.chi2.SphericalDomain(), sample, pdf, sample_dim=3, sample_count=200000, res=61, ires=12)
    assert test.run(), test.messages


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("name", ["glass", "pane"])
def test_white_furnace(folder, variant, name):
    """A ball that absorbs nothing, lit from all around, is invisible."""
    table(variant, folder, name)
    size, spp = (6, 16) if "scalar" in variant else (32, 64)
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1, "rr_depth": 200},
        "light": {"type": "constant"},
        "ball": {"type": "sphere", "bsdf": {"type": "asperity_table", "filename": str(folder / f"{name}.nc")}},
        "camera": {
            "type": "perspective",
            "fov": 28,
            "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
        },
    })
    image = np.array(mi.render(scene, spp=spp, seed=1))[..., 0]
    error = float(image.std()) / image.shape[0]
    # Beside its noise, what the measurement loses to the end of long paths, 1e-5 per interaction
    assert image.mean() == pytest.approx(1.0, abs=4 * error + 5e-4), error
    assert error < 0.02


def test_model_has_the_published_energy():
    """Eq. 25, integrated over all directions, for light from 30 degrees: by the same equations in another program."""
    for s, expected in ((3.0, 0.958038), (1.0, 0.597)):
        model = plugin("scalar_rgb", {"type": "xu_sun", "s": s, "eta": ETA})
        towards = sphere(20000)[20000:]
        light = values(model, direction(30, 0), towards, "Importance") / np.abs(towards[:, 2]) * np.pi / 20000
        assert light.sum() == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize(
    "flags, reason",
    [
        ("--theta 0,40", "measure with --bins"),
        ("--theta 40 --bins 9x18", "needs two or more"),
        ("--theta 0,40 --bins 9x18 --tau 16 --sigma 4 --tau-y 4", "--light-azimuth random"),
        ("--theta 0,40 --bins 9x18 --stokes 1,1,0,0", "without --stokes"),
        ("--theta 0,40 --bins 9x18 --light-spread 5", "without --light-spread"),
        ("--theta 0,40 --bins 9x18 --thickness 100 --bottom mirror", "no light leaves"),
        ("--theta 0,40 --bins 9x18 --phi 0,90", "--phi 0"),
        ("--theta 0,40 --bins 9x18 --phi 5", "--phi 0"),
        ("--theta 0,40 --bins 9x18 --side reflected", "--side both"),
    ],
)
def test_files_that_do_not_suffice_are_refused(tmp_path, flags, reason):
    shape = "" if "--tau" in flags else "--smoothness 3"
    sides = "" if "mirror" in flags else "--from both"
    export(tmp_path, f"{shape} {flags} {sides}")
    with pytest.raises(Exception, match=reason):
        table("scalar_rgb", tmp_path, "out")


def test_media_are_those_of_the_sample(tmp_path):
    export(tmp_path, "--smoothness 3 --from both --theta 0,40,80 --bins 9x18 --thickness 100 --bottom-eta 1.2")
    assert table("scalar_rgb", tmp_path, "out").eta == pytest.approx(1.2 * ETA)


def test_a_sculpture_is_closed():
    meshes = importlib.import_module("meshes")
    vertices, triangles = meshes.sculpture("bust")
    meshes.check(vertices, triangles)
    assert len(triangles) > 20000
    with pytest.raises(ValueError, match="not closed"):
        meshes.check(vertices, triangles[1:])
    with pytest.raises(ValueError, match="inside out"):
        meshes.check(vertices, triangles[:, ::-1])
