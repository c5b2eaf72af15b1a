//! Regions of a given surface, each lit on its own.

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Effort, ErrorSource, Estimator, Light, Outcome, Regions, Settings, Silent, Simulation,
    Stage, SurfaceSource, simulate,
};
use asperity_surface::{Border, HeightField};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, Side, TallyResult};

use crate::resuming::{Keeper, numbers, resume};
use crate::support::glass;

fn settings(columns: u32, rows: u32, rays: u64) -> Settings {
    Settings {
        regions: Some(Regions { columns, rows }),
        estimator: Estimator::Plain,
        effort: Effort::rays(rays),
        ..Settings::default()
    }
}

fn on(field: HeightField, material: Material, theta: f64) -> Case {
    let light = Light::from_above(Incidence::from_degrees(theta, 20.0).unwrap());
    Case::new(SurfaceSource::height_field(field), material, light)
}

fn rough(border: Border) -> HeightField {
    let psd = Psd::gaussian(2.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [48; 2], [1.0; 2], false).unwrap();
    synthesis.draw(1, 0).unwrap().with_border(border)
}

/// A ridge of slopes 0.2 and -0.2 in one half of the tile, and a level half: of a mirror, vertical light leaves the level half as it
/// came, and the ridge at 22.6 degrees.
#[test]
fn each_region_has_the_light_that_falls_on_it() {
    for (border, samples) in [(Border::Periodic, 16), (Border::Mirrored, 17)] {
        let height = |i: usize| 0.2 * (4.0 - (i as f64 - 4.0).abs()).max(0.0);
        let heights = (0..samples * samples).map(|i| height(i % samples));
        let field = HeightField::new(heights.collect(), [samples; 2], [1.0; 2]).unwrap();
        let case = on(field.with_border(border), Material::Mirror, 0.0);
        let outcomes = simulate(&[case], &settings(2, 3, 3000), &Silent).unwrap();
        let outcome = &outcomes[0];
        assert_eq!(outcome.errors_from, ErrorSource::Regions);
        assert_eq!(outcome.surfaces.len(), 6);
        for (number, tally) in outcome.surfaces.iter().enumerate() {
            let rings = tally.rings(Side::Reflected, Component::All);
            let [level, ridge] = [rings.get(0), rings.get(4)];
            let expected = if number % 2 == 0 {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            };
            assert!(
                (level - expected[0]).abs() + (ridge - expected[1]).abs() < 1e-12,
                "{border}, region {number}: {level} {ridge}"
            );
        }
    }
}

/// Regions have equally many rays, so that their mean is the light of the whole surface, up to the noise of rays: of either run
/// below 1e-3 / sqrt(40000) x 100 = 5e-4 in reflected flux; what is seen is within 4 times the errors by rays.
#[test]
fn the_mean_over_regions_is_the_whole_surface() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        let case = on(rough(border), glass(), 40.0);
        let whole = Settings {
            regions: None,
            ..settings(1, 1, 60_000)
        };
        let run = |settings: &Settings| -> Outcome {
            let case = std::slice::from_ref(&case);
            simulate(case, settings, &Silent).unwrap().remove(0)
        };
        let (whole, regions) = (run(&whole), run(&settings(5, 3, 60_000)));
        assert!(regions.work.rays >= 60_000 && regions.work.rays.is_multiple_of(15));
        for side in [Side::Reflected, Side::Transmitted] {
            let [a, b] = [&whole, &regions].map(|run| run.statistics.flux(side, Component::All));
            // The error of the rays of regions is that of the whole, or less.
            let se = a.se.unwrap() * 2.0_f64.sqrt();
            println!("{border} {side}: {a:?} {b:?}");
            assert!((a.mean - b.mean).abs() < 4.0 * se, "{border}: {a:?} {b:?}");
            let first = regions.surfaces[0].flux(side, Component::All);
            assert!((first - b.mean).abs() > 1e-4, "regions differ");
        }
    }
}

#[test]
fn regions_resume_from_those_kept_to_the_same_numbers() {
    let cases = [on(rough(Border::Periodic), glass(), 40.0)];
    let settings = settings(4, 4, 8000);
    let keeper = Keeper::default();
    let whole = resume(&cases, &settings, &keeper, &Silent);
    keeper.keep(|key| key.number % 2 == 0 && key.stage == Stage::Regions);
    assert_eq!(keeper.len(), 8);
    let resumed = resume(&cases, &settings, &keeper, &Silent);
    assert!(numbers(&resumed) == numbers(&whole), "other numbers");
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let simulation = Simulation::new(&cases, &settings).unwrap();
    let alone = one_thread.unwrap().install(|| simulation.run(&Silent));
    assert!(numbers(&alone.unwrap()) == numbers(&whole), "other numbers");
}
