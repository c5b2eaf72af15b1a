//! Several given surfaces: their mean, with the errors of their scatter.

use std::sync::atomic::Ordering;

use asperity_optics::Incidence;
use asperity_simulate::{
    Case, Cells, ErrorSource, Estimator, Light, Outcome, Quantity, RandomSurfaces, Regions,
    Settings, Shape, Silent, SimulateError, Simulation, SurfaceSource, simulate,
};
use asperity_synthesis::{Psd, SplineSynthesis, Synthesis};
use asperity_tally::{Component, Side, TallyResult};

use crate::resuming::{Keeper, numbers, resume};
use crate::sharing::Drawings;
use crate::support::{effort, glass, target};

const TAU: f64 = 4.0;

fn psd() -> Psd {
    Psd::gaussian(2.0, TAU).unwrap()
}

/// A surface of so many samples a side.
fn drawn(size: usize, number: u64) -> Shape {
    let synthesis = Synthesis::new(psd(), [size; 2], [1.0; 2], false).unwrap();
    Shape::height_field(synthesis.draw(1, number).unwrap())
}

fn lit(surface: SurfaceSource, theta: f64) -> Case {
    let light = Light::from_above(Incidence::from_degrees(theta, 20.0).unwrap());
    Case::new(surface, glass(), light)
}

fn given(shapes: impl IntoIterator<Item = Shape>, theta: f64) -> Case {
    lit(SurfaceSource::Given(shapes.into_iter().collect()), theta)
}

fn plain(surfaces: u64, rays: u64) -> Settings {
    Settings {
        estimator: Estimator::Plain,
        fold: false,
        mesh_quadrature: false,
        ..effort(surfaces, rays)
    }
}

/// Surfaces that are given are traced as if a recipe had drawn them: on the same random numbers, to the same bytes.
#[test]
fn given_surfaces_have_the_result_of_random_surfaces_that_are_the_same() {
    for (cells, refine) in [
        (Cells::Flat, false),
        (Cells::Flat, true),
        (Cells::Smooth, false),
    ] {
        let shapes = (0..5).map(|number| match cells {
            Cells::Flat => drawn(32, number),
            Cells::Smooth => {
                let synthesis = SplineSynthesis::new(psd(), [32; 2], [1.0; 2], false).unwrap();
                Shape::smooth(synthesis.draw(1, number).unwrap())
            }
        });
        let given = given(shapes, 40.0);
        let recipe = RandomSurfaces::new(cells, psd(), [32; 2], [1.0; 2], false).unwrap();
        let random = lit(SurfaceSource::random(recipe), 40.0);
        assert_eq!(given.surface.cells(), Some(cells));
        assert_eq!(given.surface.size(), random.surface.size());
        assert_eq!(given.surface.spacing(), random.surface.spacing());
        let settings = Settings {
            refine,
            ..plain(5, 10_000)
        };
        let drawings = Drawings::default();
        let found = simulate(&[given], &settings, &drawings).unwrap().remove(0);
        assert_eq!(drawings.0.load(Ordering::Relaxed), 5);
        let expected = simulate(&[random], &settings, &Silent).unwrap().remove(0);
        assert_eq!(found.errors_from, ErrorSource::Surfaces);
        assert_eq!(found.surfaces, expected.surfaces);
        for entry in found.statistics.spec().entries() {
            assert_eq!(found.statistics.at(entry), expected.statistics.at(entry));
            let [found, expected] = [&found, &expected].map(|one| one.errors.at(entry));
            assert_eq!(found.rays, expected.rays);
            assert_eq!(found.surfaces, expected.surfaces);
            // Facets of given heights converge in second order as those of random ones do.
            assert_eq!(found.mesh, expected.mesh);
        }
    }
}

