//! When a run ends: at an error, at the end of its time, or by an interrupt.

use std::fmt;
use std::str::FromStr;

use asperity_optics::{Layer, Material};
use asperity_tally::{BatchStatistics, Layout, OrderClass, Share, Side};
use serde::{Deserialize, Serialize};

use crate::config::ConfigError;
use crate::tables::error_in_short;

/// The quantity whose error is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aim {
    /// All that is reflected; its error is the standard error of that flux fraction.
    Reflected,
    /// All that is transmitted, likewise.
    Transmitted,
    /// All that is absorbed, likewise.
    Absorbed,
    /// The bins of the hemispheres that are asked for. The error of several fluxes `q` with standard
    /// errors `se` is relative, `sqrt(sum se^2) / sqrt(sum q^2)`.
    #[default]
    Bins,
    /// The rings of equal polar angle, likewise.
    Rings,
    /// The bins about the plane of incidence, likewise.
    InPlane,
}

impl Aim {
    const ALL: [(Self, &'static str); 6] = [
        (Self::Reflected, "reflected"),
        (Self::Transmitted, "transmitted"),
        (Self::Absorbed, "absorbed"),
        (Self::Bins, "bins"),
        (Self::Rings, "rings"),
        (Self::InPlane, "in-plane"),
    ];

    /// Where in a record the fluxes stand.
    pub(crate) fn entries(self, layout: &Layout) -> Vec<usize> {
        let all = OrderClass::All;
        match self {
            Self::Reflected => vec![Layout::REFLECTED],
            Self::Transmitted => vec![Layout::TRANSMITTED],
            Self::Absorbed => vec![Layout::ABSORBED],
            Self::Bins => {
                let bins = layout.bins(Share::Total);
                layout.asked_bins().map(|i| bins.start + i).collect()
            }
            Self::Rings => layout.sides().flat_map(|s| layout.rings(s, all)).collect(),
            Self::InPlane => layout
                .sides()
                .flat_map(|s| layout.in_plane(s, all))
                .collect(),
        }
    }

    const fn is_total(self) -> bool {
        matches!(self, Self::Reflected | Self::Transmitted | Self::Absorbed)
    }

    /// What errors are divided by, given the sum of squares of the fluxes.
    pub(crate) fn norm(self, square: f64) -> f64 {
        if self.is_total() { 1.0 } else { square.sqrt() }
    }

    /// The error that `statistics` have; `None` where they have none.
    pub(crate) fn error(self, layout: &Layout, statistics: &BatchStatistics) -> Option<f64> {
        let [mut squares, mut errors] = [0.0; 2];
        for i in self.entries(layout) {
            let estimate = statistics.estimate(i);
            squares += estimate.mean.powi(2);
            errors += estimate.se?.powi(2);
        }
        Some(ratio(errors.sqrt(), self.norm(squares)))
    }

    /// The error of fluxes which together differ from the true ones by the flux `bound` at most.
    pub(crate) fn error_within(self, layout: &Layout, fluxes: &[f64], bound: f64) -> f64 {
        if self.is_total() {
            return bound;
        }
        let squares = self.entries(layout).into_iter().map(|i| fluxes[i].powi(2));
        // What is lost here is gained there.
        ratio(std::f64::consts::SQRT_2 * bound, self.norm(squares.sum()))
    }

    /// Refuses what a material has not, or nobody asks for.
    fn check(
        self,
        layout: &Layout,
        material: Material,
        layer: Option<&Layer>,
    ) -> Result<(), ConfigError> {
        let refuse = |text: &str| Err(ConfigError::Contradiction(text.to_owned()));
        match (self, material) {
            (Self::Transmitted, _) if material.transmitting_index().is_none() => refuse(
                "nothing is transmitted by a conductor or a mirror, so no error of transmitted can be asked for",
            ),
            (Self::Transmitted, _) if layer.is_some_and(|layer| !layer.transmits()) => refuse(
                "nothing leaves below this medium, so no error of transmitted can be asked for",
            ),
            (Self::Absorbed, Material::Dielectric { .. } | Material::Mirror) if layer.is_none() => {
                refuse(
                    "nothing is absorbed by a dielectric or a mirror, so no error of absorbed can be asked for",
                )
            }
            (Self::Reflected, _) if !layout.asks(Side::Reflected) => {
                refuse("the side reflected is not recorded, so no error of it can be asked for")
            }
            (Self::Transmitted, _) if !layout.asks(Side::Transmitted) => {
                refuse("the side transmitted is not recorded, so no error of it can be asked for")
            }
            _ => Ok(()),
        }
    }
}

/// `error / norm`; nothing has no error.
pub(crate) fn ratio(error: f64, norm: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / norm }
}

impl fmt::Display for Aim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Self::ALL.iter().find(|(aim, _)| aim == self);
        f.write_str(name.map_or("", |(_, name)| name))
    }
}

impl FromStr for Aim {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(_, name)| *name == text);
        found.map(|(aim, _)| *aim).ok_or_else(|| {
            format!(
                "unknown quantity `{text}`; allowed are reflected, transmitted, absorbed, bins, rings and in-plane"
            )
        })
    }
}

/// An error to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    error: f64,
    of: Aim,
}

