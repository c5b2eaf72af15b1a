"""Files of `asperity export`, opened by programs that are not ours. ASPERITY names the program."""

import csv
import os
import re
import subprocess
import sys
from pathlib import Path

import colour
import drjit
import mitsuba
import numpy as np
import pyradiance
import pytest
import pywincalc
import xarray

# Compiled variants of Mitsuba need it; older versions cannot compile the minima of floating-point numbers
LLVM = sorted(Path("/usr/lib").glob("*/libLLVM-17.so")) + sorted(Path("/usr/lib").glob("*/libLLVM.so.[12][0-9].*"))
if LLVM:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(LLVM[-1]))

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
    asperity(folder, f"{SLAB} --for klems --bins 36x120 -o out")
    asperity(folder, "export out --format klems -o slab.xml --quiet")
    return folder


def test_xarray_opens_netcdf_without_options(tmp_path):
    asperity(tmp_path, f"{SLAB} --from both --theta 0,40 -o out")
    asperity(tmp_path, "export out --format netcdf -o out.nc --quiet")
    data = xarray.open_dataset(tmp_path / "out.nc")
    expected = ("from", "theta_i", "phi_i", "side", "theta_o", "phi_o")
    assert data.bsdf.dims == expected
    assert data.bsdf.attrs["units"] == "sr-1"
    # What all cases share
    assert (float(data.bsdf.s), float(data.flux.eta)) == (20.0, 1.5)
    assert data.attrs["completeness"] == "4 of 4 directions"
    assert data.bsdf.attrs["ancillary_variables"] == "bsdf_se"
    one = data.sel({"from": "below", "side": "transmitted"}).sel(theta_i=40)
    measured = [row for row in rows(tmp_path / "out/gonio.csv") if row["from"] == "below"]
    assert float(one.flux[0]) == float(measured[1]["transmitted"])
    theta, phi = (np.radians(data[f"{name}_bounds"].values) for name in ("theta_o", "phi_o"))
    band = 0.5 * (np.sin(theta[:, 1]) ** 2 - np.sin(theta[:, 0]) ** 2)
    weight = band[:, None] * (phi[:, 1] - phi[:, 0])[None, :]
    integral = (data.bsdf * weight).sum(("theta_o", "phi_o"))
    assert np.allclose(integral, data.flux, rtol=0, atol=1e-12)
    # Errors are those of the tables
    assert float(one.flux_se[0]) == float(measured[1]["transmitted_se"])
    exact = data.sel({"from": "above", "side": "reflected"}).sel(theta_i=40).squeeze("phi_i")
    table = [row for row in rows(tmp_path / "out/bsdf.csv") if row["setting"] == "0" and row["side"] == "reflected"]
    expected = [float(row["bsdf_se"]) for row in table if row["theta_i_deg"] == "40"]
    found = (exact.bsdf_exact_se if "bsdf_exact_se" in data else exact.bsdf_se).values.ravel()
    assert np.allclose(found[np.isfinite(found)], expected, rtol=1e-12, atol=0)


def check_bsdf(folder, file):
    place = Path(pyradiance.__file__).parent
    environment = {**os.environ, "RAYPATH": f".:{place / 'lib'}"}
    check = [place / "bin/checkBSDF", f"./{file}"]
    done = subprocess.run(check, cwd=folder, env=environment, capture_output=True, text=True, check=True)
    return done.stdout + done.stderr


def test_radiance_finds_the_light_of_both_sides(klems):
    checked = check_bsdf(klems, "slab.xml")
    assert "Type: Klems_Full" in checked, checked
    found = dict(re.findall(r"^(.* (?:Refl|Trans)).*?([\d.]+)%", checked, re.MULTILINE))
    measured = rows(klems / "out/gonio.csv")
    for name, side, column in [
        ("Interior Refl", "above", "reflected"),
        ("Exterior Refl", "below", "reflected"),
        ("Int->Ext Trans", "above", "transmitted"),
        ("Ext->Int Trans", "below", "transmitted"),
    ]:
        most = max(float(row[column]) for row in measured if row["from"] == side)
        assert float(found[name]) == pytest.approx(100 * most, abs=0.1), checked


# Radiance keeps files by their names, and frees them while others still use them: a process of its own for every file
QUERY = """
import sys, numpy, pyradiance.bsdf
file, queries, values = sys.argv[1:]
data = pyradiance.bsdf.load_file(file)
numpy.save(values, [pyradiance.bsdf.query(data, *angles)[1] for angles in numpy.load(queries)])
"""


