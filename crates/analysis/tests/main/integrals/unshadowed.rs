//! Unshadowed single scattering against facets drawn at random, against integrals over slopes, and
//! against itself turned and divided.

use std::f64::consts::{PI, TAU};

use asperity_analysis::{
    Beckmann, BsdfModel, ModelError, ModelInfo, ScatteringModel, Scope, SlopeCovariance,
    SlopeDistribution, SlopeMixture, bin_fluxes, control_variate, hemispherical_energy,
    reflecting_facet, refracting_facet, sidak_z_threshold, unshadowed_fluxes, visible_fractions,
};
use asperity_optics::{Incidence, Material, azimuth, polar_angle, reflect, refract};
use asperity_tally::{
    Component, HemisphereGrid, Side, Sides, TallyResult, TallySpec, UnshadowedFluxes,
};
use glam::DVec3;

use crate::common::closed_form;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Slopes whose deviations along the principal directions are `long` and `short`, the former at
/// `angle` degrees from x.
fn grooved(long: f64, short: f64, angle: f64) -> SlopeCovariance {
    let (s, c) = angle.to_radians().sin_cos();
    let (long, short) = (long * long, short * short);
    SlopeCovariance::new(
        long * c * c + short * s * s,
        long * s * s + short * c * c,
        (long - short) * s * c,
    )
    .unwrap()
}

fn isotropic(smoothness: f64) -> SlopeCovariance {
    SlopeCovariance::isotropic(smoothness).unwrap()
}

fn light(theta: f64, phi: f64) -> Incidence {
    Incidence::from_degrees(theta, phi).unwrap()
}

fn glass(eta: f64) -> Material {
    Material::dielectric(eta).unwrap()
}

fn spec(n_theta: usize, n_phi: usize) -> TallySpec {
    TallySpec::new(HemisphereGrid::new(n_theta, n_phi).unwrap(), 0.1).unwrap()
}

/// Unmasked scattering, put together from the formulae for a direction.
struct Unmasked {
    slopes: SlopeCovariance,
    material: Material,
}

impl ScatteringModel for Unmasked {
    fn info(&self) -> &'static ModelInfo {
        &ModelInfo {
            name: "unshadowed",
            description: "neither shadowing nor masking",
            valid_range: "nowhere",
            scope: Scope::SingleScattering,
            sides: Sides::Both,
        }
    }

    fn material(&self) -> Material {
        self.material
    }

    fn slopes(&self) -> SlopeDistribution {
        self.slopes.into()
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(self)
    }
}

impl BsdfModel for Unmasked {
    fn bsdf(&self, wi: DVec3, wo: DVec3) -> f64 {
        let facet = if wo.z > 0.0 {
            reflecting_facet(wi, wo)
        } else {
            self.material
                .transmitting_index()
                .and_then(|eta| refracting_facet(wi, wo, eta))
        };
        facet.map_or(0.0, |facet| {
            let fresnel = self.material.fresnel(facet.cos_theta_i.min(1.0));
            let part = if wo.z > 0.0 {
                fresnel.reflected
            } else {
                fresnel.transmitted
            };
            let d = Beckmann::new(self.slopes).d(facet.m);
            facet.cos_theta_i * part * d * facet.chi / (wi.z * wo.z.abs())
        })
    }
}

