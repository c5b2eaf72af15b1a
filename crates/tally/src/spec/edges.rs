//! Edges: the limits of the bins of a side that are not all of equal angles.

use std::f64::consts::TAU;
use std::sync::{Mutex, PoisonError};

use crate::Side;

/// Distance from an edge within which a direction counts as lying on it, in widths of the bin below.
const SNAP: f64 = 1e-9;

/// Widest a full turn may be off 360 degrees, degrees: rounding.
const ROUNDING_DEG: f64 = 1e-9;

/// Reason for which edges of bins are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SideEdgesError {
    /// They do not ascend from one end of the side to the other.
    #[error(
        "the edges of bins of {side} light must ascend over 90 degrees of polar angle and 360 of azimuth"
    )]
    BadEdges {
        /// The side.
        side: Side,
    },
}

/// Edges of the rings and sectors of one side, degrees.
///
/// # Examples
/// ```
/// use asperity_tally::{HemisphereGrid, Side, SideEdges};
///
/// let reflected = SideEdges::new(Side::Reflected, vec![0.0, 20.0, 40.0, 90.0], vec![0.0, 170.0, 190.0, 360.0])?;
/// let transmitted = SideEdges::new(Side::Transmitted, vec![90.0, 120.0, 150.0, 180.0], vec![0.0, 120.0, 240.0, 360.0])?;
/// let grid = HemisphereGrid::with_edges([reflected, transmitted])?;
/// assert_eq!(grid.theta_edges_deg(Side::Reflected), [0.0, 20.0, 40.0, 90.0]);
/// assert_eq!(grid.phi_edges_deg(Side::Reflected)[1], 170.0);
/// assert_eq!(grid.len(), 18);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SideEdges {
    /// Edges of the rings, degrees from +z.
    pub(crate) theta_deg: Vec<f64>,
    /// Edges of the sectors, degrees; those beyond 360 are a turn further.
    pub(crate) phi_deg: Vec<f64>,
    /// Edges of the rings, radians from +z.
    pub(crate) theta: Vec<f64>,
    /// Edges of the sectors, radians.
    pub(crate) phi: Vec<f64>,
    /// Polar angles from which on a direction belongs to the ring after the first, the second and so on, radians.
    ring_starts: Vec<f64>,
    /// Azimuths from the first edge from which on a direction belongs to the next sector; the last one is the full turn.
    sector_starts: Vec<f64>,
}

/// Angles from which on a direction belongs to the next bin, radians.
#[derive(Clone, Debug, PartialEq)]
pub struct BinStarts {
    /// Polar angles from +z at which the rings after the first begin.
    pub rings: Vec<f64>,
    /// Azimuths from the first edge at which the sectors after the first begin; the last one is the full turn.
    pub sectors: Vec<f64>,
    /// Azimuth of the first edge.
    pub first_edge: f64,
}

/// No edge is `NaN`.
impl Eq for SideEdges {}

impl SideEdges {
    /// Edges of `side`: polar angles from +z, ascending, from 0 to 90 degrees for reflection and from 90 to 180 for transmission; azimuths,
    /// ascending over exactly one turn, of which the first is at least 0 and below 360.
    ///
    /// # Errors
    /// [`SideEdgesError::BadEdges`] if they are not.
    pub fn new(side: Side, theta_deg: Vec<f64>, phi_deg: Vec<f64>) -> Result<Self, SideEdgesError> {
        let start = 90.0 * side.index() as f64;
        let ascends = |edges: &[f64]| edges.windows(2).all(|pair| pair[0] < pair[1]);
        let (first, last) = match phi_deg.as_slice() {
            [first, .., last] => (*first, *last),
            _ => (f64::NAN, f64::NAN),
        };
        let is_turn = (0.0..360.0).contains(&first) && (last - first - 360.0).abs() <= ROUNDING_DEG;
        let spans = theta_deg.first() == Some(&start) && theta_deg.last() == Some(&(start + 90.0));
        if !(is_turn && spans && ascends(&theta_deg) && ascends(&phi_deg)) {
            return Err(SideEdgesError::BadEdges { side });
        }
        let theta: Vec<f64> = theta_deg.iter().map(|deg| deg.to_radians()).collect();
        let phi: Vec<f64> = phi_deg.iter().map(|deg| deg.to_radians()).collect();
        let turned: Vec<f64> = phi.iter().map(|edge| edge - phi[0]).collect();
        let mut sector_starts = starts(&turned);
        // The full turn is the first edge again.
        sector_starts.push(TAU - SNAP * (TAU - turned[turned.len() - 2]));
        Ok(Self {
            ring_starts: starts(&theta),
            sector_starts,
            theta_deg,
            phi_deg,
            theta,
            phi,
        })
    }

