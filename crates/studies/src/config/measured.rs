//! `[measured]`: given surfaces.

use std::path::{Path, PathBuf};

use asperity_surface::{Border, Form, HeightFieldError, LengthUnit, MissingPolicy, RawHeightMap};
use serde::{Deserialize, Serialize};

use super::erosion::ErosionConfig;
use super::values::{OneOrMany, PerAxis};
use crate::settings::Length;

/// `[measured]`: a given surface, from a file or flat, or several from files, in place of random ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredConfig {
    /// Height map or triangle mesh, or several: an ensemble.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<OneOrMany<PathBuf>>,
    /// A flat surface in place of a file.
    #[serde(default)]
    pub flat: bool,
    /// Continuation beyond the border; as the file says unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub border: Option<Border>,
    /// Distance between samples along x and y; as the file says unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacing: Option<PerAxis<Length>>,
    /// The unit that lengths of the file are converted into; as the file says unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<LengthUnit>,
    /// The unit of the lengths of a file that states none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assume_unit: Option<LengthUnit>,
    /// `true` if the rows of a height map are taken in reverse order.
    #[serde(default)]
    pub flip: bool,
    /// Axis of a mesh that points up; z unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub up: Option<UpAxis>,
    /// Policy for missing points.
    #[serde(with = "MissingName")]
    pub missing: MissingPolicy,
    /// Form to remove by least squares.
    pub remove: Form,
    /// Nesting index of the S-filter, which removes shorter waves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub s_filter: Option<Length>,
    /// Nesting index of the L-filter, which removes longer waves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub l_filter: Option<Length>,
    /// Erosion of height maps after that.
    #[serde(flatten)]
    pub erosion: ErosionConfig,
}

/// Axis of the coordinates of a mesh that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// x: y, z, x become x, y, z.
    X,
    /// y, as in files of Blender: x, -z, y become x, y, z.
    Y,
    /// z.
    Z,
}

impl UpAxis {
    /// A position turned so that the axis points along z.
    #[must_use]
    pub const fn turned(self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match self {
            Self::X => [y, z, x],
            Self::Y => [x, -z, y],
            Self::Z => [x, y, z],
        }
    }
}

/// Names of [`MissingPolicy`] in files.
#[derive(Serialize, Deserialize)]
#[serde(remote = "MissingPolicy", rename_all = "lowercase")]
enum MissingName {
    Refuse,
    Fill,
}

impl MeasuredConfig {
    /// Returns `true` if there is one.
    #[must_use]
    pub const fn is_given(&self) -> bool {
        self.flat || self.file.is_some()
    }

    /// The files, none of random surfaces and of a flat one.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.file.as_ref().map_or(&[][..], OneOrMany::as_slice);
        files.iter().map(PathBuf::as_path)
    }

    /// The unit of the lengths in a file that states `stated`, before they are converted.
    ///
    /// # Errors
    /// [`UnitError`] if a unit is assumed where the file states another, or a conversion is requested where none is
    /// known.
    pub fn unit_of_file(&self, stated: LengthUnit) -> Result<LengthUnit, UnitError> {
        let own = match (stated, self.assume_unit) {
            (LengthUnit::Arbitrary, Some(assumed)) => assumed,
            // Of several files some may state a unit
            (stated, Some(assumed)) if assumed != stated && self.files().count() == 1 => {
                return Err(UnitError::Stated { stated, assumed });
            }
            (stated, _) => stated,
        };
        match self.unit {
            Some(unit) if own == LengthUnit::Arbitrary => Err(UnitError::Unknown { unit }),
            _ => Ok(own),
        }
    }

    /// A map as it was read, in the requested unit, spacing and order of rows.
    ///
    /// # Errors
    /// [`UnitError`].
    pub fn scaled(&self, mut raw: RawHeightMap) -> Result<RawHeightMap, UnitError> {
        raw.unit = self.unit_of_file(raw.unit)?;
        let unit = self.unit.unwrap_or(raw.unit);
        let mut raw = raw.in_unit(unit)?;
        if let Some(spacing) = self.spacing {
            let [dx, dy] = spacing.xy().map(|d| d.in_unit(unit));
            let (Some(dx), Some(dy)) = (dx, dy) else {
                return Err(UnitError::Spacing);
            };
            raw = raw.with_spacing([dx, dy])?;
        }
        Ok(if self.flip { raw.flipped() } else { raw })
    }
}

