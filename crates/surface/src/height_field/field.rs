//! Height field: samples of a surface on a regular grid, with spacings, unit and border.

use std::sync::Arc;

use rayon::prelude::*;

use super::border::Border;
use super::error::{HeightFieldError, MAX_HEIGHT};
use super::grid::check_grid;
use super::provenance::ProvenanceRecord;
use super::turned_cells::TurnedCells;
use super::unit::LengthUnit;

/// A single-valued surface `z = h(x, y)`, sampled on a regular grid.
///
/// Shape `[ny, nx]`, row-major: the sample in column `ix` and row `iy` is `heights[iy * nx + ix]`
/// and sits at `(ix dx, iy dy)`. All heights are finite and both spacings positive.
///
/// # Examples
/// ```
/// use asperity_surface::{Border, HeightField, LengthUnit};
///
/// // Two rows of three samples, 0.5 um apart
/// let heights = vec![0.0, 0.1, 0.0, 0.0, 0.2, 0.0];
/// let field = HeightField::new(heights, [2, 3], [0.5, 0.5])?
///     .with_unit(LengthUnit::Micrometre)
///     .with_border(Border::Mirrored);
/// assert_eq!(field.height(1, 1), 0.2);
/// // Of a surface that does not repeat, cells are one fewer than samples.
/// assert_eq!(field.extent(), [1.0, 0.5]);
/// # Ok::<(), asperity_surface::HeightFieldError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    /// Shared by copies of the surface.
    heights: Arc<Vec<f64>>,
    shape: [usize; 2],
    spacing: [f64; 2],
    unit: LengthUnit,
    border: Border,
    provenance: Option<Arc<dyn ProvenanceRecord>>,
    turned_cells: Option<Arc<TurnedCells>>,
}

impl HeightField {
    /// A periodic surface in arbitrary units.
    ///
    /// `shape`: `[ny, nx]`, at least `[2, 2]`. `spacing`: `[dx, dy]`, length units per sample.
    ///
    /// # Errors
    /// [`HeightFieldError`] if the shape is too small or does not fit the number of heights, a
    /// spacing is not positive, or a height is not finite.
    pub fn new(
        heights: Vec<f64>,
        shape: [usize; 2],
        spacing: [f64; 2],
    ) -> Result<Self, HeightFieldError> {
        Self::of_shared(Arc::new(heights), shape, spacing)
    }

    /// As [`HeightField::new`], of heights that may have other owners.
    pub(crate) fn of_shared(
        heights: Arc<Vec<f64>>,
        shape: [usize; 2],
        spacing: [f64; 2],
    ) -> Result<Self, HeightFieldError> {
        check_grid(shape, spacing)?;
        let [ny, nx] = shape;
        if heights.len() != nx * ny {
            return Err(HeightFieldError::WrongCount {
                found: heights.len(),
                nx,
                ny,
            });
        }
        check_heights(&heights, nx)?;
        Ok(Self {
            heights,
            ..Self::of_checked(Vec::new(), shape, spacing)
        })
    }

    /// A periodic surface in arbitrary units, of a grid that passes [`check_grid`] and heights that are [allowed](are_allowed).
    #[must_use]
    pub fn of_checked(heights: Vec<f64>, shape: [usize; 2], spacing: [f64; 2]) -> Self {
        Self {
            heights: Arc::new(heights),
            shape,
            spacing,
            unit: LengthUnit::Arbitrary,
            border: Border::Periodic,
            provenance: None,
            turned_cells: None,
        }
    }

    /// Returns the surface in another unit of length; numbers are not converted.
    #[must_use]
    pub fn with_unit(mut self, unit: LengthUnit) -> Self {
        self.unit = unit;
        self
    }

    /// Returns the surface with another border.
    #[must_use]
    pub fn with_border(mut self, border: Border) -> Self {
        self.border = border;
        self
    }

    /// Returns the surface with a record of how it was drawn.
    #[must_use]
    pub fn with_provenance(mut self, provenance: Option<Arc<dyn ProvenanceRecord>>) -> Self {
        self.provenance = provenance;
        self
    }

