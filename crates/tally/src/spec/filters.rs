//! Filters by direction: the geometry of bins, rings and in-plane bins on one side of the surface.
//!
//! Each filter has a number of entries and their edges, those of its grid. Views know their geometry through the filter
//! alone, whether bins are of equal angles or refine around narrow lobes.

use crate::{Bin, HemisphereGrid, Side};
use asperity_numerics::elementary::sin;

/// Bins of the hemisphere on one side, ring by ring from +z, within a ring by azimuth from 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BinFilter {
    pub(crate) grid: HemisphereGrid,
    pub(crate) side: Side,
}

impl BinFilter {
    /// The bins of `grid` on `side`.
    #[must_use]
    pub const fn new(grid: HemisphereGrid, side: Side) -> Self {
        Self { grid, side }
    }

    /// Rings of polar angle by sectors of azimuth.
    #[must_use]
    pub const fn shape(&self) -> [usize; 2] {
        [self.grid.n_theta(), self.grid.n_phi()]
    }

    /// Number of bins.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.grid.bins_per_side()
    }

    /// Returns `false`: a grid has at least one bin per side.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Bin `i` with its edges in radians and its solid angle.
    #[must_use]
    pub fn bin(&self, i: usize) -> Bin {
        self.grid.bin(self.side.index() * self.len() + i)
    }

    /// Edges `[min, max]` of bin `i` in polar angle from +z, degrees; exact.
    #[must_use]
    pub fn theta_deg(&self, i: usize) -> [f64; 2] {
        let ring = i / self.grid.n_phi();
        [ring, ring + 1].map(|k| self.grid.theta_edge_deg(self.side, k))
    }

    /// Edges `[min, max]` of bin `i` in azimuth, degrees; exact.
    #[must_use]
    pub fn phi_deg(&self, i: usize) -> [f64; 2] {
        let sector = i % self.grid.n_phi();
        [sector, sector + 1].map(|k| self.grid.phi_edge_deg(self.side, k))
    }

    /// Solid angle of bin `i` weighted with the mean `|cos theta|`, steradians: flux over it is a BSDF.
    #[must_use]
    pub fn projected_solid_angle(&self, i: usize) -> f64 {
        let bin = self.bin(i);
        bin.solid_angle * bin.mean_abs_cos()
    }
}

/// Rings of polar angle over all azimuths on one side, from +z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingFilter {
    pub(crate) grid: HemisphereGrid,
    pub(crate) side: Side,
}

impl RingFilter {
    /// Number of rings.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.grid.n_theta()
    }

    /// Returns `false`: a grid has at least one ring.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Edges `[min, max]` of ring `i` in polar angle from +z, degrees; exact.
    #[must_use]
    pub fn theta_deg(&self, i: usize) -> [f64; 2] {
        [i, i + 1].map(|k| self.grid.theta_edge_deg(self.side, k))
    }

    /// Edges `[min, max]` of ring `i` in polar angle from +z, radians.
    #[must_use]
    pub fn theta(&self, i: usize) -> [f64; 2] {
        [i, i + 1].map(|k| self.grid.theta_edge(self.side, k))
    }
}

/// Bins along the in-plane slice of one side, by signed angle from the side's own normal (+z for
/// reflection, -z for transmission) from -90 to +90 degrees; positive is forward, the way the light
/// travels horizontally.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InPlaneFilter {
    pub(crate) grid: HemisphereGrid,
    pub(crate) half_width: f64,
    pub(crate) side: Side,
}

impl InPlaneFilter {
    /// Number of bins: twice that of rings.
    #[must_use]
    pub const fn len(&self) -> usize {
        2 * self.grid.n_theta()
    }

    /// Returns `false`: a grid has at least one ring.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Angle between either edge of the slice and the plane of incidence, radians.
    #[must_use]
    pub const fn half_width(&self) -> f64 {
        self.half_width
    }

    /// Edges `[min, max]` of bin `i`, signed degrees; exact.
    #[must_use]
    pub fn theta_deg(&self, i: usize) -> [f64; 2] {
        let rings = self.grid.n_theta();
        let from_normal = |k: usize| match self.side {
            // Not by the angle from +z: bins of equal angles are the same on both sides.
            _ if self.grid.has_equal_angles() => 90.0 * k as f64 / rings as f64,
            Side::Reflected => self.grid.theta_edge_deg(self.side, k),
            Side::Transmitted => 180.0 - self.grid.theta_edge_deg(self.side, rings - k),
        };
        [i, i + 1].map(|k| match k.checked_sub(rings) {
            Some(k) => from_normal(k),
            None => -from_normal(rings - k),
        })
    }

