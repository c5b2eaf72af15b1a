//! Stopping: the end of a run.

use asperity_surface::LengthUnit;
use serde::{Deserialize, Serialize};

use crate::input::cells::Cells;
use crate::input::target::Quantity;
use crate::output::chosen_paths::ChosenPaths;
use crate::output::stopped_by::StoppedBy;
use crate::text::{error_in_short, short};

/// Figures of a pilot run for the requested quantity; variances and differences are divided by the
/// norm of the fluxes, as the error is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PilotFigures {
    /// Surfaces.
    pub realisations: u64,
    /// Rays in all.
    pub rays: u64,
    /// Variance between surfaces, if each had rays without end.
    pub variance_of_surfaces: f64,
    /// Variance of one ray on its surface.
    pub variance_of_rays: f64,
    /// Counted cost of a surface, in nanoseconds of a typical machine.
    pub cost_of_surface_ns: f64,
    /// Counted cost of a ray.
    pub cost_of_ray_ns: f64,
    /// Change of the quantity at twice the spacing, plus twice its noise; `None` if
    /// it could not be found out.
    pub mesh_difference: Option<f64>,
}

/// End of a run, and its plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stopping {
    /// The target error.
    pub target_error: Option<f64>,
    /// Quantity of the error.
    pub of: Option<Quantity>,
    /// The error reached: with a target, or `None` where there is none.
    pub error: Option<f64>,
    /// Error added by the mesh, as estimated by the pilot run.
    pub mesh_error: Option<f64>,
    /// Figures of the pilot run.
    pub pilot: Option<PilotFigures>,
    /// The paths that are followed: with a target.
    pub paths: Option<ChosenPaths>,
    /// Surfaces planned at first.
    pub realisations: u64,
    /// Rays of each surface.
    pub rays_per_surface: u64,
    /// Samples of a surface along x and y.
    pub size: Option<[usize; 2]>,
    /// Length units per sample along x and y.
    pub spacing: Option<[f64; 2]>,
    /// Times that surfaces (or rays) were added.
    pub rounds: u32,
    /// Cause of the end.
    pub stopped_by: StoppedBy,
    /// Warnings for the reader.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

impl Stopping {
    /// Returns `true` if the run was ended before all that was planned.
    #[must_use]
    pub const fn is_cut_short(&self) -> bool {
        matches!(
            self.stopped_by,
            StoppedBy::Time | StoppedBy::Interrupt | StoppedBy::Shards
        )
    }

    /// With the sentence that says what ended the run, where a reader should not miss that.
    pub(crate) fn with_warning(mut self) -> Self {
        self.warnings.extend(match self.stopped_by {
            StoppedBy::Time => Some(
                "the time limit ended the run: these results depend on the speed of the machine"
                    .to_owned(),
            ),
            StoppedBy::Interrupt => {
                Some("interrupted: these are the results so far, so they depend on when the interrupt came".to_owned())
            }
            StoppedBy::Shards => {
                Some("shards of the run are missing: these are the results of the others".to_owned())
            }
            StoppedBy::Plan => match (self.error, self.target_error) {
                (Some(error), Some(target)) if error > target => Some(format!(
                    "the error is {}, above the target {}",
                    error_in_short(error),
                    error_in_short(target)
                )),
                _ => None,
            },
            StoppedBy::Mesh => Some(
                "the target is reached except for the mesh error, which is too large at every spacing that was tried"
                    .to_owned(),
            ),
            StoppedBy::Target | StoppedBy::Bound => None,
        });
        self
    }

    /// Mesh error by the pilot run in words, if it is known, of these cells.
    pub(crate) fn mesh_by_pilot_run(&self, cells: Cells) -> Option<String> {
        let (of, error) = (self.of?, error_in_short(self.mesh_error?));
        let order = match cells {
            Cells::Smooth => " and fourth order",
            Cells::Flat => "",
        };
        Some(format!(
            "up to {error} of {of}, by the difference between two spacings in the pilot run{order}; --refine traces a finer mesh for each flux"
        ))
    }

    /// One line of what was chosen and what was got, with lengths in `unit`; nothing without a target.
    #[must_use]
    pub fn line(&self, unit: LengthUnit) -> Option<String> {
        let (of, target) = (self.of?, self.target_error?);
        let error = self
            .error
            .map_or_else(|| "unknown".to_owned(), error_in_short);
        let got = format!("error of {of} {error}, target {}", error_in_short(target));
        if self.stopped_by == StoppedBy::Bound {
            return Some(format!(
                "{got}; nothing was traced, since shadow, masking and multiple scattering cannot change more"
            ));
        }
        let spacing = self.spacing.map_or_else(String::new, |[dx, dy]| {
            let [x, y] = [dx, dy].map(short);
            let unit = unit.suffix();
            if x == y {
                format!(", spacing {x}{unit}")
            } else {
                format!(", spacing {x}, {y}{unit}")
            }
        });
        let rounds = match self.rounds {
            0 => String::new(),
            1 => "; more were added once".to_owned(),
            n => format!("; more were added {n} times"),
        };
        let mesh = self.mesh_error.map_or_else(String::new, |e| {
            format!("; the mesh adds up to {}", error_in_short(e))
        });
        let paths = self.paths.as_ref();
        let paths = paths.map_or_else(String::new, |paths| format!("; {paths}"));
        Some(format!(
            "{got}; planned {} x {} rays{spacing}{rounds}{mesh}{paths}",
            self.realisations, self.rays_per_surface
        ))
    }
}
