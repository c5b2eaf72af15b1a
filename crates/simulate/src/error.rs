//! Why a run fails.

use asperity_analysis::{ModelError, SlopeError};
use asperity_surface::{CoarseningError, SynthesisError};

use crate::input::limits::RunError;

/// Why a run on random surfaces fails.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// The surfaces cannot be drawn.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// The rays cannot be traced.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The slopes of the surfaces have no density.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// The mean of a control cannot be computed.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Every second sample makes no surface.
    #[error(transparent)]
    Coarsening(#[from] CoarseningError),
}
