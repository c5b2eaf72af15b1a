//! Branching and roulette: named, chosen by a pilot run, or as they are without one.

use asperity_optics::Incidence;
use asperity_simulate::{
    Case, Effort, Estimator, Light, Outcome, PathChoice, Quantity, Settings, SurfaceSource,
    TriedPaths, simulate,
};
use asperity_surface::LengthUnit;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::{Branching, PathSettings};

use crate::after::OncePlanned;
use crate::support::{Rough, glass, run, target};

/// The beginning of a plain run that reaches `error` of `of`.
fn begin(case: &Case, error: f64, of: Quantity, paths: PathChoice) -> Outcome {
    begin_by(Estimator::Plain, case, error, of, paths)
}

fn begin_by(
    estimator: Estimator,
    case: &Case,
    error: f64,
    of: Quantity,
    paths: PathChoice,
) -> Outcome {
    let settings = Settings {
        effort: target(error, of),
        paths,
        estimator,
        mesh_quadrature: false,
        ..Settings::default()
    };
    let cases = std::slice::from_ref(case);
    let outcomes = simulate(cases, &settings, &OncePlanned::default());
    outcomes.unwrap().remove(0)
}

/// A run of `total` rays.
fn rays(total: u64, surfaces: u64) -> Settings {
    Settings {
        effort: Effort::Rays { total, surfaces },
        mesh_quadrature: false,
        ..Settings::default()
    }
}

fn psd() -> Psd {
    Psd::gaussian(4.0, 4.0).unwrap()
}

/// Rough glass, on which a path has many branches.
fn random() -> Case {
    Rough::smooth(1.0, 4.0, 32).case(glass(), 60.0)
}

/// The light on one such surface.
fn given() -> Case {
    let synthesis = Synthesis::new(psd(), [32; 2], [1.0; 2], false).unwrap();
    let surface = SurfaceSource::height_field(synthesis.draw(1, 0).unwrap());
    let light = Light::from_above(Incidence::from_degrees(60.0, 0.0).unwrap());
    Case::new(surface, glass(), light)
}

fn free() -> PathChoice {
    PathChoice::default()
}

/// The paths that a run was traced on.
fn traced_on(outcome: &Outcome) -> PathSettings {
    PathSettings::default().with(outcome.work.branching, outcome.work.roulette)
}

fn tried(outcome: &Outcome) -> &[TriedPaths] {
    &outcome.stopping.paths.as_ref().unwrap().tried
}

/// All numbers that follow from the plan and the rays.
fn numbers(outcome: &Outcome) -> String {
    let stopping = &outcome.stopping;
    let plan = (stopping.realisations, stopping.rays_per_surface);
    let pilot = (stopping.pilot, stopping.spacing, stopping.mesh_error);
    let work = (outcome.work.rays, outcome.work.segments);
    format!("{plan:?} {pilot:?} {work:?} {:?}", outcome.statistics)
}

/// Chosen paths take the same surfaces and rays when they are named, and give the same bytes.
#[test]
fn a_long_run_takes_the_best_of_what_the_pilot_run_tried() {
    for case in [random(), given()] {
        let chosen = begin(&case, 1e-3, Quantity::Bins, free());
        println!("{:?}", chosen.stopping.line(LengthUnit::Arbitrary));
        let all = tried(&chosen);
        assert_eq!((all.len(), all[0].relative_cost), (4, 1.0));
        let best = all
            .iter()
            .min_by(|a, b| a.relative_cost.total_cmp(&b.relative_cost));
        let best = best.unwrap();
        assert!(best.relative_cost < 0.9, "{best:?}");
        let paths = PathSettings::default().with(best.strategy.branching, best.strategy.roulette);
        assert_eq!(traced_on(&chosen), paths);
        let line = chosen.stopping.line(LengthUnit::Arbitrary).unwrap();
        assert!(line.contains("of the cost x variance of split, roulette 0.01, from above, plain"));

        let named = begin(&case, 1e-3, Quantity::Bins, paths.into());
        assert!(tried(&named).is_empty());
        assert!(numbers(&named) == numbers(&chosen), "other numbers");
        let default = begin(&case, 1e-3, Quantity::Bins, PathSettings::default().into());
        assert!(numbers(&default) != numbers(&chosen), "the same numbers");
    }
}

/// If the estimator is free, the other start of paths and plain rays are tried beside the control variate, the latter on all paths;
/// where it is named, the other start alone.
#[test]
fn starts_and_estimators_are_tried_too() {
    let case = random();
    for (estimator, count) in [(Estimator::Auto, 9), (Estimator::Controlled, 5)] {
        let outcome = begin_by(estimator, &case, 1e-3, Quantity::Bins, free());
        let all = tried(&outcome);
        println!("{:?}", outcome.stopping.line(LengthUnit::Arbitrary));
        assert_eq!(all.len(), count);
        let others = all
            .iter()
            .filter(|one| one.strategy.starts != all[0].strategy.starts);
        assert!(others.count() > 0);
        let plain = all
            .iter()
            .filter(|one| one.strategy.estimator == Estimator::Plain);
        assert_eq!(plain.count(), count - 5);
        let least = all
            .iter()
            .min_by(|a, b| a.relative_cost.total_cmp(&b.relative_cost));
        let strategy = least.unwrap().strategy;
        assert_eq!(outcome.stopping.paths.as_ref().unwrap().strategy, strategy);
        assert_eq!(outcome.work.estimator, strategy.estimator);
        assert_eq!(outcome.work.starts, strategy.starts);
    }
}

/// The total of what is reflected scatters much less where both branches are followed.
#[test]
fn totals_keep_both_branches_and_a_low_threshold() {
    for case in [random(), given()] {
        let outcome = begin(&case, 1e-6, Quantity::Reflected, free());
        println!(
            "{:?} {:?}",
            outcome.stopping.line(LengthUnit::Arbitrary),
            outcome.stopping.pilot
        );
        let picked = tried(&outcome)
            .iter()
            .find(|one| one.strategy.branching == Branching::Pick);
        assert!(picked.unwrap().relative_cost > 2.0);
        assert_eq!(traced_on(&outcome), PathSettings::default());
    }
}

#[test]
fn without_a_long_run_paths_are_the_default() {
    for case in [random(), given()] {
        let short = begin(&case, 0.3, Quantity::Bins, free());
        assert!(tried(&short).is_empty());
        let fixed = run(case, &rays(2000, 2));
        assert_eq!(fixed.stopping.paths, None);
        for outcome in [short, fixed] {
            assert_eq!(traced_on(&outcome), PathSettings::default());
        }
    }
}

#[test]
fn what_is_named_is_kept() {
    for case in [random(), given()] {
        let named = |branching, roulette| {
            let choice = PathChoice::new(branching, roulette, 1000).unwrap();
            begin(&case, 1e-3, Quantity::Bins, choice)
        };
        let pick = named(Some(Branching::Pick), None);
        assert_eq!(pick.work.branching, Branching::Pick);
        assert!(tried(&pick).is_empty());
        let split = named(Some(Branching::Split), None);
        assert_eq!(tried(&split).len(), 3);
        assert_eq!(split.work.branching, Branching::Split);
        let threshold = named(None, Some(0.2));
        assert_eq!(tried(&threshold).len(), 2);
        assert_eq!(threshold.work.roulette, 0.2);
    }
}
