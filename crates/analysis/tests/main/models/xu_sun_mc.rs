//! The statistical Monte Carlo of Xu and Sun against what its own densities say.

use std::f64::consts::{LN_2, TAU};

use asperity_analysis::{
    Beckmann, BsdfModel, Expectation, Masking, ModelError, ModelInfo, SamplingEffort,
    ScatteringModel, Scope, SlopeCovariance, SlopeDistribution, Smith, bin_fluxes,
    chi_squared_survival, closed_form, create_model, expect, hemispherical_energy,
    xu_sun_visibility,
};
use asperity_optics::{Incidence, Material, dielectric, reflect, refract};
use asperity_tally::{
    Azimuth, Component, EventPath, HemisphereGrid, Side, Sides, TallyResult, TallySpec,
};
use glam::{DVec2, DVec3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const BOTH: [&str; 2] = ["xu-sun-mc", "xu-sun-mc-smith"];

fn isotropic(s: f64) -> SlopeCovariance {
    SlopeCovariance::isotropic(s).unwrap()
}

fn glass() -> Material {
    Material::dielectric(1.4).unwrap()
}

fn spec() -> TallySpec {
    TallySpec::new(
        HemisphereGrid::new(6, 8).unwrap(),
        TallySpec::DEFAULT_HALF_WIDTH,
    )
    .unwrap()
}

/// Light at azimuth 20 deg, and the azimuth that it travels to.
fn light(theta_deg: f64) -> (Incidence, Azimuth) {
    let incidence = Incidence::from_degrees(theta_deg, 20.0).unwrap();
    (
        incidence,
        Azimuth::From(incidence.phi() + std::f64::consts::PI),
    )
}

fn followed(model: &dyn ScatteringModel, theta_deg: f64, rays: u64, seed: u64) -> Expectation {
    in_batches(model, theta_deg, rays, 200, seed)
}

fn in_batches(
    model: &dyn ScatteringModel,
    theta_deg: f64,
    rays: u64,
    batches: u64,
    seed: u64,
) -> Expectation {
    let (incidence, azimuth) = light(theta_deg);
    let effort = SamplingEffort {
        rays,
        batches,
        seed,
    };
    expect(model, incidence, &spec(), azimuth, effort)
}

/// The single scattering that the walk of `xu-sun-mc` samples: Eq. 18 with the mean of Eq. 22 over heights in
/// place of the product of Eq. 23.
struct Averaged {
    smith: Smith,
    smoothness: f64,
}

impl Averaged {
    fn new(s: f64, material: Material) -> Self {
        Self {
            smith: Smith::new(isotropic(s), material, Masking::Separable).unwrap(),
            smoothness: s,
        }
    }

    /// The exponent of the distribution of heights that makes `V(0, theta)` Eq. 24.
    fn exponent(&self, w: DVec3) -> f64 {
        let x = w.x.hypot(w.y) / w.z.abs() / self.smoothness;
        0.7 * x * (-0.25 / (x * x)).exp() / LN_2
    }

    /// Eq. 22: `int_0^1 u^(a + b) du` on one side, `int_0^1 u^a (1 - u)^b du` across the surface.
    fn mean_of_product(&self, wi: DVec3, wo: DVec3) -> f64 {
        let (a, b) = (self.exponent(wi), self.exponent(wo));
        if wo.z > 0.0 {
            1.0 / (1.0 + a + b)
        } else if a.max(b) > 1e3 {
            // Below exp(-50) but for directions that carry no light.
            0.0
        } else {
            (asperity_numerics::elementary::lgamma(1.0 + a)
                + asperity_numerics::elementary::lgamma(1.0 + b)
                - asperity_numerics::elementary::lgamma(2.0 + a + b))
            .exp()
        }
    }
}

impl ScatteringModel for Averaged {
    fn info(&self) -> &'static ModelInfo {
        &ModelInfo {
            name: "averaged",
            description: "Eq. 22",
            valid_range: "this test",
            scope: Scope::SingleScattering,
            sides: Sides::Both,
        }
    }

    fn material(&self) -> Material {
        self.smith.material()
    }
    fn slopes(&self) -> SlopeDistribution {
        self.smith.slopes()
    }
    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(self)
    }
}

