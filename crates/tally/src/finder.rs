//! Finds bins of equal angles without inverse trigonometric functions, and chooses how bins are found.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::ops::Range;

use glam::DVec3;

use crate::edge_finder::EdgeFinder;
use crate::exit_columns::ExitColumns;
use crate::{HemisphereGrid, Side};

/// How far from an edge, as a sine or cosine, a table decides. Snapping reaches 1e-9 of a bin, which
/// is 3.2e-9 rad at most where there are edges, and rounding far less.
pub(crate) const MARGIN: f64 = 1e-8;

/// Horizontal components below which products would lose digits.
pub(crate) const TINY: f64 = 1e-290;

/// Finds rings and sectors of a grid, the same as [`HemisphereGrid::index_of`] names.
#[derive(Clone, Debug)]
pub(crate) enum BinFinder {
    EqualAngles(EqualAngles),
    Edges(EdgeFinder),
}

impl BinFinder {
    pub(crate) fn new(grid: HemisphereGrid) -> Self {
        match Side::BOTH.map(|side| grid.edges(side)) {
            [Some(reflected), Some(transmitted)] => {
                Self::Edges(EdgeFinder::new(grid, [reflected, transmitted]))
            }
            _ => Self::EqualAngles(EqualAngles::new(grid)),
        }
    }

    /// Number of the ring of `side`, from +z, that holds the unit vector `wo`.
    #[inline]
    pub(crate) fn ring(&self, side: Side, wo: DVec3) -> usize {
        match self {
            Self::EqualAngles(finder) => finder.ring(side, wo),
            Self::Edges(finder) => finder.ring(side, wo),
        }
    }

    /// Number of the sector of `side` that holds `wo`.
    #[inline]
    pub(crate) fn sector(&self, side: Side, wo: DVec3) -> usize {
        match self {
            Self::EqualAngles(finder) => finder.sector(wo),
            Self::Edges(finder) => finder.sector(side, wo),
        }
    }

    /// The same for many directions: rings, and sectors unless azimuths are free.
    #[inline(always)]
    pub(crate) fn locate(&self, exits: &mut ExitColumns, with_sectors: bool) {
        match self {
            Self::EqualAngles(finder) => finder.locate(exits, with_sectors),
            Self::Edges(finder) => finder.locate(exits, with_sectors),
        }
    }
}

/// Finds rings and sectors of equal angles.
///
/// Short polynomials propose a ring and a sector, and the cosines and sines of their edges confirm
/// them. What lies within [`MARGIN`] of an edge, or was proposed wrongly, is decided by the grid,
/// which defines the bins.
#[derive(Clone, Debug)]
pub(crate) struct EqualAngles {
    grid: HemisphereGrid,
    /// Cosines of the rings' edges by angle from the side's own normal, falling; the pole and the
    /// horizon are no edges.
    ring_cosines: Vec<f64>,
    /// Cosine and sine of the sectors' edges.
    sector_edges: Vec<[f64; 2]>,
    rings_per_radian: f64,
    sectors_per_radian: f64,
}

impl EqualAngles {
    pub(crate) fn new(grid: HemisphereGrid) -> Self {
        let (n_theta, n_phi) = (grid.n_theta(), grid.n_phi());
        let ring_cosines = (0..=n_theta)
            .map(|k| match k {
                0 => f64::INFINITY,
                k if k == n_theta => f64::NEG_INFINITY,
                k => (FRAC_PI_2 * k as f64 / n_theta as f64).cos(),
            })
            .collect();
        let sector_edges = (0..=n_phi)
            .map(|k| {
                let (sin, cos) = (TAU * k as f64 / n_phi as f64).sin_cos();
                [cos, sin]
            })
            .collect();
        Self {
            grid,
            ring_cosines,
            sector_edges,
            rings_per_radian: n_theta as f64 / FRAC_PI_2,
            sectors_per_radian: n_phi as f64 / TAU,
        }
    }

    /// Number of the ring of `side`, from +z, that holds the unit vector `wo`.
    #[inline]
    pub(crate) fn ring(&self, side: Side, wo: DVec3) -> usize {
        let last = self.grid.n_theta() - 1;
        let cos = match side {
            Side::Reflected => wo.z,
            Side::Transmitted => -wo.z,
        }
        .max(0.0);
        let from_normal = ((rough_acos(cos) * self.rings_per_radian) as usize).min(last);
        let above = self.ring_cosines[from_normal] - MARGIN;
        let below = self.ring_cosines[from_normal + 1] + MARGIN;
        if !(below < cos && cos < above) {
            return self.grid.ring_of(side, wo);
        }
        match side {
            Side::Reflected => from_normal,
            Side::Transmitted => last - from_normal,
        }
    }

