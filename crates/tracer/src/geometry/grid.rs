//! Grid: geometry whose facets lie in the cells of a grid, one column and one row wide.

use crate::ray::{HalfSpace, Hit, RayColumns, TileRay};

use super::Geometry;
use super::height_bounds::HeightBounds;

/// Geometry whose facets lie in the cells of a grid: in tile coordinates cell `[ix, iy]` covers `[ix, ix + 1]` by
/// `[iy, iy + 1]`, and there is one height over every place.
pub(crate) trait Grid: Geometry {
    /// Cells of the tile, `[columns, rows]`.
    fn cells(&self) -> [usize; 2];

    /// Lowest and highest z of a cell, or bounds of these.
    fn cell_range(&self, cell: [u32; 2]) -> [f64; 2];

    /// [`Grid::cell_range`] of all cells of row `iy`, written to `ranges`.
    fn row_ranges(&self, iy: usize, ranges: &mut Vec<[f64; 2]>) {
        ranges.clear();
        let columns = self.cells()[0] as u32;
        ranges.extend((0..columns).map(|ix| self.cell_range([ix, iy as u32])));
    }

    /// An upper bound of the rise along a column or a row.
    fn steepest(&self) -> f64;

    /// Bounds of heights by blocks of cells, where [`Geometry::prepare_nearby`] has made them.
    fn height_bounds(&self) -> Option<&HeightBounds>;

    /// First facet of a cell that a ray in `half_space` passes through.
    fn intersect_cell(
        &self,
        cell: [u32; 2],
        ray: &TileRay,
        half_space: HalfSpace,
    ) -> Option<Hit<Self::Facet>>;

    /// Asks for what is known of a cell, which is about to be read.
    #[inline(always)]
    fn prefetch(&self, _cell: [u32; 2]) {}

    /// For rays by number and the cells that they meet: what [`Grid::intersect_cell`] gives, or `None` where that
    /// is not certain.
    #[inline(always)]
    fn pass_cells(
        &self,
        rays: RayColumns<'_>,
        met: &[(u32, [u32; 2])],
        hits: &mut [Option<Hit<Self::Facet>>],
    ) {
        for (hit, &(i, cell)) in hits.iter_mut().zip(met) {
            let query = rays.query(i as usize);
            *hit = self.intersect_cell(cell, &query.ray, query.half_space);
        }
    }
}