    /// Returns the surface with cells that are split along the other diagonal, those of [`HeightField::turned_cells`].
    #[must_use]
    pub fn with_turned_cells(mut self, turned_cells: Option<Arc<TurnedCells>>) -> Self {
        self.turned_cells = turned_cells.filter(|cells| !cells.is_empty());
        self
    }

    /// Returns a surface of the same grid, unit, border, provenance and turned cells with other heights.
    ///
    /// # Errors
    /// Errors of [`HeightField::new`].
    pub fn with_heights(&self, heights: Vec<f64>) -> Result<Self, HeightFieldError> {
        Ok(Self::new(heights, self.shape, self.spacing)?
            .with_unit(self.unit)
            .with_border(self.border)
            .with_provenance(self.provenance.clone())
            .with_turned_cells(self.turned_cells.clone()))
    }

    /// Samples in row-major order, `heights[iy * nx + ix]`.
    #[must_use]
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Consumes the field and returns its samples in row-major order, copied if another field shares them.
    #[must_use]
    pub fn into_heights(self) -> Vec<f64> {
        Arc::unwrap_or_clone(self.heights)
    }

    /// Samples in row-major order, shared with the field.
    #[must_use]
    pub fn shared_heights(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.heights)
    }

    /// Lowest and highest height of the samples.
    #[must_use]
    pub fn range(&self) -> [f64; 2] {
        const NONE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];
        let of_both = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let of_block = |block: &[f64]| {
            let mut lanes = [NONE; 8];
            for heights in block.chunks(lanes.len()) {
                for ([low, high], h) in lanes.iter_mut().zip(heights) {
                    *low = if *h < *low { *h } else { *low };
                    *high = if *h > *high { *h } else { *high };
                }
            }
            lanes.into_iter().fold(NONE, of_both)
        };
        let blocks = self.heights.par_chunks(1 << 16).map(of_block);
        blocks.reduce(|| NONE, of_both)
    }

    /// Returns `true` if all heights are equal.
    #[must_use]
    pub fn is_flat(&self) -> bool {
        self.heights.iter().all(|h| *h == self.heights[0])
    }

    /// `[ny, nx]`.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        self.shape
    }

    /// Number of columns.
    #[must_use]
    pub const fn nx(&self) -> usize {
        self.shape[1]
    }

    /// Number of rows.
    #[must_use]
    pub const fn ny(&self) -> usize {
        self.shape[0]
    }

    /// `[dx, dy]`, length units per sample.
    #[must_use]
    pub const fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// Unit of heights and spacings.
    #[must_use]
    pub const fn unit(&self) -> LengthUnit {
        self.unit
    }

    /// Border of the surface.
    #[must_use]
    pub const fn border(&self) -> Border {
        self.border
    }

    /// Record of how the surface was drawn, if it has one.
    #[must_use]
    pub fn provenance(&self) -> Option<&Arc<dyn ProvenanceRecord>> {
        self.provenance.as_ref()
    }

    /// Cells of the periodic grid that are split along the diagonal from corner 10 to 01; `None` if all are split from 00 to 11, as
    /// those of any surface but a structure with edges along the other diagonal.
    #[must_use]
    pub const fn turned_cells(&self) -> Option<&Arc<TurnedCells>> {
        self.turned_cells.as_ref()
    }

    /// Returns `true` if the cell `(ix, iy)`, one of the periodic grid, is split along the diagonal from corner 10 to 01.
    #[inline]
    #[must_use]
    pub fn is_turned(&self, ix: usize, iy: usize) -> bool {
        self.turned_cells
            .as_ref()
            .is_some_and(|cells| cells.contains(ix, iy))
    }

    /// Number of cells `[columns, rows]` of one tile: as many as samples if periodic, one fewer
    /// along each axis otherwise.
    #[must_use]
    pub const fn cells(&self) -> [usize; 2] {
        self.border.cells([self.shape[1], self.shape[0]])
    }

    /// Extent `[x, y]` of one tile in length units.
    #[must_use]
    pub const fn extent(&self) -> [f64; 2] {
        let [cx, cy] = self.cells();
        [cx as f64 * self.spacing[0], cy as f64 * self.spacing[1]]
    }

    /// Height of the sample in column `ix` and row `iy`, which wrap around at `nx` and `ny`.
    ///
    /// Cell `(ix, iy)` of [`HeightField::cells`] has its corners at `ix`, `ix + 1` and `iy`,
    /// `iy + 1`; the wrap serves the last cells of a periodic tile.
    #[must_use]
    pub fn height(&self, ix: usize, iy: usize) -> f64 {
        let [ny, nx] = self.shape;
        let ix = if ix < nx { ix } else { ix % nx };
        let iy = if iy < ny { iy } else { iy % ny };
        self.heights[iy * nx + ix]
    }
}

