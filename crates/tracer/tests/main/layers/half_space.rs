//! A flat interface over a half space: the answers of radiative transfer.

use asperity_optics::{Layer, ParticipatingMedium, PhaseFunction, dielectric};
use asperity_tally::{Component, Side, TallyResult, TallySpec};

use super::{Scene, budget, flat, medium};
use crate::common::z_score;

/// Flux that leaves in the 18 bins of 5 deg of polar angle, of light that was scattered inside; vertical
/// light, n = 1.5, albedo .9, isotropic. From a quadrature of the integral equation of transfer with Fresnel's
/// equations at the boundary, by a program of its own.
const DIFFUSE_BY_ANGLE: [f64; 18] = [
    0.001705408410595802,
    0.00506942205755847,
    0.00829375727249071,
    0.011287726446705192,
    0.01396427021190327,
    0.016241375429451588,
    0.018043473959190204,
    0.019302849518621313,
    0.019961132775239837,
    0.01997107485663769,
    0.01929900864269411,
    0.01792882898439124,
    0.015869115882679717,
    0.01316650620226524,
    0.009931254910713045,
    0.006386734874520164,
    0.002967927796025159,
    0.0005287016915448378,
];
const DIFFUSE: f64 = 0.2199185699232275;

/// Diffuse reflection without an interface (n = 1).
const DIFFUSE_WITHOUT_INTERFACE: f64 = 0.41494747913081603;

#[test]
fn diffuse_reflectance_agrees_with_the_equation_of_transfer_for_any_mean_free_path() {
    let spec = TallySpec::default().with_medium();
    // 54 numbers of bins and 3 sums: by Sidak |z| < 3.9 leaves 0.5 % for a chance failure.
    for (i, mean_free_path) in [1.0, 0.01, 300.0].into_iter().enumerate() {
        let scene = Scene {
            theta_deg: 0.0,
            seed: 10 + i as u64,
            ..Scene::new(flat(), Layer::half_space(medium(mean_free_path, 0.9)))
        };
        let (found, work) = scene.trace(64, 40);
        let means = found.means();
        let specular = means[spec.flux_entry(Side::Reflected, Component::Unscattered)];
        assert!((specular - dielectric(1.0, 1.5).reflected).abs() < 1e-15);
        let once = found.at(spec.flux_entry(Side::Reflected, Component::ScatteredOnce));
        let z = z_score(found.budget().reflected, DIFFUSE + 0.04, 0.0);
        println!("mean free path {mean_free_path}: z {z:.2}, once {once:?}, {work:?}");
        assert!(z.abs() < 3.9);
        let rings = |component| spec.ring_entries(Side::Reflected, component);
        for (ring, exact) in DIFFUSE_BY_ANGLE.into_iter().enumerate() {
            // Once and more are two entries, correlated; the scatter of all bounds that of their sum.
            let [a, b] = [Component::ScatteredOnce, Component::ScatteredMore]
                .map(|h| means[rings(h).get(ring)]);
            let specular = means[rings(Component::Unscattered).get(ring)];
            let all = found.at(spec.ring_entries(Side::Reflected, Component::All).get(ring));
            assert!((a + b + specular - all.mean).abs() < 1e-14);
            let z = z_score(all, exact + specular, 0.0);
            println!("  ring {ring}: {:.6} {exact:.6} z {z:.2}", a + b);
            assert!(z.abs() < 3.9);
        }
        assert!((budget(&found) - 1.0).abs() < 1e-12);
        assert_eq!(means.budget().lost, 0.0);
        assert_eq!(means.budget().transmitted, 0.0);
    }
}

#[test]
fn without_an_interface_all_that_is_reflected_was_scattered() {
    let scene = Scene {
        theta_deg: 0.0,
        eta: 1.0,
        ..Scene::new(flat(), Layer::half_space(medium(2.0, 0.9)))
    };
    let (found, _) = scene.trace(64, 40);
    let z = z_score(found.budget().reflected, DIFFUSE_WITHOUT_INTERFACE, 0.0);
    println!("z {z:.2}");
    assert!(z.abs() < 3.5);
}

