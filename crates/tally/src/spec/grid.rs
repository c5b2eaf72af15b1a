//! Grid: bins over the two hemispheres of outgoing directions, of equal angles or between edges that refine around narrow lobes.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt;
use std::str::FromStr;

use asperity_numerics::elementary::{cos, sin};
use asperity_optics::{azimuth, polar_angle};
use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::Side;
use crate::spec::edges::{BinStarts, SideEdges, SideEdgesError, interned};

/// Reason for which a grid of bins is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HemisphereGridError {
    /// A count is zero or too large.
    #[error(
        "the hemisphere cannot have {n_theta} x {n_phi} bins; allowed are 1 to 9000 in theta, 1 to 36000 in phi, 4,000,000 in all"
    )]
    BadCount {
        /// Bins in theta.
        n_theta: usize,
        /// Bins in phi.
        n_phi: usize,
    },
    /// Both sides must have as many rings and sectors.
    #[error(
        "{reflected:?} bins of reflected light do not go with {transmitted:?} of transmitted light; their numbers must agree"
    )]
    UnequalSides {
        /// Rings and sectors of reflected light.
        reflected: [usize; 2],
        /// Rings and sectors of transmitted light.
        transmitted: [usize; 2],
    },
    /// The text is not `THETAxPHI`.
    #[error("`{0}` is not a grid of bins; write it as THETAxPHI, such as 18x36")]
    BadText(String),
    /// The edges are no edges of bins.
    #[error(transparent)]
    Edges(#[from] SideEdgesError),
}

/// One bin of solid angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// The hemisphere.
    pub side: Side,
    /// Polar angles `[min, max]` from +z, radians; within `[0, pi/2]` or `[pi/2, pi]`.
    pub theta: [f64; 2],
    /// Azimuths `[min, max]`, radians; `min` is within `[0, 2 pi)`, or a turn further where edges do not begin at zero.
    pub phi: [f64; 2],
    /// Solid angle, steradians.
    pub solid_angle: f64,
}

impl Bin {
    /// `|cos theta|` averaged over the bin's solid angle.
    #[must_use]
    pub fn mean_abs_cos(&self) -> f64 {
        let [a, b] = self.theta;
        0.5 * (cos(a) + cos(b)).abs()
    }
}

/// `n_theta` by `n_phi` bins on each hemisphere: of equal angles, or between edges that each side has of its own.
///
/// Bins are numbered side by side: first all reflected ones, then all transmitted ones; within a
/// side by theta from +z, and within a theta ring by phi from 0, or from the first edge. A bin holds its lower edges, and a
/// direction that is closer to an edge than 1e-9 bin widths counts as lying on it, so that exact
/// directions fall where exact arithmetic puts them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "SavedGrid", try_from = "SavedGrid")]
pub struct HemisphereGrid {
    n_theta: usize,
    n_phi: usize,
    /// `None` for bins of equal angles.
    edges: Option<&'static [SideEdges; 2]>,
}

impl HemisphereGrid {
    /// `n_theta` bins of polar angle and `n_phi` of azimuth on each hemisphere.
    ///
    /// # Errors
    /// [`HemisphereGridError::BadCount`] if a count is zero or the grid too large.
    pub const fn new(n_theta: usize, n_phi: usize) -> Result<Self, HemisphereGridError> {
        if n_theta == 0
            || n_phi == 0
            || n_theta > 9_000
            || n_phi > 36_000
            || n_theta * n_phi > 4_000_000
        {
            return Err(HemisphereGridError::BadCount { n_theta, n_phi });
        }
        Ok(Self {
            n_theta,
            n_phi,
            edges: None,
        })
    }

    /// Bins between these edges of reflected and of transmitted light. Edges are kept for as long as the program runs, each set once.
    ///
    /// # Errors
    /// [`HemisphereGridError`] if the sides have different numbers of rings or sectors, or the grid is too large.
    pub fn with_edges(edges: [SideEdges; 2]) -> Result<Self, HemisphereGridError> {
        let [reflected, transmitted] = edges
            .each_ref()
            .map(|side| [side.theta_deg.len() - 1, side.phi_deg.len() - 1]);
        if reflected != transmitted {
            return Err(HemisphereGridError::UnequalSides {
                reflected,
                transmitted,
            });
        }
        let [n_theta, n_phi] = reflected;
        Ok(Self {
            edges: Some(interned(edges)),
            ..Self::new(n_theta, n_phi)?
        })
    }

    /// Returns `true` if all bins are of equal angles.
    #[must_use]
    pub const fn has_equal_angles(&self) -> bool {
        self.edges.is_none()
    }

