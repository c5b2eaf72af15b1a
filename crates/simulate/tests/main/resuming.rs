//! Runs that were ended and go on from what a store has kept.

use std::collections::HashMap;
use std::sync::Mutex;

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Effort, Estimator, Light, Observer, Outcome, Quantity, Settings, Silent, SimulateError,
    Simulation, Stage, SurfaceKey, SurfaceSource, SurfaceStore, SurfaceTallies, Target, simulate,
};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::TallyResult;
use asperity_tracer::{Branching, PathSettings};

use crate::after::{After, OncePlanned};
use crate::sharing::{Drawings, cases, settings};
use crate::support::{Rough, glass, target};

/// Keeps finished parts as text.
#[derive(Default)]
pub(crate) struct Keeper(Mutex<HashMap<SurfaceKey, String>>);

impl Keeper {
    /// Loses all parts but some.
    pub(crate) fn keep(&self, is_kept: impl Fn(&SurfaceKey) -> bool) {
        self.0.lock().unwrap().retain(|key, _| is_kept(key));
    }

    /// Number of parts that it keeps.
    pub(crate) fn len(&self) -> usize {
        self.0.lock().unwrap().len()
    }
}

impl SurfaceStore for Keeper {
    fn load(&self, key: SurfaceKey) -> Option<SurfaceTallies> {
        let text = self.0.lock().unwrap().get(&key).cloned()?;
        Some(serde_json::from_str(&text).unwrap())
    }
    fn save(&self, key: SurfaceKey, surface: SurfaceTallies) {
        let text = serde_json::to_string(&surface).unwrap();
        self.0.lock().unwrap().insert(key, text);
    }
}

pub(crate) fn resume(
    cases: &[Case],
    settings: &Settings,
    keeper: &Keeper,
    observer: &dyn Observer,
) -> Vec<Outcome> {
    let simulation = Simulation::new(cases, settings).unwrap();
    resumed(simulation, keeper, observer).unwrap()
}

/// The outcomes of a run, in the order of the cases.
pub(crate) fn resumed(
    simulation: Simulation,
    keeper: &Keeper,
    observer: &dyn Observer,
) -> Result<Vec<Outcome>, SimulateError> {
    let mut outcomes = Vec::new();
    simulation.resume(Some(keeper), observer, 0, |outcome| {
        outcomes.push(outcome);
        Ok::<_, SimulateError>(())
    })?;
    outcomes.sort_by_key(|outcome| outcome.number);
    Ok(outcomes)
}

/// All numbers that follow from the rays.
pub(crate) fn numbers(outcomes: &[Outcome]) -> String {
    let of_one = |one: &Outcome| {
        let entries = one.statistics.spec().entries();
        let errors: Vec<_> = entries.map(|entry| one.errors.at(entry)).collect();
        let work = (one.work.rays, one.work.segments, one.work.scatterings);
        format!(
            "{:?} {errors:?} {work:?} {:?}",
            one.statistics, one.stopping
        )
    };
    outcomes.iter().map(of_one).collect()
}

#[test]
fn random_surfaces_resume_from_those_kept_to_the_same_numbers() {
    let keeper = Keeper::default();
    let whole = resume(&cases(), &settings(), &keeper, &Silent);
    // Every second surface is lost.
    keeper.keep(|key| key.number % 2 == 0);
    let drawings = Drawings::default();
    let resumed = resume(&cases(), &settings(), &keeper, &drawings);
    assert_eq!(drawings.0.into_inner(), 2 * 3);
    assert!(numbers(&resumed) == numbers(&whole), "other numbers");
}

/// Two directions of light on one given surface.
fn given() -> Vec<Case> {
    let psd = Psd::gaussian(2.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [32; 2], [1.0; 2], false).unwrap();
    let surface = SurfaceSource::height_field(synthesis.draw(1, 0).unwrap());
    let case = |theta: f64| {
        let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
        let glass = Material::dielectric(1.5).unwrap();
        Case::new(surface.clone(), glass, light)
    };
    vec![case(10.0), case(50.0)]
}

