//! Slope grid: the cells that a table of slopes is divided into.

use asperity_numerics::elementary::{asinh, sinh};
use glam::DVec2;

/// Cells along an axis, at most.
const MAX_CELLS: usize = 4096;

/// Cells per root mean square slope at the centre of [`SlopeGrid::covering`]. A table widens the variance of slopes by
/// a sixth of the square of a cell: here by 1 / 6144.
const CELLS_PER_DEVIATION: f64 = 32.0;

/// Width of the centre, in which cells are nearly equal, in units of the spread of slopes; further out they widen with the slope.
const CENTRE: f64 = 2.0;

/// Smallest spread, over the root mean square.
const MIN_SPREAD: f64 = 1.0 / 16.0;

/// Smallest spread along an axis, over that along the other.
const NARROWEST: f64 = 1e-4;

/// Spread of slopes that are all zero: densities of the narrowest cells are finite.
const SMALLEST: f64 = 1e-100;

/// Largest slope along an axis, over the spread, of facets that are level along it: rounding of heights, far below the width of other cells.
const LEVEL: f64 = 1e-9;

/// Least part of the slopes that is level along an axis for which there is a cell of level slopes.
const LEAST_LEVEL: f64 = 1e-4;

/// Rectangular cells of slopes along x and y, between edges that ascend.
///
/// Where many facets are level along an axis, as those of plateaus and grooves are, the middle cell along it holds them alone: their light
/// leaves in exactly the plane, or the direction, of that of a mirror, where bins may meet.
///
/// # Examples
/// ```
/// use asperity_analysis::SlopeGrid;
///
/// let grid = SlopeGrid::new([vec![-1.0, 0.0, 1.0], vec![-0.5, 0.5]])?;
/// assert_eq!(grid.size(), [2, 1]);
/// assert_eq!(grid.cell_of([0.2, 0.1]), Some(1));
/// # Ok::<(), asperity_analysis::SlopeTableError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeGrid {
    edges: [Vec<f64>; 2],
    /// Axes along which the middle cell holds level slopes.
    level: [bool; 2],
}

/// Error of an invalid table of slopes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SlopeTableError {
    /// Too few or too many edges along an axis.
    #[error("{count} edges of slope cells along {axis}; 2 to {} are allowed", MAX_CELLS + 1)]
    BadCount {
        /// `x` or `y`.
        axis: char,
        /// Edges.
        count: usize,
    },
    /// Edges that do not ascend, or are not finite.
    #[error(
        "edges of slope cells along {axis} must ascend and be finite; {from} is followed by {to}"
    )]
    BadEdges {
        /// `x` or `y`.
        axis: char,
        /// An edge.
        from: f64,
        /// The next one.
        to: f64,
    },
    /// Weights that are not one per cell.
    #[error("{weights} weights for {cells} slope cells")]
    BadLength {
        /// Weights given.
        weights: usize,
        /// Cells of the grid.
        cells: usize,
    },
    /// A weight that is negative or not finite.
    #[error("weight {0} of a slope cell; weights must be finite and at least 0")]
    BadWeight(f64),
    /// A slope that is not finite, or none at all.
    #[error("a table needs slopes, all finite, and weights of which one is positive")]
    Empty,
}

impl SlopeGrid {
    /// Fraction of the slopes within the spread, as of Gaussian slopes within their deviation.
    pub(crate) const WITHIN_SPREAD: f64 = 0.683;

    /// The cells between `edges` along x and along y.
    ///
    /// # Errors
    /// [`SlopeTableError::BadCount`] or [`SlopeTableError::BadEdges`].
    pub fn new(edges: [Vec<f64>; 2]) -> Result<Self, SlopeTableError> {
        for (edges, axis) in edges.iter().zip(['x', 'y']) {
            let count = edges.len();
            if !(2..=MAX_CELLS + 1).contains(&count) {
                return Err(SlopeTableError::BadCount { axis, count });
            }
            if let Some(pair) = edges.windows(2).find(|pair| !is_cell(pair[0], pair[1])) {
                let [from, to] = [pair[0], pair[1]];
                return Err(SlopeTableError::BadEdges { axis, from, to });
            }
        }
        Ok(Self {
            edges,
            level: [false; 2],
        })
    }

    /// Cells for `slopes`, and all others up to the size `largest` along x and y: 32 per spread at the centre, wider in proportion to the
    /// slope beyond twice the spread. The spread is that of two thirds of the slopes along an axis about zero, or a sixteenth of their root
    /// mean square if that is more.
    ///
    /// # Errors
    /// [`SlopeTableError::Empty`] without slopes, or if one is not finite; [`SlopeTableError::BadEdges`] if a size is not.
    pub fn covering(slopes: &[[f64; 2]], largest: [f64; 2]) -> Result<Self, SlopeTableError> {
        let spread = [spread(slopes, 0)?, spread(slopes, 1)?];
        // Slopes that are all zero along an axis have narrow cells about it, too.
        let widest = spread[0].max(spread[1]).max(SMALLEST);
        let spread = spread.map(|spread| spread.max(NARROWEST * widest));
        let widths = spread.map(|spread| LEVEL * spread);
        let level = [0, 1].map(|axis| {
            let is_level = |slope: &&[f64; 2]| slope[axis].abs() <= widths[axis];
            let count = slopes.iter().filter(is_level).count();
            count as f64 > LEAST_LEVEL * slopes.len() as f64
        });
        let edges = [0, 1].map(|axis| {
            let mut edges = graded_edges(spread[axis], largest[axis]);
            if level[axis] {
                let middle = edges.len() / 2;
                edges.splice(middle..middle, [-widths[axis], widths[axis]]);
            }
            edges
        });
        let grid = Self::new(edges)?;
        Ok(Self { level, ..grid })
    }

