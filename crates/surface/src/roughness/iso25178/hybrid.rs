//! Sdr: the area of the mesh over that of the mean plane.

use crate::HeightField;

/// Sdr in percent: the mean over all facets of `sqrt(1 + g^2) - 1`, `g` being the gradient. It is exact for the mesh of two
/// triangles per cell, as Sdq of [`Roughness`](crate::Roughness) is.
pub(super) fn developed_area_ratio(field: &HeightField) -> f64 {
    let [columns, rows] = field.cells();
    let sums = field.facet_sums(|[x, y]| {
        let square = x * x + y * y;
        // Without the cancellation of sqrt(1 + g^2) - 1
        [square / (1.0 + (1.0 + square).sqrt())]
    });
    100.0 * sums.as_flattened().iter().sum::<f64>() / (2.0 * columns as f64 * rows as f64)
}
