//! Slope tables against closed forms of Gaussian and GGX slopes, and against sums over their cells.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI, TAU};

use asperity_optics::from_spherical;

use super::*;
use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::slopes::SlopeCovariance;

fn even(reach: f64, cells: usize) -> SlopeGrid {
    let edges = || {
        (0..=cells)
            .map(|i| reach * (2.0 * i as f64 / cells as f64 - 1.0))
            .collect()
    };
    SlopeGrid::new([edges(), edges()]).unwrap()
}

/// Independent Gaussian slopes of these deviations, with the exact mass of each cell.
fn gaussian([dx, dy]: [f64; 2], cells: usize) -> SlopeTable {
    let grid = even(6.0 * dx.max(dy), cells);
    let masses = [dx, dy].map(|deviation| {
        let below =
            |s: f64| 0.5 * asperity_numerics::elementary::erfc(-s / deviation * FRAC_1_SQRT_2);
        let edges = &grid.edges()[0];
        edges
            .windows(2)
            .map(|pair| below(pair[1]) - below(pair[0]))
            .collect::<Vec<f64>>()
    });
    let [of_x, of_y] = masses;
    let weights: Vec<f64> = of_y
        .iter()
        .flat_map(|y| of_x.iter().map(move |x| x * y))
        .collect();
    SlopeTable::new(grid, &weights).unwrap()
}

/// GGX slopes with `alpha`, cell by cell from their density at 4 x 4 points.
fn ggx(alpha: f64, reach: f64, cells: usize) -> SlopeTable {
    let grid = even(reach, cells);
    let weight = |cell: usize| {
        let [low, high] = grid.corners(cell);
        let at = |i: usize, j: usize| {
            let u = DVec2::new(i as f64 + 0.5, j as f64 + 0.5) / 4.0;
            let s = low + u * (high - low);
            (alpha * alpha + s.length_squared()).powi(-2)
        };
        (0..16).map(|k| at(k / 4, k % 4)).sum::<f64>()
    };
    let weights: Vec<f64> = (0..grid.len()).map(weight).collect();
    SlopeTable::new(grid, &weights).unwrap()
}

/// Three facets in a plane and one across: skewed along both axes.
fn skewed() -> SlopeTable {
    let grid =
        SlopeGrid::new([vec![-1.0, -0.3, 0.0, 0.1, 0.5], vec![-0.4, -0.1, 0.2, 0.9]]).unwrap();
    let weights = [1.0, 0.0, 4.0, 2.0, 3.0, 5.0, 9.0, 0.0, 2.0, 1.0, 0.0, 1.0];
    SlopeTable::new(grid, &weights).unwrap().level()
}

/// A variance that rises by `v` adds `v p(mu) / 2` to `E[max(0, s - mu)]`: a table adds `h^2 / 6` per axis, so `h^2 / 12 p` on average over
/// where the threshold lies in its cell, and never more than `h^2 / 8 p`.
#[test]
fn a_table_of_gaussian_slopes_has_beckmanns_lambda() {
    let deviations = [0.35, 0.2];
    let cells = 240;
    let table = gaussian(deviations, cells);
    let h = 2.0 * 6.0 * 0.35 / cells as f64;
    let covariance = SlopeCovariance::new(0.35 * 0.35, 0.04, 0.0).unwrap();
    let beckmann = Beckmann::new(covariance);
    for theta in [0.3, 0.7, 1.2, 1.5, 2.0, 3.0] {
        for phi in [0.0, 0.4, FRAC_PI_2, 2.5, 4.0] {
            let w = from_spherical(theta, phi);
            let (found, expected) = (table.lambda(w), beckmann.lambda(w));
            let mu = (w.z / w.truncate().length()).abs();
            let variance = covariance.variance_along(w.truncate().normalize());
            let p = (-0.5 * mu * mu / variance).exp() / (TAU * variance).sqrt();
            // Both axes add their cells; densities change by a third over half a cell at six deviations.
            let allowed = 2.0 * h * h / 8.0 * 1.4 * p / mu + 1e-9;
            assert!(
                (found - expected).abs() < allowed,
                "{theta} {phi}: {found} {expected} {allowed}"
            );
        }
    }
    // Middles of cells add a twelfth of h^2 to the variance (Sheppard), and the spread within cells another.
    let [xx, xy, yy] = table.second_moments();
    assert!((xx - 0.35 * 0.35 - h * h / 6.0).abs() < 1e-7 && xy.abs() < 1e-15);
    assert!((yy - 0.04 - h * h / 6.0).abs() < 1e-7);
    // D within a cell differs by half a cell times its logarithmic derivative.
    for (x, y) in [(0.1, 0.05), (-0.3, 0.2), (0.5, -0.4)] {
        let m = DVec3::new(-x, -y, 1.0).normalize();
        let rate = f64::abs(x) / (0.35 * 0.35) + f64::abs(y) / 0.04;
        let ratio = table.d(m) / beckmann.d(m);
        assert!((ratio - 1.0).abs() < 0.5 * h * rate * 1.2, "{ratio}");
    }
}

