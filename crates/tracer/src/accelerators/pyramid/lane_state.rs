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
    /// Where it passes the corner's column and row: `-x / dx` and `-y / dy`.
    pub(super) corner_x: L::F,
    pub(super) corner_y: L::F,
    /// By how much heights may be off per unit of `t`: see [`Bounds::slack`].
    pub(super) slack: L::F,
    /// How far it must be clear of the surface where it leaves the tile across x and y.
    pub(super) clearance_x: L::F,
    pub(super) clearance_y: L::F,
    /// Height above which it meets nothing any more; a falling ray has none.
    pub(super) ceiling: L::F,
    /// By how many bits the bound of its half space is shifted in a word.
    pub(super) half: L::I,
    /// What is known of it: the column of the cell that it meets, or a negative word.
    pub(super) answer: L::I,
    /// How far the ray has come.
    pub(super) t: L::F,
    /// The cell that it is in there.
    pub(super) ix: L::I,
    pub(super) iy: L::I,
    /// The level at which it is searched; 0 is the cell itself.
    pub(super) level: L::I,
    /// Where cells have bounds: whether it has come nearer to its cell than these, and is to be tested.
    pub(super) near: L::M,
    /// Whether the ray continues.
    pub(super) active: L::M,
    /// Whether there is a ray, or the answer to one.
    pub(super) occupied: L::M,
}

/// Where rays leave the nodes that they are in.
pub(super) struct LanesExit<L: Lanes> {
    pub(super) t: L::F,
    /// Height there.
    pub(super) z: L::F,
    /// Whether through the edge across x.
    pub(super) across_x: L::M,
    /// Column and row of the node at its level, and those ahead.
    pub(super) node: [L::I; 2],
    pub(super) ahead: [L::I; 2],
    /// By how much rounding may have changed heights.
    pub(super) margin: L::F,
}

/// What rays find in the cells that they are in.
pub(super) struct CellsMet<L: Lanes> {
    /// Whether the surface in the cell is met.
    pub(super) met: L::M,
    /// By how much the ray passes over it, where positive.
    pub(super) gap: L::F,
}
