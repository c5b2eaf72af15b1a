//! Errors of a simulation.

use asperity_analysis::{ModelError, SlopeError};
use asperity_surface::{CoarseningError, RefinementError};
use asperity_synthesis::SynthesisError;
use asperity_tracer::{BuildError, MAX_TILES, MAX_TILES_AT_45_DEGREES, TracedLayerError};

/// Error of a simulation.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The surfaces cannot be drawn.
    #[error(transparent)]
    Synthesis(SynthesisError),
    /// The slopes of the surfaces have no density.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// The mean of a control variate cannot be computed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// No accelerator for the surface.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// No finer mesh of the surface.
    #[error(transparent)]
    Refinement(#[from] RefinementError),
    /// No coarser mesh of the surface.
    #[error(transparent)]
    Coarsening(#[from] CoarseningError),
    /// The layers do not fit below the surface.
    #[error(transparent)]
    Layer(#[from] TracedLayerError),
    /// Results too large for memory.
    #[error(
        "{bins} bins, {realisations} surfaces and {cases} cases take {gib:.1} GiB of results, more than 4 GiB: reduce one of them"
    )]
    TooManyResults {
        /// Bins of both hemispheres.
        bins: usize,
        /// Surfaces.
        realisations: u64,
        /// Cases.
        cases: usize,
        /// Memory that they would take.
        gib: f64,
    },
    /// The surface does not fit into memory.
    #[error("{what} needs {needed:.1} GiB of memory; {available:.1} GiB are available")]
    NotEnoughMemory {
        /// Part that needs it.
        what: &'static str,
        /// GiB needed.
        needed: f64,
        /// GiB available.
        available: f64,
    },
    /// A control variate that is insisted on where there is none.
    #[error("the controlled estimator {needs}")]
    NoControlVariate {
        /// The condition that is not met, and what to take instead.
        needs: &'static str,
    },
    /// A given surface of smooth cells that is to be refined.
    #[error(
        "a spline through given heights is the surface itself, which no finer mesh changes; refine flat cells"
    )]
    SmoothRefinement,
    /// No given surface at all.
    #[error("there is no given surface")]
    NoSurface,
    /// Given surfaces of different cells.
    #[error("given surfaces must all be flat cells, all smooth cells or all triangle meshes")]
    MixedCells,
    /// A setting for one given surface, where there are several.
    #[error(
        "{what} is for one given surface; several take the plain estimator and a number of rays"
    )]
    OnlyOfOne {
        /// Setting that was requested.
        what: &'static str,
    },
    /// A surface of which a result file has kept no points.
    #[error(
        "a result file describes this surface, but does not hold its points; read the surface itself to trace it"
    )]
    DescribedSurface,
    /// A layer whose bottom would have to be drawn, below a surface that is not.
    #[error(
        "an independent bottom is drawn like a random surface, but this surface is given; take a flat bottom, the same, or one from a file"
    )]
    IndependentBottom,
    /// Layers that are lit from below through what lets no light in.
    #[error("light from below needs layers that end on an interface, through which it comes in")]
    DarkBottom,
    /// Light so flat that it would cross too many tiles.
    #[error(
        "light from theta {theta_deg} deg crosses up to {tiles:.0} tiles between the highest and the lowest point, {} is the most: take a larger tile or a smaller angle",
        MAX_TILES
    )]
    TooGrazing {
        /// Polar angle, degrees.
        theta_deg: f64,
        /// Tiles crossed.
        tiles: f64,
    },
    /// A surface so much higher than its tile is long that rays would cross too many tiles.
    #[error(
        "the surface is {tiles:.0} times higher than its tile is long, {} is the most: give heights and spacing in one unit, or take a larger tile",
        MAX_TILES_AT_45_DEGREES
    )]
    TooHigh {
        /// Tiles that a ray at 45 degrees crosses between the highest and the lowest point.
        tiles: f64,
    },
    /// The run was stopped before there was any result.
    #[error("stopped before the first surface was finished")]
    Interrupted,
}

impl From<SynthesisError> for SimulateError {
    fn from(error: SynthesisError) -> Self {
        match error {
            SynthesisError::GivenUp => Self::Interrupted,
            error => Self::Synthesis(error),
        }
    }
}

impl SimulateError {
    /// Returns `true` if other input would help: a value is out of range, or two exclude each other. Otherwise this
    /// machine or this moment is at fault.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Synthesis(error) => error.is_usage(),
            Self::Build(error) => matches!(
                error,
                BuildError::NeedsHeightField { .. } | BuildError::NotFlat
            ),
            Self::Refinement(error) => {
                matches!(error, RefinementError::Open | RefinementError::Edges)
            }
            Self::Model(_)
            | Self::Layer(_)
            | Self::NoControlVariate { .. }
            | Self::SmoothRefinement
            | Self::NoSurface
            | Self::MixedCells
            | Self::OnlyOfOne { .. }
            | Self::DescribedSurface
            | Self::IndependentBottom
            | Self::DarkBottom => true,
            Self::Slopes(_)
            | Self::Coarsening(_)
            | Self::TooManyResults { .. }
            | Self::NotEnoughMemory { .. }
            | Self::TooGrazing { .. }
            | Self::TooHigh { .. }
            | Self::Interrupted => false,
        }
    }
}