def radiance_values(file, angles):
    """BSDF for rows of polar angle and azimuth of the light and of the direction in which it leaves, in degrees."""
    queries, values = file.with_suffix(".queries.npy"), file.with_suffix(".values.npy")
    np.save(queries, np.array(angles, float))
    subprocess.run([sys.executable, "-c", QUERY, file, queries, values], check=True)
    return np.load(values)


def test_radiance_sees_light_straight_on_and_mirrored(klems):
    angles = [(30.0, phi, theta, phi + turn) for phi in (0.0, 54.0) for theta in (150.0, 30.0) for turn in (180.0, 0.0)]
    for straight, behind, mirrored, back in radiance_values(klems / "slab.xml", angles).reshape(2, 4):
        assert straight > 100 * behind
        assert mirrored > 100 * back


@pytest.mark.parametrize(("method", "theta"), [("PHOTOPIC", 60), ("SOLAR", 20)])
def test_glazing_of_window_sends_light_as_measured(klems, method, theta):
    product = pywincalc.parse_bsdf_xml_file(str(klems / "slab.xml"))
    assert product.thickness == pytest.approx(0.001)
    standard = Path(pywincalc.__file__).parent / "standards/W5_NFRC_2003.std"
    glazing = pywincalc.GlazingSystem(
        optical_standard=pywincalc.load_standard(str(standard)),
        solid_layers=[product],
        bsdf_hemisphere=pywincalc.BSDFHemisphere.create(pywincalc.BSDFBasisType.FULL),
    )
    light = glazing.optical_method_results(method, theta, 0).system_results
    for source, side in (("above", light.back), ("below", light.front)):
        lit = (row for row in rows(klems / "out/gonio.csv") if (row["from"], float(row["theta_i_deg"])) == (source, theta))
        measured = next(lit)
        for name, found in (("reflected", side.reflectance), ("transmitted", side.transmittance)):
            assert found.direct_hemispherical == pytest.approx(float(measured[name]), abs=1e-5), (source, name)


def flux_and_mean(directions, fluxes):
    """Flux, and the mean direction in which it leaves, projected onto the mean plane."""
    return np.sum(fluxes), directions.T @ fluxes / np.sum(fluxes)


def measured_light(rows, side, theta, phi):
    rows = [row for row in rows if row["side"] == side and (float(row["theta_i_deg"]), float(row["phi_i_deg"])) == (theta, phi)]
    names = ("theta_min_deg", "theta_max_deg", "phi_min_deg", "phi_max_deg", "theta_o_deg", "phi_o_deg")
    a, b, first, last, theta, phi = (np.radians([float(row[name]) for row in rows]) for name in names)
    area = 0.5 * np.abs(np.sin(b) ** 2 - np.sin(a) ** 2) * (last - first)
    directions = (np.sin(theta) * [np.cos(phi), np.sin(phi)]).T
    return flux_and_mean(directions, area * [float(row["bsdf"]) for row in rows])


def discs(count):
    """Middles of cells of equal areas of the unit disc, by the map of Shirley and Chiu."""
    middles = 2 * (np.arange(count) + 0.5) / count - 1
    a, b = (one.ravel() for one in np.meshgrid(middles, middles))
    radius, angle = np.where(np.abs(a) > np.abs(b), (a, np.pi / 4 * b / a), (b, np.pi / 4 * (2 - a / b)))
    return (radius * [np.cos(angle), np.sin(angle)]).T


def radiance_lights(file, lights, count=128):
    """The same of Radiance, over parts of equal projected solid angle, for each half space and direction of the light and side."""
    directions = discs(count)
    polar = np.degrees(np.arcsin(np.linalg.norm(directions, axis=1)))
    azimuth = np.degrees(np.arctan2(directions[:, 1], directions[:, 0]))
    angles = []
    for source, side, theta, phi in lights:
        light = (theta if source == "above" else 180 - theta, phi)
        is_below = (source == "above") != (side == "reflected")
        angles += [(*light, *leaving) for leaving in zip(180 - polar if is_below else polar, azimuth)]
    values = radiance_values(file, angles).reshape(len(lights), -1) * np.pi / len(polar)
    return [flux_and_mean(directions, fluxes) for fluxes in values]


