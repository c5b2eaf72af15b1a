//! Slope table: a density of facet slopes that is constant in each cell of a grid.
//!
//! For measured surfaces, and others whose slopes are not Gaussian. Masses of cells are exact; within a cell slopes are
//! spread evenly, which widens their variance along an axis by a sixth of the square of the cell. Integrals of the
//! density are exact for the table, so that what is projected onto any direction is counted once.
//!
//! # Valid range
//! Smith's functions take the mean slope as zero, and the height and the slope of a facet as independent of those of all others.

#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};

use crate::microfacet::slope_grid::{SlopeGrid, SlopeTableError};

/// A density of facet slopes `(dh/dx, dh/dy)`, per area of the mean plane, constant in each cell of a [`SlopeGrid`].
///
/// # Examples
/// ```
/// use asperity_analysis::SlopeTable;
/// use asperity_optics::from_spherical;
///
/// // Saw teeth that rise slowly along x and fall steeply: light from -x is shadowed, as the slow rise faces +x less
/// let teeth = [[0.2, 0.1], [0.2, -0.1], [0.2, 0.0], [-0.6, 0.0]];
/// let table = SlopeTable::of_slopes(&teeth)?;
/// let (to_x, from_x) = (from_spherical(1.2, 0.0), from_spherical(1.2, 3.141_593));
/// assert!(table.lambda(from_x) > table.lambda(to_x));
/// # Ok::<(), asperity_analysis::SlopeTableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeTable {
    grid: SlopeGrid,
    /// Fraction of the mean plane over facets of each cell, along x within along y.
    mass: Vec<f64>,
    /// Sums of mass, and of mass times the middle along x, of the cells before each edge of each row.
    before: Vec<[f64; 2]>,
}

impl SlopeTable {
    /// The table with these weights of the cells of `grid`, along x within along y, of any sum.
    ///
    /// # Errors
    /// [`SlopeTableError`] unless there is a weight per cell, all are finite and none is negative, and one is positive.
    pub fn new(grid: SlopeGrid, weights: &[f64]) -> Result<Self, SlopeTableError> {
        let (weights_given, cells) = (weights.len(), grid.len());
        if weights_given != cells {
            return Err(SlopeTableError::BadLength {
                weights: weights_given,
                cells,
            });
        }
        if let Some(&bad) = weights.iter().find(|w| !(w.is_finite() && **w >= 0.0)) {
            return Err(SlopeTableError::BadWeight(bad));
        }
        let sum: f64 = weights.iter().sum();
        if !(sum > 0.0 && sum.is_finite()) {
            return Err(SlopeTableError::Empty);
        }
        let mass: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
        let before = sums_before(&grid, &mass);
        Ok(Self { grid, mass, before })
    }

    /// The table of `slopes` that stand for equal areas of the mean plane, less their mean, in cells of [`SlopeGrid::covering`].
    ///
    /// # Errors
    /// [`SlopeTableError::Empty`] without slopes, or if one is not finite.
    pub fn of_slopes(slopes: &[[f64; 2]]) -> Result<Self, SlopeTableError> {
        let count = slopes.len().max(1) as f64;
        let mean = [0, 1].map(|axis| slopes.iter().map(|s| s[axis]).sum::<f64>() / count);
        let level: Vec<[f64; 2]> = slopes
            .iter()
            .map(|s| [s[0] - mean[0], s[1] - mean[1]])
            .collect();
        let size = |axis: usize| {
            level
                .iter()
                .fold(0.0, |most: f64, s| most.max(s[axis].abs()))
        };
        let grid = SlopeGrid::covering(&level, [size(0), size(1)])?;
        let weights = grid.weights(level);
        Self::new(grid, &weights)
    }

    /// The cells.
    #[must_use]
    pub const fn grid(&self) -> &SlopeGrid {
        &self.grid
    }

    /// Fraction of the mean plane over facets with slopes of each cell, along x within along y; the sum is one.
    #[must_use]
    pub fn masses(&self) -> &[f64] {
        &self.mass
    }

    /// This density with its mean slope at zero.
    #[must_use]
    pub fn level(self) -> Self {
        let grid = self.grid.shifted(self.mean());
        let before = sums_before(&grid, &self.mass);
        Self {
            grid,
            before,
            ..self
        }
    }

    /// Mean slopes along x and y.
    #[must_use]
    pub fn mean(&self) -> [f64; 2] {
        self.mean_of(|[low, high]| 0.5 * (low + high)).to_array()
    }

    /// Means of the slopes' `sx sx`, `sx sy` and `sy sy` about zero, with what cells add to the squares.
    #[must_use]
    pub fn second_moments(&self) -> [f64; 3] {
        let squares = self.mean_of(|[a, b]| (a * a + a * b + b * b) / 3.0);
        let cells = self.mass.iter().enumerate();
        let product = cells.map(|(cell, mass)| {
            let [low, high] = self.grid.corners(cell);
            let middle = 0.5 * (low + high);
            mass * middle.x * middle.y
        });
        [squares.x, product.sum(), squares.y]
    }

