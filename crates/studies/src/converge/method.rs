//! Methods that are measured, and the runs by which they are.

use std::fmt::Write;

use asperity_simulate::{Case, Effort, Estimator, convergence_stream, short};
use asperity_tracer::{AcceleratorKind, Branching, Sampling};
use rand::RngExt;
use serde::Serialize;

use crate::config::values::{Number, PerAxis};

/// A way of computing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Method {
    /// Estimator.
    pub estimator: Estimator,
    /// Sampling of rays.
    pub sampling: Sampling,
    /// Branches that paths follow: both, or one picked at random.
    pub branching: Branching,
    /// Rays per second of a peer, by which its seconds are computed; `None` for what is timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer_rate: Option<f64>,
    /// Accelerator that finds hits.
    pub accelerator: AcceleratorKind,
    /// Length units per sample.
    pub spacing: PerAxis<Number>,
}

impl Method {
    /// The method whose runs it is measured by: of a peer, the same rays traced here.
    pub(super) const fn timed(&self) -> Self {
        Self {
            peer_rate: None,
            ..*self
        }
    }

    /// Returns `true` if both take the same steps on the same grid, so that what differs is the estimate.
    pub(super) fn shares_grid(&self, other: &Self) -> bool {
        self.accelerator == other.accelerator && self.spacing == other.spacing
    }

    /// Returns `true` if its paths are those of other ray tracers: independent rays that follow one branch.
    pub(super) fn is_of_peers(&self) -> bool {
        self.is_plain_and_random() && self.branching == Branching::Pick
    }

    /// Returns `true` if it is what others are compared with: independent rays, and nothing else.
    pub(super) fn is_plain_and_random(&self) -> bool {
        self.estimator == Estimator::Plain && self.sampling == Sampling::Random
    }

    /// Its spacing as text: one number, or those of x and y.
    pub(super) fn spacing_text(&self) -> String {
        let [dx, dy] = self.spacing.xy().map(|spacing| spacing.0);
        if dx == dy {
            short(dx)
        } else {
            format!("{}x{}", short(dx), short(dy))
        }
    }

    /// Its name among all methods: what they have in common is left out, the estimator and the sampling aside.
    pub(super) fn name(&self, all: &[Self]) -> String {
        let differs = |is_other: &dyn Fn(&Self) -> bool| all.iter().any(is_other);
        let mut name = match self.peer_rate {
            Some(rate) => format!("a peer of {rate:e} rays/s"),
            None => format!("{}, {}", self.estimator, self.sampling),
        };
        if self.peer_rate.is_none() && differs(&|other| other.branching != self.branching) {
            let _ = write!(name, ", {}", self.branching);
        }
        if differs(&|other| other.accelerator != self.accelerator) {
            let _ = write!(name, ", {}", self.accelerator);
        }
        if differs(&|other| other.spacing != self.spacing) {
            let _ = write!(name, ", spacing {}", self.spacing_text());
        }
        name
    }
}

/// A run of the engine.
#[derive(Clone, Debug)]
pub struct ConvergeRun {
    /// Number of its case among those of the plan.
    pub case_number: usize,
    /// Its case, on surfaces of the spacing of its method.
    pub case: Case,
    /// Method of computation.
    pub method: Method,
    /// Rays and surfaces.
    pub effort: Effort,
    /// Number among the runs of equal method and effort; `None` for the reference.
    pub repeat: Option<u64>,
    /// Seed of surfaces and rays.
    pub seed: u64,
}

impl ConvergeRun {
    /// The run whose seed derives from that of the configuration: another one for each case, method, effort and repeat, and the
    /// same whatever else is in the file.
    ///
    /// The accelerator has no part in it. It changes no result, and so the errors of two accelerators are
    /// the same to the last digit.
    pub(super) fn seeded(self, seed: u64) -> Self {
        // Methods that split have no word for it, as before there were others.
        let branching = match self.method.branching {
            Branching::Split => "",
            Branching::Pick => " pick",
        };
        let (folder, surfaces) = (self.case.folder(), self.effort.surfaces());
        let name = match self.repeat {
            None => format!("{folder} reference"),
            Some(_) => format!(
                "{folder} {} {} {} {} {surfaces}{branching}",
                self.method.estimator,
                self.method.sampling,
                self.method.spacing_text(),
                self.effort.total_rays() / surfaces,
            ),
        };
        let mut stream = convergence_stream(seed, &name, self.repeat.unwrap_or(0));
        Self {
            seed: stream.random(),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::VerifyConfig;

    #[test]
    fn runs_have_seeds_of_their_own_whatever_the_accelerator() {
        let text = "[surface]\nsmoothness = [2, 3]\n[compare]\nmodels = []";
        let cases = VerifyConfig::from_toml(text).unwrap().plan().unwrap().cases;
        let effort = |rays, surfaces| Effort::Rays {
            total: rays * surfaces,
            surfaces,
        };
        let run = ConvergeRun {
            case_number: 0,
            case: cases[0].clone(),
            method: Method {
                estimator: Estimator::Plain,
                sampling: Sampling::Random,
                branching: Branching::Split,
                peer_rate: None,
                accelerator: AcceleratorKind::Mesh,
                spacing: PerAxis::Both(Number(1.0)),
            },
            effort: effort(64, 2),
            repeat: Some(0),
            seed: 0,
        };
        let changed = |change: &dyn Fn(&mut ConvergeRun)| {
            let mut run = run.clone();
            change(&mut run);
            run.seeded(1).seed
        };
        let first = changed(&|_| {});
        let pyramid = changed(&|run| run.method.accelerator = AcceleratorKind::Pyramid);
        assert_eq!(pyramid, first);
        let other_case = |run: &mut ConvergeRun| run.case = cases[1].clone();
        let mut seeds = vec![
            first,
            run.clone().seeded(2).seed,
            changed(&other_case),
            changed(&|run| run.method.estimator = Estimator::Controlled),
            changed(&|run| run.method.sampling = Sampling::Stratified),
            changed(&|run| run.method.spacing = PerAxis::Both(Number(0.5))),
            changed(&|run| run.method.branching = Branching::Pick),
            changed(&|run| run.effort = effort(65, 2)),
            changed(&|run| run.effort = effort(64, 3)),
            changed(&|run| run.repeat = Some(1)),
            changed(&|run| run.repeat = None),
            changed(&|run| {
                other_case(run);
                run.repeat = None;
            }),
        ];
        let count = seeds.len();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), count);
    }
}
