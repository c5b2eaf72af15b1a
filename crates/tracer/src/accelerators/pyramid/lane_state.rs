//! Lane state: the rays that are in the lanes of the wide search.

#[cfg(doc)]
use super::bounds::Bounds;
#[cfg(doc)]
use super::rays::Rays;
use crate::vector::lanes::Lanes;

/// The rays that are in the lanes.
#[derive(Clone, Copy)]
pub(super) struct State<L: Lanes> {
    /// See [`Rays`] for these.
    pub(super) x: L::F,
    pub(super) y: L::F,
    pub(super) z: L::F,
    pub(super) dx: L::F,
    pub(super) dy: L::F,
    pub(super) dz: L::F,
    pub(super) inverse_dx: L::F,
    pub(super) inverse_dy: L::F,
    pub(super) side: L::F,
    pub(super) first_x: L::I,
    pub(super) first_y: L::I,
    pub(super) place: L::I,
    /// 1 if x (y) grows along the ray, otherwise 0.
    pub(super) ahead_x: L::I,
    pub(super) ahead_y: L::I,
    /// Ray parameters at the corner's column and row: `-x / dx` and `-y / dy`.
    pub(super) corner_x: L::F,
    pub(super) corner_y: L::F,
    /// Amount by which heights may be off per unit of `t`: see [`Bounds::slack`].
    pub(super) slack: L::F,
    /// Required clearance above the surface where it leaves the tile across x and y.
    pub(super) clearance_x: L::F,
    pub(super) clearance_y: L::F,
    /// Height above which it meets nothing any more; a falling ray has none.
    pub(super) ceiling: L::F,
    /// Number of bits by which the bound of its half space is shifted in a word.
    pub(super) half: L::I,
    /// Result so far: the column of the cell that it hits, or a negative word.
    pub(super) answer: L::I,
    /// Ray parameter that the ray has reached.
    pub(super) t: L::F,
    /// The cell that it is in there.
    pub(super) ix: L::I,
    pub(super) iy: L::I,
    /// The level at which it is searched; 0 is the cell itself.
    pub(super) level: L::I,
    /// `true` if it has come nearer to its cell than the bounds of that cell, if cells have bounds, and is to be tested.
    pub(super) near: L::M,
    /// `true` if the ray continues.
    pub(super) active: L::M,
    /// `true` if there is a ray, or the answer to one.
    pub(super) occupied: L::M,
}

/// Exits of rays from the nodes that they are in.
pub(super) struct LanesExit<L: Lanes> {
    pub(super) t: L::F,
    /// Height there.
    pub(super) z: L::F,
    /// `true` if they leave through the edge across x.
    pub(super) across_x: L::M,
    /// Column and row of the node at its level, and those ahead.
    pub(super) node: [L::I; 2],
    pub(super) ahead: [L::I; 2],
    /// Amount by which rounding may have changed heights.
    pub(super) margin: L::F,
}

/// Result of tests of the cells that rays are in.
pub(super) struct CellsMet<L: Lanes> {
    /// `true` if the surface in the cell is hit.
    pub(super) met: L::M,
    /// Height of the ray over it, where positive.
    pub(super) gap: L::F,
}
