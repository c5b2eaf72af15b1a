//! Erosion: wears a given surface after it was filtered.

use asperity_simulate::short;
use asperity_surface::HeightField;
use asperity_synthesis::{Erosion, Etch, Slip};
use serde::{Deserialize, Serialize};

use super::filtering::FilteringError;
use crate::config::values::Number;
use crate::settings::Length;

/// Steps of slipping unless a number is given.
const SLIP_STEPS: u32 = 1000;

/// Flag of the angle of repose.
pub(crate) const REPOSE: &str = "--repose";
/// Flag of the depth of etching.
pub(crate) const ETCH: &str = "--etch";

/// The processes that wear a surface: slipping, then etching.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErosionConfig {
    /// Angle of repose, degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub repose: Option<Number>,
    /// Most steps of slipping.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slip_steps: Option<u32>,
    /// Depth of etching.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub etch: Option<Length>,
}

impl ErosionConfig {
    /// `field` after the processes, without provenance then, and a note if one changes no shape; unchanged if there is no process.
    ///
    /// # Errors
    /// [`FilteringError`] if a process does not suit the surface.
    pub(crate) fn eroded(
        self,
        field: HeightField,
    ) -> Result<(HeightField, Option<String>), FilteringError> {
        let slip = self.repose.map(|repose| {
            Erosion::Slip(Slip {
                slope: repose.0.to_radians().tan(),
                steps: self.slip_steps.unwrap_or(SLIP_STEPS),
            })
        });
        let depth = self.etch.map(|depth| {
            let depth = depth.in_unit(field.unit());
            depth.ok_or(FilteringError::Unit { flag: ETCH })
        });
        let depth = depth.transpose()?;
        let note = depth.and_then(|depth| shallow_note(depth, &field));
        let etch = depth.map(|depth| Erosion::Etch(Etch { depth }));
        let mut processes = slip.into_iter().chain(etch);
        let field = processes.try_fold(field, |field, process| {
            let eroded = process.of(&field)?;
            Ok::<_, FilteringError>(eroded.with_provenance(None))
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