def check_light_of_all_functions(file, lights, tolerances):
    measured = rows(file.parent / "out/bsdf.csv")
    all_lights = [(source, side, *light) for source in ("above", "below") for side in ("reflected", "transmitted") for light in lights]
    for (source, side, *light), (found, towards) in zip(all_lights, radiance_lights(file, all_lights)):
        of_source = [row for row in measured if row["setting"] == str(int(source == "below"))]
        flux, mean = measured_light(of_source, side, *light)
        assert found == pytest.approx(flux, abs=tolerances[0]), (source, side, light)
        assert np.linalg.norm(towards - mean) < tolerances[1], (source, side, light, towards, mean)


def test_radiance_takes_a_tensor_tree_without_a_direction(tmp_path):
    asperity(tmp_path, f"{SLAB.replace('20', '8', 1)} --for tensor-tree -o out")
    asperity(tmp_path, "export out --format tensor-tree -o slab.xml --quiet")
    assert "TensorTree3" in (tmp_path / "slab.xml").read_text()
    # Cells of light are 1/32 wide in the sine, per unit of which reflectance changes by up to 1 at these angles
    check_light_of_all_functions(tmp_path / "slab.xml", [(38, 0), (57, 0)], (0.02, 0.04))
    lights = [("above", "transmitted", 38, phi) for phi in (0, 90)]
    found, turned = radiance_lights(tmp_path / "slab.xml", lights)
    assert turned[0] == pytest.approx(found[0], rel=0.03)
    assert np.allclose(turned[1], [-found[1][1], found[1][0]], atol=0.03)


def long_slopes(folder):
    """A slab whose upper face has slopes that face -x, so that no two azimuths are alike."""
    np.save(folder / "saw.npy", np.tile(0.15 * (np.arange(32) % 8), (32, 1)))
    return "gonio --surface saw.npy --spacing 1 --eta 1.5 --thickness 1000 --no-plots --quiet -o out"


def test_radiance_sends_light_of_a_tensor_tree_where_it_went(tmp_path):
    asperity(tmp_path, f"{long_slopes(tmp_path)} --from both --theta 20,40,60 --phi 0:330:30 --rays 2e4")
    asperity(tmp_path, "export out --format tensor-tree -o saw.xml --quiet")
    assert "TensorTree4" in (tmp_path / "saw.xml").read_text()
    # Half a cell of light is 1/32 of the sine, and reflectance changes by 0.4 from 40 to 60 degrees
    check_light_of_all_functions(tmp_path / "saw.xml", [(40, 0), (40, 120), (40, 270)], (0.06, 0.08))
    checked = check_bsdf(tmp_path, "saw.xml")
    assert "Type: Anisotropic_Tensor_Tree" in checked, checked


def test_radiance_sends_light_of_all_patches_where_it_went(tmp_path):
    asperity(tmp_path, f"{long_slopes(tmp_path)} --for klems --bins 18x36 --rays 2e3")
    asperity(tmp_path, "export out --format klems -o saw.xml --quiet")
    # A patch has about a hundred points, of which its border leaves out some; half a patch is up to 0.1 wide
    check_light_of_all_functions(tmp_path / "saw.xml", [(40, 0), (40, 120), (30, 270)], (0.05, 0.1))


def direction(theta, phi):
    theta, phi = np.radians(theta), np.radians(phi)
    return [np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)]


def test_pbrt_has_the_fields_that_it_reads(tmp_path):
    """Names, types and ranks by pbrt-v4's `MeasuredBxDFData::Create`, in the tensor reader of Mitsuba, which does not use them all."""
    asperity(tmp_path, "gonio --smoothness 3 --material gold --tau 16um --wavelength 500nm,600nm --for rgl --rays 1e3 --no-plots --quiet -o gold")
    scene = (Path(__file__).parents[2] / "examples/pbrt/ball.pbrt").read_text()
    file = re.search(r'"measured" "string filename" "(.*)"', scene).group(1)
    asperity(tmp_path, f"export gold --format rgl -o {file} --quiet")
    fields = mitsuba.tensor_io.read(str(tmp_path / file))
    ranks = {"theta_i": 1, "phi_i": 1, "ndf": 2, "sigma": 2, "vndf": 4, "spectra": 5, "luminance": 4, "wavelengths": 1}
    for name, rank in ranks.items():
        assert (fields[name].dtype, fields[name].ndim) == (np.float32, rank), name
    assert fields["description"].dtype == fields["jacobian"].dtype == np.uint8
    incidence = fields["phi_i"].size, fields["theta_i"].size
    assert fields["vndf"].shape[:2] == fields["luminance"].shape[:2] == incidence
    assert fields["spectra"].shape[:3] == (*incidence, fields["wavelengths"].size)
    assert fields["luminance"].shape[2:] == fields["spectra"].shape[3:]


