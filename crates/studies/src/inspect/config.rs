//! The configuration of an inspected height map: how it is read, eroded and lit.

use std::path::PathBuf;

use asperity_optics::Incidence;
use asperity_simulate::{Observer, short};
use asperity_surface::HeightField;
use asperity_synthesis::{Erosion, Etch, Slip};
use serde::Deserialize;

use super::statistics::Statistics;
use crate::config::error::ConfigError;
use crate::config::measured::MeasuredConfig;
use crate::config::sun::SunConfig;
use crate::config::trace::CellsConfig;
use crate::config::values::{Number, OneOrMany};
use crate::error::StudyError;
use crate::settings::Document;

/// A height map, the processes that erode it, and lights whose shadow is measured.
#[derive(Clone, Debug, Deserialize)]
pub struct InspectConfig {
    /// The cells between heights.
    pub surface: CellsConfig,
    /// The height map.
    pub measured: MeasuredConfig,
    /// The lights.
    #[serde(rename = "shadow")]
    pub light: InspectLight,
    /// The erosion.
    pub erosion: ErosionConfig,
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

/// `[erosion]`: the processes.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct ErosionConfig {
    /// Angle of repose, degrees.
    pub repose: Option<f64>,
    /// Most steps of slipping.
    pub slip_steps: u32,
    /// Depth of etching, in the unit of the heights.
    pub etch: Option<f64>,
}

/// A height map with its statistics.
pub struct Inspection {
    pub(super) file: PathBuf,
    /// The heights, eroded.
    pub(super) field: HeightField,
    /// `true` if +y is its north, and -y otherwise.
    pub(super) y_is_north: bool,
    /// Its roughness and shadows.
    pub statistics: Statistics,
    /// Notes for the user on how the file was read, eroded and written, one sentence each.
    pub(super) notes: Vec<String>,
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

    /// Reads the height map, erodes it, and measures it. `document` is that of the configuration.
    ///
    /// # Errors
    /// [`StudyError`] if the file cannot be read, the process applied, or light cannot be followed.
    pub fn inspect(
        &self,
        document: &Document,
        observer: &dyn Observer,
    ) -> Result<Inspection, StudyError> {
        let file = self.measured.required_file(document)?;
        let mut read = self.measured.read_height_map(file, observer)?;
        let in_unit: Self = document.clone().in_unit(read.field.unit())?.read()?;
        let (field, note) = in_unit.erosion.eroded(read.field)?;
        read.notes.extend(note);
        let cells = self.surface.cells.of_given();
        let lights = self.light.directions(read.y_is_north)?;
        Ok(Inspection {
            file: file.to_owned(),
            statistics: Statistics::of(&field, cells, &lights)?,
            field,
            y_is_north: read.y_is_north,
            notes: read.notes,
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

impl ErosionConfig {
    /// `field` after the processes, without provenance then, and a note if one changes no shape; unchanged if there is no process.
    fn eroded(self, field: HeightField) -> Result<(HeightField, Option<String>), StudyError> {
        let slip = self.repose.map(|repose| {
            Erosion::Slip(Slip {
                slope: repose.to_radians().tan(),
                steps: self.slip_steps,
            })
        });
        let etch = self.etch.map(|depth| Erosion::Etch(Etch { depth }));
        let note = self.etch.and_then(|depth| shallow_note(depth, &field));
        let mut processes = slip.into_iter().chain(etch);
        let field = processes.try_fold(field, |field, process| {
            let eroded = process.of(&field)?;
            Ok::<_, StudyError>(eroded.with_provenance(None))
        })?;
        Ok((field, note))
    }
}

/// Note on a depth of etching that reaches no other sample, so that the surface sinks and keeps its shape.
fn shallow_note(depth: f64, field: &HeightField) -> Option<String> {
    let [dx, dy] = field.spacing();
    let spacing = dx.min(dy);
    (depth < spacing).then(|| {
        let unit = field.unit().suffix();
        let (depth, spacing) = (short(depth), short(spacing));
        format!(
            "--etch {depth}{unit} is less than the spacing of {spacing}{unit}: the surface sinks by it and keeps its shape"
        )
    })
}
