//! Given surfaces against models: true ones are kept, wrong ones rejected.

use asperity_results::ResultSet;
use asperity_simulate::{Cells, RandomSurfaces, Silent};
use asperity_surface::{LengthUnit, RegionSlopes};
use asperity_synthesis::{NEVER, Psd};

use super::*;
use crate::given::GivenShape;
use crate::given::GivenSurface;
use crate::study::Study;
use crate::trace::{TraceOutcome, TraceStudy};

/// Slopes so small that nothing is shadowed, masked or scattered twice but for rays that are fewer than errors can tell.
const SMOOTH: f64 = 10.0;

/// A Gaussian surface 64 correlation lengths wide, in 8 x 8 regions.
fn surface(psd: Psd, seed: u64) -> GivenSurface {
    let surfaces = RandomSurfaces::new(Cells::Flat, psd, [256; 2], [1.0; 2], true).unwrap();
    let field = surfaces.heights(seed, 0, NEVER).unwrap();
    GivenSurface {
        shape: GivenShape::Field(field),
        name: "surface".to_owned(),
        file: None,
        unit: LengthUnit::Arbitrary,
        y_is_north: true,
        filled: 0,
        notes: Vec::new(),
    }
}

fn isotropic(smoothness: f64, seed: u64) -> GivenSurface {
    surface(Psd::gaussian(4.0 / smoothness, 4.0).unwrap(), seed)
}

fn planned(surface: GivenSurface, settings: &str) -> TraceStudy {
    let text = format!("[output]\nplots = false\n{settings}");
    let config = TraceConfig::from_toml(&text).unwrap();
    let tops = GivenSurfaces {
        first: surface,
        others: Vec::new(),
    };
    TraceStudy::new(config, &tops, None).unwrap()
}

