//! Cells: the tests of a kind of cells that the searches in f32 need, implemented in one file per kind.

use super::bounds::{Bounds, Table};
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

    /// Returns whether there are cells that are split along the diagonal from corner 00 to 11, and from 10 to 01: a ray that begins near it may
    /// be near two facets.
    fn diagonals(&self) -> [bool; 2];

    /// Table that tests of cells read.
    fn table(&self) -> Table;

    /// Writes the bounds of the lowest level.
    fn bound_lowest(&self, bounds: &mut Bounds);

    /// Tests the cell that a ray enters at `t`.
    fn test(bounds: &Bounds, ray: &Ray, cell: [i32; 2], t: f32, exit: &Exit) -> Test;

    /// Tests the cells of all lanes. Lanes that are not at cells return unspecified values.
    #[cfg(target_arch = "x86_64")]
    fn test_lanes<L: Lanes>(
        lanes: L,
        bounds: &Bounds,
        state: &State<L>,
        exit: &LanesExit<L>,
    ) -> CellsMet<L>;
}

/// Exit of a ray from the node that it is in.
pub(super) struct Exit {
    pub(super) t: f32,
    /// Height there.
    pub(super) z: f32,
    /// `true` if it leaves through the edge across x.
    pub(super) across_x: bool,
    /// Column and row ahead, at the level of the node.
    pub(super) ahead: [i32; 2],
    /// Amount by which rounding may have changed heights.
    pub(super) margin: f32,
}

/// Result of the test of a node or cell.
pub(super) enum Test {
    /// The surface in the cell.
    Met,
    /// The ray passes over all of it, by this height.
    Clear(f32),
    /// The node has to be looked at more closely.
    Unknown,
}

/// One comparison, where `f32::min` takes care of a NaN.
pub(super) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// One comparison, where `f32::max` takes care of a NaN.
pub(super) fn greatest(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
