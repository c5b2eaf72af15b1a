//! Filling of gaps against heights that are known there.

use super::*;
use crate::Border;

/// A map of `f` at its samples, without the points for which `gone` holds.
fn map(
    shape: [usize; 2],
    spacing: [f64; 2],
    f: impl Fn(f64, f64) -> f64,
    gone: impl Fn(usize, usize) -> bool,
) -> RawHeightMap {
    let [ny, nx] = shape;
    let heights = (0..nx * ny)
        .map(|i| {
            let (ix, iy) = (i % nx, i / nx);
            if gone(ix, iy) {
                f64::NAN
            } else {
                f(ix as f64 * spacing[0], iy as f64 * spacing[1])
            }
        })
        .collect();
    RawHeightMap::new(heights, shape, spacing).unwrap()
}

/// Largest distance from `f` once the map is filled.
fn error(map: RawHeightMap, border: Border, f: impl Fn(f64, f64) -> f64) -> f64 {
    let filled = map.into_height_field(MissingPolicy::Fill, border).unwrap();
    let [dx, dy] = filled.spacing();
    let mut worst = 0.0_f64;
    for iy in 0..filled.ny() {
        for ix in 0..filled.nx() {
            let expected = f(ix as f64 * dx, iy as f64 * dy);
            worst = worst.max((filled.height(ix, iy) - expected).abs());
        }
    }
    worst
}

/// A ramp and `x^2 - y^2` solve the five-point equation exactly, so what is left is the error at
/// which the solver stops: 1e-11 of the rim's range in the energy norm, and a point of a gap can
/// be off by some tens of that. The ranges are below 200 and 3000.
#[test]
fn harmonic_surface_is_restored() {
    for spacing in [[1.0, 1.0], [0.5, 2.0], [10.0, 0.1]] {
        let ramp = |x: f64, y: f64| 1e3 + 0.3 * x - 0.7 * y;
        let saddle = |x: f64, y: f64| 0.01 * (x * x - y * y) + 0.02 * x * y;
        for gone in [
            |ix: usize, iy: usize| (10..31).contains(&ix) && (5..37).contains(&iy),
            |ix: usize, iy: usize| ix.abs_diff(20).pow(2) + iy.abs_diff(22).pow(2) < 300,
            |ix: usize, iy: usize| ix % 9 == 4 && iy % 9 == 4,
            // Scattered points, and threads one point thick
            |ix: usize, iy: usize| {
                (1..44).contains(&ix)
                    && (1..44).contains(&iy)
                    && (ix % 7 == 3 || (ix * iy) % 5 == 2)
            },
        ] {
            let worst = error(map([45, 45], spacing, ramp, gone), Border::Open, ramp);
            assert!(worst < 2e-7, "ramp, {spacing:?}: {worst}");
            let worst = error(map([45, 45], spacing, saddle, gone), Border::Open, saddle);
            assert!(worst < 3e-6, "saddle, {spacing:?}: {worst}");
        }
    }
}

#[test]
fn single_point_is_the_weighted_mean_of_its_neighbours() {
    let nan = f64::NAN;
    let heights = vec![0.0, 4.0, 0.0, 1.0, nan, 3.0, 0.0, 8.0, 0.0];
    let raw = RawHeightMap::new(heights, [3, 3], [1.0, 2.0]).unwrap();
    let filled = raw
        .into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap();
    // Weights 1 along x, 1/4 along y
    let expected = (1.0 + 3.0 + (4.0 + 8.0) / 4.0) / 2.5;
    assert!((filled.height(1, 1) - expected).abs() < 1e-14);
}

#[test]
fn corner_uses_the_neighbours_it_has() {
    let heights = vec![f64::NAN, 4.0, 2.0, 7.0];
    let raw = RawHeightMap::new(heights, [2, 2], [1.0, 1.0]).unwrap();
    let filled = raw
        .into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap();
    assert!((filled.height(0, 0) - 3.0).abs() < 1e-14);
}

/// A strip along the border of a map that varies along x only: level if the map ends there,
/// across to the other side if it is periodic.
#[test]
fn gap_at_the_border_ends_level_or_wraps() {
    let raw = || map([6, 10], [1.0, 1.0], |x, _| x, |ix, _| ix >= 7);
    let level = raw()
        .into_height_field(MissingPolicy::Fill, Border::Mirrored)
        .unwrap();
    let wrapped = raw()
        .into_height_field(MissingPolicy::Fill, Border::Periodic)
        .unwrap();
    for iy in 0..6 {
        for ix in 7..10 {
            assert!((level.height(ix, iy) - 6.0).abs() < 1e-9);
            // From 6 at column 6 to 0 at column 10
            let expected = 6.0 * (10 - ix) as f64 / 4.0;
            assert!((wrapped.height(ix, iy) - expected).abs() < 1e-9);
        }
    }
}

/// Neither a huge offset nor a tiny scale spoils the filling: only the range of heights counts.
#[test]
fn offset_and_scale_do_not_matter() {
    for (scale, offset) in [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e9)] {
        let ramp = |x: f64, y: f64| offset + scale * (x - 2.0 * y);
        let hole = |ix: usize, iy: usize| (3..17).contains(&ix) && (3..17).contains(&iy);
        let worst = error(map([20, 20], [1.0, 1.0], ramp, hole), Border::Open, ramp);
        assert!(worst < 1e-7 * scale + 4e-16 * offset, "{worst}");
    }
}

#[test]
fn large_gap_settles_quickly() {
    let ramp = |x: f64, y: f64| 0.01 * x + 0.02 * y;
    let hole = |ix: usize, iy: usize| (5..505).contains(&ix) && (5..505).contains(&iy);
    let raw = map([510, 510], [1.0, 1.0], ramp, hole);
    assert!(error(raw, Border::Open, ramp) < 1e-7);
}

#[test]
fn missing_points_are_refused_by_default_and_when_all_are_missing() {
    let raw = || map([4, 5], [1.0, 1.0], |x, _| x, |ix, iy| (ix, iy) == (3, 2));
    assert_eq!(raw().missing(), 1);
    let refused = raw()
        .into_height_field(MissingPolicy::default(), Border::Open)
        .unwrap_err();
    assert_eq!(
        refused,
        MissingError::Refused {
            missing: 1,
            total: 20,
            ix: 3,
            iy: 2
        }
    );
    let empty = || map([4, 5], [1.0, 1.0], |x, _| x, |_, _| true);
    for policy in [MissingPolicy::Refuse, MissingPolicy::Fill] {
        assert_eq!(
            empty().into_height_field(policy, Border::Open),
            Err(MissingError::NothingLeft(20))
        );
    }
    assert!("guess".parse::<MissingPolicy>().is_err());
    assert_eq!("fill".parse(), Ok(MissingPolicy::Fill));
}
