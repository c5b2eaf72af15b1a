//! Finds bins between given edges by binary search, without inverse trigonometric functions.

use std::ops::Range;

use glam::DVec3;

use crate::edges::SideEdges;
use crate::exit_columns::ExitColumns;
use crate::{HemisphereGrid, Side};

/// How far from an edge, as a cosine or a quarter turn, a table decides. Snapping reaches 1e-9 of a bin, and rounding far less.
const MARGIN: f64 = 1e-8;

/// Horizontal components below which products would lose digits.
const TINY: f64 = 1e-290;

/// Exits of a block.
const BLOCK: usize = 64;

/// Finds rings and sectors between edges that each side has of its own.
///
/// The cosine of the polar angle, and a fraction of the horizontal components that rises with the azimuth, are sought among those of the
/// edges. Each search takes the same steps for all exits, so that loops take vector instructions. What lies within [`MARGIN`] of an
/// edge is decided by the grid, which defines the bins.
#[derive(Clone, Debug)]
pub(crate) struct EdgeFinder {
    grid: HemisphereGrid,
    rings: SortedKeys,
    sectors: SortedKeys,
    /// Number of the sector before the first key, for each side.
    first_sector: [u32; 2],
}

impl EdgeFinder {
    pub(crate) fn new(grid: HemisphereGrid, sides: [&SideEdges; 2]) -> Self {
        // Keys of rings rise with theta; the pole and the horizon are no edges.
        let rings = sides.map(|edges| {
            let inner = &edges.theta()[1..grid.n_theta()];
            inner.iter().map(|theta| -theta.cos()).collect::<Vec<_>>()
        });
        let sectors = sides.map(|edges| {
            let turns = edges.phi()[..grid.n_phi()].iter().map(|phi| {
                let (sin, cos) = phi.sin_cos();
                turned_key(cos, sin)
            });
            let keys: Vec<f64> = turns.collect();
            // Edges beyond a full turn come first.
            let first = (1..keys.len())
                .find(|&k| keys[k] < keys[k - 1])
                .unwrap_or(0);
            let sorted = [&keys[first..], &keys[..first]].concat();
            (sorted, first)
        });
        let n_phi = grid.n_phi();
        let first_sector = [0, 1].map(|side| ((sectors[side].1 + n_phi - 1) % n_phi) as u32);
        Self {
            grid,
            rings: SortedKeys::new(rings),
            sectors: SortedKeys::new(sectors.map(|(keys, _)| keys)),
            first_sector,
        }
    }

    /// Number of the ring of `side`, from +z, that holds the unit vector `wo`.
    pub(crate) fn ring(&self, side: Side, wo: DVec3) -> usize {
        let key = ring_key(side, wo.z);
        let found = self.rings.find(side.index() as u32, key);
        if self.rings.is_sure(side.index() as u32, key, found) {
            found as usize
        } else {
            self.grid.ring_of(side, wo)
        }
    }

    /// Number of the sector of `side` that holds `wo`.
    pub(crate) fn sector(&self, side: Side, wo: DVec3) -> usize {
        let key = turned_key(wo.x, wo.y);
        let number = side.index() as u32;
        let found = self.sectors.find(number, key);
        if self.sectors.is_sure(number, key, found) && is_clear(key, wo.x, wo.y) {
            self.sector_after(number, found) as usize
        } else {
            self.grid.sector_of(side, wo)
        }
    }

    /// Number of the sector that begins at key number `found - 1` of a side.
    #[inline(always)]
    fn sector_after(&self, side: u32, found: u32) -> u32 {
        let n_phi = self.grid.n_phi() as u32;
        let sector = self.first_sector[side as usize] + found;
        if sector >= n_phi {
            sector - n_phi
        } else {
            sector
        }
    }