/// Means over drawn facets, and their variances: bins, in-plane bins of both sides, absorbed, and all
/// that facets do, what is left out included.
fn drawn(
    slopes: &SlopeCovariance,
    material: Material,
    incidence: Incidence,
    spec: &TallySpec,
    facets: u32,
    rng: &mut ChaCha8Rng,
) -> Vec<[f64; 2]> {
    let grid = spec.grid();
    let wi = incidence.wi();
    let in_plane = |side: Side, wo: DVec3| -> Option<usize> {
        let n = grid.n_theta();
        let from_normal = match side {
            Side::Reflected => polar_angle(wo),
            Side::Transmitted => PI - polar_angle(wo),
        };
        let step = ((from_normal / (0.5 * PI) * n as f64) as usize).min(n - 1);
        let off = |azimuth_of_half: f64| {
            let off = (azimuth(wo) - azimuth_of_half).rem_euclid(TAU);
            off.min(TAU - off) <= spec.in_plane_half_width()
        };
        let start = grid.len() + side.index() * spec.in_plane_filter(side).len();
        if off(incidence.phi() + PI) {
            Some(start + n + step)
        } else if off(incidence.phi()) {
            Some(start + n - 1 - step)
        } else {
            None
        }
    };
    let absorbed = grid.len() + 2 * spec.in_plane_len();
    let mut sums = vec![[0.0; 2]; absorbed + 2];
    // Cholesky's root of the covariance.
    let a = slopes.xx().sqrt();
    let b = slopes.xy() / a;
    let c = (slopes.yy() - b * b).sqrt();
    for _ in 0..facets {
        let radius = (-2.0 * (1.0 - rng.random::<f64>()).ln()).sqrt();
        let (s, t) = (TAU * rng.random::<f64>()).sin_cos();
        let (u, v) = (radius * t, radius * s);
        let m = DVec3::new(-a * u, -b * u - c * v, 1.0).normalize();
        let cos_theta_i = wi.dot(m);
        if cos_theta_i <= 0.0 {
            continue;
        }
        let weight = cos_theta_i / (m.z * wi.z);
        let fresnel = material.fresnel(cos_theta_i.min(1.0));
        let mut book = |i: usize, flux: f64| {
            sums[i][0] += flux;
            sums[i][1] += flux * flux;
        };
        book(absorbed + 1, weight);
        let mut send = |side: Side, wo: DVec3, flux: f64| {
            book(grid.index_of(side, wo), flux);
            if let Some(i) = in_plane(side, wo) {
                book(i, flux);
            }
        };
        let wo = reflect(wi, m);
        if wo.z > 0.0 {
            send(Side::Reflected, wo, weight * fresnel.reflected);
        }
        match material.transmitting_index() {
            Some(eta) if fresnel.transmitted > 0.0 => {
                let wo = refract(wi, m, eta, fresnel.cos_theta_t);
                if wo.z < 0.0 {
                    send(Side::Transmitted, wo, weight * fresnel.transmitted);
                }
            }
            Some(_) => {}
            None => book(absorbed, weight * fresnel.transmitted),
        }
    }
    let n = f64::from(facets);
    sums.iter()
        .map(|[sum, squares]| {
            let mean = sum / n;
            [mean, (squares / n - mean * mean) / n]
        })
        .collect()
}

fn flat(fluxes: &UnshadowedFluxes, facing: f64) -> Vec<f64> {
    [
        &fluxes.bins[..],
        &fluxes.in_plane[0],
        &fluxes.in_plane[1],
        &[fluxes.absorbed, facing],
    ]
    .concat()
}

#[test]
fn fluxes_agree_with_randomly_sampled_facets() {
    let spec = spec(9, 12);
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let cases = [
        (isotropic(1.0), glass(1.5), light(30.0, 20.0)),
        (isotropic(100.0), glass(1.5), light(50.0, 45.0)),
        (isotropic(0.25), glass(1.0 / 1.5), light(60.0, 200.0)),
        (isotropic(3.0), gold, light(85.0, 0.0)),
        (grooved(0.9, 0.3, 25.0), glass(1.5), light(40.0, 100.0)),
        (
            grooved(0.5, 0.05, 70.0),
            glass(1.0 / 1.5),
            light(65.0, 10.0),
        ),
        (grooved(0.5, 0.05, -30.0), glass(1.01), light(0.0, 10.0)),
        (grooved(0.8, 0.4, 50.0), gold, light(70.0, 300.0)),
        (grooved(4.0, 0.4, 10.0), Material::Mirror, light(85.0, 60.0)),
        (grooved(0.02, 0.002, 40.0), glass(1.5), light(60.0, 5.0)),
    ];
    let facets = 100_000;
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let mut family = Vec::new();
    for (number, (slopes, material, incidence)) in cases.into_iter().enumerate() {
        let facing = 1.0 + Beckmann::new(slopes).lambda(incidence.wi());
        let heaviest = 1.0 + 5.0 * incidence.theta().tan() * slopes.xx().max(slopes.yy()).sqrt();
        let fluxes = unshadowed_fluxes(&slopes, material, incidence, &spec).unwrap();
        let expected = flat(&fluxes, facing);
        let drawn = drawn(&slopes, material, incidence, &spec, facets, &mut rng);
        for (i, (expected, [mean, variance])) in expected.iter().zip(drawn).enumerate() {
            // Sums of hundred facets or more are near enough to Gaussian, for weights that differ little.
            // What all facets do alike has no variance but rounding.
            let error = (mean - expected).abs();
            if mean * mean > 100.0 * variance && error > 1e-9 {
                family.push((error / variance.sqrt(), number, i));
            } else if mean == 0.0 {
                // No facet went there: below 1e-9 likely if 21 or more were expected, of weights that a
                // slope of five deviations has at most.
                let expected = expected * f64::from(facets);
                assert!(expected < 21.0 * heaviest, "{number} {i} {expected}");
            }
        }
    }
    let (z, number, i) = family
        .iter()
        .copied()
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap();
    println!("largest z of {}: {z} in case {number} at {i}", family.len());
    assert!(family.len() > 500);
    assert!(z < sidak_z_threshold(0.001, family.len()));
}

