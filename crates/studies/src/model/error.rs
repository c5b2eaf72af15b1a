//! Reasons for which a model is not evaluated.

use asperity_analysis::{FlatLayer, FlatLayerError, MODEL_NAMES, ModelError, SlopeError};

use super::slopes_of::SlopeFileError;
use crate::config::error::ConfigError;

impl EvaluationError {
    /// Returns `true` if other settings would help, rather than another file.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        !matches!(self, Self::SlopeFile(_))
    }
}

/// Reasons for which a model is not evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationError {
    /// There is no name.
    #[error("model needs NAME, or --list")]
    NoName,
    /// There is no model of that name.
    #[error("unknown model `{name}`; the models are {}", [MODEL_NAMES, &FlatLayer::NAMES].concat().join(", "))]
    Unknown {
        /// The name.
        name: String,
    },
    /// A medium below a model of rough surfaces.
    #[error(
        "the model {name} describes a surface without a medium below it; a medium is for {}",
        FlatLayer::NAMES.join(" and ")
    )]
    SurfaceAlone {
        /// Name of the model.
        name: String,
    },
    /// A model of rough surfaces without roughness.
    #[error("the model {name} needs a rough surface: give --smoothness, or --slopes-of")]
    NoSmoothness {
        /// Name of the model.
        name: String,
    },
    /// An azimuth without a second smoothness.
    #[error("--azimuth is that of the first principal axis: give --smoothness-y too")]
    NoSecondSmoothness,
    /// Rays or a seed for a model that follows none.
    #[error("the model {name} has a closed form and follows no rays; leave out --rays and --seed")]
    NoRays {
        /// Name of the model.
        name: String,
    },
    /// Single directions of a histogram of slopes.
    #[error(
        "the model {name} of a file is a histogram of slopes, which means something over bins alone; take --bins in place of --step and --sphere"
    )]
    Histogram {
        /// Name of the model.
        name: String,
    },
    /// Single directions of a model that follows rays.
    #[error(
        "the model {name} follows rays and has no value at a single direction; take --bins in place of --step and --sphere"
    )]
    NoDensity {
        /// Name of the model.
        name: String,
    },
    /// Too many directions.
    #[error("--step {step} makes {rows:.0} rows; take a larger step, {most:.0} rows is the most")]
    TooManyRows {
        /// The step, degrees.
        step: f64,
        /// Rows of the table.
        rows: f64,
        /// Most rows of a table.
        most: f64,
    },
    /// A flag that means nothing for a model of flat layers.
    #[error(
        "the model {name} is of flat faces, follows no rays and scatters once at most; leave out --{flag}"
    )]
    FlatFaces {
        /// Name of the model.
        name: String,
        /// The flag.
        flag: &'static str,
    },
    /// A model of a layer without a medium.
    #[error(
        "the model {name} needs a medium: give --mean-free-path and --albedo, or --absorption and --scattering"
    )]
    NoMedium {
        /// Name of the model.
        name: String,
    },
    /// A model of a layer below another material than a dielectric.
    #[error("the model {name} is of a dielectric")]
    NoDielectric {
        /// Name of the model.
        name: String,
    },
    /// A value is out of range, or two contradict each other.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// A file has no slopes.
    #[error(transparent)]
    SlopeFile(#[from] SlopeFileError),
    /// The roughness is out of range.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// The model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model of a layer cannot be made.
    #[error(transparent)]
    Layer(#[from] FlatLayerError),
}
