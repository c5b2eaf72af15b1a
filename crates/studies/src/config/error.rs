//! Errors of configurations.

use asperity_analysis::{FlatLayers, FlatLayersError, ModelError};
use asperity_optics::{
    IncidenceError, LayerError, Material, MaterialError, ParticipatingMediumError,
    PhaseFunctionError,
};
use asperity_simulate::{SimulateError, TargetError, short};
use asperity_surface::LengthUnit;
use asperity_synthesis::{JohnsonError, PsdError, SynthesisError};
use asperity_tally::SpecError;
use asperity_tracer::{HorizonError, PathSettingsError};

use crate::settings::SettingError;

/// Refusal of a configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// A value is unknown, invalid, missing or excluded by another, by itself or with the surfaces and the light at hand.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// Cases that the format they are measured for cannot hold.
    #[error("{0}")]
    Unfit(String),
    /// A value that does not suit the surfaces, the light or the study.
    #[error("{given}: {reason}")]
    Unsuitable {
        /// The value, with the name of its setting.
        given: String,
        /// The reason, and what to take instead.
        reason: String,
    },
    /// A list holds a value twice.
    #[error("{list}: {value} is given twice")]
    GivenTwice {
        /// The setting.
        list: &'static str,
        /// The value.
        value: String,
    },
    /// Two cases with one name.
    #[error(
        "two cases would share the same folder {folder}; give each value once, and values that differ in six digits"
    )]
    SameFolder {
        /// The name.
        folder: String,
    },
    /// A file of the configuration that was not read, which is an error of the caller.
    #[error("{0} was not read")]
    Unread(&'static str),
    /// A model of bare surfaces with a medium below, or a model of layers without a medium.
    #[error("the model {name} describes a {}", model_and_medium(*has_medium))]
    ModelOfOtherLayers {
        /// Its name.
        name: String,
        /// `true` if there is a medium.
        has_medium: bool,
    },
    /// A model is unknown or cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A model that cannot be made for a surface and its material.
    #[error("{}", refused_model(name, .error))]
    RefusedModel {
        /// Its name.
        name: String,
        /// The reason.
        error: ModelError,
    },
    /// A model of a layer that cannot be made.
    #[error(transparent)]
    LayerModel(#[from] FlatLayersError),
    /// Transmitted light alone, of a material or a layer below it that transmits none.
    #[error("nothing {}; take side reflected or both", not_transmitted(.by.as_deref()))]
    NothingTransmitted {
        /// The material; `None` if it is the layer.
        by: Option<Box<Material>>,
    },
    /// No simulation is possible: no memory, or no control variate.
    #[error(transparent)]
    Simulate(#[from] SimulateError),
    /// The surfaces that are measured cannot be drawn.
    #[error("{}", synthesis_sentence(.error, *.unit))]
    Synthesis {
        /// The reason.
        error: SynthesisError,
        /// The unit of lengths.
        unit: LengthUnit,
    },
    /// The power spectral density is invalid.
    #[error(transparent)]
    Psd(#[from] PsdError),
    /// No distribution of heights has the moments.
    #[error(transparent)]
    Heights(#[from] JohnsonError),
    /// The material is invalid.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// A record of a material that cannot be read.
    #[error("{0}")]
    Record(String),
    /// The phase function of a medium is out of range.
    #[error(transparent)]
    Phase(#[from] PhaseFunctionError),
    /// A medium is out of range.
    #[error(transparent)]
    Medium(#[from] ParticipatingMediumError),
    /// A layer is out of range.
    #[error(transparent)]
    Layer(#[from] LayerError),
    /// The direction of the light is invalid.
    #[error(transparent)]
    Incidence(#[from] IncidenceError),
    /// Horizons that cannot be found.
    #[error(transparent)]
    Horizons(#[from] HorizonError),
    /// The in-plane slice is out of range.
    #[error(transparent)]
    TallySpec(#[from] SpecError),
    /// The path settings are out of range.
    #[error(transparent)]
    Paths(#[from] PathSettingsError),
    /// The target error is out of range, or no result has it.
    #[error(transparent)]
    Target(#[from] TargetError),
}

/// The refusal of a model, which names it.
fn refused_model(name: &str, error: &ModelError) -> String {
    let reason = error.to_string();
    match reason.contains(name) {
        true => reason,
        false => format!("the model {name}: {reason}"),
    }
}

impl ConfigError {
    /// The model that is refused; `None` of other refusals.
    #[must_use]
    pub fn model(&self) -> Option<&str> {
        match self {
            Self::RefusedModel { name, .. } | Self::ModelOfOtherLayers { name, .. } => Some(name),
            _ => None,
        }
    }

    /// A value that does not suit the surfaces, the light or the study.
    pub(crate) fn unsuitable(given: impl Into<String>, reason: impl Into<String>) -> Self {
        let (given, reason) = (given.into(), reason.into());
        Self::Unsuitable { given, reason }
    }

    /// A choice without what it needs.
    pub(crate) fn missing(subject: &str, needed: impl Into<String>) -> Self {
        let (subject, needed) = (subject.to_owned(), needed.into());
        SettingError::Missing { subject, needed }.into()
    }

    /// A spacing that does not divide surfaces of that extent, length units.
    pub(crate) fn part_samples(spacing: f64, extent: f64) -> Self {
        let extent = short(extent);
        let reason = format!("must divide the extent {extent} of the surfaces into whole samples");
        Self::unsuitable(format!("spacing {}", short(spacing)), reason)
    }

    /// A medium below a material that transmits no light.
    pub(crate) fn medium_below(material: Material) -> Self {
        let why = format!("no light enters below {}", opaque(material));
        Self::missing("a medium", format!("a dielectric above it: {why}"))
    }

    /// Estimation with a control variate, of a case that has none; `needs` continues "the controlled estimator".
    pub(crate) const fn no_control_variate(needs: &'static str) -> Self {
        Self::Simulate(SimulateError::NoControlVariate { needs })
    }
}

/// The end of a sentence on a model of bare surfaces with a medium, or of a layer without one.
fn model_and_medium(has_medium: bool) -> String {
    match has_medium {
        true => format!(
            "surface without a medium below it; with a medium, take {}",
            FlatLayers::NAMES.join(" or ")
        ),
        false => "medium below the surface, but no medium is given".to_owned(),
    }
}

/// The end of a sentence on a material or a layer that transmits no light.
fn not_transmitted(by: Option<&Material>) -> String {
    match by {
        Some(material) => format!("is transmitted by {}", opaque(*material)),
        None => "leaves below a medium without end, or one that ends on an absorbing, mirror or Lambertian bottom".to_owned(),
    }
}

/// A material that transmits no light, as messages call it.
const fn opaque(material: Material) -> &'static str {
    match material {
        Material::Conductor { .. } => "a conductor",
        Material::Lambertian { .. } => "Lambertian facets",
        Material::Coated { .. } => "a coated conductor",
        _ => "a mirror",
    }
}

/// Sentence that ends in "or insist", with the flag that insists.
pub(crate) fn with_insistence(sentence: impl std::fmt::Display) -> String {
    format!("{sentence} with --insist")
}

/// Sentence on surfaces that cannot be drawn, with the flag that draws them all the same.
fn synthesis_sentence(error: &SynthesisError, unit: LengthUnit) -> String {
    let sentence = error.clone().with_unit(unit).to_string();
    match error.yields_to_insistence() {
        true => with_insistence(sentence),
        false => sentence,
    }
}
