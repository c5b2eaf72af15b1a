//! `[surface]`: spectra, roughness and distributions of heights, and what was read of files. Lengths are in length units.

use std::path::{Path, PathBuf};

use asperity_synthesis::{HeightTable, Psd};
use serde::{Deserialize, Serialize};

use crate::config::values::{Number, OneOrMany};

/// A power spectral density.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "psd", rename_all = "kebab-case")]
pub enum Spectrum {
    /// Exponential autocorrelation.
    Exponential {
        /// 1/e correlation length.
        tau: Number,
        /// Wavelength of the shortest waves.
        cut_off: Number,
    },
    /// Matern's family.
    Matern {
        /// 1/e correlation length.
        tau: Number,
        /// Parameter of the family.
        nu: Number,
        /// Wavelength of the shortest waves.
        #[serde(skip_serializing_if = "Option::is_none")]
        cut_off: Option<Number>,
    },
    /// Self-affine.
    PowerLaw {
        /// Hurst exponent.
        hurst: Number,
        /// Wavelength beyond which it is level.
        roll_off: Number,
        /// Wavelength of the shortest waves.
        cut_off: Number,
    },
    /// Gaussian autocorrelation, unless another is named.
    #[serde(untagged)]
    Gaussian {
        /// Its name, which a configuration does not keep.
        #[serde(default, skip_serializing)]
        psd: GaussianName,
        /// 1/e correlation length; none of a structure without roughness on top.
        #[serde(skip_serializing_if = "Option::is_none")]
        tau: Option<Number>,
    },
    /// A table, or `like:` and a height map.
    #[serde(untagged)]
    File {
        /// The file.
        psd: PathBuf,
    },
}

/// The name `gaussian`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GaussianName {
    /// The only one.
    #[default]
    Gaussian,
}

/// Roughness of surfaces of a spectrum: one number or several.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "slopes", rename_all = "kebab-case")]
pub enum Roughness {
    /// GGX slopes, with long tails.
    Ggx {
        /// Roughness of the slopes.
        ggx_alpha: OneOrMany<Number>,
        /// Correlation length of the amplitude of the slopes over that of the surface.
        #[serde(skip_serializing_if = "Option::is_none")]
        amplitude_ratio: Option<Number>,
    },
    /// Slopes of Gaussian heights, by the correlation length over the root mean square height.
    #[serde(untagged)]
    Smoothness {
        /// Smoothness `tau / sigma`.
        smoothness: OneOrMany<Number>,
    },
    /// Slopes of Gaussian heights, by their root mean square.
    #[serde(untagged)]
    Sigma {
        /// Root mean square height.
        sigma: OneOrMany<Number>,
    },
}

impl Roughness {
    /// Its numbers.
    pub(super) const fn list_mut(&mut self) -> &mut OneOrMany<Number> {
        match self {
            Self::Ggx {
                ggx_alpha: list, ..
            }
            | Self::Smoothness { smoothness: list }
            | Self::Sigma { sigma: list } => list,
        }
    }
}

/// A second scale that is added to a spectrum, Gaussian.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SecondScale {
    /// Root mean square height.
    #[serde(rename = "second_sigma")]
    pub sigma: Number,
    /// 1/e correlation length.
    #[serde(rename = "second_tau")]
    pub tau: Number,
}

/// A distribution of heights: that of the spectrum, or that of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum HeightsChoice {
    /// Gaussian, or by skewness and kurtosis.
    Named(GaussianName),
    /// A table, or `like:` and a height map.
    File(PathBuf),
}

impl HeightsChoice {
    pub(super) fn file(&self) -> Option<&Path> {
        match self {
            Self::Named(_) => None,
            Self::File(path) => Some(path),
        }
    }
}

/// Contents of the files that a surface names.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SurfaceFiles {
    /// The spectrum.
    #[serde(skip)]
    pub(super) psd: Option<Psd>,
    /// The distribution of heights.
    #[serde(skip)]
    pub(super) heights: Option<HeightTable>,
    /// Tells apart what was read, so that no run resumes with another file of the same name.
    pub(super) hashes: Vec<String>,
}

impl SurfaceFiles {
    pub(super) const fn is_empty(&self) -> bool {
        self.hashes.is_empty()
    }
}
