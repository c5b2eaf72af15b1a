//! Slabs between flat faces, from thin to thick.

use asperity_optics::{Bottom, FacetMueller, Layer, polarised_dielectric};
use asperity_tally::{TallyResult, TallySpec};
use asperity_tracer::{PathSettings, Polarisation};

use super::{Scene, budget, flat, medium, slab, z_between};

#[test]
fn a_slab_far_thinner_than_the_mean_free_path_is_two_interfaces() {
    // Both faces reflect F: R = F + (1 - F)^2 F / (1 - F^2) = 2 F / (1 + F), over all inner reflections; s and p keep apart.
    for (theta_deg, polarisation) in [0.0, 50.0, 75.0]
        .map(|theta_deg| [Polarisation::Tracked, Polarisation::Averaged].map(|p| (theta_deg, p)))
        .concat()
    {
        let bottom = Bottom::interface(1.0 / 1.5);
        let scene = Scene {
            theta_deg,
            settings: PathSettings::new(Default::default(), 1e-6, 1000)
                .unwrap()
                .with_polarisation(polarisation),
            ..Scene::new(flat(), slab(medium(1e10, 0.9), 1.0, bottom))
        };
        let (found, _) = scene.trace(4, 10);
        let FacetMueller { m00, m01, .. } =
            polarised_dielectric(f64::to_radians(theta_deg).cos(), 1.5).reflected;
        let both_faces = |f: f64| 2.0 * f / (1.0 + f);
        let exact = match polarisation {
            Polarisation::Averaged => both_faces(m00),
            _ => 0.5 * (both_faces(m00 + m01) + both_faces(m00 - m01)),
        };
        let [reflected, transmitted] =
            [TallySpec::BUDGET.reflected, TallySpec::BUDGET.transmitted].map(|i| found.means()[i]);
        // Roulette ends what is below 1e-6; a ray in 1e10 is scattered.
        assert!((reflected - exact).abs() < 2e-6, "{reflected} {exact}");
        assert!((transmitted - (1.0 - exact)).abs() < 2e-6);
        assert!((budget(&found) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_slab_far_thicker_than_the_mean_free_path_is_a_half_space() {
    let half_space = Scene {
        seed: 1,
        ..Scene::new(flat(), Layer::half_space(medium(1.0, 0.9)))
    };
    let (half_space, _) = half_space.trace(64, 20);
    let scene = Scene {
        seed: 2,
        ..Scene::new(flat(), slab(medium(1.0, 0.9), 60.0, Bottom::Open))
    };
    let (thick, _) = scene.trace(64, 20);
    let z = z_between(&thick, &half_space, TallySpec::BUDGET.reflected);
    println!("z {z:.2}");
    assert!(z.abs() < 3.5);
    // exp(-60 sqrt(3 (1 - .9))) is 5e-15
    assert!(thick.means().budget().transmitted < 1e-9);
}

#[test]
fn a_slab_of_one_optical_depth_obeys_beer_and_lambert() {
    // Unscattered light through matched faces: exp(-d / (mean free path cos theta)).
    let spec = TallySpec::default().with_medium();
    let entry = spec.flux_entry(
        asperity_tally::Side::Transmitted,
        asperity_tally::Component::Unscattered,
    );
    for theta_deg in [0.0, 60.0] {
        let scene = Scene {
            theta_deg,
            eta: 1.0,
            ..Scene::new(flat(), slab(medium(2.0, 0.5), 2.0, Bottom::Open))
        };
        let (found, _) = scene.trace(64, 20);
        let exact = (-1.0 / f64::to_radians(theta_deg).cos()).exp();
        let z = crate::common::z_score(found.at(entry), exact, 0.0);
        println!("{theta_deg} deg: {exact:.6}, z {z:.2}");
        assert!(z.abs() < 3.5);
    }
}

#[test]
fn reflected_and_transmitted_light_of_a_conservative_slab_add_to_one() {
    for bottom in [Bottom::Open, Bottom::interface(1.0 / 1.5)] {
        let scene = Scene::new(flat(), slab(medium(1.0, 1.0), 5.0, bottom));
        let (found, _) = scene.trace(16, 20);
        let means = found.means();
        assert_eq!(means.budget().absorbed, 0.0);
        assert_eq!(means.budget().lost, 0.0);
        let all = means.budget().reflected + means.budget().transmitted + means.budget().truncated;
        assert!((all - 1.0).abs() < 1e-12);
        let roulette = found.budget().truncated;
        assert!(roulette.mean.abs() < 4.0 * roulette.se.unwrap() + 1e-15);
    }
}

#[test]
fn what_is_absorbed_does_not_depend_on_the_side_asked_for() {
    // Light of the highest order inside cannot come out above, but may yet be absorbed.
    let scene = Scene {
        settings: asperity_tracer::PathSettings::new(Default::default(), 0.01, 1).unwrap(),
        ..Scene::new(flat(), slab(medium(1.0, 0.3), 2.0, Bottom::Open))
    };
    let both = scene.trace(2, 20).0;
    let asked = Scene {
        sides: asperity_tally::Sides::Reflected,
        ..scene
    };
    let asked = asked.trace(2, 20).0;
    for entry in [TallySpec::BUDGET.reflected, TallySpec::BUDGET.absorbed] {
        assert_eq!(asked.means()[entry], both.means()[entry]);
    }
    assert!(both.means().budget().absorbed > 0.1);
    let gone = asked.means().budget().not_recorded;
    assert!((gone - both.means().budget().transmitted).abs() < 1e-13);
}