/// Five surfaces, one of another size, against runs on each alone: the mean agrees within the errors of the rays, and the error
/// is that of the scatter, which is far above these.
#[test]
fn the_mean_is_that_of_runs_on_each_and_the_error_that_of_their_scatter() {
    let shapes: Vec<Shape> = (0..5).map(|i| drawn(32 + 16 * (i / 4), i as u64)).collect();
    let rays = 20_000;
    let run = |shapes: &[Shape]| -> Outcome {
        let total = rays * shapes.len() as u64;
        let settings = plain(1, total);
        let case = given(shapes.iter().cloned(), 60.0);
        simulate(&[case], &settings, &Silent).unwrap().remove(0)
    };
    let all = run(&shapes);
    assert_eq!(all.work.realisations, 5);
    assert!(all.work.rays >= 5 * rays && all.work.rays < 6 * rays);
    let alone: Vec<Outcome> = shapes
        .iter()
        .map(|shape| run(std::slice::from_ref(shape)))
        .collect();
    for side in [Side::Reflected, Side::Transmitted] {
        let found = all.statistics.flux(side, Component::All);
        let singles: Vec<_> = alone
            .iter()
            .map(|one| one.statistics.flux(side, Component::All))
            .collect();
        let mean = singles.iter().map(|one| one.mean).sum::<f64>() / 5.0;
        let squares: f64 = singles.iter().map(|one| one.se.unwrap().powi(2)).sum();
        let of_rays = squares.sqrt() / 5.0;
        let z = (found.mean - mean) / (of_rays * 2.0_f64.sqrt());
        println!("{side}: {found:?} {mean} z = {z:.2}");
        assert!(z.abs() < 3.5, "{side}: {z}");
        let fluxes = all
            .surfaces
            .iter()
            .map(|one| one.flux(side, Component::All));
        let scatter: f64 = fluxes.map(|flux| (flux - found.mean).powi(2)).sum();
        let expected = (scatter / (5.0 * 4.0)).sqrt();
        let se = found.se.unwrap();
        assert!((se / expected - 1.0).abs() < 1e-9, "{se} {expected}");
        assert!(se > 5.0 * of_rays, "{se} {of_rays}");
    }
}

#[test]
fn cases_share_given_surfaces_and_resume_to_the_same_numbers() {
    let shapes: Vec<Shape> = (0..4).map(|number| drawn(32, number)).collect();
    let cases = [20.0, 60.0].map(|theta| given(shapes.iter().cloned(), theta));
    let settings = plain(1, 8000);
    let (keeper, drawings) = (Keeper::default(), Drawings::default());
    let whole = resume(&cases, &settings, &keeper, &drawings);
    assert_eq!(drawings.0.load(Ordering::Relaxed), 4);
    keeper.keep(|key| key.number % 2 == 0);
    assert_eq!(keeper.len(), 2);
    let resumed = resume(&cases, &settings, &keeper, &drawings);
    assert_eq!(drawings.0.load(Ordering::Relaxed), 6);
    assert!(numbers(&resumed) == numbers(&whole), "other numbers");
    let alone = simulate(&cases[1..], &settings, &Silent).unwrap();
    assert_eq!(alone[0].surfaces, whole[1].surfaces);
}

#[test]
fn what_is_for_one_given_surface_is_refused_for_several() {
    let flat = [drawn(32, 0), drawn(32, 1)];
    let refused = |settings: &Settings, shapes: &[Shape]| -> SimulateError {
        let case = given(shapes.iter().cloned(), 20.0);
        let error = Simulation::new(&[case], settings).err().unwrap();
        assert!(error.is_usage(), "{error}");
        error
    };
    let free = plain(1, 1000);
    for settings in [
        Settings {
            effort: target(1e-2, Quantity::Rings),
            ..free
        },
        Settings {
            estimator: Estimator::Controlled,
            ..free
        },
        Settings {
            regions: Some(Regions {
                columns: 2,
                rows: 2,
            }),
            ..free
        },
    ] {
        let error = refused(&settings, &flat);
        assert!(matches!(error, SimulateError::OnlyOfOne { .. }), "{error}");
    }
    let mixed = [
        flat[0].clone(),
        Shape::smooth(
            SplineSynthesis::new(psd(), [32; 2], [1.0; 2], false)
                .unwrap()
                .draw(1, 0)
                .unwrap(),
        ),
    ];
    assert_eq!(refused(&free, &mixed), SimulateError::MixedCells);
    assert_eq!(refused(&free, &[]), SimulateError::NoSurface);
}
