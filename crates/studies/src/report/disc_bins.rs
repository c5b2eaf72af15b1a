//! Bins of a tally in the order in which discs show them.

use asperity_plot::DiscBins;
use asperity_tally::{Side, TallySpec};

/// Edges of the bins of one side, ring by ring from its normal.
pub(crate) fn disc_edges(spec: &TallySpec, side: Side) -> DiscBins {
    let theta = spec.grid().theta_edges_deg(side).into_iter();
    DiscBins {
        rings_deg: match side {
            Side::Reflected => theta.collect(),
            Side::Transmitted => theta.rev().map(|theta| 180.0 - theta).collect(),
        },
        sectors_deg: spec.grid().phi_edges_deg(side),
    }
}

/// Numbers of the bins of `side`, ring by ring from its normal, and within a ring by azimuth from 0.
pub(crate) fn disc_bins(spec: &TallySpec, side: Side) -> impl Iterator<Item = usize> + use<> {
    let [rings, sectors] = [spec.grid().n_theta(), spec.grid().n_phi()];
    (0..rings).flat_map(move |ring| {
        let row = row_of(side, ring, rings);
        (0..sectors).map(move |sector| row * sectors + sector)
    })
}

/// Row of the grid's bins that holds ring `ring` of `rings` from the normal of `side`: its rings count from +z, first
/// those of reflected light.
const fn row_of(side: Side, ring: usize, rings: usize) -> usize {
    match side {
        Side::Reflected => ring,
        Side::Transmitted => rings + rings - 1 - ring,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::HemisphereGrid;
    use std::f64::consts::{FRAC_PI_2, PI};

    #[test]
    fn rings_of_a_disc_count_from_the_normal_of_its_side() {
        let grid = HemisphereGrid::new(3, 4).unwrap();
        for (side, ring, edge) in [
            (Side::Reflected, 0, 0.0),
            (Side::Reflected, 2, FRAC_PI_2),
            (Side::Transmitted, 0, PI),
            (Side::Transmitted, 2, FRAC_PI_2),
        ] {
            let bin = grid.bin(row_of(side, ring, 3) * 4);
            assert_eq!(bin.side, side);
            let spec = TallySpec::new(grid, 0.1).unwrap();
            let edges = disc_edges(&spec, side);
            let from_normal = match side {
                Side::Reflected => bin.theta,
                Side::Transmitted => bin.theta.map(|theta| PI - theta),
            };
            for edge in [edges.rings_deg[ring], edges.rings_deg[ring + 1]] {
                let near = |theta: &f64| (theta.to_degrees() - edge).abs() < 1e-9;
                assert!(from_normal.iter().any(near), "{edge} {from_normal:?}");
            }
            assert!(bin.theta.contains(&edge), "{side} {ring}: {:?}", bin.theta);
        }
    }
}