/// Returns the value that `read` takes from the outcome of a run.
fn run<T>(plan: TraceStudy, read: impl Fn(&TraceOutcome<'_>) -> T) -> T {
    let mut found = ResultSet::in_memory(plan.header().unwrap());
    read(&plan.run(&mut found, &Silent).unwrap().each[0])
}

/// The p value of the component that each model is judged by.
fn p_values(outcome: &TraceOutcome<'_>) -> Vec<f64> {
    let models = outcome.comparison.as_ref().unwrap().judgement.models.iter();
    models
        .map(|model| model.judged().comparison.test.as_ref().unwrap().p)
        .collect()
}

const MIRROR: &str = "[material]\nkind = \"mirror\"\n[light]\ntheta = 30\n[run]\nbins = \"9x12\"\nrays = 20000\n[compare]\n";

const GLASS: &str = "[material]\neta = 1.5\n[light]\ntheta = 30\n[run]\nbins = \"9x12\"\nrays = 50000\n[compare]\nmodel_rays = 20000\n";

/// Asserts that p values are those of a true model: `n a` of `n` lie below `a` on average, and more than `n a + 4 sqrt(n a)` in fewer than one of
/// 10^4 such tests; their mean is 1/2 with the deviation `(12 n)^(-1/2)`.
fn assert_uniform(p: &[f64]) {
    println!("{p:?}");
    for level in [0.01, 0.05, 0.2, 0.5] {
        let rejected = p.iter().filter(|p| **p < level).count() as f64;
        let due = p.len() as f64 * level;
        println!("{rejected} below {level}, {due} due");
        assert!(
            rejected <= due + 4.0 * due.sqrt(),
            "{rejected} below {level}"
        );
    }
    let mean = p.iter().sum::<f64>() / p.len() as f64;
    println!("mean {mean}");
    assert!(
        (mean - 0.5).abs() < 4.0 / (12.0 * p.len() as f64).sqrt(),
        "{mean}"
    );
}

/// Bins meet at the mirror direction, where mean slopes of regions move the most light from one to another.
#[test]
#[ignore = "slow: cargo test -- --ignored --skip at_full_size"]
fn true_models_are_rejected_as_often_as_their_level_says() {
    const SEEDS: u64 = 80;
    let grooves = Psd::anisotropic_gaussian(4.0 / SMOOTH, 4.0, 6.0, 0.5).unwrap();
    let of_seed = |seed: u64| {
        let surface = match seed % 2 {
            0 => isotropic(SMOOTH, seed),
            _ => self::surface(grooves.clone(), seed),
        };
        let cells = ["flat", "smooth"][seed as usize / 2 % 2];
        let settings = format!("[surface]\ncells = \"{cells}\"\n{MIRROR}models = \"smith\"");
        run(planned(surface, &settings), p_values)[0]
    };
    assert_uniform(&(0..SEEDS).map(of_seed).collect::<Vec<f64>>());
}

/// Peaks and flat valleys: the exponential of a Gaussian surface, whose slopes are not Gaussian, and so gentle that hardly any is shadowed.
fn log_normal(seed: u64) -> GivenSurface {
    let mut surface = isotropic(8.0, seed);
    let GivenShape::Field(field) = &surface.shape else {
        panic!("a height field");
    };
    let heights = field.heights().iter().map(|h| 0.05 * (2.0 * h).exp());
    surface.shape = GivenShape::Field(field.with_heights(heights.collect()).unwrap());
    surface
}

/// Variant of [`true_models_are_rejected_as_often_as_their_level_says`] for surfaces with any slopes: errors include those of the table of slopes.
/// Smith's model of Gaussian slopes is right for one of them and wrong for the other.
#[test]
#[ignore = "slow: cargo test -- --ignored --skip at_full_size"]
fn slopes_of_any_density_are_rejected_as_often_as_their_level_says() {
    const SEEDS: u64 = 20;
    let of_seed = |seed: u64| {
        let surface = match seed % 2 {
            0 => isotropic(SMOOTH, seed),
            _ => log_normal(seed),
        };
        let cells = ["flat", "smooth"][seed as usize / 2 % 2];
        let models = "models = [\"smith-slopes\", \"smith\"]";
        let settings = format!("[surface]\ncells = \"{cells}\"\n{MIRROR}{models}");
        run(planned(surface, &settings), p_values)
    };
    let p: Vec<Vec<f64>> = (0..SEEDS).map(of_seed).collect();
    assert_uniform(&p.iter().map(|p| p[0]).collect::<Vec<f64>>());
    let wrong = |first: usize| {
        p.iter()
            .skip(first)
            .step_by(2)
            .filter(|p| p[1] < 0.01)
            .count()
    };
    println!("smith: {} of Gaussian, {} of others", wrong(0), wrong(1));
    assert!(wrong(0) <= 2 && wrong(1) == 10);
}

/// Level tops and bottoms: a Gaussian surface that is cut off above and below, so gentle that nothing is shadowed. Light of level facets leaves at the angle of
/// that of a mirror, and of those that are level along an axis in the plane of incidence, where bins meet. Of 4 seeds of which a model is true,
/// more than one has p below 0.01 with probability 6e-4.
#[test]
fn level_facets_send_light_to_the_side_of_an_edge_that_rays_take() {
    let mut found = Vec::new();
    for (phi, seed) in [(0, 1), (90, 2), (180, 3), (270, 4)] {
        let mut surface = isotropic(20.0, seed);
        let GivenShape::Field(field) = &surface.shape else {
            panic!("a height field");
        };
        let heights = field.heights().iter().map(|h| h.clamp(-0.05, 0.1));
        surface.shape = GivenShape::Field(field.with_heights(heights.collect()).unwrap());
        let settings = MIRROR.replace("theta = 30", &format!("theta = 30\nphi = {phi}"));
        let p = run(
            planned(surface, &format!("{settings}models = \"smith-slopes\"")),
            p_values,
        );
        println!("{phi} {seed}: {p:?}");
        found.push(p[0]);
    }
    let low = found.iter().filter(|p| **p < 0.01).count();
    assert!(low <= 1, "{found:?}");
}

/// Slope variances off by 20 %: light scattered once deviates by some 10 % in the ring of the steepest facets.
#[test]
fn models_of_other_slopes_are_rejected() {
    for factor in [0.8, 1.2] {
        let surface = isotropic(SMOOTH, 3);
        let GivenShape::Field(field) = surface.shape.clone() else {
            panic!("a height field");
        };
        let mut planned = planned(surface, &format!("{MIRROR}models = \"smith\""));
        let Slopes { plan, shifts, .. } = &mut planned.each[0].comparison.as_mut().unwrap().slopes;
        let mut regions = centred(field.border(), field.region_slopes([8, 8]));
        assert_eq!([plan.regions.columns, plan.regions.rows], [8, 8]);
        for region in &mut regions {
            region.second = region.second.map(|value| factor * value);
        }
        *shifts = RegionShifts::new(&regions, plan.widths()).unwrap();
        let p = run(planned, p_values);
        println!("{factor}: {p:?}");
        assert!(p[0] < 1e-3);
    }
}

/// On a rough surface V-cavities are wrong, whose slopes are right; so is light scattered once, of all light.
#[test]
fn models_of_other_shadowing_are_rejected() {
    let settings = format!("{GLASS}models = [\"smith\", \"v-cavity\"]").replace("30", "60");
    let (p, distances) = run(planned(isotropic(1.5, 5), &settings), |outcome| {
        let models = &outcome.comparison.as_ref().unwrap().judgement.models;
        let distance = |i: usize| models[i].judged().comparison.total_variation.observed;
        (p_values(outcome), [0, 1].map(distance))
    });
    println!("{p:?}");
    assert!(p[1] < 1e-3, "v-cavity");
    // Smith's shadowing leaves out how heights are correlated; it is far less wrong.
    assert!(distances[1] > 2.0 * distances[0]);
}

/// The covariance that models are made for is that of the ensemble within its errors, whatever the axes.
#[test]
fn slopes_of_the_surface_are_those_of_its_ensemble_within_their_errors() {
    let psd = Psd::anisotropic_gaussian(0.4, 4.0, 6.0, 0.5).unwrap();
    let [xx, xy, yy] = psd.slope_covariance();
    let mut squares = 0.0;
    for seed in 0..8 {
        let planned = planned(
            surface(psd.clone(), seed),
            &format!("[surface]\ncells = \"smooth\"\n{MIRROR}models = \"smith\""),
        );
        let found = planned.each[0]
            .comparison
            .as_ref()
            .unwrap()
            .slopes
            .shifts
            .elements();
        for (found, expected) in found.iter().zip([xx, xy, yy]) {
            let z = (found.mean - expected) / found.se.unwrap();
            assert!(z.abs() < 4.5, "{found:?} {expected}");
            squares += z * z;
        }
    }
    // Of 24 squares, of which those of one seed are correlated: twice the deviation of as many that are not
    let mean = squares / 24.0;
    println!("mean square {mean}");
    assert!((mean - 1.0).abs() < 4.0 * (2.0_f64 / 24.0).sqrt());
}

/// Tilts are told; of an open patch slopes are taken about their mean, and of a mirrored one, whose images have slopes of both signs,
/// without means and products.
#[test]
fn tilted_and_mirrored_surfaces_are_told() {
    let regions = vec![
        RegionSlopes {
            mean: [0.3, 0.0],
            second: [1.0, 0.5, 2.0],
        },
        RegionSlopes {
            mean: [0.1, 0.2],
            second: [1.2, 0.7, 1.0],
        },
    ];
    let open = RegionSlopes::mean_of(&centred(Border::Open, regions.clone()));
    let expected = [1.1 - 0.04, 0.6 - 0.02, 1.5 - 0.01];
    for (found, expected) in open.second.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12);
    }
    let mirrored = RegionSlopes::mean_of(&centred(Border::Mirrored, regions.clone()));
    assert_eq!((mirrored.mean, mirrored.second[1]), ([0.0; 2], 0.0));
    let flat = HeightField::new(vec![0.0; 9], [3, 3], [1.0; 2]).unwrap();
    let said = |border| slope_warnings(&flat.clone().with_border(border), &regions).join("; ");
    assert!(said(Border::Open).contains("tilted"));
    assert!(!said(Border::Open).contains("correlated"));
    assert!(said(Border::Mirrored).contains("correlated"));
    assert!(
        slope_warnings(
            &flat,
            &[RegionSlopes {
                mean: [0.0; 2],
                second: [1.0, 0.0, 1.0]
            }]
        )
        .is_empty()
    );
}
