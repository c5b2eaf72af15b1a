use std::f64::consts::{FRAC_PI_2, TAU};

use asperity_optics::from_spherical;

use super::*;
use crate::{Event, EventPath, Exit, SideEdges};

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

fn check(finder: &BinFinder, exits: &mut ExitColumns, side: Side, wo: DVec3) {
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
fn check_columns(finder: &BinFinder, mut exits: ExitColumns) {
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
fn random_directions_in_bins_of_equal_angles_are_found_where_the_grid_puts_them() {
    for (n_theta, n_phi) in GRIDS {
        let finder = BinFinder::new(HemisphereGrid::new(n_theta, n_phi).unwrap());
        let mut exits = ExitColumns::default();
        let (u, v) = (fractions(0.618_033_988_7), fractions(0.414_213_562_3));
        for (u, v) in u.zip(v).take(100_000) {
            // Uniform over the sphere, and crowded at the poles and at the horizon.
            let phi = TAU * v;
            for cos in [u, 1.0 - u.powi(6), u.powi(6)] {
                let sin = (1.0 - cos * cos).sqrt();
                let wo = DVec3::new(sin * phi.cos(), sin * phi.sin(), cos);
                check(&finder, &mut exits, Side::Reflected, wo);
                check(&finder, &mut exits, Side::Transmitted, -wo);
            }
        }
        check_columns(&finder, exits);
    }
}

#[test]
fn directions_on_and_about_edges_are_found_where_the_grid_puts_them() {
    for (n_theta, n_phi) in GRIDS {
        let grid = HemisphereGrid::new(n_theta, n_phi).unwrap();
        let finder = BinFinder::new(grid);
        let mut exits = ExitColumns::default();
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
                            check(&finder, &mut exits, bin.side, from_spherical(theta, phi));
                        }
                    }
                }
            }
        }
        check_columns(&finder, exits);
    }
}

#[test]
fn vertical_grazing_and_nearly_vertical_directions_are_found() {
    for (n_theta, n_phi) in GRIDS {
        let finder = BinFinder::new(HemisphereGrid::new(n_theta, n_phi).unwrap());
        let mut exits = ExitColumns::default();
        let smalls = [
            0.0, -0.0, 5e-324, -5e-324, 1e-320, 1e-310, -1e-300, 1e-200, 1e-17, -1e-12, 1e-9,
        ];
        for side in Side::BOTH {
            for x in smalls {
                for y in smalls {
                    for z in [1.0, -1.0, 1.0 + f64::EPSILON] {
                        check(&finder, &mut exits, side, DVec3::new(x, y, z));
                    }
                    check(&finder, &mut exits, side, DVec3::new(1.0, x, y));
                    check(&finder, &mut exits, side, DVec3::new(x, -1.0, y));
                    check(&finder, &mut exits, side, DVec3::new(-1.0, x, y));
                }
            }
        }
        check_columns(&finder, exits);
    }
}

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

/// Grids with few and with many edges per bucket.
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
                SideEdges::new(Side::Reflected, steps([0.0, 90.0], rings), phi.clone()).unwrap(),
                SideEdges::new(Side::Transmitted, steps([90.0, 180.0], rings), phi).unwrap(),
            ])
            .unwrap()
        })
        .collect()
}

#[test]
fn random_directions_between_uneven_edges_are_found_where_the_grid_puts_them() {
    for grid in grids().into_iter().chain(large_grids()) {
        let finder = BinFinder::new(grid);
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
fn directions_on_and_about_uneven_edges_and_vertical_ones_are_found() {
    for grid in grids() {
        let finder = BinFinder::new(grid);
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