    /// Edges of `side`, unless all bins are of equal angles.
    fn edges(&self, side: Side) -> Option<&'static SideEdges> {
        self.edges.map(|edges| &edges[side.index()])
    }

    /// Limits of the bins of both sides, unless all are of equal angles.
    pub(crate) fn bin_starts(&self) -> Option<[BinStarts; 2]> {
        Some(self.edges?.each_ref().map(SideEdges::bin_starts))
    }

    /// Bins of polar angle on one hemisphere.
    #[must_use]
    pub const fn n_theta(&self) -> usize {
        self.n_theta
    }

    /// Bins of azimuth.
    #[must_use]
    pub const fn n_phi(&self) -> usize {
        self.n_phi
    }

    /// Bins on one hemisphere.
    #[must_use]
    pub const fn bins_per_side(&self) -> usize {
        self.n_theta * self.n_phi
    }

    /// Bins on both hemispheres.
    #[must_use]
    pub const fn len(&self) -> usize {
        2 * self.bins_per_side()
    }

    /// Returns `false`: a grid has at least one bin per side.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        false
    }

    /// Number of the bin that holds the unit vector `wo`.
    ///
    /// `side` decides for a direction at grazing, where the sign of `z` may have been lost.
    #[must_use]
    pub fn index_of(&self, side: Side, wo: DVec3) -> usize {
        (side.index() * self.n_theta + self.ring_of(side, wo)) * self.n_phi
            + self.sector_of(side, wo)
    }

    /// Number of the ring of `side`, from +z, that holds the unit vector `wo`.
    pub(crate) fn ring_of(&self, side: Side, wo: DVec3) -> usize {
        let theta = polar_angle(wo);
        if let Some(edges) = self.edges(side) {
            return edges.ring_of(theta);
        }
        let fraction = (theta - FRAC_PI_2 * side.index() as f64) / FRAC_PI_2;
        // The pole and the horizon are in range.
        snapped_floor(fraction.max(0.0) * self.n_theta as f64).min(self.n_theta - 1)
    }

    /// Number of the sector of `side` that holds `wo`.
    pub(crate) fn sector_of(&self, side: Side, wo: DVec3) -> usize {
        if let Some(edges) = self.edges(side) {
            return edges.sector_of(azimuth(wo));
        }
        // A full turn is zero: a direction that snaps up to it belongs to the first bin.
        snapped_floor(azimuth(wo) / TAU * self.n_phi as f64) % self.n_phi
    }

    /// The bin of number `index`.
    ///
    /// # Panics
    /// If `index >= self.len()`.
    #[must_use]
    pub fn bin(&self, index: usize) -> Bin {
        assert!(
            index < self.len(),
            "bin {index} of a grid of {}",
            self.len()
        );
        let (row, sector) = (index / self.n_phi, index % self.n_phi);
        let side = Side::BOTH[row / self.n_theta];
        let ring = row % self.n_theta;
        let theta = [ring, ring + 1].map(|k| self.theta_edge(side, k));
        let phi = [sector, sector + 1].map(|k| self.phi_edge(side, k));
        // cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2) does not cancel near the pole.
        let band = 2.0 * sin(0.5 * (theta[0] + theta[1])) * sin(0.5 * (theta[1] - theta[0]));
        Bin {
            side,
            theta,
            phi,
            solid_angle: match self.edges {
                Some(_) => band * (phi[1] - phi[0]),
                None => band * TAU / self.n_phi as f64,
            },
        }
    }

    /// Edge number `k` of the rings of `side`, radians from +z.
    pub(crate) fn theta_edge(&self, side: Side, k: usize) -> f64 {
        match self.edges(side) {
            Some(edges) => edges.theta[k],
            // One multiplication and one division: the last edge is exact.
            None => FRAC_PI_2 * side.index() as f64 + FRAC_PI_2 * k as f64 / self.n_theta as f64,
        }
    }

    /// Edge number `k` of the sectors of `side`, radians.
    pub(crate) fn phi_edge(&self, side: Side, k: usize) -> f64 {
        match self.edges(side) {
            Some(edges) => edges.phi[k],
            None => TAU * k as f64 / self.n_phi as f64,
        }
    }

    /// Edge number `k` of the rings of `side`, degrees from +z.
    pub(crate) fn theta_edge_deg(&self, side: Side, k: usize) -> f64 {
        match self.edges(side) {
            Some(edges) => edges.theta_deg[k],
            None => 90.0 * side.index() as f64 + 90.0 * k as f64 / self.n_theta as f64,
        }
    }

    /// Edge number `k` of the sectors of `side`, degrees.
    pub(crate) fn phi_edge_deg(&self, side: Side, k: usize) -> f64 {
        match self.edges(side) {
            Some(edges) => edges.phi_deg[k],
            None => 360.0 * k as f64 / self.n_phi as f64,
        }
    }

    /// The part of `of_ring` that falls into a sector of `side`, if it is spread evenly over azimuth.
    #[must_use]
    pub fn part_of_ring(&self, side: Side, sector: usize, of_ring: f64) -> f64 {
        match self.edges(side) {
            Some(edges) => of_ring * (edges.phi[sector + 1] - edges.phi[sector]) / TAU,
            None => of_ring / self.n_phi as f64,
        }
    }

    /// All bins in order.
    pub fn bins(&self) -> impl Iterator<Item = Bin> + '_ {
        (0..self.len()).map(|i| self.bin(i))
    }

    /// Edges of the theta bins of `side` in degrees, `n_theta + 1` of them, ascending.
    #[must_use]
    pub fn theta_edges_deg(&self, side: Side) -> Vec<f64> {
        (0..=self.n_theta)
            .map(|k| self.theta_edge_deg(side, k))
            .collect()
    }

    /// Edges of the phi bins of `side` in degrees, `n_phi + 1` of them, ascending. The last is a turn further than the first, which need not
    /// be 0 where bins are not of equal angles.
    #[must_use]
    pub fn phi_edges_deg(&self, side: Side) -> Vec<f64> {
        (0..=self.n_phi)
            .map(|k| self.phi_edge_deg(side, k))
            .collect()
    }
}