    /// The same for many directions: rings, and sectors unless azimuths are free.
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
        let mut keys = [0.0; BLOCK];
        let mut sides = [0; BLOCK];
        for (k, i) in range.clone().enumerate() {
            sides[k] = exits.side[i].index() as u32;
            keys[k] = ring_key(exits.side[i], exits.wo[2][i]);
        }
        let (found, is_sure) = self.rings.find_all(&sides, &keys);
        exits.ring[range.clone()].copy_from_slice(&found[..range.len()]);
        for (i, _) in range.zip(is_sure).filter(|(_, is_sure)| !is_sure) {
            exits.ring[i] = self.grid.ring_of(exits.side[i], exits.wo(i)) as u32;
        }
    }

    #[inline(always)]
    fn locate_sectors(&self, exits: &mut ExitColumns, range: Range<usize>) {
        let mut keys = [0.0; BLOCK];
        let mut sides = [0; BLOCK];
        let side = &exits.side[range.clone()];
        let [x, y, _] = exits.wo.each_ref().map(|column| &column[range.clone()]);
        for (k, side) in side.iter().enumerate() {
            sides[k] = side.index() as u32;
            keys[k] = turned_key(x[k], y[k]);
        }
        let (found, mut is_sure) = self.sectors.find_all(&sides, &keys);
        let sectors = &mut exits.sector[range];
        for (k, sector) in sectors.iter_mut().enumerate() {
            *sector = self.sector_after(sides[k], found[k]);
            is_sure[k] &= is_clear(keys[k], x[k], y[k]);
        }
        for (k, sector) in sectors.iter_mut().enumerate() {
            if !is_sure[k] {
                let wo = DVec3::new(x[k], y[k], 0.0);
                *sector = self.grid.sector_of(side[k], wo) as u32;
            }
        }
    }
}

/// A number that rises with the polar angle; a direction at grazing belongs to its side whatever the sign of `z`.
#[inline(always)]
fn ring_key(side: Side, z: f64) -> f64 {
    match side {
        Side::Reflected => -z.max(0.0),
        Side::Transmitted => (-z).max(0.0),
    }
}

/// A number from 0 to 4 that rises with the azimuth of `(x, y)`, a quarter turn by one; `NaN` for a vertical direction.
///
/// Its derivative by the azimuth lies between 1/2 and 1.
#[inline(always)]
fn turned_key(x: f64, y: f64) -> f64 {
    let along = x / (x.abs() + y.abs());
    if y < 0.0 { 3.0 + along } else { 1.0 - along }
}

/// Whether a key is far from the turn, at which an edge may lie on either end of the keys, and no digits were lost.
#[inline(always)]
fn is_clear(key: f64, x: f64, y: f64) -> bool {
    (key > MARGIN) & (key < 4.0 - MARGIN) & (x.abs() + y.abs() > TINY)
}

/// Whether `key` is far from key number `next` and from the one before it, unless that is none of the first `found` of its side.
#[inline(always)]
fn is_between(key: f64, next: u32, found: u32, at: impl Fn(u32) -> f64) -> bool {
    let is_before = key < at(next) - MARGIN;
    // The first of all has none before it.
    let is_after = key > at(next.max(1) - 1) + MARGIN;
    is_before & ((found == 0) | is_after)
}

/// Ascending keys of both sides, side by side, padded to a power of two with infinity.
#[derive(Clone, Debug)]
struct SortedKeys {
    keys: Vec<f64>,
    /// Length of a side.
    padded: u32,
}

impl SortedKeys {
    fn new(sides: [Vec<f64>; 2]) -> Self {
        // One more than there are keys, so that the last steps stay inside.
        let padded = (sides[0].len() + 1).next_power_of_two();
        let mut keys = Vec::with_capacity(2 * padded);
        for side in sides {
            keys.extend(&side);
            keys.resize(keys.len() + padded - side.len(), f64::INFINITY);
        }
        Self {
            keys,
            padded: padded as u32,
        }
    }

    /// How many keys of a side do not exceed `key`.
    #[inline(always)]
    fn find(&self, side: u32, key: f64) -> u32 {
        let mut found = 0;
        let mut step = self.padded / 2;
        while step > 0 {
            let at = self.keys[(side * self.padded + found + step - 1) as usize];
            found += step * u32::from(at <= key);
            step /= 2;
        }
        found
    }

    /// Whether `key`, after which `found` keys of a side are not greater, is far from both its neighbours.
    #[inline(always)]
    fn is_sure(&self, side: u32, key: f64, found: u32) -> bool {
        is_between(key, side * self.padded + found, found, |i| {
            self.keys[i as usize]
        })
    }

