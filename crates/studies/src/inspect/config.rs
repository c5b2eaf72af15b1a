//! The configuration of an inspected height map: how it is read and lit.

use std::path::PathBuf;

use asperity_optics::Incidence;
use asperity_simulate::Observer;
use asperity_surface::HeightField;
use serde::Deserialize;

use super::statistics::Statistics;
use crate::config::error::ConfigError;
use crate::config::measured::MeasuredConfig;
use crate::config::sun::SunConfig;
use crate::config::trace::CellsConfig;
use crate::config::values::{Number, OneOrMany};
use crate::error::StudyError;
use crate::settings::Document;

/// A height map, and lights whose shadow is measured.
#[derive(Clone, Debug, Deserialize)]
pub struct InspectConfig {
    /// The cells between heights.
    pub surface: CellsConfig,
    /// The height map.
    pub measured: MeasuredConfig,
    /// The lights.
    #[serde(rename = "shadow")]
    pub light: InspectLight,
}

/// Directions of lights whose shadow is measured.
#[derive(Clone, Debug, Deserialize)]
pub struct InspectLight {
    /// Polar angles, degrees.
    pub theta: Option<OneOrMany<Number>>,
    /// Azimuth, degrees.
    pub phi: OneOrMany<Number>,
    /// Directions towards the sun, in place of `theta` and `phi`.
    #[serde(flatten)]
    pub sun: SunConfig,
}

/// A height map with its statistics.
pub struct Inspection {
    pub(super) file: PathBuf,
    /// The heights, eroded.
    pub field: HeightField,
    /// `true` if +y is its north, and -y otherwise.
    pub y_is_north: bool,
    /// Its roughness and shadows.
    pub statistics: Statistics,
}

impl InspectConfig {
    /// Reads the configuration of a document.
    ///
    /// # Errors
    /// [`StudyError`] if there is no file, or a value is invalid or lacks another.
    pub fn new(document: &Document) -> Result<Self, StudyError> {
        let config: Self = document.read()?;
        config.light.directions(false)?;
        config.measured.required_file(document)?;
        Ok(config)
    }

    /// Reads the height map, and measures it. `document` is that of the configuration.
    ///
    /// # Errors
    /// [`StudyError`] if the file cannot be read, or light cannot be followed.
    pub fn inspect(
        &self,
        document: &Document,
        observer: &dyn Observer,
    ) -> Result<Inspection, StudyError> {
        let file = self.measured.required_file(document)?;
        let read = self.measured.read_height_map(file, observer)?;
        let cells = self.surface.cells.of_given();
        let lights = self.light.directions(read.y_is_north)?;
        Ok(Inspection {
            file: file.to_owned(),
            statistics: Statistics {
                notes: read.notes,
                ..Statistics::of(&read.field, cells, &lights)?
            },
            field: read.field,
            y_is_north: read.y_is_north,
        })
    }
}

impl InspectLight {
    /// All directions on a surface, of which +y is the north or -y.
    fn directions(&self, y_is_north: bool) -> Result<Vec<Incidence>, ConfigError> {
        let sun = self.sun.clone().take(y_is_north);
        let (thetas, phi) = match &sun {
            Some([theta, phi]) => (Some(theta), phi),
            None => (self.theta.as_ref(), &self.phi),
        };
        let thetas = thetas.map(|list| list.values("theta")).transpose()?;
        let phi = phi.one("phi")?.0;
        let direction = |theta: Number| Ok(Incidence::from_degrees(theta.0, phi)?);
        let thetas = thetas.unwrap_or_default();
        thetas.into_iter().map(direction).collect()
    }
}
