//! Counted attenuation: the shadowing and masking that `attenuation` counted on explicit surfaces, in place of those of a model.
//!
//! Cook and Torrance's reflection is `F D G / (4 cos(theta_i) cos(theta_o))`, that of Neumann divides by `4 max(cos(theta_i), cos(theta_o))`,
//! and `G` is the column `g2`: the fraction of the facets facing both directions that are lit and visible.
//!
//! # Source
//! The 2019 paper on geometric attenuation, Sec. 5.3 and Fig. 9.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use asperity_analysis::{Beckmann, CookTorranceNeumann, SlopeCovariance, Smith, VCavity};
use asperity_io::{NumberTable, ReadError, read_number_table, shown_path};
use asperity_optics::from_spherical;
use asperity_simulate::short;

/// Largest relative difference of Smith's G1 of the model from that of the table. Slopes that are given with four digits are off by up to
/// 5e-4 of themselves, and G1 varies at most in proportion to them.
const SAME_SLOPES: f64 = 1e-3;

/// Reasons for which a file gives no attenuation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AttenuationFileError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The file is no table of one surface over both angles.
    #[error(
        "{}: attenuation.csv of one sigma, with two values or more of theta and of view_theta, is needed: asperity attenuation --sigma SIGMA --theta LIST --view-theta LIST --view-phi 180 -o DIR",
        shown_path(path)
    )]
    NoGrid {
        /// The file.
        path: PathBuf,
    },
    /// The table was counted on other slopes.
    #[error(
        "{}: counted on surfaces of other slopes: Smith's G1 at theta {} is {} there, and {} for those of the model",
        shown_path(path), short(*theta), short(*counted), short(*own)
    )]
    OtherSlopes {
        /// The file.
        path: PathBuf,
        /// Polar angle of the light, degrees.
        theta: f64,
        /// Smith's G1 of the surfaces that were counted on.
        counted: f64,
        /// That of the slopes of the model.
        own: f64,
    },
    /// The light comes from an angle beyond those that were counted.
    #[error("{}: theta {} is beyond those of the table, {} to {}", shown_path(path), short(*theta), short(range[0]), short(range[1]))]
    Beyond {
        /// The file.
        path: PathBuf,
        /// Polar angle of the light, degrees.
        theta: f64,
        /// Least and largest angle of the table.
        range: [f64; 2],
    },
}

/// Attenuation that was counted by the polar angles of light and view.
pub(super) struct CountedAttenuation {
    path: PathBuf,
    theta: Vec<f64>,
    view_theta: Vec<f64>,
    /// A row per angle of the light.
    g2: Vec<f64>,
    /// Smith's G1 by angle of the light.
    smith_g1: Vec<f64>,
    /// Azimuth of the view less that of the light, degrees.
    pub(super) azimuth_deg: f64,
}

impl CountedAttenuation {
    /// Reads attenuation.csv.
    pub(super) fn read(path: &Path) -> Result<Self, AttenuationFileError> {
        let table = read_number_table(path)?;
        Self::of(&table).ok_or_else(|| AttenuationFileError::NoGrid {
            path: path.to_owned(),
        })
    }

    fn of(table: &NumberTable) -> Option<Self> {
        let the_same = |name| {
            let column = table.column(name)?;
            let first = *column.first()?;
            column.iter().all(|value| *value == first).then_some(first)
        };
        the_same("sigma")?;
        let azimuth_deg = the_same("view_phi")? - the_same("phi")?;
        let [view_theta, theta] = table.grid(["view_theta", "theta"])?;
        let known = |name| {
            let column = table.column(name)?;
            let is_whole = column.iter().all(|value| value.is_finite());
            is_whole.then(|| column.to_vec())
        };
        let smith_g1 = known("smith_g1")?;
        Some(Self {
            path: table.path().to_owned(),
            smith_g1: smith_g1.into_iter().step_by(view_theta.len()).collect(),
            g2: known("g2")?,
            theta,
            view_theta,
            azimuth_deg,
        })
    }

    /// Checks that it was counted on surfaces of these slopes, equal in all directions, and around that angle of the light, degrees.
    pub(super) fn check(
        &self,
        slopes: SlopeCovariance,
        theta_deg: f64,
    ) -> Result<(), AttenuationFileError> {
        let path = self.path.clone();
        let beckmann = Beckmann::new(slopes);
        for (&theta, &counted) in self.theta.iter().zip(&self.smith_g1) {
            for phi in [0.0, FRAC_PI_2] {
                let own = beckmann.g1(from_spherical(theta.to_radians(), phi));
                if (own - counted).abs() > SAME_SLOPES * counted {
                    return Err(AttenuationFileError::OtherSlopes {
                        path,
                        theta,
                        counted,
                        own,
                    });
                }
            }
        }
        let range = [self.theta[0], self.theta[self.theta.len() - 1]];
        if !(range[0]..=range[1]).contains(&theta_deg) {
            return Err(AttenuationFileError::Beyond {
                path,
                theta: theta_deg,
                range,
            });
        }
        Ok(())
    }

    /// Least and largest polar angle of the view, degrees.
    pub(super) fn views(&self) -> [f64; 2] {
        [
            self.view_theta[0],
            self.view_theta[self.view_theta.len() - 1],
        ]
    }

    /// `G2` at polar angles within the table, degrees, linear between those of the table.
    pub(super) fn g2(&self, theta: f64, view_theta: f64) -> f64 {
        let (row, down) = cell(&self.theta, theta);
        let (column, across) = cell(&self.view_theta, view_theta);
        let at = |row: usize| {
            let row = &self.g2[row * self.view_theta.len()..];
            row[column] + across * (row[column + 1] - row[column])
        };
        at(row) + down * (at(row + 1) - at(row))
    }
}

/// The interval of `nodes` that holds a value, and the value's place in it, from 0 to 1.
fn cell(nodes: &[f64], value: f64) -> (usize, f64) {
    let above = nodes.partition_point(|node| *node <= value);
    let i = above.clamp(1, nodes.len() - 1) - 1;
    (i, (value - nodes[i]) / (nodes[i + 1] - nodes[i]))
}

/// The model with Smith's separable attenuation that counted attenuation is put into, by the name of a model; `None` of models without one of
/// these forms.
pub(super) fn with_smith(name: &str) -> Option<&'static str> {
    match name {
        VCavity::NAME | Smith::NAME_SEPARABLE => Some(Smith::NAME_SEPARABLE),
        CookTorranceNeumann::NAME_GROOVES | CookTorranceNeumann::NAME_SMITH => {
            Some(CookTorranceNeumann::NAME_SMITH)
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attenuation_is_linear_between_the_angles_of_the_table() {
        let counted = CountedAttenuation {
            path: PathBuf::new(),
            theta: vec![0.0, 40.0],
            view_theta: vec![0.0, 20.0, 60.0],
            g2: vec![1.0, 0.8, 0.4, 0.6, 0.4, 0.2],
            smith_g1: vec![1.0, 0.9],
            azimuth_deg: 180.0,
        };
        for (theta, view, expected) in [
            (0.0, 0.0, 1.0),
            (40.0, 60.0, 0.2),
            (0.0, 40.0, 0.6),
            (20.0, 20.0, 0.6),
            (10.0, 30.0, 0.75 * 0.7 + 0.25 * 0.35),
        ] {
            assert!((counted.g2(theta, view) - expected).abs() < 1e-15);
        }
    }
}
