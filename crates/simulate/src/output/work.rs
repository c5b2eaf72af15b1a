//! Work of a run, and its time.

use asperity_tracer::{AcceleratorKind, Branching, PreparedSurface, Sampling, Starts, Work};
use serde::{Deserialize, Serialize};

use crate::input::estimator::Estimator;
use crate::methods::method::{ControlVariateMean, Method};

/// Work, and its time.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct SummaryWork {
    /// Surfaces.
    pub realisations: u64,
    /// Incident rays.
    pub rays: u64,
    /// Segments searched for a hit.
    pub segments: u64,
    /// Segments that needed no search.
    pub segments_skipped: u64,
    /// Segments of these that bounds on slopes and heights ahead skipped, not the steepest facets of the whole surface.
    pub segments_skipped_nearby: u64,
    /// Branches not followed, since they could end only on a side that is not recorded.
    pub branches_not_recorded: u64,
    /// Scatterings inside a medium.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub scatterings: u64,
    /// Most scatterings of one path.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub most_scatterings: u64,
    /// Accelerator used.
    pub accelerator: AcceleratorKind,
    /// Estimator used.
    pub estimator: Estimator,
    /// Source of the mean of its control variate; `None` without one.
    pub control_variate: Option<ControlVariateMean>,
    /// Variance of the target quantity, or of the bins, that a further control variate by the slopes of each surface has left; `None`
    /// without one.
    pub slope_control: Option<f64>,
    /// `true` if bins on either side of the plane of incidence are averaged.
    pub folded: bool,
    /// Branches that its paths follow.
    pub branching: Branching,
    /// Flux below which Russian roulette decides.
    pub roulette: f64,
    /// Starts of its paths.
    pub starts: Starts,
    /// Sampling of the starts.
    pub sampling: Sampling,
    /// Work that depends on the machine and the moment.
    #[serde(default)]
    pub machine: MachineWork,
}

/// Work that depends on the machine and the moment, which comparisons of results leave out.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct MachineWork {
    /// Instructions with which the accelerator searches, where there is a choice.
    pub instructions: Option<String>,
    /// Seconds spent on drawing surfaces, summed over surfaces.
    pub generate_seconds: f64,
    /// Seconds spent on building accelerators, summed over surfaces.
    pub build_seconds: f64,
    /// Seconds spent on tracing, summed over surfaces.
    pub trace_seconds: f64,
    /// Seconds from beginning to end.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
}

/// The accelerator that was built.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Used {
    accelerator: AcceleratorKind,
    #[serde(rename = "machine")]
    instructions: Option<String>,
}

impl Used {
    pub(crate) fn of(surface: &dyn PreparedSurface) -> Self {
        Self {
            accelerator: surface.accelerator(),
            instructions: surface.instructions(),
        }
    }
}

impl Used {
    /// Its kind.
    pub(crate) const fn kind(&self) -> AcceleratorKind {
        self.accelerator
    }

    /// Accelerator without its instructions, which depend on the machine.
    pub(crate) fn without_machine(self) -> Self {
        Self {
            instructions: None,
            ..self
        }
    }

    /// None, since no rays were traced.
    pub(crate) const fn nothing() -> Self {
        Self {
            accelerator: AcceleratorKind::Auto,
            instructions: None,
        }
    }
}

impl SummaryWork {
    pub(crate) fn new(work: Work, used: Used, method: &Method, sampling: Sampling) -> Self {
        Self {
            realisations: 0,
            rays: work.rays,
            segments: work.segments,
            segments_skipped: work.segments_skipped,
            segments_skipped_nearby: work.segments_skipped_nearby,
            branches_not_recorded: work.branches_not_recorded,
            scatterings: work.scatterings,
            most_scatterings: work.max_scatterings.into(),
            accelerator: used.accelerator,
            estimator: method.estimator(),
            control_variate: method.control_variate_mean(),
            slope_control: None,
            folded: method.mirror.is_some(),
            branching: method.paths.branching(),
            roulette: method.paths.roulette(),
            starts: method.starts,
            sampling,
            machine: MachineWork {
                instructions: used.instructions,
                threads: rayon::current_num_threads(),
                ..MachineWork::default()
            },
        }
    }
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}
