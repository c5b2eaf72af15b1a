//! Heights of mean zero.

use rayon::prelude::*;

/// The heights less their mean, rows of `nx`; summed by rows, so that it does not depend on the number of threads.
pub(super) fn centred(mut heights: Vec<f64>, nx: usize) -> Vec<f64> {
    let rows: Vec<f64> = heights
        .par_chunks(nx)
        .map(|row| row.iter().sum::<f64>())
        .collect();
    let mean = rows.iter().sum::<f64>() / heights.len() as f64;
    heights
        .par_chunks_mut(nx)
        .for_each(|row| row.iter_mut().for_each(|height| *height -= mean));
    heights
}