    /// Number of the sector that holds `wo`.
    #[inline]
    pub(crate) fn sector(&self, wo: DVec3) -> usize {
        let n_phi = self.grid.n_phi();
        let sector = ((rough_azimuth(wo) * self.sectors_per_radian) as usize).min(n_phi - 1);
        let [cos, sin] = self.sector_edges[sector];
        let after_first = cos * wo.y - sin * wo.x;
        let [cos, sin] = self.sector_edges[sector + 1];
        let before_last = sin * wo.x - cos * wo.y;
        // The sum is not below the length of the horizontal component. Of a single sector both
        // edges are the same, and no direction lies between them.
        let length = wo.x.abs() + wo.y.abs();
        let margin = MARGIN * length;
        if after_first > margin && before_last > margin && length > TINY {
            sector
        } else {
            self.grid.sector_of(Side::Reflected, wo)
        }
    }
}

/// Exits of a block.
const BLOCK: usize = 64;

impl EqualAngles {
    /// The same for many directions: rings, and sectors unless azimuths are free.
    #[inline(always)]
    pub(crate) fn locate(&self, exits: &mut ExitColumns, with_sectors: bool) {
        let n = exits.len();
        exits.ring.resize(n, 0);
        exits.sector.resize(n, 0);
        for first in (0..n).step_by(BLOCK) {
            let last = (first + BLOCK).min(n);
            self.locate_rings(exits, first..last);
            if with_sectors {
                self.locate_sectors(exits, first..last);
            }
        }
    }

    #[inline(always)]
    fn locate_rings(&self, exits: &mut ExitColumns, range: Range<usize>) {
        let last = self.grid.n_theta() as i32 - 1;
        let (z, side) = (&exits.wo[2][range.clone()], &exits.side[range.clone()]);
        let rings = &mut exits.ring[range.clone()];
        let mut cosines = [0.0; BLOCK];
        for ((ring, cos), (&z, &side)) in rings.iter_mut().zip(&mut cosines).zip(z.iter().zip(side))
        {
            let along = if side == Side::Reflected { z } else { -z };
            *cos = if along > 0.0 { along } else { 0.0 };
            let from_normal = (rough_acos(*cos) * self.rings_per_radian) as i32;
            *ring = from_normal.clamp(0, last) as u32;
        }
        let mut edges = [[0.0; 2]; BLOCK];
        for (edges, &ring) in edges.iter_mut().zip(rings.iter()) {
            let ring = ring as usize;
            *edges = [self.ring_cosines[ring], self.ring_cosines[ring + 1]];
        }
        let mut is_sure = [true; BLOCK];
        for (k, ring) in rings.iter_mut().enumerate() {
            let [above, below] = edges[k];
            is_sure[k] = (below + MARGIN < cosines[k]) & (cosines[k] < above - MARGIN);
            let transmitted = last as u32 - *ring;
            *ring = if side[k] == Side::Reflected {
                *ring
            } else {
                transmitted
            };
        }
        for (i, _) in range.zip(is_sure).filter(|(_, is_sure)| !is_sure) {
            exits.ring[i] = self.grid.ring_of(exits.side[i], exits.wo(i)) as u32;
        }
    }

    #[inline(always)]
    fn locate_sectors(&self, exits: &mut ExitColumns, range: Range<usize>) {
        let last = self.grid.n_phi() as i32 - 1;
        let [x, y, _] = exits.wo.each_ref().map(|column| &column[range.clone()]);
        let sectors = &mut exits.sector[range.clone()];
        for (sector, (&x, &y)) in sectors.iter_mut().zip(x.iter().zip(y)) {
            let azimuth = rough_azimuth(DVec3::new(x, y, 0.0));
            *sector = ((azimuth * self.sectors_per_radian) as i32).clamp(0, last) as u32;
        }
        let mut edges = [[0.0; 4]; BLOCK];
        for (edges, &sector) in edges.iter_mut().zip(sectors.iter()) {
            let sector = sector as usize;
            let ([c0, s0], [c1, s1]) = (self.sector_edges[sector], self.sector_edges[sector + 1]);
            *edges = [c0, s0, c1, s1];
        }
        let mut is_sure = [true; BLOCK];
        for (k, is_sure) in is_sure.iter_mut().enumerate().take(x.len()) {
            let [c0, s0, c1, s1] = edges[k];
            let after_first = c0 * y[k] - s0 * x[k];
            let before_last = s1 * x[k] - c1 * y[k];
            let length = x[k].abs() + y[k].abs();
            let margin = MARGIN * length;
            *is_sure = (after_first > margin) & (before_last > margin) & (length > TINY);
        }
        for (i, _) in range.zip(is_sure).filter(|(_, is_sure)| !is_sure) {
            exits.sector[i] = self.grid.sector_of(exits.side[i], exits.wo(i)) as u32;
        }
    }
}

/// `acos x` for `0 <= x <= 1` to 7e-5.
///
/// # Source
/// Abramowitz and Stegun 4.4.45.
#[inline(always)]
fn rough_acos(x: f64) -> f64 {
    let polynomial = 1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261_0 - x * 0.018_729_3));
    (1.0 - x).sqrt() * polynomial
}

