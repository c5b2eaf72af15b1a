//! `[surface]`: choices of spectra and of distributions of heights, by name or by file, and what was read of files.

use std::path::{Path, PathBuf};

use asperity_synthesis::{HeightTable, Psd};
use serde::{Deserialize, Serialize};

/// A power spectral density by its name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SpectrumName {
    /// Gaussian autocorrelation.
    #[default]
    Gaussian,
    /// Exponential autocorrelation.
    Exponential,
    /// Matern's family.
    Matern,
    /// Self-affine.
    PowerLaw,
}

/// A power spectral density by its name, or by a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SpectrumChoice {
    /// By its name.
    Named(SpectrumName),
    /// A table, or `like:` and a height map.
    File(PathBuf),
}

impl Default for SpectrumChoice {
    fn default() -> Self {
        Self::Named(SpectrumName::Gaussian)
    }
}

impl PartialEq<SpectrumName> for SpectrumChoice {
    fn eq(&self, name: &SpectrumName) -> bool {
        matches!(self, Self::Named(own) if own == name)
    }
}

impl SpectrumChoice {
    pub(super) fn is_gaussian(&self) -> bool {
        *self == SpectrumName::Gaussian
    }

    pub(super) fn file(&self) -> Option<&Path> {
        match self {
            Self::Named(_) => None,
            Self::File(path) => Some(path),
        }
    }
}

/// A distribution of heights: that of the spectrum, or that of a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum HeightsChoice {
    /// By its name.
    Named(HeightsName),
    /// A table, or `like:` and a height map.
    File(PathBuf),
}

/// A distribution of heights by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HeightsName {
    /// Gaussian, or by skewness and kurtosis.
    Gaussian,
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
