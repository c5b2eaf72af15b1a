//! Lines at the directions of the light and of a flat surface's light, over signed angles.

use super::curve::{Curve, Style};

/// Directions in the plane of incidence, signed degrees; `None` draws no line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Directions {
    /// Towards the light.
    pub(crate) light_deg: Option<f64>,
    /// Direction of the light that a flat surface sends, and its name.
    pub(crate) flat_deg: Option<f64>,
    pub(crate) flat_name: &'static str,
}

impl Directions {
    /// The lines, from `lo` to `hi`.
    pub(crate) fn guides(self, lo: f64, hi: f64) -> impl Iterator<Item = Curve> {
        let lines = [
            (self.flat_deg, self.flat_name, Style::Guide),
            (self.light_deg, "towards the light", Style::Faint),
        ];
        lines.into_iter().filter_map(move |(angle, name, style)| {
            Some(Curve::guide(name, style, [(angle?, lo), (angle?, hi)]))
        })
    }
}
