//! Bin finder: finds the rings and sectors of directions without inverse trigonometric functions.

pub(crate) mod aperture_windows;
pub(crate) mod exit_columns;
pub(crate) mod in_plane;
pub(crate) mod keys;

use std::ops::Range;

use asperity_numerics::elementary::{cos, sin_cos};
use glam::DVec3;

use crate::{HemisphereGrid, Side};
use exit_columns::ExitColumns;
use keys::{MARGIN, SortedKeys, TINY};

/// Keys of the rings of a side are between 0 and this, and those of transmitted light follow those of reflected light.
const RING_KEYS: f64 = 1.0;
/// Keys of the sectors of a side are between 0 and this.
const SECTOR_KEYS: f64 = 4.0;

/// Exits of a block.
const BLOCK: usize = 64;

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
            (1..grid.n_theta()).map(move |k| ring_key(side, cos(grid.theta_edge(side, k))))
        });
        let mut sectors = Vec::with_capacity(2 * n_phi);
        let first_sector = Side::BOTH.map(|side| {
            let edges = (0..n_phi).map(|k| {
                let (sin, cos) = sin_cos(grid.phi_edge(side, k));
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
            rings: SortedKeys::new(rings.collect(), 2.0 * RING_KEYS),
            sectors: SortedKeys::new(sectors, 2.0 * SECTOR_KEYS),
            first_sector,
        }
    }

    /// Number of the ring of `side`, from +z, that holds the unit vector `wo`.
    pub(crate) fn ring(&self, side: Side, wo: DVec3) -> usize {
        let ([found], [is_sure]) = self.rings.find(&[ring_key(side, wo.z)]);
        if is_sure {
            self.ring_after(side, found) as usize
        } else {
            self.grid.ring_of(side, wo)
        }
    }

    /// Number of the sector of `side` that holds `wo`.
    pub(crate) fn sector(&self, side: Side, wo: DVec3) -> usize {
        let key = sector_key(side, wo.x, wo.y);
        let ([found], [is_sure]) = self.sectors.find(&[key]);
        if is_sure & is_clear(side, key, wo.x, wo.y) {
            self.sector_after(side, found) as usize
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
        for first in (0..n).step_by(BLOCK) {
            let range = first..(first + BLOCK).min(n);
            self.locate_rings(exits, range.clone());
            if with_sectors {
                self.locate_sectors(exits, range);
            }
        }
    }

    #[inline(always)]
    fn locate_rings(&self, exits: &mut ExitColumns, range: Range<usize>) {
        let (side, z) = (&exits.side[range.clone()], &exits.wo[2][range.clone()]);
        let mut keys = [0.0; BLOCK];
        for (key, (&side, &z)) in keys.iter_mut().zip(side.iter().zip(z)) {
            *key = ring_key(side, z);
        }
        let (found, is_sure) = self.rings.find(&keys);
        for (k, ring) in exits.ring[range.clone()].iter_mut().enumerate() {
            *ring = self.ring_after(side[k], found[k]);
        }
        for (i, _) in range.zip(is_sure).filter(|(_, is_sure)| !is_sure) {
            exits.ring[i] = self.grid.ring_of(exits.side[i], exits.wo(i)) as u32;
        }
    }

    #[inline(always)]
    fn locate_sectors(&self, exits: &mut ExitColumns, range: Range<usize>) {
        let side = &exits.side[range.clone()];
        let [x, y, _] = exits.wo.each_ref().map(|column| &column[range.clone()]);
        let mut keys = [0.0; BLOCK];
        for (k, key) in keys.iter_mut().enumerate().take(side.len()) {
            *key = sector_key(side[k], x[k], y[k]);
        }
        let (found, mut is_sure) = self.sectors.find(&keys);
        for (k, sector) in exits.sector[range.clone()].iter_mut().enumerate() {
            *sector = self.sector_after(side[k], found[k]);
            is_sure[k] &= is_clear(side[k], keys[k], x[k], y[k]);
        }
        for (i, _) in range.zip(is_sure).filter(|(_, is_sure)| !is_sure) {
            exits.sector[i] = self.grid.sector_of(exits.side[i], exits.wo(i)) as u32;
        }
    }

    /// Number of the ring of `side` that begins after so many edges of both sides.
    #[inline(always)]
    fn ring_after(&self, side: Side, found: u32) -> u32 {
        found.wrapping_sub(number(side) * (self.grid.n_theta() as u32 - 1))
    }

    /// Number of the sector of `side` that begins after so many edges of both sides.
    #[inline(always)]
    fn sector_after(&self, side: Side, found: u32) -> u32 {
        let n_phi = self.grid.n_phi() as u32;
        let [reflected, transmitted] = self.first_sector;
        let first = match side {
            Side::Reflected => reflected,
            Side::Transmitted => transmitted,
        };
        let sector = first.wrapping_add(found).wrapping_sub(number(side) * n_phi);
        if sector >= n_phi {
            sector.wrapping_sub(n_phi)
        } else {
            sector
        }
    }
}

/// The number of a side, without a branch.
#[inline(always)]
fn number(side: Side) -> u32 {
    u32::from(side == Side::Transmitted)
}

/// Returns `true` if a key is far from the turn, at which an edge may lie on either end of the keys, and no digits were lost.
#[inline(always)]
fn is_clear(side: Side, key: f64, x: f64, y: f64) -> bool {
    let turned = key - SECTOR_KEYS * f64::from(number(side));
    (turned > MARGIN) & (turned < SECTOR_KEYS - MARGIN) & (x.abs() + y.abs() > TINY)
}

/// Key of a ring: rises with the polar angle, by 1/2 to 0.71 per radian. A direction at grazing belongs to its side whatever the sign of `z`.
#[inline(always)]
fn ring_key(side: Side, z: f64) -> f64 {
    let is_reflected = side == Side::Reflected;
    let along = if is_reflected { z } else { -z };
    let cos = if along > 0.0 { along } else { 0.0 };
    let from_normal = (1.0 - cos).sqrt();
    if is_reflected {
        from_normal
    } else {
        2.0 * RING_KEYS - from_normal
    }
}

/// Key of a sector: rises with the azimuth of `(x, y)`, by 1/2 to 1 per radian; `NaN` for a vertical direction.
#[inline(always)]
fn sector_key(side: Side, x: f64, y: f64) -> f64 {
    let along = x / (x.abs() + y.abs());
    let key = if y < 0.0 { 3.0 + along } else { 1.0 - along };
    key + SECTOR_KEYS * f64::from(number(side))
}

#[cfg(test)]
mod tests;
