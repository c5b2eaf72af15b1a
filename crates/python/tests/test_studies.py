"""Studies: the same bytes as the command line, arrays that agree with the files, and errors of Python's kinds."""

import io
import json
import pickle
import subprocess
import sys
import zipfile

import numpy as np
import pytest

import asperity as asp

SURFACE = asp.Surface.gaussian(size=128, tau=8, smoothness=3, seed=7)
RAYS = 20_000


def program(*arguments):
    """Output of the program."""
    command = [sys.executable, "-m", "asperity", *map(str, arguments)]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def members(path):
    """Contents of a result file, but for the machine and the name of the surface."""
    with zipfile.ZipFile(path) as file:
        found = {name: file.read(name) for name in file.namelist() if name != "machine.json"}
    for name in [name for name in found if name.endswith("header.json")]:
        header = json.loads(found[name])
        header["document"].pop("measured", None)
        found[name] = header
    return found


STUDIES = {
    "verify": dict(smoothness=[3, 2], eta=1.41421356, theta=1 / 3, models=["smith", "heitz"], rays=RAYS, model_rays=RAYS, size=64, tau=8),
    "map": dict(smoothness=[3, 6], eta=1.5, theta=[0, 60], models="smith", rays=RAYS, size=64, tau=8),
    "gonio": dict(smoothness=3, eta=1.5, theta=[0, 45], rays=RAYS, size=64, tau=8, polarisation="mueller"),
    "attenuation": dict(sigma=0.5, tau=0.5, realisations=2),
}


@pytest.mark.parametrize("name", STUDIES)
def test_results_have_the_bytes_of_the_command_line(name, tmp_path):
    options = STUDIES[name]
    flags = []
    for key, value in options.items():
        value = ",".join(map(str, value)) if isinstance(value, list) else value
        flags += [f"--{key.replace('_', '-')}", value]
    if name != "attenuation":
        flags.append("--no-plots")
    text = program(name, *flags, "-o", tmp_path / "theirs")
    ours = getattr(asp, name)(**options, output=tmp_path / "ours", **({"no_plots": True} if name != "attenuation" else {}))
    assert members(tmp_path / "ours" / "results.npz") == members(tmp_path / "theirs" / "results.npz")
    for file in ours.folder.rglob("*.csv"):
        theirs = tmp_path / "theirs" / file.relative_to(ours.folder)
        if name != "attenuation" or "seconds" not in file.read_text():
            assert file.read_bytes() == theirs.read_bytes(), file
    assert repr(ours) == text.split("results in ")[0].rstrip()


@pytest.mark.parametrize("threads", [1, 3])
def test_a_surface_in_memory_has_the_results_of_its_file(threads, tmp_path):
    file = tmp_path / "surface.npy"
    np.save(file, SURFACE.heights)
    program("trace", file, "--spacing", 1, "--border", "periodic", "--eta", 1.5, "--theta", 30, "--rays", RAYS, "-q",
            "--no-plots", "-o", tmp_path / "theirs")
    given = asp.Surface(SURFACE.heights, spacing=1, border="periodic")
    result = given.trace(eta=1.5, theta=30, rays=RAYS, threads=threads)
    ours, theirs = (members(folder / "results.npz") for folder in (result.folder, tmp_path / "theirs"))
    assert ours.keys() == theirs.keys()
    assert all(ours[name] == theirs[name] for name in ours)


def test_arrays_agree_with_the_files():
    result = SURFACE.trace(eta=1.5, theta=30, rays=RAYS)
    table = result.to_dataframe("histogram")
    for side, values, errors in [("reflected", result.brdf, result.brdf_se), ("transmitted", result.btdf, result.btdf_se)]:
        rows = table[table["side"] == side]
        expected = rows["bsdf"].to_numpy().reshape(18, 36)
        # Tables have transmitted light by the angle from +z
        expected = expected if side == "reflected" else expected[::-1]
        np.testing.assert_allclose(values, expected, rtol=1e-12)
        np.testing.assert_allclose(errors.sum(), rows["bsdf_se"].sum(), rtol=1e-9)
    summary = result.summary
    assert abs(summary["appearance"]["reflectance"]["mean"] - result.reflected) < 1e-15
    np.testing.assert_allclose(result.orders.sum(axis=1), [result.reflected, result.transmitted], rtol=1e-12)
    edges = np.radians(result.bins["theta"])
    omega = 0.5 * np.diff(np.sin(edges) ** 2) * np.diff(np.radians(result.bins["phi"])).T
    np.testing.assert_allclose((result.brdf * omega).sum(), result.reflected, rtol=1e-12)