impl BsdfModel for Averaged {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        // All facets of Eq. 18, whatever is visible of them: without its fraction of visible facets.
        let bare = self.smith.bsdf(wi, wo);
        if bare == 0.0 {
            return 0.0;
        }
        let g1 = |w| Beckmann::new(self.slopes().covariance()).g1(w);
        bare / (g1(wi) * g1(wo)) * self.mean_of_product(wi, wo)
    }
}

/// The p value of singly scattered light in bins against the exact one.
///
/// With 200 batches the square of a t value has mean 199 / 197, one percent above that of a normal one. Bins
/// that few rays reach are left out, since their errors are not known.
fn single_p_value(walked: &Expectation, exact: &dyn BsdfModel, theta_deg: f64) -> f64 {
    let spec = spec();
    let exact = bin_fluxes(exact, light(theta_deg).0.wi(), &spec.grid());
    let hits = |side| spec.hit_entries(side, Component::Single);
    let hits: Vec<_> = Side::BOTH.into_iter().flat_map(hits).collect();
    let errors = walked.statistics().error_squares();
    let (mut chi_squared, mut bins) = (0.0, 0);
    for (k, i) in spec.grid_entries(Component::Single).iter().enumerate() {
        let rays = walked.statistics().means()[hits[k]] * walked.rays() as f64;
        if rays < 200.0 {
            continue;
        }
        let d = walked.statistics().means()[i] - exact[k];
        chi_squared += d * d / errors[i] * (197.0 / 199.0);
        bins += 1;
    }
    assert!(bins >= 18, "{bins} bins");
    let p = chi_squared_survival(chi_squared, bins);
    println!(
        "{} {theta_deg} deg: chi^2 {chi_squared:.1} in {bins} bins, p {p:.4}",
        walked.rays()
    );
    p
}

fn fluxes(walked: &Expectation) -> [f64; 5] {
    walked.statistics().means().budget().parts()
}

