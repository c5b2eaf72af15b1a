//! Watch: shows how near a run has come to its target while it goes on.

use std::sync::Mutex;

use asperity_tally::BatchStatistics;

use crate::input::target::{Target, ratio};
use crate::observer::Observer;
use crate::output::surface_tallies::SurfaceTallies;

/// Surfaces after which the error so far is worth showing.
const WORTH_SHOWING: u64 = 4;

/// Most rays that are shown as expected.
const MAX_EXPECTED: f64 = 1e15;

/// Display of a run while it goes on.
pub(crate) struct Watch {
    /// `None` if nothing is shown.
    target: Option<Target>,
    /// Surfaces planned.
    planned: u64,
    /// Rays of all cases on one surface.
    rays: u64,
    seen: Mutex<Seen>,
}

/// The quantity whose error is to reach a target, by case.
#[derive(Default)]
struct Seen {
    surfaces: u64,
    cases: Vec<BatchStatistics>,
}

impl Watch {
    /// `planned`: surfaces. `rays`: of all cases on one surface.
    pub(crate) fn new(target: Option<Target>, planned: u64, rays: u64) -> Self {
        Self {
            target,
            planned,
            rays,
            seen: Mutex::default(),
        }
    }

    /// Adds a surface, and shows the error so far of the most demanding case, and what it lets expect.
    ///
    /// Surfaces come here in any order: nothing but what is shown depends on it.
    pub(crate) fn add(&self, surface: &SurfaceTallies, observer: &dyn Observer) {
        let Some(target) = self.target else { return };
        let Ok(mut seen) = self.seen.lock() else {
            return;
        };
        let worst = seen.add(surface, target);
        if seen.surfaces < WORTH_SHOWING {
            return;
        }
        observer.note(&format!("error {worst:.2e} of {:.2e}", target.error()));
        let needed = seen.surfaces as f64 * (worst / target.error()).powi(2);
        if needed > self.planned as f64 && needed < MAX_EXPECTED / self.rays as f64 {
            observer.expect((needed * self.rays as f64) as u64);
        }
    }
}

impl Seen {
    /// Adds a surface, and returns the largest error of a case.
    fn add(&mut self, surface: &SurfaceTallies, target: Target) -> f64 {
        self.surfaces += 1;
        self.cases
            .resize_with(surface.cases.len(), BatchStatistics::default);
        let mut worst = 0.0_f64;
        for (seen, case) in self.cases.iter_mut().zip(&surface.cases) {
            let Some(total) = case.blocks.total() else {
                continue;
            };
            let means = total.tally.means();
            let entries = target.of().entries(means.spec());
            let values: Vec<f64> = entries.iter().map(|&i| means[i]).collect();
            if seen.batches() == 0 {
                *seen = BatchStatistics::new(values.len());
            }
            seen.push(&values);
            let squares: f64 = seen.error_squares().sum();
            let norm = seen.means().iter().map(|mean| mean * mean).sum();
            worst = worst.max(ratio(squares.sqrt(), target.of().norm(norm)));
        }
        worst
    }
}