/// A run is ended again and again, at its pilot run, in the first round and in later ones, by threads that leave out
/// blocks in the middle.
#[test]
fn a_given_surface_resumes_round_by_round_to_the_same_numbers() {
    let target = Target::new(4e-3, Quantity::Rings).unwrap();
    for (refine, effort) in [
        (false, Effort::rays(100_000)),
        (true, Effort::rays(20_000)),
        (false, Effort::TargetError(target)),
    ] {
        let settings = Settings {
            refine,
            effort,
            ..Settings::default()
        };
        let whole = simulate(&given(), &settings, &Silent).unwrap();
        let keeper = Keeper::default();
        let all: u64 = whole.iter().map(|one| one.work.rays).sum();
        for runs in 1.. {
            // The rays that are resumed count as well.
            let after = After::rays(runs * all / 4);
            let resumed = resume(&given(), &settings, &keeper, &after);
            let is_whole = resumed.iter().all(|one| !one.stopping.is_cut_short());
            if is_whole && resumed.len() == whole.len() {
                assert!(numbers(&resumed) == numbers(&whole), "other numbers");
                assert!(runs > 2);
                assert!(after.most_at_once.into_inner() > all / 8);
                break;
            }
            assert!(runs < 20);
        }
    }
}

/// A run is ended in its pilot run, in the trial of paths and in the coarse pilot run.
#[test]
fn a_run_that_tries_paths_resumes_to_the_same_numbers() {
    let settings = Settings {
        effort: target(1e-3, Quantity::Bins),
        estimator: Estimator::Plain,
        mesh_quadrature: false,
        ..Settings::default()
    };
    let case = [Rough::smooth(1.0, 4.0, 32).case(glass(), 60.0)];
    let whole = simulate(&case, &settings, &OncePlanned::default()).unwrap();
    assert_eq!(whole[0].stopping.paths.as_ref().unwrap().tried.len(), 4);
    let keeper = Keeper::default();
    let of_pilot = 16 << 11;
    // One pilot run, three of the trial and a coarse one.
    for (rays, tries) in [(of_pilot / 2, 0), (2 * of_pilot, 1), (9 * of_pilot / 2, 2)] {
        let simulation = Simulation::new(&case, &settings).unwrap();
        let ended = resumed(simulation, &keeper, &After::rays(rays));
        assert_eq!(ended.err(), Some(SimulateError::Interrupted));
        let kept = keeper.0.lock().unwrap();
        let of_stage = |stage: Stage| kept.keys().filter(|key| key.stage == stage).count();
        assert_eq!(of_stage(Stage::PathTrial) > 0, tries > 0);
        assert_eq!(of_stage(Stage::CoarsePilot) > 0, tries > 1);
    }
    let resumed = resume(&case, &settings, &keeper, &OncePlanned::default());
    assert!(numbers(&resumed) == numbers(&whole), "other numbers");
}

/// A run that was stopped before its trial of paths leaves what it found on others.
#[test]
fn what_was_found_on_other_paths_is_not_resumed() {
    let random = vec![Rough::smooth(1.0, 4.0, 32).case(glass(), 60.0)];
    for cases in [random, given()] {
        let on = |branching| Settings {
            effort: Effort::Rays {
                total: 4000,
                surfaces: 2,
            },
            paths: PathSettings::default().with(branching, 0.01).into(),
            mesh_quadrature: false,
            ..Settings::default()
        };
        let pick = on(Branching::Pick);
        let whole = simulate(&cases, &pick, &Silent).unwrap();
        let keeper = Keeper::default();
        resume(&cases, &on(Branching::Split), &keeper, &Silent);
        assert!(!keeper.0.lock().unwrap().is_empty());
        let resumed = resume(&cases, &pick, &keeper, &Silent);
        assert!(numbers(&resumed) == numbers(&whole), "other numbers");
    }
}
