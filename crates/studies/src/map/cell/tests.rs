//! Tests of the verdicts on a cell, against numbers put in by hand.

use super::*;
use crate::comparison::models::Testing;
use crate::config::VerifyConfig;
use crate::config::values::Number;
use crate::verify::judge_case;
use asperity_simulate::{Outcome, Silent, simulate};

/// Rounding of sums and differences of a few numbers near one.
const ROUNDING: f64 = 1e-14;

fn peak() -> PeakDifference {
    PeakDifference {
        explicit_deg: 32.0,
        model_deg: 30.5,
        half_width_deg: 12.0,
        se_deg: Some(0.25),
        unresolved_deg: 1.5,
    }
}

fn side() -> CellSide {
    CellSide {
        side: Side::Reflected,
        explicit: 0.5,
        model: 0.375,
        difference: 0.125,
        difference_se: Some(0.01),
        mesh: 0.002,
        peak: Some(peak()),
    }
}

fn distances() -> CellDistances {
    CellDistances {
        total_variation: 0.25,
        noise_95: Some(0.02),
        mesh: 0.003,
        sides: vec![side()],
    }
}

/// Twenty surfaces, and so many rays that the limit `6 / rays` is below the rounding here.
fn results(deviation_bound: Option<f64>, distances: &CellDistances) -> CellResults {
    CellResults {
        surfaces: 20,
        rays: 1 << 60,
        size: [64, 64],
        spacing: [1.0, 1.0],
        deviation_bound,
        lost: 0.0,
        tracked_less_averaged: None,
        models: vec![CellModel {
            name: "smith".to_owned(),
            all_orders: false,
            rays: 1 << 60,
            own: distances.clone(),
            all: distances.clone(),
        }],
    }
}

fn interval(results: &CellResults, measure: &str) -> Interval {
    let judged = results.judge(
        &results.models[0],
        ComparedLight::Own,
        &ToleranceConfig::default(),
    );
    judged.measure(measure).unwrap().interval
}

/// Half the width of the interval, which must lie about `value`.
fn half_width(results: &CellResults, measure: &str, value: f64) -> f64 {
    let found = interval(results, measure);
    let [low, high] = found.range.unwrap();
    assert_eq!(found.value, value, "{measure}");
    assert!((0.5 * (low + high) - value).abs() < ROUNDING, "{measure}");
    0.5 * (high - low)
}

#[test]
fn an_energy_is_known_to_its_error_and_that_of_the_mesh() {
    let found = half_width(&results(None, &distances()), "reflected", 0.125);
    let expected = student_95(20).unwrap() * 0.01 + 0.002;
    assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
}

/// Whatever factor turns an error into 95 %, the mesh is added to it as it is.
#[test]
fn the_mesh_widens_a_total_variation_by_all_that_it_adds() {
    let with = half_width(&results(None, &distances()), "total-variation", 0.25);
    let ideal = CellDistances {
        mesh: 0.0,
        ..distances()
    };
    let without = half_width(&results(None, &ideal), "total-variation", 0.25);
    println!("{with} {without}");
    assert!((with - without - 0.003).abs() < ROUNDING);
    assert!(without >= 0.02 - ROUNDING);
}

#[test]
fn a_peak_is_known_to_its_error_and_what_bins_cannot_tell() {
    let found = half_width(&results(None, &distances()), "reflected-peak", 1.5);
    let expected = student_95(20).unwrap() * 0.25 + 1.5;
    assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
}

/// If nothing was traced, by a model without noise, the bound is all that is left, and the mesh, of
/// which there is none.
#[test]
fn the_bound_of_what_was_not_traced_is_an_error_of_energies() {
    let mut exact = distances();
    exact.sides[0].mesh = 0.0;
    exact.sides[0].difference_se = Some(0.0);
    let found = half_width(&results(Some(0.0625), &exact), "reflected", 0.125);
    assert!((found - 0.0625).abs() < ROUNDING, "{found}");
    // It adds to the noise of a model.
    exact.sides[0].difference_se = Some(0.01);
    let of = |bound| half_width(&results(Some(bound), &exact), "reflected", 0.125);
    let (noise, both) = (of(0.0), of(0.0625));
    assert!(noise >= 0.0195 && (both - noise - 0.0625).abs() < ROUNDING);
}

#[test]
fn few_surfaces_tell_nothing_of_errors() {
    let mut few = results(None, &distances());
    few.surfaces = FEWEST_SURFACES - 1;
    for measure in ["total-variation", "reflected", "reflected-peak"] {
        assert_eq!(interval(&few, measure).range, None, "{measure}");
    }
    few.surfaces = FEWEST_SURFACES;
    for measure in ["total-variation", "reflected", "reflected-peak"] {
        assert!(interval(&few, measure).range.is_some(), "{measure}");
    }
}

/// Without any ray the error is three rays, of either side of a comparison.
#[test]
fn no_observed_ray_is_an_error_of_three_rays() {
    let mut unobserved = distances();
    unobserved.mesh = 0.001;
    unobserved.noise_95 = Some(0.0);
    let mut few = results(None, &unobserved);
    (few.rays, few.models[0].rays) = (1000, 2000);
    let found = half_width(&few, "total-variation", 0.25);
    let expected = 3.0 / 1000.0 + 3.0 / 2000.0 + 0.001;
    assert!((found - expected).abs() < ROUNDING, "{found} {expected}");
}

