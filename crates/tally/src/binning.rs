//! Bin finder: finds the rings and sectors of directions without inverse trigonometric functions.

pub(crate) mod exit_columns;
pub(crate) mod in_plane;
pub(crate) mod keys;

use glam::DVec3;

use crate::{HemisphereGrid, Side};
use exit_columns::ExitColumns;
use keys::{MARGIN, SortedKeys, TINY};

/// Difference between the keys of rings of both sides: no two of them are within [`MARGIN`] of each other.
const RING_OFFSET: f64 = 2.0;
/// The same of sectors, whose keys reach from 0 to 4.
const SECTOR_OFFSET: f64 = 5.0;

/// Finds rings and sectors of a grid: those that [`HemisphereGrid::index_of`] names.
///
/// A number that rises with the polar angle, and one that rises with the azimuth, are searched for among those of the edges; bins of equal
/// angles are edges like any others. A direction within [`MARGIN`] of an edge is decided by the grid, which defines the bins.
#[derive(Clone, Debug)]
pub(crate) struct BinFinder {
    grid: HemisphereGrid,
    rings: SortedKeys,
    sectors: SortedKeys,
    /// Sector before the first key, for each side.
    first_sector: [u32; 2],
}

impl BinFinder {
    pub(crate) fn new(grid: HemisphereGrid) -> Self {
        let n_phi = grid.n_phi();
        // The pole and the horizon are no edges.
        let rings = Side::BOTH.into_iter().flat_map(|side| {
            (1..grid.n_theta()).map(move |k| ring_key(side, grid.theta_edge(side, k).cos()))
        });
        let mut sectors = Vec::with_capacity(2 * n_phi);
        let first_sector = Side::BOTH.map(|side| {
            let edges = (0..n_phi).map(|k| {
                let (sin, cos) = grid.phi_edge(side, k).sin_cos();
                sector_key(side, cos, sin)
            });
            let mut keys: Vec<f64> = edges.collect();
            // Edges beyond a full turn come first.
            let first = (1..n_phi).find(|&k| keys[k] < keys[k - 1]).unwrap_or(0);
            keys.rotate_left(first);
            sectors.extend(keys);
            ((first + n_phi - 1) % n_phi) as u32
        });
        Self {
            grid,
            rings: SortedKeys::new(rings.collect(), RING_OFFSET + 1.0),
            sectors: SortedKeys::new(sectors, SECTOR_OFFSET + 4.0),
            first_sector,
        }
    }

    /// Number of the ring of `side`, from +z, that holds the unit vector `wo`.
    #[inline(always)]
    pub(crate) fn ring(&self, side: Side, wo: DVec3) -> usize {
        let (found, is_sure) = self.rings.find(ring_key(side, wo.z));
        if is_sure {
            found as usize - side.index() * (self.grid.n_theta() - 1)
        } else {
            self.grid.ring_of(side, wo)
        }
    }

    /// Number of the sector of `side` that holds `wo`.
    #[inline(always)]
    pub(crate) fn sector(&self, side: Side, wo: DVec3) -> usize {
        let key = sector_key(side, wo.x, wo.y);
        let (found, is_sure) = self.sectors.find(key);
        let of_side = key - SECTOR_OFFSET * side.index() as f64;
        // At the turn an edge may lie on either end of the keys.
        let is_off_turn = (of_side > MARGIN) & (of_side < 4.0 - MARGIN);
        if is_sure & is_off_turn & (wo.x.abs() + wo.y.abs() > TINY) {
            let n_phi = self.grid.n_phi();
            let sector =
                self.first_sector[side.index()] as usize + found as usize - side.index() * n_phi;
            if sector >= n_phi {
                sector - n_phi
            } else {
                sector
            }
        } else {
            self.grid.sector_of(side, wo)
        }
    }

    /// Finds the rings of many directions, and their sectors unless azimuths are free.
    #[inline(always)]
    pub(crate) fn locate(&self, exits: &mut ExitColumns, with_sectors: bool) {
        let n = exits.len();
        exits.ring.resize(n, 0);
        exits.sector.resize(n, 0);
        for i in 0..n {
            exits.ring[i] = self.ring(exits.side[i], exits.wo(i)) as u32;
        }
        if with_sectors {
            for i in 0..n {
                exits.sector[i] = self.sector(exits.side[i], exits.wo(i)) as u32;
            }
        }
    }
}

/// A number from 0 to 1 that rises with the polar angle on a side, plus the offset of that side. A direction at grazing belongs to its
/// side whatever the sign of `z`.
#[inline(always)]
fn ring_key(side: Side, z: f64) -> f64 {
    match side {
        Side::Reflected => 1.0 - z.max(0.0),
        Side::Transmitted => RING_OFFSET + (-z).max(0.0),
    }
}

/// A number from 0 to 4 that rises with the azimuth of `(x, y)`, a quarter turn by one, plus the offset of the side; `NaN` for a vertical
/// direction.
///
/// Its derivative by the azimuth lies between 1/2 and 1.
#[inline(always)]
fn sector_key(side: Side, x: f64, y: f64) -> f64 {
    let along = x / (x.abs() + y.abs());
    let key = if y < 0.0 { 3.0 + along } else { 1.0 - along };
    key + SECTOR_OFFSET * side.index() as f64
}

#[cfg(test)]
mod tests;