    /// Limits of the bins.
    pub(crate) fn bin_starts(&self) -> BinStarts {
        BinStarts {
            rings: self.ring_starts.clone(),
            sectors: self.sector_starts.clone(),
            first_edge: self.phi[0],
        }
    }

    /// Number of the ring that holds the polar angle `theta`.
    pub(crate) fn ring_of(&self, theta: f64) -> usize {
        self.ring_starts.partition_point(|start| *start <= theta)
    }

    /// Number of the sector that holds the azimuth `phi`.
    pub(crate) fn sector_of(&self, phi: f64) -> usize {
        let from_first = (phi - self.phi[0]).rem_euclid(TAU);
        let sector = self
            .sector_starts
            .partition_point(|start| *start <= from_first);
        sector % (self.phi.len() - 1)
    }
}

/// Angles from which on a direction belongs to the bin after each of the inner edges.
fn starts(edges: &[f64]) -> Vec<f64> {
    let inner = edges.windows(2).take(edges.len() - 2);
    inner
        .map(|pair| pair[1] - SNAP * (pair[1] - pair[0]))
        .collect()
}

/// All sets of edges that are in use. Grids are copied freely and refer to them, so that they stay for as long as the program runs.
static IN_USE: Mutex<Vec<&'static [SideEdges; 2]>> = Mutex::new(Vec::new());

/// The one copy of a set of edges.
pub(crate) fn interned(edges: [SideEdges; 2]) -> &'static [SideEdges; 2] {
    let mut in_use = IN_USE.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = in_use.iter().find(|known| ***known == edges) {
        return known;
    }
    let kept: &'static [SideEdges; 2] = Box::leak(Box::new(edges));
    in_use.push(kept);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reflected(theta: &[f64], phi: &[f64]) -> Result<SideEdges, SideEdgesError> {
        SideEdges::new(Side::Reflected, theta.to_vec(), phi.to_vec())
    }

    #[test]
    fn edges_that_do_not_cover_the_side_are_refused() {
        let turn = [10.0, 180.0, 370.0];
        assert!(reflected(&[0.0, 30.0, 90.0], &turn).is_ok());
        for theta in [
            &[0.0][..],
            &[0.0, 80.0],
            &[1.0, 90.0],
            &[0.0, 50.0, 50.0, 90.0],
            &[0.0, f64::NAN, 90.0],
        ] {
            assert!(reflected(theta, &turn).is_err(), "{theta:?}");
        }
        for phi in [
            &[0.0][..],
            &[0.0, 350.0],
            &[-10.0, 350.0],
            &[360.0, 720.0],
            &[0.0, 200.0, 100.0, 360.0],
        ] {
            assert!(reflected(&[0.0, 90.0], phi).is_err(), "{phi:?}");
        }
    }

    #[test]
    fn azimuths_before_the_first_edge_lie_in_the_last_sector() {
        let edges = reflected(&[0.0, 90.0], &[10.0, 30.0, 200.0, 370.0]).unwrap();
        for (phi_deg, sector) in [
            (9.0, 2),
            (10.0, 0),
            (29.9, 0),
            (30.0, 1),
            (200.0, 2),
            (0.0, 2),
            (369.0, 2),
            (10.0 - 1e-9, 0),
        ] {
            assert_eq!(
                edges.sector_of(f64::to_radians(phi_deg)),
                sector,
                "{phi_deg}"
            );
        }
    }

    #[test]
    fn equal_sets_of_edges_are_kept_once() {
        let both = || {
            let transmitted =
                SideEdges::new(Side::Transmitted, vec![90.0, 180.0], vec![7.5, 367.5]);
            [
                reflected(&[0.0, 90.0], &[7.5, 367.5]).unwrap(),
                transmitted.unwrap(),
            ]
        };
        assert!(std::ptr::eq(interned(both()), interned(both())));
    }
}
