//! A measured grid with the units of its file, and the map that it makes.

use asperity_surface::RawHeightMap;

use crate::error::ReadProblem;
use crate::height_maps::unit::PowerOfMetre;
use crate::text_lines::short;

/// Metre, millimetre, micrometre.
pub(super) const METRE: PowerOfMetre = PowerOfMetre(0);
pub(super) const MILLIMETRE: PowerOfMetre = PowerOfMetre(-3);
pub(super) const MICROMETRE: PowerOfMetre = PowerOfMetre(-6);

/// A number of units of length.
#[derive(Clone, Copy)]
pub(super) struct Length {
    pub(super) value: f64,
    pub(super) unit: PowerOfMetre,
}

/// Heights on a grid, as the file has them.
pub(crate) struct Measured {
    /// Row by row, NaN where missing.
    pub(super) heights: Vec<f64>,
    pub(super) height_unit: PowerOfMetre,
    /// `[ny, nx]`.
    pub(super) shape: [u64; 2],
    /// Along x and y; `None` if the file states none.
    pub(super) spacing: Option<[Length; 2]>,
    pub(super) notes: Vec<String>,
}

impl Measured {
    /// The map, with all lengths in the unit of the spacing along x.
    pub(super) fn into_map(mut self) -> Result<RawHeightMap, ReadProblem> {
        let unit = match self.spacing {
            Some([dx, _]) => dx.unit.kept_as(),
            None => self.height_unit.kept_as(),
        };
        let mut spacing = [1.0; 2];
        if let Some(lengths) = self.spacing {
            for (spacing, length) in spacing.iter_mut().zip(lengths) {
                *spacing = length
                    .unit
                    .convert(unit)
                    .map_or(length.value, |convert| convert(length.value));
            }
        }
        if let Some(convert) = self.height_unit.convert(unit) {
            for height in &mut self.heights {
                *height = convert(*height);
            }
        }
        let shape = self.shape.map(|n| usize::try_from(n).unwrap_or(usize::MAX));
        let mut map = RawHeightMap::new(self.heights, shape, spacing)?;
        if self.spacing.is_none() {
            map = map.with_assumed_spacing();
            self.notes.push(
                "the instrument was not calibrated along x and y: set the spacing with a unit, as in --spacing 1um"
                    .to_owned(),
            );
        }
        map.unit = unit;
        map.notes = self.notes;
        Ok(map)
    }
}

/// The unit of length that a file names; `what` says of what.
pub(super) fn unit_of_length(what: &str, text: &str) -> Result<PowerOfMetre, ReadProblem> {
    length_unit(text).ok_or_else(|| {
        ReadProblem::unsupported(format_args!(
            "the unit of {what} is `{}`, but a unit of length is needed",
            short(text)
        ))
    })
}

/// A unit of length, if it is one. Old programs write the sign for micro as `~`, or as that of another code page.
pub(super) fn length_unit(text: &str) -> Option<PowerOfMetre> {
    let text = text.trim();
    match text {
        "~m" | "\u{e6}m" => Some(MICROMETRE),
        _ => PowerOfMetre::parse(text),
    }
}
