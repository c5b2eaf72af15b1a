//! Outcomes that are handed over group by group, and cases that are left out.

use asperity_simulate::{
    Case, Division, Observer, Outcome, Quantity, Settings, Silent, SimulateError, Simulation,
    StoppedBy, SurfaceSource, simulate,
};
use asperity_tracer::Sampling;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::after::After;
use crate::resuming::{Keeper, numbers, resumed};
use crate::sharing::{Drawings, cases, settings};
use crate::support::{Rough, effort, glass, target};

#[test]
fn cases_that_are_left_out_change_neither_numbers_nor_results_of_others() {
    let all = simulate(&cases(), &settings(), &Silent).unwrap();
    let simulation =
        Simulation::of_missing(&cases(), &settings(), &Division::WHOLE, |case| case < 2).unwrap();
    let drawings = Drawings::default();
    let others = simulation.run(&drawings).unwrap();
    assert_eq!(others[0].number, 2);
    assert!(numbers(&others) == numbers(&all[2..]), "other numbers");
    assert_eq!(drawings.0.into_inner(), 6);
}

/// Ends a run between groups, and counts what has come until then.
#[derive(Default)]
struct AfterOne(AtomicU64);

impl Observer for AfterOne {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        (self.0.load(Ordering::Relaxed) > 0).then_some(StoppedBy::Time)
    }
}

#[test]
fn a_group_is_handed_over_before_the_next_begins() {
    let simulation = Simulation::new(&cases(), &settings()).unwrap();
    let observer = AfterOne::default();
    let mut found: Vec<Outcome> = Vec::new();
    let run = simulation.resume(None, &observer, 0, |outcome| {
        observer.0.fetch_add(1, Ordering::Relaxed);
        found.push(outcome);
        Ok::<_, SimulateError>(())
    });
    run.unwrap();
    let cases: Vec<usize> = found.iter().map(|outcome| outcome.number).collect();
    assert_eq!(cases, [0, 2, 3]);
    assert!(found.iter().all(|outcome| !outcome.stopping.is_cut_short()));
}

#[test]
fn a_failing_sink_ends_the_run() {
    let simulation = Simulation::new(&cases(), &settings()).unwrap();
    let drawings = Drawings::default();
    let run = simulation.resume(None, &drawings, 0, |_| Err(SimulateError::Interrupted));
    assert_eq!(run, Err(SimulateError::Interrupted));
    assert_eq!(drawings.0.into_inner(), 6);
}

/// The two directions need different efforts.
#[test]
fn cases_that_plan_alone_have_the_results_of_single_runs() {
    let settings = Settings {
        effort: target(2e-2, Quantity::Rings),
        plan_alone: true,
        mesh_quadrature: false,
        ..Settings::default()
    };
    let cases = [0.0, 60.0].map(|theta| Rough::smooth(1.0, 4.0, 32).case(glass(), theta));
    let together = simulate(&cases, &settings, &Silent).unwrap();
    for (case, outcome) in cases.iter().zip(&together) {
        let alone = simulate(std::slice::from_ref(case), &settings, &Silent).unwrap();
        assert!(alone[0].surfaces == outcome.surfaces);
    }
    let [a, b] = [&together[0], &together[1]].map(|outcome| outcome.work.rays);
    assert_ne!(a, b);
}

/// A run on one thread is interrupted on its only surface, again and again.
#[test]
fn the_first_surface_keeps_the_blocks_that_were_finished() {
    // Blocks are traced one by one.
    let settings = Settings {
        sampling: Sampling::Random,
        ..effort(1, 64_000)
    };
    let cases = &cases()[..1];
    let whole = simulate(cases, &settings, &Silent).unwrap();
    let keeper = Keeper::default();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build().unwrap().install(|| {
        let mut rays = 0;
        for runs in 1.. {
            let after = After::rays(rays + 10_000);
            let simulation = Simulation::new(cases, &settings).unwrap();
            let part = resumed(simulation, &keeper, &after).unwrap();
            if !part[0].stopping.is_cut_short() {
                assert!(numbers(&part) == numbers(&whole), "other numbers");
                assert!(runs > 3, "{runs}");
                break;
            }
            // What is reported is kept: the next run goes on from there.
            assert!(part[0].work.rays > rays);
            rays = part[0].work.rays;
        }
    });
}

#[test]
fn a_surface_that_was_read_is_described_and_not_traced() {
    let field = asperity_surface::HeightField::new(vec![0.0; 16], [4, 4], [1.0, 2.0]).unwrap();
    let case = Rough::smooth(2.0, 4.0, 32).case(glass(), 30.0);
    let given = Case {
        surface: SurfaceSource::height_field(field),
        ..case.clone()
    };
    let read = |case: &Case| -> Case {
        serde_json::from_value(serde_json::to_value(case).unwrap()).unwrap()
    };
    assert_eq!(read(&case), case);
    let [a, b] = [&case, &read(&case)]
        .map(|case| simulate(std::slice::from_ref(case), &settings(), &Silent).unwrap());
    assert!(numbers(&a) == numbers(&b), "other numbers");
    let described = read(&given);
    assert_eq!(described.surface, given.surface.described());
    assert_eq!(described.surface.size(), Some([4, 4]));
    assert_eq!(described.surface.spacing(), Some([1.0, 2.0]));
    assert!(described.surface.is_level());
    let refused = simulate(&[described], &settings(), &Silent);
    assert_eq!(refused.err(), Some(SimulateError::DescribedSurface));
}
