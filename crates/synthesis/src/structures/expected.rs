//! Statistics of structured surfaces that are known before any is drawn.

use serde::Serialize;

/// Statistics expected of a structured surface, on average over its realisations; `None` where there is no closed form.
///
/// They are those of the continuous surface, without roughness on top.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StructureStatistics {
    /// Highest to lowest point, length units.
    pub depth: Option<f64>,
    /// Fraction of the mean plane that features cover.
    pub coverage: Option<f64>,
    /// Mean of the squared gradient, over both axes together.
    pub mean_square_slope: Option<f64>,
}
