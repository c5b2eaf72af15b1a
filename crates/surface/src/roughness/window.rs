//! Hann window over a grid.

use std::f64::consts::PI;

use asperity_numerics::elementary::sin;
use rayon::prelude::*;

/// Multiplies by `sin^2` from border to border along both axes. Returns the mean square of the window, 9/64 but for grids of two samples.
pub(crate) fn multiply_by_hann(heights: &mut [f64], [ny, nx]: [usize; 2]) -> f64 {
    let window = |n: usize| -> Vec<f64> {
        let at = |i: usize| sin(PI * (i as f64 + 0.5) / n as f64).powi(2);
        (0..n).map(at).collect()
    };
    let (along_x, along_y) = (window(nx), window(ny));
    let rows = heights.par_chunks_exact_mut(nx).zip(&along_y);
    rows.for_each(|(row, y)| {
        for (h, x) in row.iter_mut().zip(&along_x) {
            *h *= x * y;
        }
    });
    let mean_square = |w: &[f64]| w.iter().map(|w| w * w).sum::<f64>() / w.len() as f64;
    mean_square(&along_x) * mean_square(&along_y)
}