/// Azimuth from +x to 1e-5, from zero to a full turn; NaN for a vertical direction.
///
/// # Source
/// Abramowitz and Stegun 4.4.47.
#[inline(always)]
fn rough_azimuth(w: DVec3) -> f64 {
    let (a, b) = (w.x.abs(), w.y.abs());
    let (least, greatest) = if a < b { (a, b) } else { (b, a) };
    let t = least / greatest;
    let t2 = t * t;
    let polynomial = 0.999_866_0
        + t2 * (-0.330_299_5 + t2 * (0.180_141_0 + t2 * (-0.085_133_0 + t2 * 0.020_835_1)));
    let octant = t * polynomial;
    // Reflected at the diagonal, at the y axis and at the x axis, by signs: directions come as they like.
    let quadrant = FRAC_PI_4 - (FRAC_PI_4 - octant).copysign(a - b);
    let half = FRAC_PI_2 - (FRAC_PI_2 - quadrant).copysign(w.x);
    PI - (PI - half).copysign(w.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;

    /// Uniform numbers in `[0, 1)`: Weyl's sequence.
    fn fractions(step: f64) -> impl Iterator<Item = f64> {
        (1..).map(move |i| (f64::from(i) * step).fract())
    }

    const GRIDS: [(usize, usize); 9] = [
        (1, 1),
        (1, 2),
        (2, 3),
        (5, 4),
        (18, 36),
        (45, 90),
        (7, 13),
        (9000, 7),
        (11, 36_000),
    ];

    fn check(finder: &EqualAngles, side: Side, wo: DVec3) {
        let grid = finder.grid;
        let (ring, sector) = (finder.ring(side, wo), finder.sector(wo));
        let found = (side.index() * grid.n_theta() + ring) * grid.n_phi() + sector;
        assert_eq!(found, grid.index_of(side, wo), "{grid} {side} {wo:?}");
    }

    #[test]
    fn random_directions_are_found_where_the_grid_puts_them() {
        for (n_theta, n_phi) in GRIDS {
            let finder = EqualAngles::new(HemisphereGrid::new(n_theta, n_phi).unwrap());
            let (u, v) = (fractions(0.618_033_988_7), fractions(0.414_213_562_3));
            for (u, v) in u.zip(v).take(100_000) {
                // Uniform over the sphere, and crowded at the poles and at the horizon.
                let phi = TAU * v;
                for cos in [u, 1.0 - u.powi(6), u.powi(6)] {
                    let sin = (1.0 - cos * cos).sqrt();
                    let wo = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                    check(&finder, Side::Reflected, wo);
                    check(&finder, Side::Transmitted, -wo);
                }
            }
        }
    }

    #[test]
    fn directions_on_and_about_edges_are_found_where_the_grid_puts_them() {
        for (n_theta, n_phi) in GRIDS {
            let grid = HemisphereGrid::new(n_theta, n_phi).unwrap();
            let finder = EqualAngles::new(grid);
            let bins = grid.bins().step_by(1 + grid.len() / 2000);
            for bin in bins {
                for off in [
                    0.0, 1e-16, 1e-15, 1e-12, 4e-10, 9e-10, 1e-9, 1.1e-9, 2e-9, 1e-8, 1.1e-8, 1e-6,
                ] {
                    for sign in [-1.0, 1.0] {
                        let [t0, t1] = bin.theta;
                        let [p0, p1] = bin.phi;
                        // Both in radians and in bin widths, in which snapping is defined.
                        for (dt, dp) in [(off, off), (off * (t1 - t0), off * (p1 - p0))] {
                            let theta = (t0 + sign * dt).clamp(0.0, 2.0 * FRAC_PI_2);
                            let phi = p0 + sign * dp;
                            let middle = (0.5 * (t0 + t1), 0.5 * (p0 + p1));
                            for (theta, phi) in [(theta, middle.1), (middle.0, phi), (theta, phi)] {
                                check(&finder, bin.side, from_spherical(theta, phi));
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn vertical_grazing_and_nearly_vertical_directions_are_found() {
        for (n_theta, n_phi) in GRIDS {
            let finder = EqualAngles::new(HemisphereGrid::new(n_theta, n_phi).unwrap());
            let smalls = [
                0.0, -0.0, 5e-324, -5e-324, 1e-320, 1e-310, -1e-300, 1e-200, 1e-17, -1e-12, 1e-9,
            ];
            for side in Side::BOTH {
                for x in smalls {
                    for y in smalls {
                        for z in [1.0, -1.0, 1.0 + f64::EPSILON] {
                            check(&finder, side, DVec3::new(x, y, z));
                        }
                        check(&finder, side, DVec3::new(1.0, x, y));
                        check(&finder, side, DVec3::new(x, -1.0, y));
                        check(&finder, side, DVec3::new(-1.0, x, y));
                    }
                }
            }
        }
    }
}
