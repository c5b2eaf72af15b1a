//! Tests of maps of absorbed light: flat and grooved surfaces, the budget, errors and threads.

use std::f64::consts::TAU;

use asperity_optics::Incidence;
use asperity_surface::{Border, HeightField, SplineSurface};
use asperity_synthesis::{GrooveProfile, Grooves, Structure, StructureSynthesis};
use asperity_tally::TallyResult;
use asperity_tracer::Sampling;

use super::*;
use crate::engine::simulation::simulate;
use crate::input::case::Light;
use crate::input::estimator::Estimator;
use crate::input::settings::Effort;
use crate::input::surface_source::SurfaceSource;
use crate::observer::Silent;
use crate::output::stopped_by::StoppedBy;

const GOLD: Material = Material::Conductor {
    eta: 0.2,
    kappa: 3.9,
};

fn case(surface: SurfaceSource, material: Material, theta: f64) -> Case {
    let light = Light::from_above(Incidence::from_degrees(theta, 20.0).unwrap());
    Case::new(surface, material, light)
}

fn settings(estimator: Estimator, rays: u64) -> Settings {
    Settings {
        estimator,
        effort: Effort::rays(rays),
        ..Settings::default()
    }
}

/// A sum of waves. Rows and columns differ in number and width, so that axes cannot be mixed up.
fn rough() -> HeightField {
    let heights = (0..32 * 60).map(|i| {
        let [x, y] = [f64::from(i % 60) / 60.0, f64::from(i / 60) / 32.0].map(|at| TAU * at);
        1.5 * (3.0 * x).sin() + 1.5 * (4.0 * y + x).cos() + (5.0 * x - 2.0 * y + 1.0).sin()
    });
    HeightField::new(heights.collect(), [32, 60], [0.5, 1.0]).unwrap()
}

fn run(case: &Case, settings: &Settings) -> (AbsorbedMap, Outcome) {
    let cases = std::slice::from_ref(case);
    let outcome = simulate(cases, settings, &Silent).unwrap().remove(0);
    let map = AbsorbedMap::of(case, settings, &outcome, &Silent).unwrap();
    (map.unwrap(), outcome)
}

#[test]
fn every_cell_of_a_flat_conductor_absorbs_one_minus_its_reflectance() {
    let field = HeightField::new(vec![2.0; 32], [4, 8], [1.0, 3.0]).unwrap();
    let case = case(SurfaceSource::height_field(field), GOLD, 50.0);
    // 64 blocks of 64 x 64 rays: 8 x 16 of each on a cell
    let (map, _) = run(&case, &settings(Estimator::Auto, 1 << 18));
    let reflected = GOLD.fresnel(50_f64.to_radians().cos()).reflected;
    assert_eq!(map.shape, [4, 8]);
    for (mean, error) in map.means.iter().zip(&map.errors) {
        assert!((mean - (1.0 - reflected)).abs() < 1e-11, "{mean}");
        assert!(*error < 1e-11, "{error}");
    }
}

/// The rays are those of the run, whatever the cells, borders, materials, sides and samplings.
#[test]
fn the_mean_over_cells_is_the_absorbed_fraction_of_the_plain_estimator() {
    let field = rough();
    let with = |border| SurfaceSource::height_field(field.clone().with_border(border));
    let spline = SplineSurface::through(&field);
    let surfaces = [
        (with(Border::Periodic), [32, 60]),
        (with(Border::Mirrored), [31, 59]),
        (with(Border::Open), [31, 59]),
        (SurfaceSource::Given(vec![Shape::smooth(spline)]), [32, 60]),
    ];
    let grey = Material::lambertian(0.6).unwrap();
    for (surface, shape) in surfaces {
        for (material, from, sampling) in [
            (GOLD, HalfSpace::Above, Sampling::Stratified),
            (GOLD, HalfSpace::Below, Sampling::Random),
            (grey, HalfSpace::Above, Sampling::QuasiRandom),
        ] {
            let mut case = case(surface.clone(), material, 60.0);
            case.light.from = from;
            let mut settings = settings(Estimator::Plain, 20_000);
            settings.sampling = sampling;
            let (map, outcome) = run(&case, &settings);
            let budget = outcome.statistics.means().budget().absorbed;
            assert_eq!(map.shape, shape);
            assert!((map.mean() - budget).abs() < 1e-11, "{budget}");
            assert!(budget > 0.05 && map.means.iter().all(|mean| *mean >= 0.0));
        }
    }
}

