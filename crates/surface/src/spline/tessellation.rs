//! Heights on regular grids: at the grid points, or finer, for a mesh.

use rayon::prelude::*;

use super::patch::{Place, dot};
use super::surface::SplineSurface;
use crate::height_field::check_grid;
use crate::{Border, HeightField, HeightFieldError};

impl SplineSurface {
    /// Grid points `[rows, columns]`: those of [`SplineSurface::samples`].
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        let [cx, cy] = self.cells();
        match self.border() {
            Border::Periodic => [cy, cx],
            Border::Mirrored | Border::Open => [cy + 1, cx + 1],
        }
    }

    /// Heights at the grid points: shape `[cy, cx]` if the border is periodic, `[cy + 1, cx + 1]` otherwise.
    ///
    /// Spacing, unit, border and provenance stay. [`SplineSurface::through`] these samples is this surface
    /// again, to rounding.
    #[must_use]
    pub fn samples(&self) -> HeightField {
        self.sampled(1)
    }

    /// Heights on a grid `per_cell` times as fine along both axes, at least 1.
    ///
    /// Extent, unit, border and provenance stay. How far the two triangles per cell of this field are from the
    /// surface is bounded by [`SplineSurface::deviation`].
    ///
    /// # Errors
    /// [`HeightFieldError`] if `per_cell` is zero, or the grid is too large for memory.
    pub fn tessellated(&self, per_cell: usize) -> Result<HeightField, HeightFieldError> {
        check_grid(self.fine_shape(per_cell), self.fine_spacing(per_cell))?;
        Ok(self.sampled(per_cell))
    }

    fn fine_shape(&self, per_cell: usize) -> [usize; 2] {
        let [cx, cy] = self.cells;
        let last = usize::from(self.border != Border::Periodic);
        [cy, cx].map(|cells| cells.saturating_mul(per_cell).saturating_add(last))
    }

    fn fine_spacing(&self, per_cell: usize) -> [f64; 2] {
        self.spacing.map(|d| d / per_cell as f64)
    }

    fn sampled(&self, per_cell: usize) -> HeightField {
        let ([cx, cy], stride) = (self.cells, self.stride());
        let shape @ [ny, nx] = self.fine_shape(per_cell);
        let along_x: Vec<(usize, [f64; 4])> = (0..nx)
            .map(|ix| Place::of_fine_grid(ix, per_cell, cx))
            .map(|place| (place.cell, place.weights()))
            .collect();
        let mut heights = vec![0.0; ny * nx];
        heights.par_chunks_exact_mut(nx).enumerate().for_each_init(
            || vec![0.0; stride],
            |blended, (iy, heights)| {
                let along_y = Place::of_fine_grid(iy, per_cell, cy);
                let weights = along_y.weights();
                let rows = &self.coefficients[along_y.cell * stride..];
                for (ix, value) in blended.iter_mut().enumerate() {
                    *value = dot(&[0, 1, 2, 3].map(|j| rows[j * stride + ix]), weights);
                }
                for (height, &(cell, weights)) in heights.iter_mut().zip(&along_x) {
                    *height = dot(&blended[cell..], weights);
                }
            },
        );
        HeightField::of_checked(heights, shape, self.fine_spacing(per_cell))
            .with_unit(self.unit)
            .with_border(self.border)
            .with_provenance(self.provenance.clone())
    }
}