impl Target {
    /// The error `error` of `of`; `None` if neither is given.
    ///
    /// # Errors
    /// [`ConfigError::Contradiction`] unless the error is positive and finite, and if a quantity is named
    /// without an error.
    pub fn new(error: Option<f64>, of: Option<Aim>) -> Result<Option<Self>, ConfigError> {
        match (error, of) {
            (None, None) => Ok(None),
            (None, Some(of)) => Err(ConfigError::Contradiction(format!(
                "of = {of} says whose error is to reach a target, but no target error is given"
            ))),
            (Some(error), _) if !(error > 0.0 && error.is_finite()) => {
                Err(ConfigError::Contradiction(format!(
                    "the target error is {error}; it must be above 0"
                )))
            }
            (Some(error), of) => Ok(Some(Self {
                error,
                of: of.unwrap_or_default(),
            })),
        }
    }

    /// The error.
    #[must_use]
    pub const fn error(&self) -> f64 {
        self.error
    }

    /// Whose error it is.
    #[must_use]
    pub const fn of(&self) -> Aim {
        self.of
    }

    /// Refuses a target that no result of `material` over `layer`, recorded by `layout`, has.
    ///
    /// # Errors
    /// [`ConfigError::Contradiction`].
    pub fn check(
        &self,
        layout: &Layout,
        material: Material,
        layer: Option<&Layer>,
    ) -> Result<(), ConfigError> {
        self.of.check(layout, material, layer)
    }
}

/// What ended a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StoppedBy {
    /// The error asked for was reached.
    Target,
    /// Surfaces and rays are as many as the error asked for takes, but the mesh adds too much to it.
    Mesh,
    /// All that was planned is done.
    Plan,
    /// Its time was over.
    Time,
    /// An interrupt.
    Interrupt,
    /// A bound on all that tracing could find lies below the target: nothing was traced.
    Bound,
}

/// What a pilot run found, for the quantity asked for; variances and differences are divided by the
/// norm of the fluxes, as the error is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
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
    /// How much the quantity changes at twice the spacing, with twice what noise leaves open; `None` if
    /// it could not be found out.
    pub mesh_difference: Option<f64>,
}

/// How a run came to its end, and what had been planned.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stopping {
    /// The error asked for.
    pub target_error: Option<f64>,
    /// Whose error it is.
    pub of: Option<Aim>,
    /// The error reached: with a target, or `None` where there is none.
    pub error: Option<f64>,
    /// What the mesh adds to it, as far as the pilot run could tell.
    pub mesh_error: Option<f64>,
    /// What the pilot run found.
    pub pilot: Option<PilotFigures>,
    /// Surfaces planned at first.
    pub realisations: u64,
    /// Rays of each surface.
    pub rays_per_surface: u64,
    /// Samples of a surface along x and y.
    pub size: Option<[usize; 2]>,
    /// Length units a sample along x and y.
    pub spacing: Option<[f64; 2]>,
    /// Times that surfaces (or rays) were added.
    pub rounds: u32,
    /// What ended the run.
    pub stopped_by: StoppedBy,
    /// What a reader should not miss.
    #[serde(skip)]
    pub warnings: Vec<String>,
}

impl Stopping {
    /// With the sentence that says what ended the run, where a reader should not miss that.
    pub(crate) fn with_warning(mut self) -> Self {
        self.warnings.extend(match self.stopped_by {
            StoppedBy::Time => Some(
                "the time was over before all was done: these results depend on the speed of the machine"
                    .to_owned(),
            ),
            StoppedBy::Interrupt => {
                Some("interrupted: these are the results so far, and depend on when that was".to_owned())
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
                "the target is reached but for the mesh, which no finer spacing tried makes good enough"
                    .to_owned(),
            ),
            StoppedBy::Target | StoppedBy::Bound => None,
        });
        self
    }

    /// One line of what was chosen and what was got; nothing without a target.
    #[must_use]
    pub fn line(&self) -> Option<String> {
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
            if dx == dy {
                format!(", spacing {dx}")
            } else {
                format!(", spacing {dx}, {dy}")
            }
        });
        let rounds = match self.rounds {
            0 => String::new(),
            1 => "; more were added once".to_owned(),
            n => format!("; more were added {n} times"),
        };
        let mesh = self.mesh_error.map_or_else(String::new, |e| {
            format!("; the mesh adds {}", error_in_short(e))
        });
        Some(format!(
            "{got}; planned {} x {} rays{spacing}{rounds}{mesh}",
            self.realisations, self.rays_per_surface
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_bins_are_relative_and_those_of_totals_absolute() {
        let layout = Layout::new("2x1".parse().unwrap(), 0.1).unwrap();
        let record = |x: f64| {
            let mut record = vec![0.0; layout.len()];
            record[Layout::REFLECTED] = x;
            record[layout.bins(Share::Total).start] = x;
            record
        };
        let mut statistics = BatchStatistics::new(layout.len());
        statistics.push(&record(0.1));
        assert_eq!(Aim::Bins.error(&layout, &statistics), None);
        statistics.push(&record(0.3));
        // Mean 0.2, standard error 0.1.
        let error = |aim: Aim| aim.error(&layout, &statistics).unwrap();
        assert!((error(Aim::Reflected) - 0.1).abs() < 1e-12);
        assert!((error(Aim::Bins) - 0.5).abs() < 1e-12);
        assert_eq!(error(Aim::Rings), 0.0);
    }

    #[test]
    fn names_are_read_as_they_are_written() {
        for (aim, name) in Aim::ALL {
            assert_eq!(name.parse(), Ok(aim));
            assert_eq!(aim.to_string(), name);
            assert_eq!(serde_json::to_value(aim).unwrap(), name);
        }
        assert!("ring".parse::<Aim>().unwrap_err().contains("in-plane"));
    }
}
