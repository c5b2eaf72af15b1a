//! Mean height of a spline surface.

use super::surface::SplineSurface;

/// Integrals over a cell of the four B-splines that it depends on.
const WEIGHTS: [f64; 4] = [1.0 / 24.0, 11.0 / 24.0, 11.0 / 24.0, 1.0 / 24.0];

impl SplineSurface {
    /// Mean height over the tile, by the integrals of the B-splines.
    #[must_use]
    pub fn mean(&self) -> f64 {
        let rows: Vec<f64> = self
            .coefficients()
            .chunks_exact(self.stride())
            .map(mean_of_cells)
            .collect();
        mean_of_cells(&rows)
    }
}

/// Mean over the cells of a line of coefficients; differences from the first, so that an offset loses no digits.
fn mean_of_cells(coefficients: &[f64]) -> f64 {
    let first = coefficients[0];
    let cells = coefficients.windows(4).map(|four| -> f64 {
        let weighted = four.iter().zip(WEIGHTS);
        weighted.map(|(c, weight)| (c - first) * weight).sum()
    });
    first + cells.sum::<f64>() / (coefficients.len() - 3) as f64
}
