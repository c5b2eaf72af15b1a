//! Why a configuration is refused.

use asperity_analysis::ModelError;
use asperity_optics::{
    IncidenceError, LayerError, MaterialError, ParticipatingMediumError, PhaseFunctionError,
};
use asperity_simulate::TargetError;
use asperity_surface::{JohnsonError, LengthUnit, PsdError, StructureError};
use asperity_tally::SpecError;
use asperity_tracer::PathSettingsError;

use crate::settings::SettingError;

/// Why a configuration is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// A value is unknown, invalid or excluded by another.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Two keys that exclude each other, or none of two that are needed.
    #[error("{0}")]
    Contradiction(String),
    /// Facets so level that lobes are narrower than quadrature resolves.
    #[error(
        "smoothness is {0:e}; up to 1e6 is allowed, beyond which lobes are too narrow to be computed: a flat surface (gonio --flat, trace --flat) reflects as well"
    )]
    TooSmooth(f64),
    /// A list is empty.
    #[error("`{0}` is an empty list; give one value or several")]
    EmptyList(&'static str),
    /// The material is invalid.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// The direction of the light is invalid.
    #[error(transparent)]
    Incidence(#[from] IncidenceError),
    /// The power spectral density is invalid.
    #[error(transparent)]
    Psd(#[from] PsdError),
    /// No distribution of heights has the moments.
    #[error(transparent)]
    Heights(#[from] JohnsonError),
    /// The structure cannot be made.
    #[error("{}", structure_sentence(.error, *.unit))]
    Structure {
        /// Why.
        error: StructureError,
        /// The unit of lengths.
        unit: LengthUnit,
    },
    /// A setting of structures, without a structure.
    #[error("{setting} is that of a structure: name one by --structure, or leave it out")]
    NoStructure {
        /// The key.
        setting: &'static str,
    },
    /// A spectrum of roughness on top of a structure, without its height.
    #[error(
        "roughness on top of a structure needs --sigma; without it leave out its spectrum, heights and slopes"
    )]
    NoRoughness,
    /// Roughness on top of a structure that is not Gaussian.
    #[error(
        "roughness on top of a structure is Gaussian; leave out --slopes, --skewness and --kurtosis"
    )]
    OtherRoughness,
    /// A setting that this structure does not have.
    #[error("{structure} have no {setting}; leave it out")]
    UnusedByStructure {
        /// The key.
        setting: &'static str,
        /// The name of the structure.
        structure: &'static str,
    },
    /// A control variate for surfaces whose slopes are not known.
    #[error(
        "the distribution of slopes of structured surfaces is not known, so they have no control variate; give --estimators plain"
    )]
    NoControl,
    /// A control variate for facets that reflect diffusely.
    #[error("Lambertian facets have no control variate; give --estimators plain")]
    DiffuseControl,
    /// The in-plane slice is out of range.
    #[error(transparent)]
    TallySpec(#[from] SpecError),
    /// The path settings are out of range.
    #[error(transparent)]
    Paths(#[from] PathSettingsError),
    /// The target error is out of range, or no result has it.
    #[error(transparent)]
    Target(#[from] TargetError),
    /// A model is unknown or cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The phase function of a medium is out of range.
    #[error(transparent)]
    Phase(#[from] PhaseFunctionError),
    /// A medium is out of range.
    #[error(transparent)]
    Medium(#[from] ParticipatingMediumError),
    /// A layer is out of range.
    #[error(transparent)]
    Layer(#[from] LayerError),
}

/// Why a structure cannot be made, with the flag that draws it all the same.
fn structure_sentence(error: &StructureError, unit: LengthUnit) -> String {
    let sentence = error.in_unit(unit);
    match error {
        StructureError::Unresolved { .. } => format!("{sentence} with --insist"),
        _ => sentence,
    }
}