    /// Cells along x and y.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [0, 1].map(|axis| self.edges[axis].len() - 1)
    }

    /// Number of cells.
    #[must_use]
    pub fn len(&self) -> usize {
        let [nx, ny] = self.size();
        nx * ny
    }

    /// Never: a grid has at least one cell.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Edges along x and along y.
    #[must_use]
    pub const fn edges(&self) -> &[Vec<f64>; 2] {
        &self.edges
    }

    /// Number of the cell that holds `slope`, along x within along y; `None` outside. The last cell holds its upper edge.
    #[must_use]
    pub fn cell_of(&self, slope: [f64; 2]) -> Option<usize> {
        let of_axis = |axis: usize| {
            let (edges, s) = (&self.edges[axis], slope[axis]);
            let last = edges.len() - 1;
            if !(s >= edges[0] && s <= edges[last]) {
                return None;
            }
            Some(edges.partition_point(|&edge| edge <= s).clamp(1, last) - 1)
        };
        Some(of_axis(1)? * self.size()[0] + of_axis(0)?)
    }

    /// Number of `slopes` in each cell, along x within along y. Slopes outside are left out.
    #[must_use]
    pub fn weights(&self, slopes: impl IntoIterator<Item = [f64; 2]>) -> Vec<f64> {
        let mut weights = vec![0.0; self.len()];
        for cell in slopes.into_iter().filter_map(|slope| self.cell_of(slope)) {
            weights[cell] += 1.0;
        }
        weights
    }

    /// Lower and upper corner of the cell of number `cell`.
    #[must_use]
    pub(crate) fn corners(&self, cell: usize) -> [DVec2; 2] {
        let nx = self.size()[0];
        let (ix, iy) = (cell % nx, cell / nx);
        [0, 1].map(|k| DVec2::new(self.edges[0][ix + k], self.edges[1][iy + k]))
    }

    /// Least and largest slopes of the facets in the cell of number `cell`: its corners, but zero along an axis along which they are level.
    #[must_use]
    pub(crate) fn facets(&self, cell: usize) -> [DVec2; 2] {
        let size = self.size();
        let numbers = [cell % size[0], cell / size[0]];
        let is_level = |axis: usize| self.level[axis] && numbers[axis] == size[axis] / 2;
        let tilted = DVec2::from_array([0, 1].map(|k| if is_level(k) { 0.0 } else { 1.0 }));
        self.corners(cell).map(|corner| tilted * corner)
    }

    /// These cells with all slopes less `mean`.
    #[must_use]
    pub fn shifted(&self, mean: [f64; 2]) -> Self {
        let edges = [0, 1].map(|axis| self.edges[axis].iter().map(|s| s - mean[axis]).collect());
        Self {
            edges,
            level: [false; 2],
        }
    }
}

/// The spread of slopes about zero along one axis, as in [`SlopeGrid::covering`].
fn spread(slopes: &[[f64; 2]], axis: usize) -> Result<f64, SlopeTableError> {
    let mut sizes: Vec<f64> = slopes.iter().map(|slope| slope[axis].abs()).collect();
    if sizes.is_empty() || !sizes.iter().all(|size| size.is_finite()) {
        return Err(SlopeTableError::Empty);
    }
    let count = sizes.len();
    let rms = (sizes.iter().map(|size| size * size).sum::<f64>() / count as f64).sqrt();
    let within = ((SlopeGrid::WITHIN_SPREAD * count as f64) as usize).min(count - 1);
    let spread = *sizes.select_nth_unstable_by(within, f64::total_cmp).1;
    Ok(spread.max(MIN_SPREAD * rms))
}

fn is_cell(from: f64, to: f64) -> bool {
    from.is_finite() && to.is_finite() && to > from
}

/// Edges symmetric about zero up to `largest`, at `a sinh(k u)` with `a` the width of the centre.
fn graded_edges(spread: f64, largest: f64) -> Vec<f64> {
    let a = CENTRE * spread;
    let step = 1.0 / (CENTRE * CELLS_PER_DEVIATION);
    let reach = (asinh(largest / a) / step).floor() as i64 + 1;
    // Two more cells where one of level slopes divides the middle one
    let half = reach.min(MAX_CELLS as i64 / 2 - 2);
    let edge = |k: i64| a * sinh((k as f64 - 0.5) * step);
    let mut edges: Vec<f64> = (-half..=half + 1).map(edge).collect();
    if let Some(last) = edges.last_mut() {
        *last = last.max(largest * (1.0 + f64::EPSILON));
    }
    edges[0] = -edges[edges.len() - 1];
    edges
}