/// Slopes from steep lobes to facets steeper than any surface has, and narrow along one direction.
fn all_slopes() -> Vec<SlopeCovariance> {
    vec![
        isotropic(0.25),
        isotropic(100.0),
        grooved(0.5, 0.05, 33.0),
        grooved(5.0, 0.5, -20.0),
        grooved(0.014, 0.0014, 0.0),
        grooved(0.014, 0.0014, 130.0),
    ]
}

#[test]
fn sides_add_up_to_the_integral_over_facets() {
    // Each of 162 bins per side errs by at most about 1e-12, the integral over slopes by 1e-10 of
    // itself; sides are up to some thirty, where light grazes steep facets.
    let spec = spec(9, 18);
    let grid = spec.grid();
    let mut worst = 0.0_f64;
    for slopes in all_slopes() {
        for material in [glass(1.5), glass(1.0 / 1.5), glass(1.01), Material::Mirror] {
            for (theta, phi) in [(0.0, 0.0), (30.0, 37.0), (85.0, 200.0)] {
                let incidence = light(theta, phi);
                let fluxes = unshadowed_fluxes(&slopes, material, incidence, &spec).unwrap();
                let model = Unmasked { slopes, material };
                let energy = hemispherical_energy(&model, incidence.wi());
                for (side, expected) in [energy.reflected, energy.transmitted].iter().enumerate() {
                    let sum: f64 = fluxes.rings[side].iter().sum();
                    let of_bins: f64 = fluxes.bins[side * grid.bins_per_side()..]
                        [..grid.bins_per_side()]
                        .iter()
                        .sum();
                    assert!((sum - of_bins).abs() < 1e-13 * (1.0 + sum));
                    let error = (sum - expected).abs();
                    worst = worst.max(error);
                    assert!(
                        error < 1e-9,
                        "{slopes:?} {material:?} {theta} side {side}: {sum} {expected}"
                    );
                }
            }
        }
    }
    println!("largest error of a side: {worst:e}");
}

#[test]
fn a_bin_is_the_sum_of_its_subdivisions() {
    // The six parts of a bin and the bin itself, each to about 1e-12 or 1e-11 of itself.
    let (coarse, fine) = (spec(3, 4), spec(6, 12));
    for slopes in all_slopes() {
        for material in [glass(1.5), glass(1.0 / 1.5), glass(1.01)] {
            for theta in [0.0, 60.0, 85.0] {
                let incidence = light(theta, 47.3);
                let whole = unshadowed_fluxes(&slopes, material, incidence, &coarse).unwrap();
                let parts = unshadowed_fluxes(&slopes, material, incidence, &fine).unwrap();
                let mut sums = vec![0.0; coarse.grid().len()];
                for (i, flux) in parts.bins.iter().enumerate() {
                    sums[i / 12 / 2 * 4 + i % 12 / 3] += flux;
                }
                let mut in_plane = [vec![0.0; 6], vec![0.0; 6]];
                for (sums, parts) in in_plane.iter_mut().zip(&parts.in_plane) {
                    for (i, flux) in parts.iter().enumerate() {
                        sums[i / 2] += flux;
                    }
                }
                let all = [&whole.bins[..], &whole.in_plane[0], &whole.in_plane[1]].concat();
                let sums = [&sums[..], &in_plane[0], &in_plane[1]].concat();
                for (i, (a, b)) in all.iter().zip(&sums).enumerate() {
                    assert!(
                        (a - b).abs() < 1e-10 * (1.0 + a),
                        "{slopes:?} {material:?} {theta} bin {i}: {a} {b}"
                    );
                }
            }
        }
    }
}

#[test]
fn components_add_to_one_plus_lambda() {
    // Slopes of deviation 0.08 at most, eight deviations from reflecting light from 20 deg downwards
    // and more from turning away from it: 1e-15 is left out. 162 bins per side to 1e-12, and what
    // conductors absorb.
    let spec = spec(9, 18);
    for slopes in [isotropic(25.0), grooved(0.08, 0.01, 66.0)] {
        for material in [
            glass(1.5),
            glass(1.0 / 1.5),
            Material::conductor(1.2, 7.0).unwrap(),
            Material::Mirror,
        ] {
            let fluxes = unshadowed_fluxes(&slopes, material, light(20.0, 3.0), &spec).unwrap();
            let sum = fluxes.bins.iter().sum::<f64>() + fluxes.absorbed;
            assert!((sum - 1.0).abs() < 1e-9, "{material:?} {sum}");
        }
    }
}