impl Default for HemisphereGrid {
    /// 18 x 36: bins of 5 by 10 degrees.
    fn default() -> Self {
        Self {
            n_theta: 18,
            n_phi: 36,
            edges: None,
        }
    }
}

/// The numbers of rings and sectors alone.
impl fmt::Display for HemisphereGrid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.n_theta, self.n_phi)
    }
}

impl FromStr for HemisphereGrid {
    type Err = HemisphereGridError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let bad = || HemisphereGridError::BadText(text.to_owned());
        let (theta, phi) = text.split_once(['x', 'X']).ok_or_else(bad)?;
        let count = |part: &str| part.trim().parse().map_err(|_| bad());
        Self::new(count(theta)?, count(phi)?)
    }
}

/// A grid as it is written: as text, or by the edges of both sides.
#[derive(Serialize, Deserialize)]
#[serde(
    untagged,
    expecting = "a grid of bins is THETAxPHI, such as 18x36, or the edges of both sides"
)]
enum SavedGrid {
    Even(String),
    Edges([SavedEdges; 2]),
}

#[derive(Serialize, Deserialize)]
struct SavedEdges {
    theta_deg: Vec<f64>,
    phi_deg: Vec<f64>,
}

impl From<HemisphereGrid> for SavedGrid {
    fn from(grid: HemisphereGrid) -> Self {
        match grid.edges {
            None => Self::Even(grid.to_string()),
            Some(edges) => Self::Edges(edges.each_ref().map(|side| SavedEdges {
                theta_deg: side.theta_deg.clone(),
                phi_deg: side.phi_deg.clone(),
            })),
        }
    }
}

impl TryFrom<SavedGrid> for HemisphereGrid {
    type Error = HemisphereGridError;

    fn try_from(saved: SavedGrid) -> Result<Self, Self::Error> {
        let [reflected, transmitted] = match saved {
            SavedGrid::Even(text) => return text.parse(),
            SavedGrid::Edges(edges) => edges,
        };
        let of = |side, saved: SavedEdges| SideEdges::new(side, saved.theta_deg, saved.phi_deg);
        Self::with_edges([
            of(Side::Reflected, reflected)?,
            of(Side::Transmitted, transmitted)?,
        ])
    }
}