/// The sum of all that is booked and its standard error, from batches.
fn budget(walked: &Expectation) -> (f64, f64) {
    let sums: Vec<f64> = walked
        .tallies()
        .iter()
        .map(|tally| tally.budget().total())
        .collect();
    let n = sums.len() as f64;
    let mean = sums.iter().sum::<f64>() / n;
    let variance = sums.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

#[test]
fn single_scattering_is_the_mean_over_heights() {
    // Six tests: Sidak's level for 1e-3 together is 1.7e-4.
    for (i, (s, theta, eta)) in [(1.0, 30.0, 1.4), (3.0, 60.0, 1.4), (1.0, 60.0, 1.0 / 1.4)]
        .into_iter()
        .enumerate()
    {
        let material = Material::dielectric(eta).unwrap();
        for name in BOTH {
            let model = create_model(name, isotropic(s), material).unwrap();
            let walked = followed(model.as_ref(), theta, 60_000, i as u64);
            let p = if name == "xu-sun-mc" {
                single_p_value(&walked, &Averaged::new(s, material), theta)
            } else {
                let smith = closed_form("smith", isotropic(s), material).unwrap();
                single_p_value(&walked, smith.as_ref(), theta)
            };
            assert!(p > 1.7e-4, "{name} s {s} theta {theta}: p {p}");
        }
    }
}

#[test]
fn mean_weights_are_the_mean_visibility_of_lit_facets() {
    // E[W / cos(theta_i)] = E[V] (1 + Lambda), and nothing is lost after the first hit. For Smith's visibility
    // it is one. At height zero it would be 0.862, 0.510 and 0.0725 for that of Eq. 24; over heights it is more.
    let slopes = isotropic(1.0);
    for (theta, expected) in [(30.0, 0.818_209), (60.0, 0.596_909), (80.0, 0.557_312)] {
        let wi = light(theta).0.wi();
        let v = xu_sun_visibility(wi, 1.0);
        let facing = 1.0 + Beckmann::new(slopes).lambda(wi);
        let over_heights = facing / (1.0 - v.ln() / LN_2);
        println!(
            "{theta}: at height zero {:.4}, over heights {over_heights:.4}",
            v * facing
        );
        assert!((over_heights - expected).abs() < 5e-4, "{over_heights}");
        for (name, mean) in BOTH.into_iter().zip([over_heights, 1.0]) {
            let model = create_model(name, slopes, glass()).unwrap();
            let (found, error) = budget(&followed(model.as_ref(), theta, 30_000, 5));
            let z = (found - mean) / error;
            println!("{name}: {found:.4} +- {error:.4}, z {z:.2}");
            assert!(z.abs() < 4.0 && error < 0.02);
        }
    }
}

/// A ray above the surface or below it, as a test follows it.
struct Leaving {
    direction: DVec3,
    above: bool,
    flux: f64,
}

/// Light from `v`, above or below, that a facet `m` (up) reflects and refracts.
fn at_facet(v: DVec3, above: bool, m: DVec3, eta: f64) -> [Leaving; 2] {
    let (m, eta) = if above { (m, eta) } else { (-m, 1.0 / eta) };
    let fresnel = dielectric(v.dot(m).min(1.0), eta);
    let down = if fresnel.transmitted > 0.0 {
        refract(v, m, eta, fresnel.cos_theta_t)
    } else {
        -v
    };
    [
        Leaving {
            direction: reflect(v, m),
            above,
            flux: fresnel.reflected,
        },
        Leaving {
            direction: down,
            above: !above,
            flux: fresnel.transmitted,
        },
    ]
}

#[test]
fn double_scattering_is_by_two_independent_facets() {
    // The four paths of two events, with the choices of the model written out another way: normals of the second
    // facet are drawn from all and weighted by 1 / P(facing), P the normal distribution at cot / deviation, and the
    // last visibility is its mean over heights, 1 / (1 + exponent).
    let (s, eta, theta, rays) = (1.0, 1.4, 30.0, 100_000);
    let slopes = isotropic(s);
    let deviation = std::f64::consts::SQRT_2 / s;
    let wi = light(theta).0.wi();
    let phi = |x: f64| 0.5 * asperity_numerics::elementary::erfc(-x / std::f64::consts::SQRT_2);
    for (name, seed) in BOTH.into_iter().zip([21, 22]) {
        let averaged = Averaged::new(s, glass());
        let exponent = |w: DVec3| match name {
            "xu-sun-mc" => averaged.exponent(w),
            _ => Beckmann::new(slopes).lambda(w),
        };
        let outward = |ray: &Leaving| ray.above == (ray.direction.z > 0.0);
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let normal = |rng: &mut ChaCha8Rng| {
            let radius = deviation * (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
            let slope = radius * DVec2::from_angle(TAU * rng.random::<f64>());
            (-slope).extend(1.0).normalize()
        };
        let (mut sums, mut squares) = ([0.0; 4], [0.0; 4]);
        for _ in 0..rays {
            let (u, m) = (rng.random::<f64>(), normal(&mut rng));
            let second = normal(&mut rng);
            if wi.dot(m) <= 0.0 {
                continue;
            }
            let lit = u.powf(exponent(wi)) * wi.dot(m) / (m.z * wi.z);
            for (i, first) in at_facet(wi, true, m, eta).into_iter().enumerate() {
                let clear = if first.above { u } else { 1.0 - u };
                let blocked = if outward(&first) {
                    1.0 - clear.powf(exponent(first.direction))
                } else {
                    1.0
                };
                let v = -first.direction;
                let front = if first.above { v } else { -v };
                if first.flux == 0.0 || front.dot(second) <= 0.0 {
                    continue;
                }
                let facing = phi(front.z / front.x.hypot(front.y) / deviation);
                for (j, last) in at_facet(v, first.above, second, eta)
                    .into_iter()
                    .enumerate()
                {
                    if outward(&last) {
                        let seen = 1.0 / (1.0 + exponent(last.direction));
                        let flux = lit * first.flux * blocked / facing * last.flux * seen;
                        sums[i + 2 * j] += flux;
                        squares[i + 2 * j] += flux * flux;
                    }
                }
            }
        }
        let model = create_model(name, slopes, glass()).unwrap();
        let walked = followed(model.as_ref(), theta, 100_000, 4);
        for code in 0..4_usize {
            // Bit k of the code is a transmission at hit k.
            let side = match code.count_ones() {
                1 => Side::Transmitted,
                _ => Side::Reflected,
            };
            let entry = spec().event_path_entry(side, EventPath::from_code(2, code as u32));
            let found = walked.statistics().at(entry);
            let mean = sums[code] / f64::from(rays);
            let variance = (squares[code] / f64::from(rays) - mean * mean) / f64::from(rays);
            let z = (found.mean - mean) / found.se.unwrap().hypot(variance.sqrt());
            println!(
                "{name} path {code:02b}: {:.5} here, {mean:.5} there, z {z:.2}",
                found.mean
            );
            if code == 3 {
                // A ray that passes from a prism to air is bent towards its thick end, which is below.
                assert!(eta > 1.0 && found.mean == 0.0 && mean == 0.0);
                continue;
            }
            // Six values: beyond 4 once in 2600 runs.
            assert!(z.abs() < 4.0 && mean > 0.0, "{name} {code}");
        }
    }
}

#[test]
fn a_conductor_absorbs_what_it_does_not_reflect() {
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let model = create_model("xu-sun-mc-smith", isotropic(1.5), gold).unwrap();
    let walked = followed(model.as_ref(), 45.0, 50_000, 3);
    let [reflected, transmitted, absorbed, truncated, lost] = fluxes(&walked);
    let (sum, error) = budget(&walked);
    assert!(transmitted == 0.0 && lost == 0.0 && truncated < 1e-6);
    assert!(reflected > 0.8 && absorbed > 0.05);
    assert!((sum - 1.0).abs() < 4.0 * error);
}

#[test]
fn a_mirror_reflects_all_light() {
    let model = create_model("xu-sun-mc-smith", isotropic(1.0), Material::Mirror).unwrap();
    let walked = followed(model.as_ref(), 30.0, 50_000, 3);
    let [reflected, transmitted, absorbed, truncated, lost] = fluxes(&walked);
    let (_, error) = budget(&walked);
    assert_eq!([transmitted, absorbed, lost], [0.0; 3]);
    assert!(truncated < 1e-3);
    assert!(
        (reflected + truncated - 1.0).abs() < 4.0 * error,
        "{reflected} {error}"
    );
}

#[test]
fn a_nearly_smooth_surface_is_flat() {
    // Slopes of variance 2e-4 change Fresnel's terms by a few times that.
    for name in BOTH {
        for eta in [1.4, 1.0 / 1.4] {
            let model =
                create_model(name, isotropic(100.0), Material::dielectric(eta).unwrap()).unwrap();
            let [reflected, transmitted, ..] = fluxes(&followed(model.as_ref(), 30.0, 20_000, 1));
            let flat = dielectric(f64::to_radians(30.0).cos(), eta);
            assert!((reflected - flat.reflected).abs() < 1e-3);
            assert!((transmitted - flat.transmitted).abs() < 1e-3);
        }
    }
}

#[test]
fn the_threshold_truncates_little() {
    // A ray that ends has less than 1e-5; what ends is then below that times the rays that split off.
    for name in BOTH {
        for (s, eta) in [
            (0.5, 1.4),
            (1.0, 1.4),
            (3.0, 1.4),
            (0.5, 1.0 / 1.4),
            (1.0, 1.0 / 1.4),
        ] {
            let model =
                create_model(name, isotropic(s), Material::dielectric(eta).unwrap()).unwrap();
            for theta in [30.0, 80.0] {
                let [.., truncated, _] = fluxes(&followed(model.as_ref(), theta, 4000, 1));
                println!("{name} s {s} eta {eta:.3} theta {theta}: ended {truncated:.2e}");
                assert!(truncated < 1e-4);
            }
        }
    }
}

#[test]
fn turning_the_surface_turns_the_scattered_light() {
    // Slopes of (xx, yy, xy) turned by 90 deg are (yy, xx, -xy); two independent runs, bin by bin.
    let here = SlopeCovariance::new(0.5, 0.1, 0.1).unwrap();
    let there = SlopeCovariance::new(0.1, 0.5, -0.1).unwrap();
    let spec = spec();
    let run = |slopes, phi: f64, seed| {
        let model = create_model("xu-sun-mc-smith", slopes, glass()).unwrap();
        let incidence = Incidence::from_degrees(40.0, phi).unwrap();
        let azimuth = Azimuth::From(incidence.phi() + std::f64::consts::PI);
        let effort = SamplingEffort {
            rays: 60_000,
            batches: 200,
            seed,
        };
        expect(model.as_ref(), incidence, &spec, azimuth, effort)
    };
    let p_value = |a: &Expectation, b: &Expectation| {
        let n = spec.grid().n_phi();
        let errors = [a, b].map(|e| e.statistics().error_squares());
        let (mut chi_squared, mut bins) = (0.0, 0);
        let entries = spec.grid_entries(Component::All);
        for k in 0..spec.grid().len() {
            let turned = k / n * n + (k % n + n / 4) % n;
            let (i, j) = (entries.get(k), entries.get(turned));
            let variance = errors[0][i] + errors[1][j];
            let means = [a.statistics().means()[i], b.statistics().means()[j]];
            if means[0].min(means[1]) > 1e-3 {
                chi_squared += (means[0] - means[1]) * (means[0] - means[1]) / variance;
                bins += 1;
            }
        }
        assert!(bins >= 12, "{bins}");
        chi_squared_survival(chi_squared, bins)
    };
    let first = run(here, 20.0, 1);
    let p = p_value(&first, &run(there, 110.0, 2));
    let unturned = p_value(&first, &run(here, 110.0, 3));
    println!("turned p {p:.4}, surface left as it was p {unturned:e}");
    assert!(p > 1e-3 && unturned < 1e-10);
}

#[test]
fn only_smiths_visibility_accepts_anisotropic_slopes() {
    let slopes = SlopeCovariance::new(0.5, 0.1, 0.1).unwrap();
    let error = create_model("xu-sun-mc", slopes, glass())
        .map(|model| model.name())
        .unwrap_err();
    assert!(
        matches!(
            error,
            ModelError::Anisotropic {
                model: "xu-sun-mc",
                ..
            }
        ),
        "{error}"
    );
    assert!(
        error
            .to_string()
            .starts_with("the model xu-sun-mc is defined for isotropic surfaces")
    );
    assert!(create_model("xu-sun-mc-smith", slopes, glass()).is_ok());
}

#[test]
fn results_do_not_depend_on_the_thread_count() {
    for name in BOTH {
        let model = create_model(name, isotropic(0.7), glass()).unwrap();
        let [one, two] = [1, 2].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| followed(model.as_ref(), 50.0, 4000, 9))
                .tallies()
                .to_vec()
        });
        assert_eq!(one, two);
        assert!(one[0] != one[1]);
    }
}

