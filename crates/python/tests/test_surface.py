"""Surfaces: arrays of every kind go in once and come out without a copy."""

import pickle

import numpy as np
import pytest

import asperity as asp

HEIGHTS = np.arange(12.0).reshape(3, 4) ** 2


@pytest.mark.parametrize(
    "heights",
    [
        HEIGHTS.tolist(),
        HEIGHTS.astype(np.float32),
        HEIGHTS.astype(np.int16),
        np.asfortranarray(HEIGHTS),
        np.repeat(HEIGHTS, 2, axis=1)[:, ::2],
        np.ma.asarray(HEIGHTS),
        HEIGHTS.astype(">f8"),
        tuple(map(tuple, HEIGHTS)),
    ],
    ids=["list", "float32", "int16", "fortran", "strided", "masked", "big-endian", "tuple"],
)
def test_every_array_like_has_the_same_heights(heights):
    surface = asp.Surface(heights, spacing=0.5, unit="um")
    np.testing.assert_array_equal(surface.heights, HEIGHTS)
    assert surface.heights.flags.c_contiguous and surface.shape == (3, 4)
    assert surface == asp.Surface(HEIGHTS, 0.5, "um") and hash(surface) == hash(asp.Surface(HEIGHTS, 0.5, "um"))


def test_masked_points_and_nan_are_missing():
    masked = np.ma.masked_equal(HEIGHTS, 4.0)
    assert asp.Surface(masked).missing == 1
    holed = HEIGHTS.copy()
    holed[1, 2] = np.nan
    surface = asp.Surface(holed, border="mirrored")
    assert surface.missing == 1
    with pytest.raises(ValueError, match="missing"):
        surface.parameters()
    assert surface.filter(missing="fill").missing == 0


def test_heights_come_out_without_a_copy_and_cannot_be_changed():
    source = HEIGHTS.copy()
    surface = asp.Surface(source)
    first, second = surface.heights, surface.heights
    assert np.shares_memory(first, second) and not np.shares_memory(first, source)
    assert np.shares_memory(np.asarray(surface), first)
    with pytest.raises(ValueError, match="read-only"):
        first[0, 0] = 1.0
    source[0, 0] = 99.0
    assert surface.heights[0, 0] == 0.0
    with pytest.raises(AttributeError):
        surface.unit = "nm"


def test_heights_outlive_their_surface():
    heights = asp.Surface(HEIGHTS).heights
    for _ in range(3):
        asp.Surface(np.ones((300, 300)))
    np.testing.assert_array_equal(heights, HEIGHTS)


def test_pickled_surfaces_are_equal():
    for surface in [asp.Surface(HEIGHTS, (0.5, 0.25), "nm", "open", y_is_north=True), asp.Surface(HEIGHTS)]:
        again = pickle.loads(pickle.dumps(surface))
        assert again == surface and repr(again) == repr(surface)
        assert again._map.y_is_north == surface._map.y_is_north
        assert again._map.spacing_is_known == surface._map.spacing_is_known


def test_saved_surfaces_are_read(tmp_path):
    surface = asp.Surface.gaussian(size=(64, 32), tau="4um", smoothness=3, seed=2)
    surface.save(tmp_path / "surface.x3p")
    again = asp.read(tmp_path / "surface.x3p")
    assert again.shape == (32, 64) and again.unit == "m"
    np.testing.assert_allclose(again.heights, surface.heights * 1e-6, rtol=1e-12)
    assert "triangles" in surface.mesh(tmp_path / "surface.ply") and (tmp_path / "surface.ply").exists()


def test_what_is_known_of_a_surface_tells_it_apart_and_stays():
    plain, north = asp.Surface(HEIGHTS), asp.Surface(HEIGHTS, y_is_north=True)
    assert plain != north and plain != asp.Surface(HEIGHTS, spacing=1.0) and plain == asp.Surface(plain)
    assert north.filter(remove="plane")._map.y_is_north and asp.Surface(north, border="open")._map.y_is_north
    assert not asp.Surface(plain, border="open")._map.spacing_is_known
    with pytest.raises(ValueError, match="heights are in um"):
        asp.Surface(asp.Surface(HEIGHTS, unit="µm"), unit="nm")


def test_filters_keep_what_is_between_their_wavelengths():
    surface = asp.Surface.gaussian(size=256, tau=8, smoothness=4, seed=1)
    short, long = surface.filter(l=20), surface.filter(s=20)
    assert np.diff(long.heights).std() < np.diff(short.heights).std()
    both = short.heights + long.heights
    np.testing.assert_allclose(both, surface.heights, atol=1e-9 * surface.heights.std())


def test_refused_arguments_are_named():
    with pytest.raises(TypeError, match="heights"):
        asp.Surface([[1.0, 2.0], [3.0]])
    with pytest.raises(TypeError, match="heights"):
        asp.Surface(np.zeros(5))
    with pytest.raises(ValueError, match="at least"):
        asp.Surface(np.zeros((1, 1)))
    with pytest.raises(ValueError, match="unit=inch: must be one of"):
        asp.Surface(HEIGHTS, unit="inch")
    with pytest.raises(ValueError, match="border=round"):
        asp.Surface(HEIGHTS, border="round")
    with pytest.raises(ValueError):
        asp.Surface(HEIGHTS, spacing=-1)
    with pytest.raises(ValueError, match="infinite|finite"):
        asp.Surface([[0.0, np.inf], [0.0, 0.0]])
    with pytest.raises(TypeError, match="spacing: must be a number"):
        asp.Surface(HEIGHTS, spacing="0.5um")
    with pytest.raises(TypeError, match="unit: int"):
        asp.Surface(HEIGHTS, unit=3)
    with pytest.raises(TypeError, match="real"):
        asp.Surface(HEIGHTS * 1j)
    for options in [{"output": "x.npy"}, {"realisations": 3}]:
        with pytest.raises(TypeError, match=next(iter(options))):
            asp.Surface.gaussian(**options)
    with pytest.raises(TypeError, match="s_filter"):
        asp.Surface(HEIGHTS).filter(s_filter=3)
    with pytest.raises(FileNotFoundError, match="no-such-file"):
        asp.read("no-such-file.sur")
    with pytest.raises(OSError, match="ending"):
        asp.read(__file__)


def test_surfaces_of_surfalize_are_taken():
    surfalize = pytest.importorskip("surfalize")
    surface = asp.Surface(surfalize.Surface(HEIGHTS, 0.3, 0.4))
    assert (surface.spacing, surface.unit) == ((0.3, 0.4), "um")
    np.testing.assert_array_equal(surface.heights, HEIGHTS)


def test_surfaces_of_other_packages_have_their_spacing_and_unit():
    class Topography:
        """As SurfaceTopography: x along the first axis."""

        nb_grid_pts, physical_sizes, pixel_size = (4, 3), (2.0, 3.0), (0.5, 1.0)
        unit, is_periodic = "µm", True

        def heights(self):
            return HEIGHTS.T

    class Measured:
        """As surfalize."""

        data, step_x, step_y = HEIGHTS, 0.3, 0.4

    surface = asp.Surface(Topography())
    assert (surface.spacing, surface.unit, surface.border) == ((0.5, 1.0), "um", "periodic")
    np.testing.assert_array_equal(surface.heights, HEIGHTS)
    assert (asp.Surface(Measured()).spacing, asp.Surface(Measured()).unit) == ((0.3, 0.4), "um")
