//! GGX microfacets: values as renderers compute them, energy by two integrals, and the white furnace.

use std::f64::consts::PI;

use asperity_analysis::{
    BsdfModel, Ggx, Heitz, MODEL_NAMES, Masking, RandomWalk, SlopeCovariance, SlopeDistribution,
    Smith, SmithSlopes, bin_fluxes, create_model, hemispherical_energy,
};
use asperity_optics::{Material, from_spherical};
use asperity_tally::{
    Azimuth, Component, HemisphereGrid, Side, Tally, TallyResult, TallySpec, TallyStatistics,
};
use glam::DVec3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

const ALPHA: f64 = 0.4;

fn glass() -> Material {
    Material::dielectric(1.5).unwrap()
}

fn ggx() -> Ggx {
    Ggx::isotropic(ALPHA).unwrap()
}

/// Fresnel reflectance of unpolarised light, by amplitudes.
fn fresnel(cos_i: f64, eta: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    0.5 * (s * s + p * p)
}

/// The BSDF of Walter et al. 2007, Eqs. 20, 21, 33 and 34, with their unit vectors `i`, `o` and macroscopic normal `z`, written out anew:
/// separable as Mitsuba's `roughdielectric` has it.
fn walter(i: DVec3, o: DVec3, eta: f64) -> f64 {
    let tan2 = |v: DVec3| 1.0 / (v.z * v.z) - 1.0;
    let d = |m: DVec3| ALPHA * ALPHA / (PI * m.z.powi(4) * (ALPHA * ALPHA + tan2(m)).powi(2));
    let g1 = |v: DVec3| 2.0 / (1.0 + (1.0 + ALPHA * ALPHA * tan2(v)).sqrt());
    let g = g1(i) * g1(o);
    if o.z > 0.0 {
        let m = (i + o).normalize();
        return fresnel(i.dot(m), eta) * g * d(m) / (4.0 * i.z * o.z);
    }
    let m = -(i + eta * o).normalize();
    let (im, om) = (i.dot(m), o.dot(m));
    let transmitted = 1.0 - fresnel(im, eta);
    (im * om / (i.z * o.z)).abs() * eta * eta * transmitted * g * d(m) / (im + eta * om).powi(2)
}

#[test]
fn separable_values_are_those_of_walter_et_al() {
    let model = Smith::of_ggx(ggx(), glass(), Masking::Separable).unwrap();
    for (theta_i, theta_o, phi) in [
        (0.0, 0.5, 1.0),
        (0.6, 0.7, 3.0),
        (1.3, 1.2, 2.6),
        (0.2, 2.9, 3.0),
        (0.9, 2.5, 3.3),
        (1.2, 2.2, 2.8),
    ] {
        let (i, o) = (from_spherical(theta_i, 0.0), from_spherical(theta_o, phi));
        let (found, expected) = (model.bsdf(i, o), walter(i, o, 1.5));
        assert!(expected > 0.0, "{theta_i} {theta_o}");
        assert!((found / expected - 1.0).abs() < 1e-11, "{found} {expected}");
    }
}