#[test]
fn turning_light_and_surface_together_shifts_the_sectors() {
    // Quadrature begins with other pieces: each flux to about 1e-12, or 1e-11 of itself.
    let spec = spec(6, 36);
    for material in [glass(1.5), glass(1.0 / 1.5)] {
        for (long, short, theta) in [(0.5, 0.1, 55.0), (0.014, 0.0014, 0.0), (0.3, 0.3, 80.0)] {
            let at = |steps: usize| {
                let turn = 10.0 * steps as f64;
                let slopes = grooved(long, short, 20.0 + turn);
                unshadowed_fluxes(&slopes, material, light(theta, 5.0 + turn), &spec).unwrap()
            };
            let here = at(0);
            for steps in [1, 7, 20] {
                let there = at(steps);
                for i in 0..spec.grid().len() {
                    let turned = i / 36 * 36 + (i + steps) % 36;
                    let difference = here.bins[i] - there.bins[turned];
                    assert!(difference.abs() < 1e-10, "{i} {difference:e}");
                }
                for side in Side::BOTH.map(Side::index) {
                    for (a, b) in here.in_plane[side].iter().zip(&there.in_plane[side]) {
                        assert!((a - b).abs() < 1e-10);
                    }
                }
            }
        }
    }
}

#[test]
fn isotropic_fluxes_are_those_of_a_model_without_masking() {
    let spec = spec(9, 12);
    for material in [glass(1.5), Material::conductor(0.2, 3.0).unwrap()] {
        let slopes = isotropic(2.0);
        let incidence = light(50.0, 30.0);
        let fluxes = unshadowed_fluxes(&slopes, material, incidence, &spec).unwrap();
        let model = Unmasked { slopes, material };
        let expected = bin_fluxes(&model, incidence.wi(), &spec.grid());
        for (a, b) in fluxes.bins.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-12);
        }
    }
}

#[test]
fn visible_fractions_are_smiths_fluxes_over_unshadowed_ones() {
    let spec = spec(18, 12);
    let mut between = 0;
    for s in [0.5, 1.0, 3.0] {
        for (material, theta) in [
            (glass(1.5), 40.0),
            (glass(1.0 / 1.5), 70.0),
            (Material::Mirror, 85.0),
        ] {
            let incidence = light(theta, 30.0);
            let slopes = isotropic(s);
            let mixture = SlopeMixture::from(slopes);
            let fractions = visible_fractions(&mixture, material, incidence, &spec).unwrap();
            let again = visible_fractions(&mixture, material, incidence, &spec).unwrap();
            assert_eq!(fractions, again);
            let g1 = Beckmann::new(slopes).g1(incidence.wi());
            assert_eq!(fractions.absorbed, if g1 > 0.97 { 1.0 } else { g1 });
            let all = unshadowed_fluxes(&slopes, material, incidence, &spec).unwrap();
            let model = closed_form("smith", s, material);
            let visible = bin_fluxes(model.as_ref(), incidence.wi(), &spec.grid());
            for (i, visible) in visible.chunks(12).enumerate() {
                let fraction = fractions.rings[i / 18][i % 18];
                let unshadowed = all.rings[i / 18][i % 18];
                // Fluxes above 1e-9 are known to three digits here, and to two at least there.
                if unshadowed > 1e-9 {
                    let ratio = visible.iter().sum::<f64>() / unshadowed;
                    match fraction {
                        0.0 => assert!(ratio < 0.052, "{ratio}"),
                        1.0 => assert!(ratio > 0.967, "{ratio}"),
                        _ => {
                            between += 1;
                            assert!((ratio / fraction - 1.0).abs() < 0.004, "{ratio} {fraction}");
                        }
                    }
                } else if unshadowed < 1e-13 {
                    assert_eq!(fraction, 1.0);
                }
            }
        }
    }
    assert!(between > 80, "{between}");
}

