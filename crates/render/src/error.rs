//! Error: the reasons for which a picture cannot be made.

use asperity_simulate::SimulateError;
use asperity_tracer::{BuildError, MAX_TILES, TracedLayerError};

use crate::lights::LightsError;
use crate::settings::MAX_PIXELS;
use crate::view::ViewError;

/// Error of a picture that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The surface is too large.
    #[error(transparent)]
    Run(#[from] SimulateError),
    /// No accelerator for the surface.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The layer does not fit below the surface.
    #[error(transparent)]
    Layer(#[from] TracedLayerError),
    /// The camera is in an invalid place.
    #[error(transparent)]
    View(#[from] ViewError),
    /// A light is out of range.
    #[error(transparent)]
    Lights(#[from] LightsError),
    /// Rays so grazing that they would cross too many tiles.
    #[error(
        "{what} at theta {theta_deg} deg is too flat: straight lines cross up to {tiles:.0} tiles between the highest and the lowest point, {} is the most; take a larger tile or a smaller angle",
        MAX_TILES
    )]
    TooGrazing {
        /// Camera or sun.
        what: &'static str,
        /// Polar angle, degrees.
        theta_deg: f64,
        /// Tiles crossed.
        tiles: f64,
    },
    /// There is no picture yet.
    #[error("stopped before the first pass was finished")]
    Interrupted,
    /// No pixels, or too many.
    #[error("the picture has {0} x {1} pixels; 1 to {MAX_PIXELS} per side are allowed")]
    BadSize(usize, usize),
}