/// `G1 = 2 / (1 + sqrt(1 + alpha^2 tan^2))`, Walter et al. 2007, Eq. 34. Beyond the reach `S` lies `alpha^2 / (alpha^2 + S^2)` of the slopes,
/// and of the excess at most the mean of `q` beyond: in the marginal `p(q) = alpha^2 / 2 (alpha^2 + q^2)^(-3/2)`, `alpha^2 / (2 S)`.
#[test]
fn a_table_of_ggx_slopes_has_the_closed_form_of_g1() {
    let (alpha, reach) = (0.3, 24.0);
    let table = ggx(alpha, reach, 1600);
    for theta in [0.4, 1.0, 1.3] {
        for phi in [0.0, 0.9] {
            let w = from_spherical(theta, phi);
            let tan = f64::tan(theta);
            let expected = 2.0 / (1.0 + (1.0 + (alpha * tan).powi(2)).sqrt());
            let found = 1.0 / (1.0 + table.lambda(w));
            // Lost in corners outside and beyond, and what cells of a tenth of alpha add
            let truncated = tan * alpha * alpha / (2.0 * reach);
            let h: f64 = 2.0 * reach / 1600.0;
            let allowed = truncated + h * h / 8.0 * tan / (2.0 * alpha);
            assert!(
                (found - expected).abs() < allowed,
                "{theta}: {found} {expected} {allowed}"
            );
            assert!(allowed < 0.02 * expected);
        }
    }
}

/// `int D cos = 1`, over directions: Simpson's rule would not do over jumps; sums over 1000^2 directions of a table with few
/// cells err where cells' edges pass, by about the edges' length times the square root of the area of a step.
#[test]
fn projected_facets_cover_the_mean_plane_once() {
    let table = skewed();
    let (n, mut sum) = (1000, 0.0);
    for i in 0..n {
        // In u = tan^2 / (1 + tan^2), d(Omega) cos = du dphi / 2
        let u = (f64::from(i) + 0.5) / f64::from(n);
        let theta = u.sqrt().asin();
        for j in 0..n {
            let phi = TAU * (f64::from(j) + 0.5) / f64::from(n);
            sum += table.d(from_spherical(theta, phi));
        }
    }
    let total = sum * PI / f64::from(n * n);
    println!("{total}");
    assert!((total - 1.0).abs() < 2e-3);
    assert!((table.masses().iter().sum::<f64>() - 1.0).abs() < 1e-14);
}