def measured_material(variant, file, theta, phi=0.0):
    """BSDF of Mitsuba, and a point of a surface seen from a direction."""
    mitsuba.set_variant(variant)
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(file)})
    point = mitsuba.SurfaceInteraction3f()
    point.wi = direction(theta, phi)
    if "spectral" in variant:
        point.wavelengths = [550.0] * 4
    return bsdf, point


def albedo(bsdf, point, count=4000):
    """Mean and standard error of the weights of samples."""
    context, random = mitsuba.BSDFContext(), np.random.default_rng(1)
    weights = []
    for u in random.random((count, 3)).tolist():
        sample, weight = bsdf.sample(context, point, u[0], u[1:])
        weights.append(weight[0] if sample.pdf > 0 else 0.0)
    return np.mean(weights), np.std(weights) / np.sqrt(count)


@pytest.mark.parametrize("smoothness", [2, 100])
def test_mitsuba_reflects_what_was_measured_at_angles_and_between(tmp_path, smoothness):
    gonio = f"gonio --smoothness {smoothness} --material mirror --rays 2e4 --realisations 4 --no-plots --quiet --for rgl"
    asperity(tmp_path, f"{gonio} -o out")
    asperity(tmp_path, "export out --format rgl -o mirror.bsdf --quiet")
    asperity(tmp_path, "export out --format rgl-rgb -o rgb.bsdf --quiet")
    for theta in (0, 57, 75.5, 83):
        for variant, file in (("scalar_spectral", "mirror.bsdf"), ("scalar_rgb", "rgb.bsdf")):
            mean, error = albedo(*measured_material(variant, tmp_path / file, theta))
            assert mean == pytest.approx(1.0, abs=4 * error + 0.005), (theta, variant)


def test_colours_are_those_of_the_spectrum(tmp_path):
    gold = "gonio --smoothness 4 --tau 16um --material gold --wavelength 400:700:20nm --theta 0,50,85 --bins 18x36"
    asperity(tmp_path, f"{gold} --rays 1e4 --realisations 2 --no-plots --quiet -o out")
    asperity(tmp_path, "export out --format rgl -o gold.bsdf --quiet")
    asperity(tmp_path, "export out --format rgl-rgb -o rgb.bsdf --quiet")
    wavelengths = np.arange(400.0, 701.0, 20.0)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    lamp = colour.SDS_ILLUMINANTS["D65"]
    for theta in (30.0, 55.0):
        bsdf, point = measured_material("scalar_spectral", tmp_path / "gold.bsdf", 50)
        spectrum = []
        for four in wavelengths.reshape(4, 4).tolist():
            point.wavelengths = four
            spectrum += list(bsdf.eval(mitsuba.BSDFContext(), point, direction(theta, 180)))
        shape = colour.SpectralShape(400, 700, 20)
        distribution = colour.SpectralDistribution(dict(zip(wavelengths, spectrum))).align(shape)
        xyz = colour.sd_to_XYZ(distribution, observer, lamp, method="Integration") / 100
        expected = colour.XYZ_to_RGB(xyz, "sRGB", apply_cctf_encoding=False)
        bsdf, point = measured_material("scalar_rgb", tmp_path / "rgb.bsdf", 50)
        found = np.array(bsdf.eval(mitsuba.BSDFContext(), point, direction(theta, 180)))
        # Wavelengths of 20 nm are weighted by different rules
        assert np.allclose(found, expected, rtol=0, atol=0.01 * expected.max()), (found, expected)


@pytest.mark.skipif(not LLVM, reason="libLLVM of version 17 or later is not installed (apt-get install libllvm19)")
def test_vectorised_mitsuba_reads_the_same(tmp_path):
    gold = "gonio --smoothness 4 --theta 0,40,80 --rays 1e4 --realisations 2 --no-plots --quiet"
    asperity(tmp_path, f"{gold} -o out")
    asperity(tmp_path, "export out --format rgl -o one.bsdf --quiet")
    bsdf, point = measured_material("scalar_spectral", tmp_path / "one.bsdf", 30)
    leaving = [direction(theta, phi) for theta in (5, 30, 60) for phi in (0, 100, 180)]
    expected = [bsdf.eval(mitsuba.BSDFContext(), point, one)[0] for one in leaving]
    mitsuba.set_variant("llvm_ad_spectral")
    bsdf = mitsuba.load_dict({"type": "measured", "filename": str(tmp_path / "one.bsdf")})
    point = drjit.zeros(mitsuba.SurfaceInteraction3f, len(leaving))
    point.wi, point.wavelengths = mitsuba.Vector3f([float(x) for x in direction(30, 0)]), mitsuba.UnpolarizedSpectrum(550.0)
    found = bsdf.eval(mitsuba.BSDFContext(), point, mitsuba.Vector3f(np.array(leaving).T))
    assert np.allclose(np.array(found)[0], expected, rtol=1e-4, atol=1e-6)