    /// [`SortedKeys::find`] and [`SortedKeys::is_sure`] for many.
    #[inline(always)]
    fn find_all(&self, sides: &[u32; BLOCK], keys: &[f64; BLOCK]) -> ([u32; BLOCK], [bool; BLOCK]) {
        // Where the number of keys is known to the compiler, their indices need no check, and loops take vector instructions. More than
        // 1024 keys are rare.
        match self.keys.len() {
            ..=64 => self.find_all_of::<64>(sides, keys),
            65..=128 => self.find_all_of::<128>(sides, keys),
            129..=256 => self.find_all_of::<256>(sides, keys),
            257..=512 => self.find_all_of::<512>(sides, keys),
            513..=1024 => self.find_all_of::<1024>(sides, keys),
            _ => {
                let found = std::array::from_fn(|k| self.find(sides[k], keys[k]));
                let is_sure = std::array::from_fn(|k| self.is_sure(sides[k], keys[k], found[k]));
                (found, is_sure)
            }
        }
    }

    /// The same for at most `N` keys, a power of two, step by step.
    #[inline(always)]
    fn find_all_of<const N: usize>(
        &self,
        sides: &[u32; BLOCK],
        keys: &[f64; BLOCK],
    ) -> ([u32; BLOCK], [bool; BLOCK]) {
        let mut all = [f64::INFINITY; N];
        all[..self.keys.len()].copy_from_slice(&self.keys);
        let key = |i: u32| all[i as usize % N];
        let mut found = [0; BLOCK];
        let mut step = self.padded / 2;
        while step > 0 {
            for k in 0..BLOCK {
                let at = key(sides[k] * self.padded + found[k] + step - 1);
                found[k] += step * u32::from(at <= keys[k]);
            }
            step /= 2;
        }
        let mut is_sure = [true; BLOCK];
        for k in 0..BLOCK {
            let next = sides[k] * self.padded + found[k];
            is_sure[k] = is_between(keys[k], next, found[k], key);
        }
        (found, is_sure)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use asperity_optics::from_spherical;

    use super::*;
    use crate::{Event, EventPath, Exit};

    /// Edges at `centre` plus and minus distances that grow from `finest` by `ratio`.
    fn about(centre: f64, finest: f64, ratio: f64, [first, last]: [f64; 2]) -> Vec<f64> {
        let mut edges = vec![first, last];
        let mut off = 0.5 * finest;
        let mut width = finest;
        while off < last - first {
            edges.extend(
                [centre - off, centre + off]
                    .into_iter()
                    .filter(|e| *e > first && *e < last),
            );
            width *= ratio;
            off += width;
        }
        edges.sort_by(f64::total_cmp);
        edges.dedup();
        edges
    }

    fn grids() -> Vec<HemisphereGrid> {
        let mut grids = Vec::new();
        for (theta, finest, ratio, azimuth) in [
            (30.0, 1e-3, 1.5, 0.0),
            (0.0, 0.01, 1.3, 77.7),
            (88.0, 0.3, 2.0, 359.9),
            (45.0, 40.0, 1.1, 123.456),
        ] {
            let reflected = about(theta, finest, ratio, [0.0, 90.0]);
            let below = about(180.0 - theta, 0.7 * finest, ratio, [90.0, 180.0]);
            // As many on both sides
            let n = reflected.len().min(below.len());
            let cut = |mut edges: Vec<f64>| {
                edges.drain(1..1 + edges.len() - n);
                edges
            };
            let phi = about(azimuth + 180.0, finest, ratio, [azimuth, azimuth + 360.0]);
            let turned: Vec<f64> = phi.iter().map(|deg| deg - azimuth).collect();
            grids.push(
                HemisphereGrid::with_edges([
                    SideEdges::new(Side::Reflected, cut(reflected), phi).unwrap(),
                    SideEdges::new(Side::Transmitted, cut(below), turned).unwrap(),
                ])
                .unwrap(),
            );
        }
        grids
    }

    /// Grids with as many keys as each of the loops of [`SortedKeys::find_all`] takes, and with more.
    fn large_grids() -> Vec<HemisphereGrid> {
        let steps = |[first, last]: [f64; 2], count: usize| -> Vec<f64> {
            let step = (last - first) / count as f64;
            (0..=count).map(|k| first + step * k as f64).collect()
        };
        [(20, 40), (90, 180), (200, 300), (600, 700)]
            .into_iter()
            .map(|(rings, sectors)| {
                let phi = steps([0.0, 360.0], sectors);
                HemisphereGrid::with_edges([
                    SideEdges::new(Side::Reflected, steps([0.0, 90.0], rings), phi.clone())
                        .unwrap(),
                    SideEdges::new(Side::Transmitted, steps([90.0, 180.0], rings), phi).unwrap(),
                ])
                .unwrap()
            })
            .collect()
    }

    fn check(finder: &EdgeFinder, exits: &mut ExitColumns, side: Side, wo: DVec3) {
        let grid = finder.grid;
        let found = (side.index() * grid.n_theta() + finder.ring(side, wo)) * grid.n_phi()
            + finder.sector(side, wo);
        assert_eq!(found, grid.index_of(side, wo), "{side} {wo:?}");
        let exit = Exit {
            side,
            wo,
            flux: 1.0,
            path: EventPath::default().then(Event::Reflection),
            scatterings: 0,
        };
        exits.push(&exit, 0);
    }

    /// Columns are found as single directions are.
    fn check_columns(finder: &EdgeFinder, mut exits: ExitColumns) {
        finder.locate(&mut exits, true);
        for i in 0..exits.len() {
            let (side, wo) = (exits.side[i], exits.wo(i));
            let found = [exits.ring[i], exits.sector[i]].map(|k| k as usize);
            let expected = [
                finder.grid.ring_of(side, wo),
                finder.grid.sector_of(side, wo),
            ];
            assert_eq!(found, expected, "{side} {wo:?}");
        }
    }

    #[test]
    fn random_directions_are_found_where_the_grid_puts_them() {
        for grid in grids().into_iter().chain(large_grids()) {
            let edges = Side::BOTH.map(|side| grid.edges(side).unwrap());
            let finder = EdgeFinder::new(grid, edges);
            let mut exits = ExitColumns::default();
            for i in 0..20_000 {
                let [u, v] = [0.618_033_988_7, 0.414_213_562_3]
                    .map(|step: f64| (f64::from(i + 1) * step).fract());
                for cos in [u, 1.0 - u.powi(6), u.powi(6)] {
                    let sin = (1.0 - cos * cos).sqrt();
                    let phi = TAU * v;
                    let wo = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                    check(&finder, &mut exits, Side::Reflected, wo);
                    check(&finder, &mut exits, Side::Transmitted, -wo);
                }
            }
            check_columns(&finder, exits);
        }
    }

    #[test]
    fn directions_on_and_about_edges_and_vertical_ones_are_found() {
        for grid in grids() {
            let edges = Side::BOTH.map(|side| grid.edges(side).unwrap());
            let finder = EdgeFinder::new(grid, edges);
            let mut exits = ExitColumns::default();
            for bin in grid.bins().step_by(7) {
                let ([t0, t1], [p0, p1]) = (bin.theta, bin.phi);
                for off in [0.0, 1e-16, 1e-12, 1e-9, 2e-9, 1e-8, 1.1e-8, 1e-6] {
                    for sign in [-1.0, 1.0] {
                        for (dt, dp) in [(off, off), (off * (t1 - t0), off * (p1 - p0))] {
                            let theta = (t0 + sign * dt).clamp(0.0, std::f64::consts::PI);
                            let phi = p0 + sign * dp;
                            let middle = (0.5 * (t0 + t1), 0.5 * (p0 + p1));
                            for (theta, phi) in [(theta, middle.1), (middle.0, phi), (theta, phi)] {
                                let wo = from_spherical(theta, phi);
                                check(&finder, &mut exits, bin.side, wo);
                            }
                        }
                    }
                }
            }
            for side in Side::BOTH {
                for x in [0.0, -0.0, 5e-324, -1e-300, 1e-17, -1e-9] {
                    for y in [0.0, -0.0, -5e-324, 1e-310, 1e-12] {
                        for z in [1.0, -1.0] {
                            check(&finder, &mut exits, side, DVec3::new(x, y, z));
                        }
                        check(&finder, &mut exits, side, DVec3::new(1.0, x, y));
                        check(&finder, &mut exits, side, DVec3::new(x, -1.0, y));
                    }
                }
            }
            check_columns(&finder, exits);
        }
    }
}
