//! Light in apertures about the specular direction, against closed forms and quadrature.

use std::f64::consts::{PI, TAU};

use asperity_optics::{Incidence, Material, dielectric};
use asperity_simulate::{
    Case, CaseApertures, Effort, Estimator, Light, Outcome, Settings, SurfaceSource,
};
use asperity_surface::HeightField;
use asperity_tally::{Aperture, Estimate, TallyResult};
use glam::DVec3;

use crate::support::{Rough, glass, run};

/// Flux into an aperture.
fn light(outcome: &Outcome, aperture: Option<Aperture>) -> Estimate {
    let statistics = &outcome.statistics;
    let number = statistics.spec().apertures().position(aperture.unwrap());
    statistics.apertures().nth(number.unwrap()).unwrap()
}

fn flat(material: Material, theta: f64, rays: u64) -> Outcome {
    let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0, 1.0]).unwrap();
    let incidence = Incidence::from_degrees(theta, 40.0).unwrap();
    let source = SurfaceSource::height_field(field);
    let settings = Settings {
        effort: Effort::rays(rays),
        ..Settings::default()
    };
    run(
        Case::new(source, material, Light::from_above(incidence)),
        &settings,
    )
}

fn assert_near(found: Estimate, expected: f64, what: &str) {
    let z = (found.mean - expected) / found.se.unwrap();
    println!("{what}: {} expected {expected}, z {z:.2}", found.mean);
    assert!(z.abs() < 4.0, "{what}: {found:?}, expected {expected}");
}

/// A rectangle of 0.75 by 2.5 degrees, moved, in one of these full angles, degrees: its part inside.
fn in_receptor(offset: [f64; 2], receptor: [f64; 2]) -> f64 {
    let part = |i: usize| {
        let half = 0.5 * [0.75_f64, 2.5][i].to_radians();
        let edge = 0.5 * receptor[i].to_radians();
        let ends = [offset[i] - half, offset[i] + half].map(|end| end.clamp(-edge, edge));
        (ends[1] - ends[0]) / (2.0 * half)
    };
    part(0) * part(1)
}

#[test]
fn a_flat_sample_sends_all_light_into_its_apertures() {
    for theta in [0.0, 20.0, 60.0, 85.0] {
        let outcome = flat(glass(), theta, 1000);
        let apertures = CaseApertures::of(&outcome.case);
        let eta = glass().transmitting_index().unwrap();
        let fresnel = dielectric(theta.to_radians().cos(), eta);
        let inside = [
            (Some(apertures.specular), fresnel.reflected),
            (apertures.straight, fresnel.transmitted),
            (apertures.clear, fresnel.transmitted),
        ];
        let gloss = apertures.gloss.map(|one| (Some(one), fresnel.reflected));
        assert_eq!(gloss.is_some(), theta > 0.0);
        for (aperture, expected) in inside.into_iter().chain(gloss) {
            let found = light(&outcome, aperture).mean;
            assert!((found - expected).abs() < 1e-14, "{theta}: {aperture:?}");
        }
    }
}

/// The cosine law: `sin^2` of the half angle about the normal, and about 60 degrees the integral over a trapezoid.
#[test]
fn a_lambertian_sample_fills_apertures_by_the_cosine_law() {
    let white = Material::lambertian(1.0).unwrap();
    let outcome = flat(white, 0.0, 4_000_000);
    let specular = CaseApertures::of(&outcome.case).specular;
    let sin = 2_f64.to_radians().sin();
    assert_near(light(&outcome, Some(specular)), sin * sin, "cone");

    let outcome = flat(white, 60.0, 4_000_000);
    let gloss = CaseApertures::of(&outcome.case).gloss;
    let (n, reach) = (400, 10_f64.to_radians());
    let step = 2.0 * reach / f64::from(n);
    let at = |i: i32| (f64::from(i) + 0.5) * step - reach;
    let mut expected = 0.0;
    for (along, across) in (0..n).flat_map(|i| (0..n).map(move |j| (at(i), at(j)))) {
        let weight = in_receptor([along, across], [4.4, 11.7]);
        let cos = across.cos() * (PI / 3.0 + along).cos();
        expected += weight * cos / PI * across.cos() * step * step;
    }
    assert_near(light(&outcome, gloss), expected, "gloss");
}