    /// The middle of bin `i`, signed degrees.
    #[must_use]
    pub fn centre_deg(&self, i: usize) -> f64 {
        let [from, to] = self.theta_deg(i);
        0.5 * (from + to)
    }

    /// Solid angle of bin `i`, steradians.
    #[must_use]
    pub fn solid_angle(&self, i: usize) -> f64 {
        let [a, b] = self.theta_deg(i).map(|deg| deg.to_radians().abs());
        let band = 2.0 * sin(0.5 * (a + b)) * sin((0.5 * (b - a)).abs());
        2.0 * self.half_width * band
    }

    /// Number of the bin over `ring` of polar angle, counted from +z, on one half of the plane of
    /// incidence.
    pub(crate) const fn number(&self, ring: usize, half: Half) -> usize {
        let n = self.grid.n_theta();
        // Rings count from +z; the in-plane angle counts from the side's own normal.
        let from_normal = match self.side {
            Side::Reflected => ring,
            Side::Transmitted => n - 1 - ring,
        };
        match half {
            Half::Forward => n + from_normal,
            Half::Backward => n - 1 - from_normal,
        }
    }
}

/// A half of the plane of incidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Half {
    /// The half that the light travels towards.
    Forward,
    /// The half that it comes from.
    Backward,
}

impl Half {
    pub(crate) const BOTH: [Self; 2] = [Self::Backward, Self::Forward];
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SideEdges;

    #[test]
    fn in_plane_bins_are_symmetric_about_the_normal() {
        let bins = InPlaneFilter {
            grid: HemisphereGrid::default(),
            half_width: 5_f64.to_radians(),
            side: Side::Reflected,
        };
        assert_eq!(bins.theta_deg(0), [-90.0, -85.0]);
        assert_eq!(bins.theta_deg(35), [85.0, 90.0]);
        assert_eq!(bins.solid_angle(0), bins.solid_angle(35));
        let expected = 10_f64.to_radians() * (1.0 - 5_f64.to_radians().cos());
        assert!((bins.solid_angle(18) - expected).abs() < 1e-15);
    }

    #[test]
    fn edges_of_filters_are_those_of_the_grid() {
        let grid = HemisphereGrid::new(7, 13).unwrap();
        for side in Side::BOTH {
            let bins = BinFilter { grid, side };
            let [theta, phi] = [grid.theta_edges_deg(side), grid.phi_edges_deg(side)];
            for i in 0..bins.len() {
                let (ring, sector) = (i / 13, i % 13);
                assert_eq!(bins.theta_deg(i), [theta[ring], theta[ring + 1]]);
                assert_eq!(bins.phi_deg(i), [phi[sector], phi[sector + 1]]);
                assert_eq!(bins.bin(i).side, side);
            }
        }
    }

    #[test]
    fn in_plane_bins_between_edges_mirror_them_at_the_normal() {
        let phi = vec![0.0, 360.0];
        let grid = HemisphereGrid::with_edges([
            SideEdges::new(Side::Reflected, vec![0.0, 10.0, 90.0], phi.clone()).unwrap(),
            SideEdges::new(Side::Transmitted, vec![90.0, 165.0, 180.0], phi).unwrap(),
        ])
        .unwrap();
        for (side, near) in [(Side::Reflected, 10.0), (Side::Transmitted, 15.0)] {
            let bins = InPlaneFilter {
                grid,
                half_width: 0.1,
                side,
            };
            let found: Vec<_> = (0..4).map(|i| bins.theta_deg(i)).collect();
            let expected = [[-90.0, -near], [-near, 0.0], [0.0, near], [near, 90.0]];
            assert_eq!(found, expected);
            let rings = RingFilter { grid, side };
            for ring in 0..2 {
                let [from, to] = rings.theta_deg(ring);
                let [lower, upper] = bins.theta_deg(bins.number(ring, Half::Forward));
                let expected = match side {
                    Side::Reflected => [from, to],
                    Side::Transmitted => [180.0 - to, 180.0 - from],
                };
                assert_eq!([lower, upper], expected);
            }
        }
    }
}
