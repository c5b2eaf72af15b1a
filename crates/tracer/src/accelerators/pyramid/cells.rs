//! Cells: what the searches in f32 ask of the kind of cells that a surface consists of, one file for each kind.

use super::bounds::{Bounds, Table};
use super::exit::{Exit, Test};
#[cfg(target_arch = "x86_64")]
use super::lane_state::{CellsMet, LanesExit, State};
use super::rays::Ray;
use crate::geometry::grid::Grid;
#[cfg(target_arch = "x86_64")]
use crate::vector::lanes::Lanes;

/// A grid whose cells can be tested in f32.
pub(super) trait SearchedGrid: Grid {
    /// The lowest level that has bounds. 1 where a test of a cell costs no more than that of a bound; 0 where it costs many
    /// times as much, so that rays first try the bound of a cell, and wait for others that have to be tested.
    const LOWEST_LEVEL: usize;

    /// Whether cells are divided along the diagonal, so that a ray that begins near it is near two facets.
    const HAS_DIAGONAL: bool;

    /// What tests read.
    fn table(&self) -> Table;

    /// Writes the bounds of the lowest level.
    fn bound_lowest(&self, bounds: &mut Bounds);

    /// Tests the cell that a ray enters at `t`.
    fn test(bounds: &Bounds, ray: &Ray, cell: [i32; 2], t: f32, exit: &Exit) -> Test;

    /// The same for all lanes. Lanes that are not at cells return unspecified values.
    #[cfg(target_arch = "x86_64")]
    fn test_lanes<L: Lanes>(
        lanes: L,
        bounds: &Bounds,
        state: &State<L>,
        exit: &LanesExit<L>,
    ) -> CellsMet<L>;
}