/// On one side `1 / (1 + Lambda_i + Lambda_o)`, as pbrt has it.
#[test]
fn height_correlated_values_follow_from_separable_ones() {
    let [model, separable] = [Masking::HeightCorrelated, Masking::Separable]
        .map(|masking| Smith::of_ggx(ggx(), glass(), masking).unwrap());
    let (i, o) = (from_spherical(1.1, 0.0), from_spherical(1.3, 2.5));
    let lambda = |v: DVec3| 0.5 * ((1.0 + (ALPHA * v.x.hypot(v.y) / v.z).powi(2)).sqrt() - 1.0);
    let (a, b) = (lambda(i), lambda(o));
    let expected = (1.0 + a) * (1.0 + b) / (1.0 + a + b);
    let found = model.bsdf(i, o) / separable.bsdf(i, o);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

/// Fluxes into bins, and over half the sphere, against sums over facets: steep ones are a good part of the light at grazing incidence.
#[test]
fn bins_energies_and_sums_over_facets_agree() {
    let slopes = SlopeCovariance::new(0.5 * ALPHA * ALPHA, 0.02, 0.01).unwrap();
    for (ggx, theta) in [(ggx(), 0.0), (ggx(), 80.0), (Ggx::new(slopes), 60.0)] {
        let wi = from_spherical(f64::to_radians(theta), 0.3);
        let model = Smith::of_ggx(ggx, Material::Mirror, Masking::HeightCorrelated).unwrap();
        let grid = HemisphereGrid::new(9, 12).unwrap();
        let bins: f64 = bin_fluxes(&model, wi, &grid).iter().sum();
        let energy = hemispherical_energy(&model, wi).reflected;
        assert!((bins - energy).abs() < 1e-9, "{theta}: {bins} {energy}");
        // Midpoints over tilt and azimuth of the facets
        let (n, mut sum) = (1200, 0.0);
        for j in 0..n {
            let t = 0.5 * PI * (f64::from(j) + 0.5) / f64::from(n);
            for k in 0..n {
                let m = from_spherical(t, 2.0 * PI * (f64::from(k) + 0.5) / f64::from(n));
                let o = 2.0 * wi.dot(m) * m - wi;
                if wi.dot(m) > 0.0 && o.z > 0.0 {
                    let g = 1.0 / (1.0 + ggx.lambda(wi) + ggx.lambda(o));
                    sum += wi.dot(m) * ggx.d(m) * g / wi.z * t.sin();
                }
            }
        }
        sum *= PI * PI / f64::from(n * n);
        assert!(
            (sum - energy).abs() < 2e-3 * energy,
            "{theta}: {sum} {energy}"
        );
    }
}

#[test]
fn white_furnace_conserves_energy() {
    let spec = TallySpec::new(HemisphereGrid::new(3, 4).unwrap(), 0.1).unwrap();
    for (material, theta) in [(Material::Mirror, 75.0), (glass(), 30.0), (glass(), 80.0)] {
        let wi = from_spherical(f64::to_radians(theta), 0.3);
        let walk = Heitz::of_ggx(Ggx::isotropic(1.0).unwrap(), material).unwrap();
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut statistics = TallyStatistics::new(spec);
        for _ in 0..50 {
            let mut tally = Tally::new(spec, Azimuth::From(0.0));
            for _ in 0..400 {
                walk.follow(wi, &mut rng, &mut tally);
            }
            statistics.push(&tally.into_fractions(400));
        }
        let total = statistics.means().budget().total();
        assert!((total - 1.0).abs() < 1e-9, "{theta}: {total}");
        // Light scattered once, by the walk and by its closed form
        let single = Smith::of_ggx(
            Ggx::isotropic(1.0).unwrap(),
            material,
            Masking::HeightCorrelated,
        );
        let exact = hemispherical_energy(&single.unwrap(), wi);
        for (side, exact) in [
            (Side::Reflected, exact.reflected),
            (Side::Transmitted, exact.transmitted),
        ] {
            let found = statistics.flux(side, Component::Single);
            let off = (found.mean - exact) / found.se.unwrap().max(1e-12);
            assert!(off.abs() < 4.0, "{theta} {side}: {off}");
        }
        // Roulette takes as much as it gives, so all light leaves
        let truncated = statistics.budget().truncated;
        let off = truncated.mean / truncated.se.unwrap();
        assert!(off.abs() < 4.0, "{theta}: {off}");
        assert_eq!(statistics.means().budget().absorbed, 0.0);
    }
}

/// `smith-slopes` of GGX slopes is `ggx`; a surface's Gaussian slopes give GGX the same alpha.
#[test]
fn ggx_slopes_reach_the_models_that_take_them() {
    let slopes = SlopeDistribution::Ggx {
        ggx: ggx(),
        surface: None,
        covariance: SlopeCovariance::isotropic(2.0).unwrap(),
    };
    let (i, o) = (from_spherical(0.7, 0.0), from_spherical(0.9, 2.9));
    let of_name = |name: &str, slopes: SlopeDistribution| {
        let model = create_model(name, slopes, glass()).unwrap();
        assert_eq!(model.name(), name);
        model.density().unwrap().bsdf(i, o)
    };
    let expected = Smith::of_ggx(ggx(), glass(), Masking::HeightCorrelated);
    let expected = expected.unwrap().bsdf(i, o);
    for name in ["ggx", "heitz-ggx", "smith-slopes"] {
        assert!(MODEL_NAMES.contains(&name));
        let found = of_name(name, slopes.clone());
        assert!((found / expected - 1.0).abs() < 1e-13, "{name}: {found}");
    }
    let smith = of_name("smith", slopes.clone());
    assert!((smith / expected - 1.0).abs() > 0.1);
    // alpha = 2 / s
    let gaussian = SlopeCovariance::isotropic(2.0 / ALPHA).unwrap();
    let found = of_name("ggx", gaussian.into());
    assert!((found / expected - 1.0).abs() < 1e-12, "{found}");
    let energy = [
        SmithSlopes::new(slopes, glass()).map(|model| hemispherical_energy(&model, i)),
        Smith::of_ggx(ggx(), glass(), Masking::HeightCorrelated)
            .map(|model| hemispherical_energy(&model, i)),
    ];
    let [a, b] = energy.map(Result::unwrap);
    assert!((a.reflected - b.reflected).abs() < 1e-10);
}