def test_mitsuba_sends_light_of_all_azimuths_where_it_went(tmp_path):
    # Long slopes that face -x, so that no two azimuths are alike
    heights = np.tile(0.15 * (np.arange(32) % 8), (32, 1))
    np.save(tmp_path / "saw.npy", heights)
    gonio = "gonio --surface saw.npy --spacing 1 --material mirror --theta 20,40 --phi 0:315:45 --bins 18x36"
    asperity(tmp_path, f"{gonio} --rays 2e4 --no-plots --quiet -o out")
    asperity(tmp_path, "export out --format rgl -o saw.bsdf --quiet")
    measured = rows(tmp_path / "out/bsdf.csv")
    for phi in (45, 135, 270):
        bsdf, point = measured_material("scalar_spectral", tmp_path / "saw.bsdf", 40, phi)
        light = [row for row in measured if (row["theta_i_deg"], row["phi_i_deg"]) == ("40", str(phi))]
        angles = [[float(row[name]) for name in ("theta_o_deg", "phi_o_deg")] for row in light]
        cosines = np.cos(np.radians([theta for theta, _ in angles]))
        expected = cosines * [float(row["bsdf"]) for row in light]
        found = np.array([bsdf.eval(mitsuba.BSDFContext(), point, direction(*one))[0] for one in angles])
        cosine = expected @ found / np.linalg.norm(expected) / np.linalg.norm(found)
        assert cosine > 0.9, phi
        assert found.sum() == pytest.approx(expected.sum(), rel=0.1), phi


def test_mitsuba_polarises_as_its_own_rough_metal(tmp_path):
    gonio = "gonio --smoothness 20 --material conductor --eta 0.43 --kappa 2.455 --for pbsdf --rays 2e4 --realisations 4"
    asperity(tmp_path, f"{gonio} --no-plots --quiet -o out")
    asperity(tmp_path, "export out --format pbsdf -o metal.pbsdf --quiet")
    mitsuba.set_variant("scalar_spectral_polarized")
    file = str(tmp_path / "metal.pbsdf")
    measured = mitsuba.load_dict({"type": "measured_polarized", "filename": file, "alpha_sample": 0.1})
    index = {name: {"type": "spectrum", "value": value} for name, value in (("eta", 0.43), ("k", 2.455))}
    rough = mitsuba.load_dict({"type": "roughconductor", "material": "none", "alpha": 0.1, **index})
    point, context = mitsuba.SurfaceInteraction3f(), mitsuba.BSDFContext()
    point.wavelengths = [550.0] * 4
    for light, seen, turn in ((40, 45, 183), (20, 28, 165), (60, 55, 176), (75, 72, 181)):
        point.wi = direction(seen, 20 + turn)
        first, second = (
            np.array(bsdf.eval(context, point, mitsuba.Vector3f(direction(light, 20))))[..., 0] for bsdf in (measured, rough)
        )
        assert first[0, 0] == pytest.approx(second[0, 0], rel=0.1)
        assert np.allclose(first / first[0, 0], second / second[0, 0], atol=0.02), (light, seen, turn)
    # Light of a lamp beside the camera, where measured files have no values
    point.wi = direction(9, 0)
    assert np.array(measured.eval(context, point, mitsuba.Vector3f(direction(9, 180))))[0, 0, 0] > 0.1
    random = np.random.default_rng(1)
    for theta in (0.5, 45, 75.5):
        point.wi = direction(theta, 30)
        samples = [measured.sample(context, point, u[0], u[1:])[1] for u in random.random((4000, 3)).tolist()]
        weights = [np.array(sample)[0, 0, 0] for sample in samples]
        error = np.std(weights) / np.sqrt(len(weights))
        expected = next(row for row in rows(tmp_path / "out/gonio.csv") if abs(float(row["theta_i_deg"]) - theta) < 2)
        assert np.mean(weights) == pytest.approx(float(expected["reflected"]), abs=4 * error + 0.01)