/// Returns `true` if all heights are finite and within bounds. There is no early exit, which would keep this from being
/// compiled to vector instructions.
#[must_use]
pub fn are_allowed(heights: &[f64]) -> bool {
    heights
        .iter()
        .fold(true, |all, h| all & (h.abs() <= MAX_HEIGHT))
}

/// Refuses heights that are not finite, or else too high, by the first of them.
fn check_heights(heights: &[f64], nx: usize) -> Result<(), HeightFieldError> {
    if are_allowed(heights) {
        return Ok(());
    }
    if let Some(i) = heights.iter().position(|h| !h.is_finite()) {
        return Err(HeightFieldError::NotFinite {
            ix: i % nx,
            iy: i / nx,
            value: heights[i],
        });
    }
    if let Some(i) = heights.iter().position(|h| h.abs() > MAX_HEIGHT) {
        return Err(HeightFieldError::TooHigh {
            ix: i % nx,
            iy: i / nx,
            value: heights[i],
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_grids_and_heights_are_refused() {
        let new = HeightField::new;
        assert!(matches!(
            new(vec![0.0], [1, 1], [1.0, 1.0]),
            Err(HeightFieldError::TooSmall { .. })
        ));
        assert!(matches!(
            new(vec![0.0; 5], [1, 5], [1.0, 1.0]),
            Err(HeightFieldError::TooSmall { .. })
        ));
        assert!(matches!(
            new(vec![0.0; 4], [2, 2], [0.0, 1.0]),
            Err(HeightFieldError::BadSpacing { axis: 'x', .. })
        ));
        assert!(matches!(
            new(vec![0.0; 4], [2, 2], [1.0, -1.0]),
            Err(HeightFieldError::BadSpacing { axis: 'y', .. })
        ));
        assert!(matches!(
            new(vec![0.0, 0.0, f64::NAN, 0.0], [2, 2], [1.0, 1.0]),
            Err(HeightFieldError::NotFinite { ix: 0, iy: 1, .. })
        ));
        assert!(matches!(
            new(vec![], [usize::MAX, 2], [1.0, 1.0]),
            Err(HeightFieldError::TooLarge { .. })
        ));
        assert!(matches!(
            new(vec![0.0, 0.0, -1e101, 0.0], [2, 2], [1.0, 1.0]),
            Err(HeightFieldError::TooHigh { ix: 0, iy: 1, .. })
        ));
        assert!(matches!(
            new(vec![0.0; 3], [2, 2], [1.0, 1.0]),
            Err(HeightFieldError::WrongCount { found: 3, .. })
        ));
    }

    #[test]
    fn tile_of_a_periodic_field_has_as_many_cells_as_samples() {
        let field = HeightField::new(vec![0.0; 6], [2, 3], [0.5, 2.0]).unwrap();
        assert_eq!(field.cells(), [3, 2]);
        assert_eq!(field.extent(), [1.5, 4.0]);
        let open = field.with_border(Border::Open);
        assert_eq!(open.cells(), [2, 1]);
        assert_eq!(open.extent(), [1.0, 2.0]);
    }
}
