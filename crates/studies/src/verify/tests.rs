//! Random surfaces whose slopes are not Gaussian, against models with their root mean square slopes and with all of their slopes.

use asperity_analysis::{Untested, sidak_level};
use asperity_simulate::{Quantity, RandomSurfaces, Silent, simulate};
use asperity_synthesis::{Psd, StudentSlopes};
use asperity_tally::Component;

use super::*;
use crate::comparison::models::ModelOutcome;

/// One case of `settings` on surfaces of GGX slopes, or on Gaussian ones.
fn outcome<T>(settings: &str, is_ggx: bool, read: impl Fn(&Judgement<'_>) -> T) -> T {
    let text = format!(
        "[surface]\nsize = 128\ntau = 6\nsmoothness = 100\n[material]\nkind = \"mirror\"\n[output]\nplots = false\n{settings}"
    );
    let config = VerifyConfig::from_toml(&text).unwrap();
    let mut plan = config.plan().unwrap();
    if is_ggx {
        let psd = Psd::gaussian(6.0 / 100.0, 6.0).unwrap();
        let recipe = StudentSlopes::new(psd, 3.0).unwrap();
        let grid = &config.surface;
        let shape = grid.shape();
        let surfaces = RandomSurfaces::new(grid.cells(), recipe, shape, grid.spacing(), false);
        plan.cases[0].surface = SurfaceSource::random(surfaces.unwrap());
    }
    let found = simulate(&plan.cases, &plan.settings, &Silent).unwrap();
    read(&judge_case(&config, &found[0], Testing::Tests, &Silent).unwrap())
}

fn p_values(outcome: &Judgement<'_>) -> Vec<f64> {
    let compared = |model: &ModelOutcome| model.compared(Component::Single).unwrap().clone();
    let models = outcome.models.iter();
    models
        .map(|model| compared(model).comparison.test.unwrap().p)
        .collect()
}

/// Alpha is 0.02: a fraction 4e-4 of the facets is steeper than 1, and next to nothing is shadowed, masked or scattered twice. At an alpha of 0.1
/// a thousandth of the light is, by facets that are steep together, which no model knows of, and the test finds it; so it does at this
/// alpha with the control variate, whose errors are a hundred times smaller. Of 6 seeds of which a model is true, more than 3 have p below 0.05
/// with probability 9e-5.
#[test]
fn ggx_surfaces_have_the_light_of_their_slopes() {
    let (mut low, mut rejected) = (0, 0);
    for azimuth in ["fixed", "random"] {
        for seed in 1..=3 {
            let run = format!(
                "[light]\ntheta = 20\nazimuth = \"{azimuth}\"\n[run]\nbins = \"9x12\"\nrays = 100000\nestimator = \"plain\"\nrealisations = 24\nseed = {seed}\n[compare]\nmodels = [\"smith-slopes\", \"smith\"]"
            );
            let p = outcome(&run, true, p_values);
            println!("{azimuth} {seed}: {p:?}");
            low += usize::from(p[0] < 0.05);
            rejected += usize::from(p[1] < 0.01);
        }
    }
    assert!(low <= 3 && rejected == 6, "{low} {rejected}");
}

/// Pits so shallow that nothing is shadowed, masked or scattered twice, in a plane whose facets are level, and triangles at their rims that are level
/// along an axis. Their light leaves at the angle and in the plane of that of a mirror, where bins meet. Of 6 runs of which a model is true, more than
/// one has p below 0.01 with probability 1.5e-3; each kind has two.
#[test]
fn light_of_level_facets_is_that_of_their_slopes() {
    let mut found = Vec::new();
    for light in [
        "azimuth = \"random\"",
        "azimuth = \"fixed\"",
        "azimuth = \"random\"\n[run]\nfold = false",
    ] {
        for seed in 1..=2 {
            let run = if light.contains("[run]") {
                ""
            } else {
                "[run]\n"
            };
            let text = format!(
                "[surface]\nstructure = \"pits\"\nwidth = 12\ndepth = 0.15\nsize = 64\nspacing = 1\ninsist = true\n[material]\nkind = \"mirror\"\n[output]\nplots = false\n[compare]\nmodels = \"smith-slopes\"\n[light]\ntheta = 30\n{light}\n{run}bins = \"9x12\"\nrays = 8000\nestimator = \"plain\"\nrealisations = 12\nseed = {seed}"
            );
            let config = VerifyConfig::from_toml(&text).unwrap();
            let plan = config.plan().unwrap();
            let outcomes = simulate(&plan.cases, &plan.settings, &Silent).unwrap();
            let p =
                p_values(&judge_case(&config, &outcomes[0], Testing::Tests, &Silent).unwrap())[0];
            println!("{light} {seed}: {p}");
            found.push(p);
        }
    }
    let low = found.iter().filter(|p| **p < 0.01).count();
    assert!(low <= 1, "{found:?}");
}

/// Slopes of Gaussian surfaces are known, and need no table: the model is that of Smith, to the last digit.
#[test]
fn gaussian_surfaces_need_no_table() {
    let run = "[light]\ntheta = 40\n[run]\nbins = \"9x12\"\nrays = 20000\nrealisations = 8\n[compare]\nmodels = [\"smith-slopes\", \"smith\"]";
    let [one, other] = outcome(run, false, |found| {
        [0, 1].map(|i| found.models[i].expectation.tallies()[0].clone())
    });
    assert_eq!(one, other);
}

/// Reading of the comparison of a few small surfaces with the models of `compare`.
fn compared<T>(compare: &str, run: &str, read: impl Fn(&Judgement<'_>) -> T) -> T {
    let text = format!(
        "[surface]\nsize = 64\ntau = 4\nsmoothness = 2\n[material]\neta = 1.5\n[light]\ntheta = 30\n[output]\nplots = false\n[run]\nbins = \"9x12\"\n{run}\n[compare]\n{compare}"
    );
    let config = VerifyConfig::from_toml(&text).unwrap();
    let plan = config.plan().unwrap();
    let found = simulate(&plan.cases, &plan.settings, &Silent).unwrap();
    read(&judge_case(&config, &found[0], Testing::Tests, &Silent).unwrap())
}

#[test]
fn models_that_expect_the_same_are_one_test_and_unclaimed_light_is_none() {
    let compare = "models = [\"xu-sun\", \"smith\", \"heitz\"]\nmodel_rays = 20000";
    compared(compare, "realisations = 16\nrays = 50000", |found| {
        let single = |i: usize| found.models[i].compared(Component::Single).unwrap();
        assert_eq!(single(1).comparison, single(2).comparison);
        assert_eq!(single(1).sides, single(2).sides);
        assert!(single(2).comparison.test.is_ok());
        assert_eq!(single(1).verdict, single(2).verdict);
        assert_ne!(single(0).comparison, single(1).comparison);
        // Single scattering of two kinds, multiple and all light of one model
        assert_eq!(found.level, sidak_level(0.01, 4));
        let all = |i: usize| found.models[i].compared(Component::All).unwrap();
        for i in [0, 1] {
            assert_eq!(all(i).comparison.test, Err(Untested::NotRequested));
            assert_eq!(all(i).verdict, None);
            assert!(all(i).comparison.total_variation.noise.is_some());
        }
        assert!(all(2).verdict.is_some());
    });
}

/// The variance over the bins is half of that of the surfaces, or less where models follow as many rays as these. The pilot run and the model know
/// that variance by a dozen batches each, over some ten bins that hold most of it: their ratio scatters by 0.2.
#[test]
fn models_follow_as_many_rays_as_a_target_error_asks_for() {
    for (target, seed) in [(1e-3, 1), (1e-3, 2), (2e-2, 1)] {
        let run = format!("target_error = {target}\nseed = {seed}");
        let [rays, least, fraction] = compared("models = \"heitz\"", &run, |found| {
            let error = |statistics| Quantity::Bins.error(statistics).unwrap();
            let expectation = &found.models[0].expectation;
            let ratio = error(expectation.statistics()) / error(&found.outcome.statistics);
            let rays = [expectation.rays(), found.outcome.work.rays];
            let [rays, least] = rays.map(|rays| rays as f64);
            [rays, least, ratio * ratio]
        });
        println!("{target} {seed}: {rays} rays, {least} at least, fraction {fraction}");
        assert!(rays >= least && fraction < 0.75);
        assert!(rays < 1.1 * least.max(16_384.0) || fraction > 0.25);
    }
}
