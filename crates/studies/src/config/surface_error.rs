//! Surface error: why no surfaces are drawn from a `[surface]` configuration.

use asperity_simulate::{SimulateError, short};
use asperity_surface::LengthUnit;
use asperity_synthesis::{JohnsonError, PsdError, StructureError};

use super::surface_choices::SpectrumName;

/// Why no surfaces are drawn from a configuration.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// A choice without a value that it needs.
    #[error("{choice} needs --{flag}")]
    Needs {
        /// The choice, as a flag.
        choice: &'static str,
        /// The flag of the value.
        flag: &'static str,
    },
    /// A parameter of other spectra.
    #[error("--{flag} is for --psd {}; the spectrum is {spectrum}", names(.spectra))]
    OfOtherSpectra {
        /// Its flag.
        flag: &'static str,
        /// The spectra that have it.
        spectra: &'static [SpectrumName],
        /// The name of the chosen spectrum.
        spectrum: String,
    },
    /// A parameter of GGX slopes, without them.
    #[error("--ggx-alpha and --amplitude-ratio are for --slopes ggx")]
    OfGgxSlopes,
    /// Neither smoothness nor root mean square height, or both.
    #[error("give either smoothness or sigma: smoothness = tau / sigma")]
    NoHeight,
    /// A smoothness out of range.
    #[error("smoothness is {}; tau / sigma must be positive and finite", short(*.0))]
    BadSmoothness(f64),
    /// Facets so level that lobes are narrower than quadrature resolves.
    #[error(
        "smoothness is {}; up to 1e6 is allowed, beyond which lobes are too narrow to be computed: a flat surface (gonio --flat, trace --flat) reflects as well",
        short(*.0)
    )]
    TooSmooth(f64),
    /// No correlation length.
    #[error("tau is missing")]
    NoTau,
    /// A correlation length for a spectrum that has its own.
    #[error(
        "the correlation length of a power law follows from --hurst, --roll-off and --cut-off; leave out tau"
    )]
    TauOfPowerLaw,
    /// A correlation length for a spectrum of a file.
    #[error("the correlation length of a spectrum from a file is its own; leave out tau and tau_y")]
    TauOfFile,
    /// The file of the spectrum has not been read, which is an error of the caller.
    #[error("the file of the spectrum has not been read")]
    UnreadSpectrum,
    /// Half of a second scale.
    #[error("a second scale needs both --second-sigma and --second-tau")]
    HalfASecondScale,
    /// A distribution of heights and its moments.
    #[error("give either heights or skewness and kurtosis")]
    HeightsTwice,
    /// GGX slopes without their roughness.
    #[error("--slopes ggx needs --ggx-alpha, in place of smoothness and sigma")]
    NoAlpha,
    /// GGX slopes with a second scale.
    #[error("--slopes ggx has no second scale; leave out --second-sigma and --second-tau")]
    GgxOfTwoScales,
    /// GGX slopes with a distribution of heights.
    #[error(
        "--slopes ggx decides the heights as well; leave out --heights, --skewness and --kurtosis"
    )]
    GgxHeights,
    /// A direction of surfaces that have none.
    #[error(
        "azimuth is {}, but these surfaces have no direction that it turns: it is for --tau-y, grooves and scratches",
        short(*.azimuth)
    )]
    NoDirection {
        /// The angle, degrees.
        azimuth: f64,
    },
    /// More samples than can be counted.
    #[error("{0} samples do not fit into memory")]
    TooManySamples(u64),
    /// The surfaces do not fit into memory.
    #[error(transparent)]
    Memory(SimulateError),
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
    #[error("{} is that of a structure: name one by --structure, or leave it out", words(.setting))]
    NoStructure {
        /// The key.
        setting: &'static str,
    },
    /// A spectrum of roughness on top of a structure, without its height.
    #[error(
        "roughness on top of a structure needs --sigma; without it leave out tau, the spectrum, heights and slopes"
    )]
    NoRoughness,
    /// Roughness on top of a structure that is not Gaussian.
    #[error(
        "roughness on top of a structure is Gaussian; leave out --slopes, --heights, --skewness and --kurtosis"
    )]
    OtherRoughness,
    /// A setting that this structure does not have.
    #[error("{structure} have no {}; leave out --{}", words(.setting), .setting.replace('_', "-"))]
    UnusedByStructure {
        /// The key.
        setting: &'static str,
        /// The name of the structure.
        structure: &'static str,
    },
}

/// A key as words, `edge radius`.
fn words(key: &str) -> String {
    key.replace('_', " ")
}

fn names(spectra: &[SpectrumName]) -> String {
    let names: Vec<&str> = spectra.iter().map(|spectrum| spectrum.name()).collect();
    names.join(", ")
}

/// Why a structure cannot be made, with the flag that draws it all the same.
fn structure_sentence(error: &StructureError, unit: LengthUnit) -> String {
    let sentence = error.clone().with_unit(unit).to_string();
    match error {
        StructureError::Unresolved { .. } => format!("{sentence} with --insist"),
        _ => sentence,
    }
}
