//! Where in the mean plane, and from which azimuth, rays are sent: random, stratified or quasi-random.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// How the rays of a batch are spread over the mean plane and, where it is free, over azimuth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// Each ray anywhere, whatever the others do.
    Random,
    /// One ray in each stratum of the mean plane; azimuths anywhere.
    #[default]
    Stratified,
    /// One ray in each stratum, and evenly spread over place and azimuth together: Owen-scrambled
    /// Sobol points.
    QuasiRandom,
}

impl fmt::Display for Sampling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Random => "random",
            Self::Stratified => "stratified",
            Self::QuasiRandom => "quasi-random",
        })
    }
}

impl FromStr for Sampling {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "random" => Ok(Self::Random),
            "stratified" => Ok(Self::Stratified),
            "quasi-random" => Ok(Self::QuasiRandom),
            _ => Err(format!(
                "unknown sampling `{text}`; allowed are random, stratified and quasi-random"
            )),
        }
    }
}