    fn mean_of(&self, of_cell: impl Fn([DVec2; 2]) -> DVec2) -> DVec2 {
        let cells = self.mass.iter().enumerate();
        cells.fold(DVec2::ZERO, |sum, (cell, mass)| {
            sum + *mass * of_cell(self.grid.corners(cell))
        })
    }

    /// Density of slopes; zero outside the table.
    #[must_use]
    pub fn density(&self, slope: [f64; 2]) -> f64 {
        self.grid.cell_of(slope).map_or(0.0, |cell| {
            let [low, high] = self.grid.corners(cell);
            self.mass[cell] / (high - low).element_product()
        })
    }

    /// Density of facet normals `D(m)` in 1/sr, the density of slopes over `cos^4(theta_m)`; zero for `m.z <= 0`.
    ///
    /// # Source
    /// Ashikhmin, Premoze and Shirley 2000, for models of any density of facets.
    #[must_use]
    pub fn d(&self, m: DVec3) -> f64 {
        if m.z <= 0.0 {
            return 0.0;
        }
        self.density([-m.x / m.z, -m.y / m.z]) / m.z.powi(4)
    }

    /// Smith's Lambda of direction `w`, up or down: the integral `int_mu^inf (q - mu) p(q) dq / mu` with `mu = cot(theta)` and the
    /// density `p` of the slope `q` along the azimuth of `w`; for a direction below, of a surface turned upside down. Exact for the table.
    ///
    /// # Source
    /// Smith 1967; Bourlier, Saillard and Berginc 2000, and Heitz 2014, Sec. 5.3, for any slopes.
    #[must_use]
    pub fn lambda(&self, w: DVec3) -> f64 {
        if w.z == 0.0 {
            return f64::INFINITY;
        }
        self.mean_excess(w.truncate() / w.z, 1.0)
    }

    /// Mean over slopes `s` of `max(0, direction . s - threshold)`.
    pub(crate) fn mean_excess(&self, direction: DVec2, threshold: f64) -> f64 {
        let [nx, ny] = self.grid.size();
        let [xs, ys] = self.grid.edges();
        let mut sum = 0.0;
        for iy in 0..ny {
            let (y0, y1) = (ys[iy], ys[iy + 1]);
            let (a, b) = (direction.y * y0 - threshold, direction.y * y1 - threshold);
            let (least, most) = (a.min(b), a.max(b));
            // Cells of the row are below the threshold, then across it, then above it; the other way about for negative slopes.
            let [across, above] = if direction.x > 0.0 {
                let first = xs[1..].partition_point(|x| direction.x * x + most <= 0.0);
                let whole = xs[..nx].partition_point(|x| direction.x * x + least < 0.0);
                [[first, whole.max(first)], [whole.max(first), nx]]
            } else if direction.x < 0.0 {
                let end = xs[..nx].partition_point(|x| direction.x * x + most > 0.0);
                let whole = xs[1..].partition_point(|x| direction.x * x + least >= 0.0);
                [[whole.min(end), end], [0, whole.min(end)]]
            } else if least >= 0.0 {
                [[0, 0], [0, nx]]
            } else {
                [[0, nx], [0, 0]]
            };
            let row = iy * (nx + 1);
            let [of_before, of_all] = above.map(|k| self.before[row + k]);
            let [mass, first] = [of_all[0] - of_before[0], of_all[1] - of_before[1]];
            sum += direction.x * first + 0.5 * (a + b) * mass;
            for ix in across[0]..across[1] {
                let mass = self.mass[iy * nx + ix];
                if mass > 0.0 {
                    let (x0, x1) = (xs[ix], xs[ix + 1]);
                    let middle = 0.5 * (direction.x * (x0 + x1) + a + b);
                    sum += mass * mean_ramp(middle, direction.x * (x1 - x0), most - least);
                }
            }
        }
        sum.max(0.0)
    }
}

fn sums_before(grid: &SlopeGrid, mass: &[f64]) -> Vec<[f64; 2]> {
    let [nx, ny] = grid.size();
    let xs = &grid.edges()[0];
    let mut before = Vec::with_capacity((nx + 1) * ny);
    for row in mass.chunks_exact(nx) {
        let mut sum = [0.0; 2];
        before.push(sum);
        for (ix, mass) in row.iter().enumerate() {
            sum = [sum[0] + mass, sum[1] + mass * 0.5 * (xs[ix] + xs[ix + 1])];
            before.push(sum);
        }
    }
    before
}

/// Mean of `max(0, middle + b u + c v)` over `u` and `v` uniform within a half of zero.
fn mean_ramp(middle: f64, b: f64, c: f64) -> f64 {
    let (b, c) = (b.abs().max(c.abs()), b.abs().min(c.abs()));
    // Too narrow to cancel digits: the density along is constant, and the square across adds its mean
    if c <= 1e-4 * b {
        return if middle >= 0.5 * b {
            middle
        } else if middle <= -0.5 * b {
            0.0
        } else {
            let above = middle + 0.5 * b;
            (above * above + c * c / 12.0) / (2.0 * b)
        };
    }
    let cube = |x: f64| x.max(0.0).powi(3);
    let (far, near) = (0.5 * (b + c), 0.5 * (b - c));
    (cube(middle + far) - cube(middle + near) - cube(middle - near) + cube(middle - far))
        / (6.0 * b * c)
}