#[test]
fn eq_23_differs_from_the_mean_that_it_approximates() {
    // Transmitted and reflected single scattering at 30 deg, n = 1.4: with the mean of Eq. 22 over heights, and
    // with the product at height zero of Eq. 23 in its place, which is Eq. 25. Heights oppose each other in
    // transmission, so that Eq. 23 is too high there, and agree in reflection, where it is too low.
    for (s, mean, eq25) in [
        (3.0, [0.957_896, 0.021_370], [0.958_038, 0.021_278]),
        (1.0, [0.510_992, 0.002_858], [0.596_959, 0.002_109]),
        (0.5, [0.129_287, 0.000_431], [0.190_799, 0.000_162]),
    ] {
        let wi = light(30.0).0.wi();
        let average = hemispherical_energy(&Averaged::new(s, glass()), wi);
        let model = closed_form("xu-sun", isotropic(s), glass()).unwrap();
        let at_zero = hemispherical_energy(model.as_ref(), wi);
        for (energy, expected) in [(average, mean), (at_zero, eq25)] {
            let found = [energy.transmitted, energy.reflected];
            println!("s {s}: {found:?}");
            // Six digits are given.
            assert!(
                found
                    .iter()
                    .zip(expected)
                    .all(|(a, b)| (a - b).abs() < 6e-7)
            );
        }
    }
}

#[test]
fn rays_terminate_on_any_surface() {
    // Nearly upright facets, nearly none, and slopes at the ends of what numbers hold.
    for s in [1e-150, 1e-3, 0.05, 1e9] {
        for material in [
            Material::Mirror,
            glass(),
            Material::dielectric(1.0 / 1.4).unwrap(),
        ] {
            for name in BOTH {
                let model = create_model(name, isotropic(s), material).unwrap();
                for theta in [0.0, 60.0, 89.99] {
                    let found = fluxes(&in_batches(model.as_ref(), theta, 10, 2, 2));
                    assert!(
                        found.iter().all(|flux| flux.is_finite() && *flux >= 0.0),
                        "{name} {s} {theta} {found:?}"
                    );
                    assert_eq!(found[4], 0.0);
                }
            }
        }
    }
}
