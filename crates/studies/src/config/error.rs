//! Errors of configurations.

use asperity_analysis::{FlatLayer, FlatLayerError, ModelError};
use asperity_optics::{
    IncidenceError, LayerError, Material, MaterialError, ParticipatingMediumError,
    PhaseFunctionError,
};
use asperity_simulate::{TargetError, short};
use asperity_tally::SpecError;
use asperity_tracer::{HorizonError, PathSettingsError, Polarisation};

use super::surface_error::SurfaceError;
use crate::settings::SettingError;
use crate::settings::number::MOST_COUNT;

/// Refusal of a configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConfigError {
    /// A value is unknown, invalid or excluded by another.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A list is empty.
    #[error("`{0}` is an empty list; give one value or several")]
    EmptyList(&'static str),
    /// A list where one value is needed.
    #[error("{name} has {count} values where one is needed")]
    SeveralValues {
        /// The setting.
        name: &'static str,
        /// Values of the list.
        count: usize,
    },
    /// A list holds a value twice.
    #[error("{list}: {value} is given twice")]
    GivenTwice {
        /// The setting.
        list: &'static str,
        /// The value.
        value: String,
    },
    /// The Stokes vector of the light is invalid.
    #[error("stokes {}: {error}", .given.iter().map(f64::to_string).collect::<Vec<_>>().join(","))]
    Stokes {
        /// The Stokes vector.
        given: Vec<f64>,
        /// The reason.
        error: StokesError,
    },
    /// Models of light from one azimuth, for light from random azimuths.
    #[error(
        "models: they are made for light from one azimuth; leave out azimuth random, or the models"
    )]
    ModelsOfOneAzimuth,
    /// Models of unpolarised light, for polarised light.
    #[error("models: they are made for unpolarised light; leave out stokes, or the models")]
    ModelsOfUnpolarisedLight,
    /// A given surface where random ones are needed.
    #[error("a verification is of random surfaces, not of a given one")]
    GivenSurface,
    /// The given surface has not been read, which is an error of the caller.
    #[error("the measured surface was not read")]
    UnreadSurface,
    /// Polarisation states of light of many directions.
    #[error(
        "--polarisation {0}: gonio keeps fluxes alone; take tracked or averaged, or trace or verify for one direction"
    )]
    GonioOfStates(Polarisation),
    /// The material is invalid.
    #[error(transparent)]
    Material(#[from] MaterialError),
    /// The direction of the light is invalid.
    #[error(transparent)]
    Incidence(#[from] IncidenceError),
    /// No surfaces can be drawn from `[surface]`.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// Matrices in a map.
    #[error(
        "--polarisation mueller: a map compares fluxes alone; take tracked, averaged or both, or verify for the matrices"
    )]
    MapOfMatrices,
    /// A map without models.
    #[error("a map needs models to compare with; name one or several")]
    MapWithoutModels,
    /// A map of surfaces that no model describes.
    #[error(
        "no model describes anisotropic Lambertian facets, and a map needs one; verify and gonio do not"
    )]
    NoModelToMap,
    /// Too many combinations of the values of lists.
    #[error("the lists make {count:.0e} cases; at most {most:.0e} are possible")]
    TooManyCases {
        /// Combinations.
        count: f64,
        /// Most that are possible.
        most: f64,
    },
    /// Two cases with one name.
    #[error(
        "two cases would share the same folder {folder}; give each value once, and values that differ in six digits"
    )]
    SameFolder {
        /// The name.
        folder: String,
    },
    /// A random azimuth where it matters.
    #[error("on an anisotropic surface the azimuth of the light matters; it cannot be random")]
    RandomAzimuth,
    /// The accelerator of flat surfaces for rough ones.
    #[error("the accelerator flat is for flat surfaces, but those drawn here are rough; take auto")]
    FlatAccelerator,
    /// A model of a layer that cannot be made.
    #[error(transparent)]
    LayerModel(FlatLayerError),
    /// A model of bare surfaces, with a medium below.
    #[error(
        "the model {name} describes a surface without a medium below it; with a medium, take {}",
        FlatLayer::NAMES.join(" or ")
    )]
    ModelOfBareSurface {
        /// Its name.
        name: String,
    },
    /// A model of a layer, without one.
    #[error("the model {name} describes a medium below the surface, but no medium is given")]
    ModelOfLayer {
        /// Its name.
        name: String,
    },
    /// Transmitted light alone, of a layer that transmits none.
    #[error(
        "nothing leaves below a medium without end, or one that ends on an absorbing, mirror or Lambertian bottom; take side reflected or both"
    )]
    NothingBelowLayer,
    /// Transmitted light alone, of a material that transmits none.
    #[error(
        "nothing is transmitted by {}; take side reflected or both",
        opaque(*.material)
    )]
    NothingTransmitted {
        /// The material.
        material: Material,
    },
    /// A medium below a material that transmits no light.
    #[error("no light enters a medium below {}: take a dielectric", opaque(*.material))]
    MediumBelow {
        /// The material.
        material: Material,
    },
    /// A medium below, with light from below.
    #[error("the medium lies below the surface, so the light must come from above")]
    LightInMedium,
    /// A control variate for a surface over a medium.
    #[error(
        "the controlled estimator does not support a medium below the surface; take auto or plain"
    )]
    MediumControl,
    /// A control variate for surfaces whose slopes are not known.
    #[error(
        "the distribution of slopes of structured surfaces is not known, so they have no control variate; give --estimators plain"
    )]
    NoControl,
    /// A control variate for facets that reflect diffusely.
    #[error("Lambertian facets have no control variate; give --estimators plain")]
    DiffuseControl,
    /// A spacing that does not divide the surfaces.
    #[error(
        "spacing {} does not divide the extent {} of the surfaces into whole samples",
        short(*.spacing),
        short(*.extent)
    )]
    PartSamples {
        /// The spacing, length units.
        spacing: f64,
        /// Side of the surfaces, length units.
        extent: f64,
    },
    /// More counts of an attenuation run than are kept.
    #[error(
        "{counts:.1e} counts would be kept, {most:.0e} is the most: take fewer directions or surfaces"
    )]
    TooManyCounts {
        /// Counts of this configuration.
        counts: f64,
        /// Most that are kept.
        most: f64,
    },
    /// An open patch without samples inside.
    #[error(
        "an open patch of {nx} x {ny} samples has none inside, where paper_g2 counts; take 3 or more a side"
    )]
    SmallPatch {
        /// Samples along x.
        nx: usize,
        /// Samples along y.
        ny: usize,
    },
    /// Horizons of smooth cells.
    #[error("--demarcation needs horizons, which are those of flat cells")]
    HorizonsOfSmoothCells,
    /// Horizons that cannot be found.
    #[error(transparent)]
    Horizons(#[from] HorizonError),
    /// The azimuth of a view from straight above.
    #[error(
        "--view-phi: the viewer is straight above, where the azimuth has no meaning; give --view-theta too"
    )]
    ViewAzimuth,
    /// A value of a figure that is not measured.
    #[error("{name}: {} is not among the values that are measured", short(*.value))]
    NotMeasured {
        /// The setting.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// Triangles nearer to smooth cells than their heights are rounded to.
    #[error(
        "--deviation {}{unit}: must be above {least}{unit}, to which heights of this surface are rounded",
        short(*.deviation)
    )]
    Deviation {
        /// The distance.
        deviation: f64,
        /// Rounding of the heights, in words.
        least: String,
        /// Suffix of the unit.
        unit: &'static str,
    },
    /// A rate of a peer, and no method that has its errors.
    #[error(
        "peer_rate takes errors of plain random rays that pick a branch: add plain to estimators, random to samplings and pick to branchings"
    )]
    NoMethodOfPeer,
    /// Lists of rays and surfaces of different lengths.
    #[error(
        "rays has {rays} values and surfaces {surfaces}; they go together value by value, so give as many of both, or one of either"
    )]
    UnequalLists {
        /// Numbers of rays.
        rays: usize,
        /// Numbers of surfaces.
        surfaces: usize,
    },
    /// More rays than can be counted.
    #[error("{rays} rays on each of {surfaces} surfaces are more than {MOST_COUNT:e} in all")]
    TooManyRays {
        /// Rays of each surface.
        rays: u64,
        /// Surfaces.
        surfaces: u64,
    },
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

/// Refusal of a Stokes vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum StokesError {
    /// More or fewer numbers than four.
    #[error("takes four numbers, I,Q,U,V")]
    NotFour,
    /// An intensity of zero or less.
    #[error("the intensity I must exceed 0")]
    NoIntensity,
    /// A degree of polarisation above one.
    #[error("more light is polarised than there is: Q^2 + U^2 + V^2 exceeds I^2")]
    AboveIntensity,
    /// Paths do not carry the polarisation of the incident light.
    #[error(
        "paths carry the polarisation of the incident light with --polarisation tracked or both"
    )]
    NotTracked,
}

/// A material that transmits no light, as messages call it.
const fn opaque(material: Material) -> &'static str {
    match material {
        Material::Conductor { .. } => "a conductor",
        Material::Lambertian { .. } => "Lambertian facets",
        _ => "a mirror",
    }
}
