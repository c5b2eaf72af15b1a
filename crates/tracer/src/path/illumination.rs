//! Illumination: the light, and the start points of its paths.

use asperity_optics::{Incidence, Spread};
use serde::{Deserialize, Serialize};

use crate::sampling::Sampling;
use crate::settings::Polarisation;

/// Start points of the paths of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Starts {
    /// Rays come from above, evenly spread over the mean plane, and carry a flux of one.
    #[default]
    FromAbove,
    /// Points of the surface, evenly spread over the mean plane, that turn out to be lit; each carries
    /// what falls on its facet, `max(0, wi . m) / (cos theta_m cos theta_i)`.
    OnSurface,
}

/// Light that falls on a surface, and how its rays are chosen.
#[derive(Clone, Copy, Debug)]
pub struct Illumination {
    /// Direction of incidence.
    pub incidence: Incidence,
    /// Directions around that of incidence, in place of it alone. Only rays [from above](Starts::FromAbove) have them.
    pub spread: Option<Spread>,
    /// `true` if each ray comes from an azimuth of its own, uniformly drawn. Light that leaves is turned back, so that
    /// its azimuths are as if the light had come from that of `incidence`. All azimuths of vertical light are one: none
    /// is drawn, and light that leaves is spread evenly over azimuth ([`asperity_tally::Azimuth::Free`]).
    pub any_azimuth: bool,
    /// Distribution of the rays over the mean plane and, where it is free, over azimuth.
    pub sampling: Sampling,
    /// Start points of the paths.
    pub starts: Starts,
    /// Q, U and V over I of the light, in the axes of its ray; zeros for unpolarised light. Paths that average ignore it, and a
    /// Mueller matrix holds for any.
    pub stokes: [f64; 3],
    /// The part of the mean plane that it falls on. Fluxes are fractions of what falls there.
    pub window: Window,
}

impl Illumination {
    /// Rays from above, one in each stratum.
    #[must_use]
    pub const fn new(incidence: Incidence, any_azimuth: bool) -> Self {
        Self {
            incidence,
            spread: None,
            any_azimuth,
            sampling: Sampling::Stratified,
            starts: Starts::FromAbove,
            stokes: [0.0; 3],
            window: Window::WHOLE,
        }
    }

    /// Returns `true` if each ray has an azimuth of its own. Vertical light has none to draw, except for the axes to
    /// which its polarisation or a Mueller matrix refers.
    #[must_use]
    pub fn turns(&self, polarisation: Polarisation) -> bool {
        let has_axes = polarisation == Polarisation::Mueller || self.stokes != [0.0; 3];
        self.any_azimuth && (has_axes || !self.incidence.is_vertical())
    }
}

/// A rectangle of the period of a surface, in fractions of the period along x and y, each from 0 to 1.
///
/// A mirrored tile and its images make a period of two tiles along each axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// The corner with the lower coordinates.
    pub from: [f64; 2],
    /// The corner with the higher coordinates.
    pub to: [f64; 2],
}

impl Window {
    /// The whole period.
    pub const WHOLE: Self = Self {
        from: [0.0; 2],
        to: [1.0; 2],
    };
}
