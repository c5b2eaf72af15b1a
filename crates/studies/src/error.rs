//! Reasons for which a study is refused or fails.

use asperity_analysis::{ComparisonError, ModelError, SlopeError, SlopeTableError};
use asperity_render::{LightsError, RenderError, ViewError};
use asperity_results::ResultsError;
use asperity_simulate::SimulateError;
use asperity_surface::{HeightFieldError, LengthUnit};
use asperity_synthesis::ErosionError;
use asperity_tracer::MeshError;

use crate::config::SurfaceFileError;
use crate::config::error::ConfigError;
use crate::given::GivenError;
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
    /// The surfaces cannot be simulated.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// A model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Results cannot be kept.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// Results and model do not fit each other.
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
    /// A process of erosion cannot be applied.
    #[error(transparent)]
    Erosion(#[from] ErosionError),
    /// A height map has too many samples or extreme heights for a finer grid.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
    /// A mesh has too many triangles.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// The camera is in an invalid place.
    #[error("{}", error.in_unit(unit.suffix()))]
    View {
        /// The reason.
        error: ViewError,
        /// Unit of the lengths.
        unit: LengthUnit,
    },
    /// A light is out of range.
    #[error(transparent)]
    Lights(#[from] LightsError),
    /// A picture cannot be rendered.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// No light at all in the bins over which errors are taken.
    #[error(
        "no light reaches the bins of the side requested; without any, no error can be a fraction of it"
    )]
    NoLight,
}

impl From<SlopeTableError> for StudyError {
    fn from(error: SlopeTableError) -> Self {
        Self::Model(error.into())
    }
}

impl From<SlopeError> for StudyError {
    fn from(error: SlopeError) -> Self {
        Self::Model(error.into())
    }
}

impl StudyError {
    /// `true` if other input would help: a value is out of range, or two exclude each other.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Setting(_)
            | Self::Config(_)
            | Self::Model(_)
            | Self::Erosion(_)
            | Self::View { .. }
            | Self::Lights(_) => true,
            Self::Render(error) => matches!(
                error,
                RenderError::Layer(_) | RenderError::TooGrazing { .. } | RenderError::BadSize(..)
            ),
            Self::SurfaceFile(error) => matches!(error, SurfaceFileError::Unknown { .. }),
            Self::Given(error) => error.is_usage(),
            Self::Simulate(error) => error.is_usage(),
            Self::Results(_)
            | Self::Comparison(_)
            | Self::HeightField(_)
            | Self::Mesh(_)
            | Self::NoLight => false,
        }
    }
}