/// Reasons for which lengths of a file cannot be taken as requested.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitError {
    /// A unit is assumed, and the file states another.
    #[error(
        "--assume-unit {assumed}: the file states its unit, {stated}; --unit {assumed} converts"
    )]
    Stated {
        /// The unit of the file.
        stated: LengthUnit,
        /// The assumed one.
        assumed: LengthUnit,
    },
    /// Lengths are to be converted from a unit that is not known.
    #[error(
        "the file states no unit, so that its lengths cannot be converted into {unit}; say what its numbers are in with --assume-unit"
    )]
    Unknown {
        /// The requested unit.
        unit: LengthUnit,
    },
    /// The spacing has a unit, and the surface none.
    #[error(
        "--spacing with a unit: the surface has no unit of length; say what its heights are in with --assume-unit"
    )]
    Spacing,
    /// The numbers become too large or too small.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
}

#[cfg(test)]
mod tests {
    use asperity_surface::HeightField;

    use super::*;
    use crate::settings::{Command, Document};

    fn measured(keys: &str) -> MeasuredConfig {
        #[derive(Deserialize)]
        struct Config {
            measured: MeasuredConfig,
        }
        let text = format!("[measured]\nfile = \"a.npy\"\n{keys}");
        let document = Document::of_text(Command::Trace, &text).unwrap();
        document.read::<Config>().unwrap().measured
    }

    fn scaled(keys: &str, unit: LengthUnit) -> Result<HeightField, UnitError> {
        let mut raw = RawHeightMap::new(vec![1.0, 2.0, 3.0, 4.0], [2, 2], [10.0, 20.0]).unwrap();
        raw.unit = unit;
        let map = measured(keys).scaled(raw)?;
        Ok(map
            .into_height_field(MissingPolicy::Refuse, Border::Open)
            .unwrap())
    }

    #[test]
    fn units_convert_and_never_rename() {
        let field = scaled("unit = \"um\"", LengthUnit::Nanometre).unwrap();
        assert_eq!(field.unit(), LengthUnit::Micrometre);
        assert_eq!((field.height(1, 0), field.spacing()), (2e-3, [0.01, 0.02]));
        let assumed = "assume_unit = \"nm\"\nunit = \"um\"";
        let field = scaled(assumed, LengthUnit::Arbitrary).unwrap();
        assert_eq!((field.height(1, 0), field.spacing()), (2e-3, [0.01, 0.02]));
        let stated = (LengthUnit::Metre, LengthUnit::Nanometre);
        assert_eq!(
            scaled(assumed, LengthUnit::Metre),
            Err(UnitError::Stated {
                stated: stated.0,
                assumed: stated.1
            })
        );
        // Of several files the assumed unit is that of those that state none
        let mut several = measured(assumed);
        several.file = Some(OneOrMany::Many(vec!["a.npy".into(), "b.sur".into()]));
        assert_eq!(several.unit_of_file(stated.0), Ok(stated.0));
        assert_eq!(several.unit_of_file(LengthUnit::Arbitrary), Ok(stated.1));
        let unit = LengthUnit::Micrometre;
        assert_eq!(
            scaled("unit = \"um\"", LengthUnit::Arbitrary),
            Err(UnitError::Unknown { unit })
        );
    }

    #[test]
    fn spacings_are_in_the_unit_of_the_surface_or_in_their_own() {
        let field = scaled("spacing = [3, \"500nm\"]", LengthUnit::Micrometre).unwrap();
        assert_eq!(field.spacing(), [3.0, 0.5]);
        let plain = scaled("spacing = 3", LengthUnit::Arbitrary).unwrap();
        assert_eq!(plain.spacing(), [3.0, 3.0]);
        let error = scaled("spacing = \"3nm\"", LengthUnit::Arbitrary);
        assert_eq!(error, Err(UnitError::Spacing));
    }

    #[test]
    fn rows_are_reversed_on_request() {
        let field = scaled("flip = true", LengthUnit::Metre).unwrap();
        assert_eq!(field.heights(), [3.0, 4.0, 1.0, 2.0]);
    }
}
