//! Reasons for which a study is refused or fails.

use asperity_analysis::{ComparisonError, ModelError, SlopeError, SlopeTableError};
use asperity_gpu::DeviceError;
use asperity_plot::PlotError;
use asperity_render::RenderError;
use asperity_results::ResultsError;
use asperity_simulate::SimulateError;
use asperity_surface::{HeightFieldError, LengthUnit};
use asperity_synthesis::SynthesisError;
use asperity_tracer::MeshError;

use crate::config::SurfaceFileError;
use crate::config::error::{ConfigError, with_insistence};
use crate::given::{ComparedSurfaceError, GivenError};
use crate::settings::SettingError;

/// Reasons for which a study is refused or fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A setting is invalid on the surface that was read.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A file that random surfaces are described by cannot be used.
    #[error(transparent)]
    SurfaceFile(#[from] SurfaceFileError),
    /// A given surface cannot be used.
    #[error(transparent)]
    Given(#[from] GivenError),
    /// A given surface cannot be compared with models.
    #[error(transparent)]
    ComparedSurface(#[from] ComparedSurfaceError),
    /// The surfaces cannot be drawn.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// The surfaces cannot be simulated.
    #[error(transparent)]
    Simulate(SimulateError),
    /// A GPU is requested, and none is usable.
    #[error("--engine gpu: {0}; --engine auto uses the CPU instead")]
    NoGpu(DeviceError),
    /// Results cannot be kept.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// Shards that do not make up a run.
    #[error("{0}")]
    Shards(String),
    /// Results and model do not fit each other.
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
    /// A height map has too many samples or extreme heights for a finer grid.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
    /// A mesh has too many triangles.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A picture cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// A stop before all wavelengths of a picture were rendered.
    #[error("stopped before all wavelengths were rendered")]
    ColourInterrupted,
    /// A figure cannot be drawn.
    #[error("a figure could not be drawn: {0}")]
    Plot(#[from] PlotError),
    /// No light at all in the bins over which errors are taken.
    #[error(
        "no light reaches the bins of the side requested; without any, no error can be a fraction of it"
    )]
    NoLight,
}

impl From<SimulateError> for StudyError {
    fn from(error: SimulateError) -> Self {
        match error {
            SimulateError::Synthesis(error) => error.into(),
            error => Self::Simulate(error),
        }
    }
}

impl From<ModelError> for StudyError {
    fn from(error: ModelError) -> Self {
        ConfigError::from(error).into()
    }
}

impl From<SlopeTableError> for StudyError {
    fn from(error: SlopeTableError) -> Self {
        ModelError::from(error).into()
    }
}

impl From<SlopeError> for StudyError {
    fn from(error: SlopeError) -> Self {
        ModelError::from(error).into()
    }
}

impl StudyError {
    /// `true` if a stop came before there was any result.
    #[must_use]
    pub const fn is_stopped(&self) -> bool {
        matches!(
            self,
            Self::Simulate(SimulateError::Interrupted)
                | Self::Render(RenderError::Interrupted)
                | Self::ColourInterrupted
        )
    }

    /// Sentence for a user whose surfaces have lengths in `unit`, with the flag that draws them all the same.
    #[must_use]
    pub fn sentence(self, unit: LengthUnit) -> String {
        match self {
            Self::Synthesis(error) if error.yields_to_insistence() => {
                with_insistence(error.with_unit(unit))
            }
            error => error.to_string(),
        }
    }

    /// `true` if other input would help: a value is out of range, or two exclude each other.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Config(ConfigError::Simulate(error)) | Self::Simulate(error) => error.is_usage(),
            Self::Config(ConfigError::Synthesis { error, .. }) | Self::Synthesis(error) => {
                error.is_usage()
            }
            Self::Config(ConfigError::Record(_)) => false,
            Self::Setting(_) | Self::Config(_) | Self::ComparedSurface(_) => true,
            Self::Render(error) => matches!(
                error,
                RenderError::View(_)
                    | RenderError::Lights(_)
                    | RenderError::Layer(_)
                    | RenderError::TooGrazing { .. }
                    | RenderError::BadSize(..)
            ),
            Self::SurfaceFile(error) => matches!(error, SurfaceFileError::Unknown { .. }),
            Self::Given(error) => error.is_usage(),
            Self::NoGpu(_)
            | Self::Results(_)
            | Self::Shards(_)
            | Self::Comparison(_)
            | Self::HeightField(_)
            | Self::Mesh(_)
            | Self::ColourInterrupted
            | Self::Plot(_)
            | Self::NoLight => false,
        }
    }
}