#[test]
fn isotropic_visible_fractions_do_not_depend_on_the_quadrature() {
    // A slight anisotropy takes the general path. Both to three digits.
    let spec = TallySpec::default();
    for material in [glass(1.5), glass(1.0 / 1.5)] {
        let incidence = light(60.0, 0.0);
        let near = SlopeCovariance::new(0.5, 0.5 * (1.0 + 1e-9), 0.0).unwrap();
        let a = visible_fractions(&isotropic(2.0).into(), material, incidence, &spec).unwrap();
        let b = visible_fractions(&near.into(), material, incidence, &spec).unwrap();
        for (a, b) in a.rings.iter().flatten().zip(b.rings.iter().flatten()) {
            assert!((a - b).abs() < 0.004 || (a - b).abs() > 0.02 && (*a == 1.0 || *b == 1.0));
        }
    }
}

#[test]
fn a_control_variate_is_the_visible_fraction_of_the_fluxes() {
    let spec = TallySpec::default();
    let slopes = grooved(0.9, 0.3, 25.0);
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let incidence = light(70.0, 100.0);
    let fluxes = unshadowed_fluxes(&slopes, gold, incidence, &spec).unwrap();
    let control_variate = control_variate(&slopes.into(), gold, incidence, &spec).unwrap();
    let n_phi = spec.grid().n_phi();
    let bins = &control_variate.expected()[spec.grid_entries(Component::Single)];
    for (i, (expected, flux)) in bins.iter().zip(&fluxes.bins).enumerate() {
        if i < spec.grid().bins_per_side() {
            assert_eq!(
                *expected,
                flux * control_variate.fraction(Side::Reflected, i / n_phi)
            );
        } else {
            assert_eq!(*expected, 0.0);
        }
    }
    let rings = &control_variate.expected()[spec.ring_entries(Side::Reflected, Component::Single)];
    let sum: f64 = rings.iter().sum();
    assert!((sum - control_variate.expected().budget().reflected).abs() < 1e-14);
    let absorbed = control_variate.absorbed_fraction() * fluxes.absorbed;
    assert_eq!(control_variate.expected().budget().absorbed, absorbed);
    // Smith's masking sends away less than falls in, and at 70 deg most of it.
    assert!((0.5..1.0).contains(&(sum + absorbed)), "{sum} {absorbed}");
}

/// Each entry of a mixture is the sum over components of their fluxes, times one fraction, which lies between those of components.
#[test]
fn the_control_variate_of_a_mixture_is_the_sum_over_its_components() {
    let spec = spec(9, 12);
    let base = grooved(0.3, 0.1, 25.0);
    let components = [(0.7, base), (0.3, grooved(0.9, 0.3, 25.0))];
    let gold = Material::conductor(0.21, 3.272).unwrap();
    let incidence = light(60.0, 20.0);
    let mixture = SlopeMixture::scaled(&base, &[[1.0, 1.4], [9.0, 0.6]]).unwrap();
    let control = control_variate(&mixture, gold, incidence, &spec).unwrap();
    let of = |slopes: SlopeCovariance| {
        let fluxes = unshadowed_fluxes(&slopes, gold, incidence, &spec).unwrap();
        let fractions = visible_fractions(&slopes.into(), gold, incidence, &spec).unwrap();
        (fluxes, fractions.rings[0].clone())
    };
    let [(first, low), (second, high)] = components.map(|(_, slopes)| of(slopes));
    let bins = &control.expected()[spec.grid_entries(Component::Single)];
    let of_side = &bins[..spec.grid().bins_per_side()];
    for (i, found) in of_side.iter().enumerate() {
        let ring = i / 12;
        let fraction = control.fraction(Side::Reflected, ring);
        let expected = fraction * (0.7 * first.bins[i] + 0.3 * second.bins[i]);
        assert!((found - expected).abs() < 1e-15, "{i}");
        let (low, high) = (low[ring].min(high[ring]), low[ring].max(high[ring]));
        // Fractions of both parts are rounded
        assert!(
            (low - 0.06..=high + 0.03).contains(&fraction),
            "{ring}: {low} {fraction} {high}"
        );
    }
    let absorbed = 0.7 * first.absorbed + 0.3 * second.absorbed;
    let found = control.expected().budget().absorbed / control.absorbed_fraction();
    assert!((found - absorbed).abs() < 1e-15);
}

#[test]
fn matched_indices_are_refused() {
    let spec = TallySpec::default();
    for eta in [1.0, 1.0 + 1e-6] {
        let refused = unshadowed_fluxes(&isotropic(1.0), glass(eta), light(0.0, 0.0), &spec);
        assert_eq!(refused, Err(ModelError::MatchedIndices(eta)));
        let slopes = isotropic(1.0).into();
        assert!(control_variate(&slopes, glass(eta), light(0.0, 0.0), &spec).is_err());
    }
}