/// Whole part of `x >= 0`, where anything within 1e-9 below a whole number counts as that number.
fn snapped_floor(x: f64) -> usize {
    (x + 1e-9) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;
    use std::f64::consts::PI;

    #[test]
    fn solid_angles_add_to_the_sphere() {
        for (n_theta, n_phi) in [(1, 1), (18, 36), (7, 13), (900, 4)] {
            let grid = HemisphereGrid::new(n_theta, n_phi).unwrap();
            let total: f64 = grid.bins().map(|b| b.solid_angle).sum();
            assert!((total - 4.0 * PI).abs() < 1e-11, "{total}");
        }
    }

    #[test]
    fn every_bin_holds_its_centre_and_its_lower_edges() {
        let grid = HemisphereGrid::new(18, 36).unwrap();
        for (i, bin) in grid.bins().enumerate() {
            let [t0, t1] = bin.theta;
            let [p0, p1] = bin.phi;
            let centre = from_spherical(0.5 * (t0 + t1), 0.5 * (p0 + p1));
            assert_eq!(grid.index_of(bin.side, centre), i);
            if t0 > 0.0 {
                assert_eq!(grid.index_of(bin.side, from_spherical(t0, p0)), i);
            }
        }
    }

    #[test]
    fn edges_in_degrees_are_exact() {
        let grid = HemisphereGrid::new(18, 36).unwrap();
        assert_eq!(grid.theta_edges_deg(Side::Reflected)[6], 30.0);
        assert_eq!(grid.theta_edges_deg(Side::Reflected)[18], 90.0);
        assert_eq!(grid.theta_edges_deg(Side::Transmitted)[0], 90.0);
        assert_eq!(grid.theta_edges_deg(Side::Transmitted)[18], 180.0);
        assert_eq!(grid.phi_edges_deg(Side::Reflected)[36], 360.0);
    }

    #[test]
    fn grazing_and_vertical_directions_have_a_bin() {
        let grid = HemisphereGrid::new(18, 36).unwrap();
        assert_eq!(grid.index_of(Side::Reflected, DVec3::Z), 0);
        assert_eq!(grid.index_of(Side::Reflected, DVec3::X), 17 * 36);
        assert_eq!(grid.index_of(Side::Transmitted, DVec3::X), 18 * 36);
        assert_eq!(grid.index_of(Side::Transmitted, DVec3::NEG_Z), 35 * 36);
        assert_eq!(
            grid.index_of(Side::Reflected, DVec3::new(1.0, -1e-300, 1e-300)),
            17 * 36
        );
    }

    /// Narrow bins about 30 and 160 degrees; azimuths begin at 20 degrees.
    fn uneven() -> HemisphereGrid {
        let phi = vec![20.0, 150.0, 199.0, 201.0, 250.0, 380.0];
        let reflected = vec![0.0, 20.0, 29.0, 29.99, 30.01, 31.0, 90.0];
        let transmitted = vec![90.0, 140.0, 158.0, 159.9, 160.1, 170.0, 180.0];
        HemisphereGrid::with_edges([
            SideEdges::new(Side::Reflected, reflected, phi.clone()).unwrap(),
            SideEdges::new(Side::Transmitted, transmitted, phi).unwrap(),
        ])
        .unwrap()
    }

    #[test]
    fn bins_between_edges_cover_the_sphere_and_hold_their_lower_edges() {
        let grid = uneven();
        assert_eq!([grid.n_theta(), grid.n_phi()], [6, 5]);
        let total: f64 = grid.bins().map(|b| b.solid_angle).sum();
        assert!((total - 4.0 * PI).abs() < 1e-12, "{total}");
        for (i, bin) in grid.bins().enumerate() {
            let [t0, t1] = bin.theta;
            let [p0, p1] = bin.phi;
            let centre = from_spherical(0.5 * (t0 + t1), 0.5 * (p0 + p1));
            assert_eq!(grid.index_of(bin.side, centre), i);
            if t0 > 0.0 {
                assert_eq!(grid.index_of(bin.side, from_spherical(t0, p0)), i);
            }
            let filter_edges = grid.theta_edges_deg(bin.side);
            assert_eq!(filter_edges[i / 5 % 6].to_radians(), t0);
        }
        assert_eq!(grid.index_of(Side::Transmitted, DVec3::NEG_Z) / 5, 11);
        for side in Side::BOTH {
            let parts = (0..5).map(|sector| grid.part_of_ring(side, sector, 3.0));
            assert!((parts.sum::<f64>() - 3.0).abs() < 1e-15);
        }
    }

    #[test]
    fn sides_of_different_numbers_of_bins_are_refused() {
        let side = |side: Side, theta: Vec<f64>| {
            SideEdges::new(side, theta, vec![0.0, 180.0, 360.0]).unwrap()
        };
        let found = HemisphereGrid::with_edges([
            side(Side::Reflected, vec![0.0, 90.0]),
            side(Side::Transmitted, vec![90.0, 100.0, 180.0]),
        ]);
        assert!(found.unwrap_err().to_string().contains("must agree"));
    }

    #[test]
    fn text_is_theta_by_phi() {
        assert_eq!("9x12".parse::<HemisphereGrid>(), HemisphereGrid::new(9, 12));
        assert_eq!(HemisphereGrid::default().to_string(), "18x36");
        assert!("9".parse::<HemisphereGrid>().is_err());
        assert!("0x4".parse::<HemisphereGrid>().is_err());
        assert!("9x-1".parse::<HemisphereGrid>().is_err());
    }
}