/// Facets that face `w`, less those behind that they hide, cover the projection of the mean plane once: `E[max(0, 1 - t . s)] = 1 + Lambda`,
/// with `t = tan(theta)` along the azimuth. By sums over 400^2 points of each cell.
#[test]
fn visible_facets_cover_the_projected_plane_once() {
    let table = skewed();
    assert!(table.mean().iter().all(|mean| mean.abs() < 1e-15));
    for theta in [0.5, 1.2, 1.45] {
        for phi in [0.0, 0.8, PI, 4.5] {
            let w = from_spherical(theta, phi);
            let t = w.truncate() / w.z;
            let n = 400;
            let facing: f64 = (0..table.grid().len())
                .filter(|&cell| table.masses()[cell] > 0.0)
                .map(|cell| {
                    let [low, high] = table.grid().corners(cell);
                    let mut sum = 0.0;
                    for k in 0..n * n {
                        let u = DVec2::new((k % n) as f64 + 0.5, (k / n) as f64 + 0.5) / n as f64;
                        sum += (1.0 - t.dot(low + u * (high - low))).max(0.0);
                    }
                    table.masses()[cell] * sum / (n * n) as f64
                })
                .sum();
            let g1 = 1.0 / (1.0 + table.lambda(w));
            // A kink within a step of 1 / 400 of a cell of slopes up to 0.7 wide
            let allowed = (t.length() * 0.7 / n as f64).powi(2) + 1e-12;
            assert!(
                (facing * g1 - 1.0).abs() < allowed,
                "{theta} {phi} {facing}"
            );
        }
    }
}

#[test]
fn skewed_slopes_shadow_differently_from_opposite_sides() {
    let table = skewed();
    for phi in [0.0, 1.0] {
        let (one, other) = (from_spherical(1.2, phi), from_spherical(1.2, phi + PI));
        let ratio = table.lambda(one) / table.lambda(other);
        assert!((ratio - 1.0).abs() > 0.1, "{ratio}");
        // Seen from below, the surface is upside down and turned about.
        assert_eq!(table.lambda(one), table.lambda(-one));
    }
    let grazing = from_spherical(FRAC_PI_2, 0.0);
    assert!(table.lambda(grazing) > 1e12);
    assert_eq!(table.lambda(DVec3::Z), 0.0);
    assert_eq!(table.lambda(DVec3::X), f64::INFINITY);
}

/// Weights of facets: the mean of the excess over the slopes themselves, to the width of a cell.
#[test]
fn a_table_of_facets_has_their_excess() {
    let slopes: Vec<[f64; 2]> = (0..5000)
        .map(|i| {
            let u = f64::from(i) / 5000.0;
            [(37.0 * u).sin() * u, 0.2 * (91.0 * u).cos().powi(3) - 0.1]
        })
        .collect();
    let table = SlopeTable::of_slopes(&slopes).unwrap();
    let n = slopes.len() as f64;
    let mean = [0, 1].map(|axis| slopes.iter().map(|s| s[axis]).sum::<f64>() / n);
    let w = from_spherical(1.3, 0.6);
    let t = w.truncate() / w.z;
    let excess = |s: &[f64; 2]| (t.x * (s[0] - mean[0]) + t.y * (s[1] - mean[1]) - 1.0).max(0.0);
    let expected = slopes.iter().map(excess).sum::<f64>() / n;
    let found = table.lambda(w);
    println!("{found} {expected}");
    assert!((found / expected - 1.0).abs() < 2e-3);
}

#[test]
fn invalid_tables_are_refused() {
    let grid = || SlopeGrid::new([vec![0.0, 1.0], vec![0.0, 1.0, 2.0]]).unwrap();
    let refused = |weights: &[f64]| SlopeTable::new(grid(), weights).unwrap_err();
    assert!(matches!(refused(&[1.0]), SlopeTableError::BadLength { .. }));
    assert_eq!(refused(&[1.0, -1.0]), SlopeTableError::BadWeight(-1.0));
    assert_eq!(refused(&[0.0, 0.0]), SlopeTableError::Empty);
    assert!(SlopeTable::of_slopes(&[]).is_err());
    assert!(SlopeTable::of_slopes(&[[0.0, f64::NAN]]).is_err());
    // Flat ones have a density, if a narrow one.
    assert!(SlopeTable::of_slopes(&[[0.0, 0.0]; 3]).is_ok());
    assert!(SlopeGrid::new([vec![0.0], vec![0.0, 1.0]]).is_err());
    assert!(SlopeGrid::new([vec![0.0, 0.0], vec![0.0, 1.0]]).is_err());
}