#[test]
fn a_run_under_a_control_variate_agrees_within_its_errors() {
    let case = case(SurfaceSource::height_field(rough()), GOLD, 60.0);
    let (map, controlled) = run(&case, &settings(Estimator::Controlled, 100_000));
    let (_, plain) = run(&case, &settings(Estimator::Plain, 100_000));
    let [one, other] = [&controlled, &plain].map(|one| one.statistics.budget().absorbed);
    let z = (map.mean() - one.mean) / one.se.unwrap().hypot(other.se.unwrap());
    assert!(one.mean != other.mean && z.abs() < 4.0, "{z}");
}

/// Bottoms get light from the opposite flank too. Grooves of 45 degrees: two reflections near the bottom, one or two near the top.
#[test]
fn bottoms_of_grooves_absorb_more_than_tops() {
    let grooves = Structure::Grooves(Grooves {
        profile: GrooveProfile::V,
        depth: 12.0,
        width: 16.0,
        azimuth: 0.0,
        edge_radius: 0.0,
        randomness: 0.0,
    });
    let synthesis = StructureSynthesis::new(grooves, [16; 2], [1.0; 2], false).unwrap();
    let field = synthesis.draw(1, 0).unwrap();
    let heights = field.heights().to_vec();
    let case = case(SurfaceSource::height_field(field), GOLD, 0.0);
    let (map, _) = run(&case, &settings(Estimator::Plain, 1 << 17));
    // A cell lies between its row and the next.
    let middle = |row: usize| heights[16 * row] + heights[16 * ((row + 1) % 16)];
    let rows: Vec<usize> = (0..16).collect();
    let of_row = |row: &usize| map.means[16 * row..][..16].iter().sum::<f64>() / 16.0;
    let by_height = |a: &&usize, b: &&usize| middle(**a).total_cmp(&middle(**b));
    let (bottom, top) = (
        rows.iter().min_by(by_height).unwrap(),
        rows.iter().max_by(by_height).unwrap(),
    );
    let error = map.errors[16 * bottom] + map.errors[16 * top];
    let difference = of_row(bottom) - of_row(top);
    assert!(
        difference > 0.02 && difference > 5.0 * error,
        "{difference}"
    );
}

/// The scatter of each cell between runs of other seeds, over its error: squares of 1920 cells and 24 runs, whose mean has a standard
/// deviation of about `sqrt(2 / (23 * 1920))` if cells were independent.
#[test]
fn errors_are_the_scatter_between_runs() {
    let case = case(SurfaceSource::height_field(rough()), GOLD, 60.0);
    let runs: Vec<AbsorbedMap> = (1..=24)
        .map(|seed| {
            let mut settings = settings(Estimator::Plain, 64 * 1936);
            settings.seed = seed;
            run(&case, &settings).0
        })
        .collect();
    let n = runs.len() as f64;
    let [mut scatter, mut expected] = [0.0; 2];
    for cell in 0..1920 {
        let mean = runs.iter().map(|run| run.means[cell]).sum::<f64>() / n;
        let squares = runs.iter().map(|run| (run.means[cell] - mean).powi(2));
        scatter += squares.sum::<f64>() / (n - 1.0);
        expected += runs.iter().map(|run| run.errors[cell].powi(2)).sum::<f64>() / n;
    }
    let ratio = scatter / expected;
    println!("{ratio:.4}");
    assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
}

#[test]
fn threads_change_no_bit() {
    let case = case(SurfaceSource::height_field(rough()), GOLD, 60.0);
    let settings = settings(Estimator::Plain, 30_000);
    let maps = [1, 2, 5].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(|| run(&case, &settings).0)
    });
    assert!(maps[0] == maps[1] && maps[0] == maps[2]);
}

struct Stopped;

impl Observer for Stopped {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        Some(StoppedBy::Time)
    }
}

#[test]
fn there_is_no_map_of_a_run_that_is_stopped_nor_of_several_surfaces() {
    let case = case(SurfaceSource::height_field(rough()), GOLD, 60.0);
    let settings = settings(Estimator::Plain, 10_000);
    let (_, outcome) = run(&case, &settings);
    let stopped = AbsorbedMap::of(&case, &settings, &outcome, &Stopped).unwrap();
    assert!(stopped.is_none());
    let several = Case {
        surface: SurfaceSource::Given([case.surface.shapes(), case.surface.shapes()].concat()),
        ..case
    };
    let of_several = AbsorbedMap::of(&several, &settings, &outcome, &Silent).unwrap();
    assert!(of_several.is_none());
}