/// A small run of a model that is sampled and of one that is exact.
fn run() -> (VerifyConfig, Outcome) {
    let text = "
        [surface]
        smoothness = 3
        tau = 4
        size = 32
        spacing = 1
        cells = 'flat'
        [material]
        eta = 1.5
        [light]
        theta = 30
        [run]
        realisations = 16
        rays = 16000
        bins = '3x4'
        estimator = 'plain'
        [compare]
        models = ['heitz', 'smith']
        model_rays = 16000
        ";
    let config = VerifyConfig::from_toml(text).unwrap();
    let plan = config.plan().unwrap();
    let outcomes = simulate(&plan.cases, &plan.settings, &Silent).unwrap();
    (config, outcomes.into_iter().next().unwrap())
}

#[test]
fn the_numbers_of_a_cell_are_those_of_its_run() {
    let (config, outcome) = run();
    let spec = *outcome.statistics.spec();
    let mut judged = judge_case(&config, &outcome, Testing::Tests, &Silent).unwrap();
    let found = CellResults::of(&judged);
    let case = &judged;

    // Of what the mesh adds to a bin half is light that has moved there, half light that has gone.
    for (model, component) in [(0, Component::All), (1, Component::Single)] {
        let mesh = spec
            .grid_entries(component)
            .iter()
            .map(|i| case.outcome.errors.at(i).mesh.unwrap_or(0.0).abs());
        let expected = 0.5 * mesh.sum::<f64>();
        let own = &found.models[model].own;
        println!("mesh {} of {expected}", own.mesh);
        assert!(expected > 1e-4 && (own.mesh / expected - 1.0).abs() < 1e-12);
        let observed = match component {
            Component::All => case.models[model].compared_or_all(Component::All),
            _ => case.models[model].judged(),
        };
        let total = observed.comparison.total_variation;
        // By the quantile of so few surfaces it may be a little more.
        let widened = own.noise_95.unwrap() / total.noise_95.unwrap();
        assert!(widened > 1.0 - ROUNDING && widened < student_95(16).unwrap() / 1.959);
        assert_eq!(own.total_variation, total.observed);
    }

    // Where nothing was traced, noise is that of the model alone: 95 % of each bin, or by Student's quantile
    // of 16 batches a little more.
    let bound = 1e-3;
    let bounded = Outcome {
        deviation_bound: Some(bound),
        ..outcome.clone()
    };
    judged.outcome = &bounded;
    let known = CellResults::of(&judged);
    let statistics = judged.models[0].expectation.statistics();
    let errors = spec.grid_entries(Component::All);
    let errors: f64 = errors.iter().map(|i| statistics.at(i).se.unwrap()).sum();
    let [sampled, exact] = [0, 1].map(|i| known.models[i].own.noise_95.unwrap());
    let quantile = (sampled - bound) / (0.5 * errors);
    println!("errors of bins {errors}, quantile {quantile}");
    assert!(errors > 5e-4);
    assert!(quantile > 1.9599 && quantile < student_95(16).unwrap() + 1e-9);
    assert!((exact - bound).abs() < 1e-15);
    let se = statistics.budget().reflected.se;
    assert_eq!(known.models[0].own.sides[0].difference_se, se);
}

/// A hundredth of the light of a side is the most that may have gone elsewhere.
#[test]
fn a_peak_is_certain_only_if_the_bound_is_far_below_its_light() {
    let (config, outcome) = run();
    let light = judge_case(&config, &outcome, Testing::Tests, &Silent)
        .unwrap()
        .models[1]
        .judged()
        .sides
        .clone();
    let peaks_at = |fraction: f64, side: usize| {
        let bounded = Outcome {
            deviation_bound: Some(fraction * light[side].explicit),
            ..outcome.clone()
        };
        let mut judged = judge_case(&config, &outcome, Testing::Tests, &Silent).unwrap();
        judged.outcome = &bounded;
        let known = CellResults::of(&judged);
        [0, 1].map(|model| known.models[model].own.sides[side].peak.unwrap().se_deg)
    };
    for side in [0, 1] {
        assert_eq!(peaks_at(0.0099, side), [None, Some(0.0)], "{side}");
        assert_eq!(peaks_at(0.0101, side), [None, None], "{side}");
        assert_eq!(peaks_at(1.0, side), [None, None], "{side}");
    }
}

#[test]
fn a_tolerance_decides_by_the_whole_interval() {
    let tolerances = ToleranceConfig {
        energy: Number(0.2),
        total_variation: Number(0.3),
        peak: Number(5.0),
    };
    let results = results(None, &distances());
    let judged = results.judge(&results.models[0], ComparedLight::Own, &tolerances);
    assert_eq!(judged.verdict, CellVerdict::Within, "{judged:?}");
    let close = ToleranceConfig {
        energy: Number(0.13),
        ..tolerances
    };
    let judged = results.judge(&results.models[0], ComparedLight::Own, &close);
    assert_eq!(judged.decided_by(), ["reflected"]);
}
