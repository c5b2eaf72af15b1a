//! What is measured: methods, and how much each of them does.

use asperity_simulate::{Case, Estimator, convergence_stream, short};
use asperity_tracer::{AcceleratorKind, Branching, Sampling};
use rand::RngExt;
use serde::Serialize;

use crate::config::values::{Number, PerAxis};

/// A way of computing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Method {
    /// How paths become results.
    pub estimator: Estimator,
    /// How rays are spread.
    pub sampling: Sampling,
    /// Whether paths follow both branches, or one picked at random.
    pub branching: Branching,
    /// How hits are found.
    pub accelerator: AcceleratorKind,
    /// Length units per sample.
    pub spacing: PerAxis<Number>,
}

impl Method {
    /// Whether both take the same steps on the same grid, so that what differs is the estimate.
    pub(super) fn shares_grid(&self, other: &Self) -> bool {
        self.accelerator == other.accelerator && self.spacing == other.spacing
    }

    /// Whether its paths are those of other ray tracers: independent rays that follow one branch.
    pub(super) fn is_of_peers(&self) -> bool {
        self.is_plain_and_random() && self.branching == Branching::Pick
    }

    /// Whether it is what others are compared with: independent rays, and nothing else.
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
}

/// How much a run does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct RunEffort {
    /// Rays per surface, at least.
    pub rays: u64,
    /// Surfaces.
    pub surfaces: u64,
}

/// The seed of repeat `repeat` of a run: another one for each case, method, effort and repeat, and the
/// same whatever else is in the file.
///
/// The accelerator has no part in it. It changes no result, and so the errors of two accelerators are
/// the same to the last digit.
pub(super) fn run_seed(
    seed: u64,
    case: &Case,
    method: &Method,
    effort: RunEffort,
    repeat: u64,
) -> u64 {
    // Methods that split have no word for it, as before there were others.
    let branching = match method.branching {
        Branching::Split => "",
        Branching::Pick => " pick",
    };
    let name = format!(
        "{} {} {} {} {} {}{branching}",
        case.folder(),
        method.estimator,
        method.sampling,
        method.spacing_text(),
        effort.rays,
        effort.surfaces,
    );
    convergence_stream(seed, &name, repeat).random()
}

/// The seed of the reference of a case.
pub(super) fn reference_seed(seed: u64, case: &Case) -> u64 {
    convergence_stream(seed, &format!("{} reference", case.folder()), 0).random()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::VerifyConfig;

    #[test]
    fn runs_have_seeds_of_their_own_whatever_the_accelerator() {
        let text = "[surface]\nsmoothness = [2, 3]\n[compare]\nmodels = []";
        let cases = VerifyConfig::from_toml(text).unwrap().plan().unwrap().cases;
        let method = Method {
            estimator: Estimator::Plain,
            sampling: Sampling::Random,
            branching: Branching::Split,
            accelerator: AcceleratorKind::Mesh,
            spacing: PerAxis::Both(Number(1.0)),
        };
        let effort = RunEffort {
            rays: 64,
            surfaces: 2,
        };
        let first = run_seed(1, &cases[0], &method, effort, 0);
        let pyramid = Method {
            accelerator: AcceleratorKind::Pyramid,
            ..method
        };
        assert_eq!(run_seed(1, &cases[0], &pyramid, effort, 0), first);
        let controlled = Method {
            estimator: Estimator::Controlled,
            ..method
        };
        let stratified = Method {
            sampling: Sampling::Stratified,
            ..method
        };
        let pick = Method {
            branching: Branching::Pick,
            ..method
        };
        let finer = Method {
            spacing: PerAxis::Both(Number(0.5)),
            ..method
        };
        let mut seeds = vec![
            first,
            run_seed(2, &cases[0], &method, effort, 0),
            run_seed(1, &cases[1], &method, effort, 0),
            run_seed(1, &cases[0], &controlled, effort, 0),
            run_seed(1, &cases[0], &stratified, effort, 0),
            run_seed(1, &cases[0], &finer, effort, 0),
            run_seed(1, &cases[0], &pick, effort, 0),
            run_seed(1, &cases[0], &method, RunEffort { rays: 65, ..effort }, 0),
            run_seed(
                1,
                &cases[0],
                &method,
                RunEffort {
                    surfaces: 3,
                    ..effort
                },
                0,
            ),
            run_seed(1, &cases[0], &method, effort, 1),
            reference_seed(1, &cases[0]),
            reference_seed(1, &cases[1]),
        ];
        let count = seeds.len();
        seeds.sort_unstable();
        seeds.dedup();
        assert_eq!(seeds.len(), count);
    }
}
