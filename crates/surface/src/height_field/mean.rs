//! Mean height of a surface.

use rayon::prelude::*;

use super::field::HeightField;

/// Mean height, summed relative to the first height so that a common offset rounds but once.
pub(crate) fn mean_height(field: &HeightField) -> f64 {
    let origin = field.heights()[0];
    let rows: Vec<f64> = field
        .heights()
        .par_chunks_exact(field.nx())
        .map(|row| row.iter().map(|h| h - origin).sum())
        .collect();
    origin + rows.iter().sum::<f64>() / field.heights().len() as f64
}