def test_mueller_matrices_are_those_of_the_table():
    result = SURFACE.trace(eta=1.5, theta=50, rays=200_000, polarisation="mueller")
    assert result.mueller.shape == (2, 18, 36, 4, 4)
    # Both are unbiased, and the BSDF has a control variate
    deviations = (result.mueller[0, ..., 0, 0] - result.brdf) / np.hypot(result.mueller_se[0, ..., 0, 0], result.brdf_se)
    assert np.nanmean(deviations**2) < 1.5
    table = result.to_dataframe("mueller")
    for side, matrices in zip(["reflected", "transmitted"], result.mueller):
        rows = table[table["side"] == side]
        for row, column in [(0, 1), (1, 0), (2, 3), (3, 2), (3, 0)]:
            ratios = rows[f"m{row}{column}"].to_numpy().reshape(18, 36)[:: 1 if side == "reflected" else -1]
            # Left out of the table where few rays arrive
            known = np.isfinite(ratios)
            assert known.sum() > 100
            found = matrices[known][:, row, column] / matrices[known][:, 0, 0]
            np.testing.assert_allclose(found, ratios[known], rtol=1e-9, atol=1e-12)
    assert np.isfinite(result.mueller_se).all()
    with pytest.raises(ValueError, match="polarisation"):
        SURFACE.trace(eta=1.5, rays=1000).mueller


def test_labelled_results_are_those_of_the_netcdf_file(tmp_path):
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("scipy")
    result = asp.gonio(SURFACE, eta=[1.3, 1.5], theta=[0, 40], rays=RAYS)
    labelled = result.to_xarray()
    assert dict(labelled.sizes) | {"eta": 2, "theta_i": 2, "side": 2} == dict(labelled.sizes)
    result.export(tmp_path / "results.nc", "netcdf")
    with xarray.open_dataset(tmp_path / "results.nc", engine="scipy") as file:
        for name in file.data_vars:
            assert labelled[name].dims == file[name].dims, name
            np.testing.assert_array_equal(labelled[name].to_numpy().astype(str), file[name].to_numpy().astype(str), name)
    assert float(labelled["flux"].sel(eta=1.5, theta_i=40, side="reflected").squeeze()) == result.reflected[1, 1]


def test_results_are_pickled_saved_and_loaded(tmp_path):
    result = SURFACE.trace(eta=1.5, rays=RAYS)
    again = pickle.loads(pickle.dumps(result))
    assert repr(again) == repr(result) and again.folder != result.folder
    np.testing.assert_array_equal(again.brdf, result.brdf)
    loaded = asp.load(result.save(tmp_path / "kept"))
    assert loaded.summary == result.summary and loaded.is_complete and "trace" in repr(loaded)
    np.testing.assert_array_equal(loaded.orders_se, result.orders_se)
    with pytest.raises(FileNotFoundError, match="no result folder"):
        asp.load(tmp_path)


def test_pages_and_files_of_other_programs_are_written(tmp_path):
    result = asp.gonio(SURFACE, material="gold", wavelength=633, theta=[0, 20, 40, 60], rays=2000)
    assert "rgl" in result.export(tmp_path / "gold.bsdf", format="rgl")
    result.report(tmp_path / "gold.html")
    page = (tmp_path / "gold.html").read_text()
    assert "<svg" in page and len(page) < 600_000
    asp.report([result, SURFACE.trace(eta=1.5, rays=2000)], tmp_path / "both.html")
    with pytest.raises(ValueError, match="pages"):
        result.report(tmp_path / "gold.pdf")
    with pytest.raises(ValueError, match="format=gerber"):
        result.export(tmp_path / "gold.xyz", "gerber")


def test_a_folder_is_resumed_and_other_settings_are_refused_or_replaced(tmp_path):
    first = asp.verify(smoothness=3, eta=1.4, rays=RAYS, size=64, tau=8, models="none", output=tmp_path / "out")
    again = asp.verify(smoothness=3, eta=1.4, rays=RAYS, size=64, tau=8, models="none", output=tmp_path / "out")
    assert repr(first) == repr(again)
    (tmp_path / "out" / "mine.txt").write_text("kept")
    with pytest.raises(OSError, match="trace"):
        asp.trace(flat=True, eta=1.5, rays=1000, output=tmp_path / "out")
    assert (tmp_path / "out" / "mine.txt").read_text() == "kept"