#[test]
fn light_scattered_once_without_an_interface_is_known_for_every_phase_function() {
    // Chandrasekhar: the flux scattered once is the integral over mu of
    // albedo p(cos) mu / (mu0 + mu) 2 pi, mu0 = 1, where cos = -mu.
    let spec = TallySpec::default().with_medium();
    let entry = spec.flux_entry(Side::Reflected, Component::ScatteredOnce);
    for phase in [
        PhaseFunction::Isotropic,
        PhaseFunction::Rayleigh,
        PhaseFunction::henyey_greenstein(0.6).unwrap(),
        PhaseFunction::henyey_greenstein(-0.4).unwrap(),
    ] {
        let n = 4000;
        let exact: f64 = (0..n)
            .map(|i| {
                let mu = (f64::from(i) + 0.5) / f64::from(n);
                let p = phase.density(-mu);
                std::f64::consts::TAU * 0.7 * p * mu / (1.0 + mu) / f64::from(n)
            })
            .sum();
        let medium = ParticipatingMedium::from_mean_free_path(0.3, 0.7, phase).unwrap();
        let scene = Scene {
            theta_deg: 0.0,
            eta: 1.0,
            ..Scene::new(flat(), Layer::half_space(medium))
        };
        let (found, _) = scene.trace(64, 30);
        let z = z_score(found.at(entry), exact, 0.0);
        println!("{phase:?}: {exact:.6}, z {z:.2}");
        assert!(z.abs() < 3.5);
    }
}

#[test]
fn a_medium_that_never_absorbs_loses_nothing() {
    let scene = Scene {
        max_scatterings: 2000,
        ..Scene::new(flat(), Layer::half_space(medium(1.0, 1.0)))
    };
    let (found, work) = scene.trace(8, 20);
    let [reflected, transmitted, absorbed, truncated, lost] = found.means().budget().parts();
    println!("{reflected} {truncated} {work:?}");
    assert_eq!([transmitted, absorbed, lost], [0.0; 3]);
    assert!((reflected + truncated - 1.0).abs() < 1e-12);
    // What is still inside after n scatterings falls as 1 / sqrt(n), about 4 / sqrt(n) here.
    assert!(truncated > 0.0 && truncated < 0.2);
    assert_eq!(work.max_scatterings, 2000);
}

#[test]
fn a_medium_that_only_absorbs_leaves_the_reflection_of_the_interface() {
    for theta_deg in [0.0, 40.0, 80.0] {
        let scene = Scene {
            theta_deg,
            ..Scene::new(flat(), Layer::half_space(medium(1.0, 0.0)))
        };
        let (found, work) = scene.trace(2, 10);
        let exact = dielectric(f64::to_radians(theta_deg).cos(), 1.5).reflected;
        assert!((found.means().budget().reflected - exact).abs() < 1e-13);
        assert!((found.means().budget().absorbed - (1.0 - exact)).abs() < 1e-13);
        assert_eq!(work.scatterings, 0);
    }
}

#[test]
fn roulette_changes_no_mean() {
    use asperity_tracer::{Branching, PathSettings};
    let layer = Layer::half_space(medium(1.0, 0.8));
    let with = |roulette, branching, seed| {
        let scene = Scene {
            settings: PathSettings::new(branching, roulette, 1000).unwrap(),
            seed,
            ..Scene::new(flat(), layer)
        };
        scene.trace(64, 20).0
    };
    let exhaustive = with(1e-6, Branching::Split, 1);
    for (found, seed) in [
        (with(0.5, Branching::Split, 2), 2),
        (with(0.01, Branching::Pick, 3), 3),
    ] {
        for entry in [TallySpec::BUDGET.reflected, TallySpec::BUDGET.absorbed] {
            let z = super::z_between(&found, &exhaustive, entry);
            println!("seed {seed}, entry {entry}: z {z:.2}");
            assert!(z.abs() < 3.5);
        }
        assert!((budget(&found) - 1.0).abs() < 1e-12);
    }
}