/// Gaussian slopes so small that light is scattered once and nothing is shadowed: quadrature over the slopes of facets, each with the light that
/// falls on it.
#[test]
fn small_slopes_fill_apertures_as_their_distribution_says() {
    let rough = Rough::smooth(120.0, 4.0, 128);
    // Slopes of flat facets, one length unit wide
    let variance = 2.0 * rough.sigma.powi(2) * (1.0 - (-rough.tau.powi(-2)).exp());
    let deviation = variance.sqrt();
    let incidence = Incidence::from_degrees(60.0, 0.0).unwrap();
    let wi = incidence.wi();
    let centre = DVec3::new(-wi.x, 0.0, wi.z);
    let (n, reach) = (1200, 6.0 * deviation);
    let step = 2.0 * reach / f64::from(n);
    let at = |i: i32| (f64::from(i) + 0.5) * step - reach;
    let [mut cone, mut gloss] = [0.0; 2];
    for (p, q) in (0..n).flat_map(|i| (0..n).map(move |j| (at(i), at(j)))) {
        let density = (-0.5 * (p * p + q * q) / deviation.powi(2)).exp();
        let weight = density / (TAU * deviation.powi(2)) * step * step;
        let facet = DVec3::new(-p, -q, 1.0);
        let m = facet.normalize();
        let falls = weight * (facet.dot(wi) / wi.z).max(0.0);
        let wo = 2.0 * wi.dot(m) * m - wi;
        if wo.angle_between(centre) <= 2_f64.to_radians() {
            cone += falls;
        }
        let along = (-wo.x).atan2(wo.z) - PI / 3.0;
        gloss += falls * in_receptor([along, wo.y.asin()], [4.4, 11.7]);
    }
    for estimator in [Estimator::Plain, Estimator::Controlled] {
        let settings = Settings {
            estimator,
            effort: Effort::Rays {
                total: 400_000,
                surfaces: 64,
            },
            ..Settings::default()
        };
        let outcome = run(rough.case(Material::Mirror, 60.0), &settings);
        let apertures = CaseApertures::of(&outcome.case);
        let name = format!("{estimator:?}");
        assert_near(light(&outcome, Some(apertures.specular)), cone, &name);
        assert_near(light(&outcome, apertures.gloss), gloss, &name);
    }
}

/// Rough glass, with and without a control variate, which apertures have no part in.
#[test]
fn controlled_and_plain_runs_agree_in_apertures() {
    for (smoothness, theta) in [(20.0, 20.0), (8.0, 60.0), (4.0, 85.0)] {
        let outcome = |estimator, seed| {
            let settings = Settings {
                estimator,
                seed,
                effort: Effort::Rays {
                    total: 200_000,
                    surfaces: 32,
                },
                ..Settings::default()
            };
            run(
                Rough::smooth(smoothness, 4.0, 64).case(glass(), theta),
                &settings,
            )
        };
        let [plain, controlled] = [
            outcome(Estimator::Plain, 1),
            outcome(Estimator::Controlled, 2),
        ];
        assert!(controlled.work.control_variate.is_some());
        let pairs = plain
            .statistics
            .apertures()
            .zip(controlled.statistics.apertures());
        for (number, (a, b)) in pairs.enumerate() {
            let se = a.se.unwrap().hypot(b.se.unwrap());
            let difference = b.mean - a.mean;
            println!("s = {smoothness}, {number}: {a:?} {b:?}");
            assert!(difference.abs() < 4.0 * se + 1e-13, "{number}: {a:?} {b:?}");
        }
    }
}