def test_configurations_are_read_and_overridden(tmp_path):
    config = tmp_path / "glass.toml"
    config.write_text("[surface]\nsmoothness = 3\nsize = 64\ntau = 8\n[material]\neta = 1.4\n[run]\nrays = 20000\n")
    study = asp.verify(config, models="none", theta=30)
    same = asp.verify(smoothness=3, size=64, tau=8, eta=1.4, rays=RAYS, models="none", theta=30)
    assert (study.reflected, study.summary["appearance"]) == (same.reflected, same.summary["appearance"])
    config.write_text("[surface]\nsmoothnes = 3\n")
    with pytest.raises(ValueError, match="glass.toml: line 2: unknown key `smoothnes`"):
        asp.verify(config)
    with pytest.raises(FileNotFoundError):
        asp.verify(tmp_path / "none.toml")


@pytest.mark.parametrize(
    ("kind", "words", "options"),
    [
        (TypeError, "trace\\(\\) has no argument `thta`; did you mean theta", dict(thta=30)),
        (TypeError, "models is for|smoothness is for", dict(smoothness=3)),
        (TypeError, "theta: object is neither", dict(theta=object())),
        (TypeError, "refine='yes': must be True or False", dict(refine="yes")),
        (TypeError, "must not be True", dict(theta=True)),
        (TypeError, "theta: complex", dict(theta=1j)),
        (ValueError, "theta=100: must be a number", dict(theta=100)),
        (ValueError, "eta=-1: must be", dict(eta=-1)),
        (ValueError, "threads=0: must be", dict(threads=0)),
        (ValueError, "threads=20000: must be", dict(threads=20000)),
        (TypeError, "progress: str", dict(progress="yes")),
        (ValueError, "unobtainium", dict(material="unobtainium")),
        (ValueError, "kappa", dict(material="gold", kappa=3)),
    ],
)
def test_refusals_name_the_argument(kind, words, options):
    with pytest.raises(kind, match=words) as refused:
        SURFACE.trace(**{"eta": 1.5, **options} if "material" not in options else options)
    assert "--" not in str(refused.value)


def test_arrays_and_broken_folders_are_refused_by_name(tmp_path):
    for call in [lambda: asp.trace(np.zeros((4, 4)), eta=1.5), lambda: asp.gonio(np.zeros((4, 4)), eta=1.5), lambda: asp.trace(3)]:
        with pytest.raises(TypeError, match="surface: .* neither a Surface nor a file"):
            call()
    with pytest.raises(ValueError, match="Unicode"):
        asp.trace("\udcff.npy", eta=1.5)
    with pytest.raises(FileNotFoundError, match="a--theta.sur"):
        asp.read("a--theta.sur")
    (tmp_path / "manifest.json").write_text("{")
    with pytest.raises(OSError, match="damaged"):
        asp.load(tmp_path)
    asp.settings("trace").clear()
    assert asp.settings("trace")


def test_progress_is_told_and_its_exceptions_end_the_run():
    told = []
    SURFACE.trace(eta=1.5, rays=2_000_000, progress=lambda *step: told.append(step))
    assert told and all(isinstance(stage, str) and done <= total for stage, done, total in told)

    def fail(*_):
        raise LookupError("no more")

    with pytest.raises(LookupError, match="no more"):
        SURFACE.trace(eta=1.5, rays=200_000_000, progress=fail)


def test_tables_of_every_study_are_frames():
    frame = asp.attenuation(realisations=1).to_dataframe()
    assert len(frame) > 3
    found = asp.map(smoothness=[3, 6], eta=1.5, theta=0, models="smith", rays=RAYS, size=64, tau=8)
    assert found.to_xarray().sizes
    with pytest.raises(ValueError, match="no light by direction"):
        found.brdf  # noqa: B018
    with pytest.raises(ValueError, match="table=none"):
        found.to_dataframe("none")


def test_materials_have_their_constants():
    assert "gold" in json.dumps(asp.materials())
    with pytest.raises(ValueError, match="adamantium"):
        asp.materials("adamantium")


def test_the_program_is_part_of_the_package():
    assert "verify" in program("--help")
    assert asp.__version__ in program("--version")
    refused = subprocess.run(
        [sys.executable, "-m", "asperity", "trace", "--theta", "100"], capture_output=True, text=True, check=False
    )
    assert refused.returncode == 2 and refused.stderr.startswith("asperity: --theta 100: must be")


def test_figures_are_drawn():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    result = asp.gonio(SURFACE, eta=1.5, theta=[0, 40], rays=RAYS)
    for figure in [result.plot(), SURFACE.plot().figure]:
        out = io.BytesIO()
        figure.savefig(out)
        assert len(out.getvalue()) > 10_000
    assert "<pre>" in result._repr_html_()
