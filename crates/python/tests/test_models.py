"""Models: values over arrays, samples that follow their density, and energies by quadrature."""

import pickle

import numpy as np
import pytest

from asperity import models


def test_values_broadcast_and_are_reciprocal():
    smith = models.smith(smoothness=3, eta=1.5)
    theta = np.array([[0.0], [20.0], [40.0]])
    wi, wo = models.direction(theta), models.direction([10.0, 30.0], 180)
    values = smith.eval(wi, wo)
    assert values.shape == (3, 2) and (values > 0).all()
    np.testing.assert_allclose(values, smith.eval(wo[None], wi), rtol=1e-12)
    assert smith.eval([0, 0, 1], [0, 0, -1]) > 0
    assert smith.eval([0, 0, -1], [0, 0, 1]) == 0
    assert np.isnan(smith.eval([np.nan] * 3, [0, 0, 1])) and np.isnan(smith.pdf([0, 0, 1], [np.nan] * 3))
    many = np.broadcast_to(models.direction(30), (5000, 3))
    np.testing.assert_array_equal(smith.sample(many, 1)[:100], smith.sample(many[:100], 1))
    np.testing.assert_array_equal(smith.eval(many, wo[0]), np.full(5000, smith.eval(many[0], wo[0])))


def test_values_are_those_of_the_program():
    table = models.evaluate("smith", smoothness=3, eta=1.5, theta=30, step=5)
    smith = models.smith(smoothness=3, eta=1.5)
    theta = table["theta_deg"].to_numpy()
    phi = table["phi_deg"].to_numpy() if "phi_deg" in table else 0.0
    values = smith.eval(models.direction(30), models.direction(theta, phi))
    np.testing.assert_allclose(values, table["bsdf"], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("smith", dict(smoothness=3, eta=1.5)),
        ("smith", dict(smoothness=2, material="gold", wavelength=633)),
        ("v-cavity", dict(smoothness=2.5, eta=1.4)),
        ("ggx", dict(slopes="ggx", ggx_alpha=0.4, eta=1.5)),
    ],
)
def test_sampled_energy_is_that_by_quadrature(name, options):
    model = models.Model(name, **options)
    wi = models.direction(50, 20)
    wo = model.sample(np.broadcast_to(wi, (200_000, 3)), rng=1)
    is_direction = np.isfinite(wo[:, 0])
    wo = wo[is_direction]
    np.testing.assert_allclose(np.linalg.norm(wo, axis=1), 1.0, rtol=1e-12)
    weights = model.eval(wi, wo) * np.abs(wo[:, 2]) / model.pdf(wi, wo)
    for side, exact in zip([wo[:, 2] > 0, wo[:, 2] < 0], model.albedo(wi)):
        mean = weights[side].sum() / len(is_direction)
        se = np.sqrt((weights[side] ** 2).sum()) / len(is_direction)
        # Eight comparisons: passed once in 10 000 runs
        assert abs(mean - exact) <= 4.4 * se + 1e-12, (mean, se, exact)


def test_samples_follow_their_density():
    model = models.smith(smoothness=2.5, eta=1.5)
    wi = models.direction(40)
    n = 400_000
    wo = model.sample(np.broadcast_to(wi, (n, 3)), rng=np.random.default_rng(5))
    wo = wo[np.isfinite(wo[:, 0])]
    cosines, azimuths = np.linspace(-1, 1, 41), np.linspace(-np.pi, np.pi, 25)
    counts, _, _ = np.histogram2d(wo[:, 2], np.arctan2(wo[:, 1], wo[:, 0]), [cosines, azimuths])
    # Mean density of each bin over 24 x 24 points
    fine = 24
    z = np.linspace(-1, 1, 40 * fine + 1)
    z = 0.5 * (z[1:] + z[:-1])
    phi = np.linspace(-np.pi, np.pi, 24 * fine + 1)
    phi = 0.5 * (phi[1:] + phi[:-1])
    z, phi = np.meshgrid(z, phi, indexing="ij")
    r = np.sqrt(1 - z**2)
    density = model.pdf(wi, np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=-1))
    expected = density.reshape(40, fine, 24, fine).mean(axis=(1, 3)) * (2 / 40) * (2 * np.pi / 24) * n
    tested = expected > 50
    chi2 = ((counts - expected)[tested] ** 2 / expected[tested]).sum()
    assert abs(chi2 - tested.sum()) < 5 * np.sqrt(2 * tested.sum())


def test_samples_depend_on_the_generator_alone():
    model = models.smith(smoothness=3, eta=1.5)
    wi = np.broadcast_to(models.direction(30), (5, 4, 3))
    first = model.sample(wi, 3)
    assert first.shape == (5, 4, 3)
    np.testing.assert_array_equal(first, model.sample(wi, np.random.default_rng(3)))
    assert not np.array_equal(first, model.sample(wi, 4))


def test_models_are_pickled_and_named():
    model = models.smith(smoothness=3, eta=1.5)
    again = pickle.loads(pickle.dumps(model))
    assert repr(again) == repr(model) == "models.smith(smoothness=3, eta=1.5)"
    assert again.description == model.description and "Smith" in model.description
    assert "heitz" in models.names() and "heitz_ggx" in dir(models)


def test_refusals_name_what_is_wrong():
    with pytest.raises(AttributeError, match="phong"):
        models.phong  # noqa: B018
    with pytest.raises(ValueError, match="smoothness"):
        models.smith(eta=1.5)
    with pytest.raises(ValueError, match="smoothness=-3: must be"):
        models.smith(smoothness=-3, eta=1.5)
    with pytest.raises(TypeError, match="smothness"):
        models.smith(smothness=3)
    with pytest.raises(ValueError, match="lists"):
        models.smith(smoothness=[3, 4], eta=1.5)
    with pytest.raises(TypeError, match="single directions"):
        models.xu_sun_mc(smoothness=3, eta=1.5).eval([0, 0, 1], [0, 0, 1])
    with pytest.raises(ValueError, match="unit vectors"):
        models.smith(smoothness=3, eta=1.5).eval([0, 0, 5], [0, 0, 1])
    with pytest.raises(ValueError, match="three components"):
        models.smith(smoothness=3, eta=1.5).eval([0, 1], [0, 0, 1])
