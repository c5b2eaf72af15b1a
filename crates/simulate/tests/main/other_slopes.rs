//! Random surfaces whose slopes are a mixture of Gaussian ones, with a control variate.

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Cells, ControlVariateMean, Estimator, Light, RandomSurfaces, Settings, Silent,
    SimulateError, SurfaceSource, simulate,
};
use asperity_synthesis::{
    GrooveProfile, Grooves, Psd, Structure, StructureSynthesis, StructuredSurface, StudentSlopes,
    SurfaceRecipe, TransformedHeights,
};
use asperity_tally::{Component, Side, TallyResult};
use asperity_tracer::HalfSpace;

use crate::support::{effort, glass, lit, run};

fn case(recipe: impl Into<SurfaceRecipe>, size: usize, material: Material, theta: f64) -> Case {
    let surfaces = RandomSurfaces::new(Cells::Smooth, recipe, [size; 2], [1.0; 2], false).unwrap();
    lit(surfaces, material, theta)
}

fn settings(estimator: Estimator, surfaces: u64, rays: u64) -> Settings {
    Settings {
        estimator,
        ..effort(surfaces, rays)
    }
}

/// Energies and rings of both estimators agree within their errors, and those of the control variate are smaller.
///
/// Bound of the sum of squares of z over `n` rings with two estimates on the same surfaces: chi square of `n` degrees of
/// freedom, mean `n` and variance `2 n`, heavier for Student's t; four deviations and a half more.
#[test]
fn controlled_and_plain_means_agree_on_skewed_and_ggx_surfaces() {
    let skewed = || {
        let psd = Psd::gaussian(5.0 / 4.0, 5.0).unwrap();
        TransformedHeights::new(psd, 0.9, 4.5).unwrap()
    };
    let student = StudentSlopes::new(Psd::gaussian(5.0 / 16.0, 5.0).unwrap(), 2.0).unwrap();
    let cases = [
        (case(skewed(), 60, glass(), 30.0), 4.0),
        (case(skewed(), 60, Material::Mirror, 60.0), 1.5),
        (case(student, 100, glass(), 0.0), 1.2),
    ];
    for (case, gain) in cases {
        let [plain, controlled] = [Estimator::Plain, Estimator::Controlled].map(|estimator| {
            let outcome = run(case.clone(), &settings(estimator, 128, 600_000));
            let mean = outcome.work.control_variate;
            let expected = match estimator {
                Estimator::Plain => None,
                _ => Some(ControlVariateMean::SlopeMixture),
            };
            assert_eq!(mean, expected);
            outcome.statistics
        });
        let spec = *plain.spec();
        for side in Side::BOTH {
            let [a, b] = [&plain, &controlled].map(|found| found.flux(side, Component::All));
            println!("{a:?} {b:?}");
            assert!((a.mean - b.mean).abs() <= 4.0 * a.se.unwrap().hypot(b.se.unwrap()));
        }
        let entries = Side::BOTH
            .into_iter()
            .flat_map(|side| spec.ring_entries(side, Component::All).iter());
        let (mut squares, mut rings, mut variances) = (0.0, 0.0, [0.0; 2]);
        for entry in entries {
            let [a, b] = [&plain, &controlled].map(|found| found.at(entry));
            let [plain_se, se] = [a, b].map(|found| found.se.unwrap());
            if a.mean < 1e-3 {
                continue;
            }
            let z = (a.mean - b.mean) / plain_se.hypot(se);
            (squares, rings) = (squares + z * z, rings + 1.0);
            variances = [variances[0] + plain_se * plain_se, variances[1] + se * se];
        }
        let found_gain = variances[0] / variances[1];
        println!("{squares:.1} of {rings} rings, variance {found_gain:.2} times smaller");
        let most: f64 = rings + 4.5 * (2.0_f64 * rings).sqrt();
        assert!(rings > 5.0 && squares < most);
        assert!(found_gain > gain);
    }
}

/// Structures have no known slopes: a control variate is refused, and none is taken where the choice is free.
#[test]
fn structured_surfaces_have_no_control_variate() {
    let grooves = Grooves {
        profile: GrooveProfile::V,
        depth: 1.0,
        width: 16.0,
        azimuth: 0.0,
        edge_radius: 0.0,
        randomness: 0.0,
    };
    let grooves = Structure::Grooves(grooves);
    let drawn = StructureSynthesis::new(grooves, [64; 2], [1.0; 2], false).unwrap();
    let surface = StructuredSurface::new(&drawn, None).unwrap();
    let surfaces = RandomSurfaces::new(Cells::Flat, surface, [64; 2], [1.0; 2], false).unwrap();
    let light = Light {
        incidence: Incidence::from_degrees(30.0, 0.0).unwrap(),
        from: HalfSpace::Above,
        spread: None,
        random_azimuth: false,
        stokes: [0.0; 3],
    };
    let case = Case::new(SurfaceSource::random(surfaces), glass(), light);
    let refused = simulate(
        std::slice::from_ref(&case),
        &settings(Estimator::Controlled, 4, 4000),
        &Silent,
    );
    assert!(matches!(
        refused,
        Err(SimulateError::NoControlVariate { .. })
    ));
    let free = run(case, &settings(Estimator::Auto, 4, 4000));
    assert_eq!(free.work.control_variate, None);
}
