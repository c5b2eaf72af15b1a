//! Heights and gradients at any place.

use super::surface::SplineSurface;

impl SplineSurface {
    /// Height at `(x, y)`, length units.
    ///
    /// Places from `(0, 0)` to [`SplineSurface::extent`]; beyond them, it is the height at the nearest place
    /// of the tile. Rounding is below `32 eps` of the largest coefficient.
    #[must_use]
    pub fn height(&self, x: f64, y: f64) -> f64 {
        let [along_x, along_y] = self.places(x, y);
        self.blend(&along_x, along_x.weights(), &along_y, along_y.weights())
    }

    /// Gradient `[dh/dx, dh/dy]` at `(x, y)`, dimensionless; places as for [`SplineSurface::height`].
    #[must_use]
    pub fn gradient(&self, x: f64, y: f64) -> [f64; 2] {
        let [along_x, along_y] = self.places(x, y);
        let [dx, dy] = self.spacing;
        let per_u = self.blend(
            &along_x,
            along_x.slope_weights(),
            &along_y,
            along_y.weights(),
        );
        let per_v = self.blend(
            &along_x,
            along_x.weights(),
            &along_y,
            along_y.slope_weights(),
        );
        [per_u / dx, per_v / dy]
    }

    fn places(&self, x: f64, y: f64) -> [Place; 2] {
        let ([cx, cy], [dx, dy]) = (self.cells, self.spacing);
        [Place::new(x / dx, cx), Place::new(y / dy, cy)]
    }

    /// Sum of the 4 x 4 coefficients of a cell by weights along x and along y.
    fn blend(&self, along_x: &Place, x: [f64; 4], along_y: &Place, y: [f64; 4]) -> f64 {
        let rows = self.coefficients[along_y.cell * self.stride()..].chunks(self.stride());
        rows.zip(y)
            .map(|(row, weight)| weight * dot(&row[along_x.cell..], x))
            .sum()
    }
}

/// Sum of four values by their weights.
pub(crate) fn dot(values: &[f64], weights: [f64; 4]) -> f64 {
    values.iter().zip(weights).map(|(v, w)| v * w).sum()
}

/// A place along one axis.
pub(crate) struct Place {
    pub(super) cell: usize,
    /// From 0 to 1 within the cell.
    u: f64,
}

impl Place {
    /// `at`: in cells from the first on; `cells`: their number.
    fn new(at: f64, cells: usize) -> Self {
        let cell = (at as usize).min(cells - 1);
        let u = (at - cell as f64).clamp(0.0, 1.0);
        Self { cell, u }
    }

    /// A place of the first cell.
    pub(crate) const fn within_cell(u: f64) -> Self {
        Self { cell: 0, u }
    }

    /// Grid point `i` of a grid `per_cell` times as fine.
    pub(super) fn of_fine_grid(i: usize, per_cell: usize, cells: usize) -> Self {
        let cell = (i / per_cell).min(cells - 1);
        let u = (i - cell * per_cell) as f64 / per_cell as f64;
        Self { cell, u }
    }

    /// Values of the four basis functions, which sum to 1.
    pub(crate) fn weights(&self) -> [f64; 4] {
        let (u, w) = (self.u, 1.0 - self.u);
        let inner = |u: f64| (4.0 + 3.0 * u * u * (u - 2.0)) / 6.0;
        [w * w * w / 6.0, inner(u), inner(w), u * u * u / 6.0]
    }

    /// Their derivatives by `u`, which sum to 0.
    pub(crate) fn slope_weights(&self) -> [f64; 4] {
        let (u, w) = (self.u, 1.0 - self.u);
        let inner = |u: f64| 0.5 * u * (3.0 * u - 4.0);
        [-0.5 * w * w, inner(u), -inner(w), 0.5 * u * u]
    }
}
