//! Lengths that the tags of a TIFF file state: spacing, unit, and the scale of heights.

use asperity_surface::LengthUnit;

/// Scale from samples to heights: `factor (offset + scale sample)`.
pub(super) struct HeightScale {
    pub(super) scale: f64,
    pub(super) offset: f64,
    /// Length units of the grid in one unit of the heights.
    pub(super) factor: f64,
}

impl Default for HeightScale {
    fn default() -> Self {
        Self {
            scale: 1.0,
            offset: 0.0,
            factor: 1.0,
        }
    }
}

impl HeightScale {
    pub(super) fn of(&self, sample: f64) -> f64 {
        (self.offset + self.scale * sample) * self.factor
    }
}

/// Lengths that a file states.
#[derive(Default)]
pub(super) struct Lengths {
    /// `[dx, dy]` in `unit`; `None` if the file states none.
    pub(super) spacing: Option<[f64; 2]>,
    /// Unit of spacing and heights.
    pub(super) unit: LengthUnit,
    pub(super) heights: HeightScale,
    /// `true` if rows and columns are stored in the other order: from south to north, from east to west.
    pub(super) turned_back: [bool; 2],
    pub(super) notes: Vec<String>,
}
