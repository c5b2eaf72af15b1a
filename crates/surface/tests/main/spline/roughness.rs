//! Roughness of smooth surfaces: means over all places, not over samples.

use std::f64::consts::{SQRT_2, TAU};

use asperity_surface::{Border, HeightField, Roughness, SplineRoughness, SplineSurface};

use super::{BORDERS, jumble};

/// Midpoints of a fine grid integrate to second order within cells, over whose edges all are continuous; Richardson's value of
/// two of them is off by the fourth order, some 1e-7 here.
#[test]
fn means_are_those_over_all_places() {
    for border in BORDERS {
        let surface = SplineSurface::through(&jumble([7, 9], border));
        let found = SplineRoughness::of(&surface);
        let ([cx, cy], [dx, dy]) = (surface.cells(), surface.spacing());
        let mean_of = |n: usize, of: &dyn Fn(f64, f64) -> f64| {
            let at = |k: usize, d: f64| (k as f64 + 0.5) / n as f64 * d;
            let places = (0..n * cx).flat_map(|i| (0..n * cy).map(move |j| (i, j)));
            let sum: f64 = places.map(|(i, j)| of(at(i, dx), at(j, dy))).sum();
            sum / (n * n * cx * cy) as f64
        };
        let mean = |of: &dyn Fn(f64, f64) -> f64| (4.0 * mean_of(64, of) - mean_of(32, of)) / 3.0;
        let near = |name: &str, found: f64, expected: f64| {
            let scale = expected.abs().max(1.0);
            assert!(
                (found - expected).abs() < 2e-6 * scale,
                "{border}, {name}: {found} against {expected}"
            );
        };
        near("mean", found.mean, mean(&|x, y| surface.height(x, y)));
        let variance = mean(&|x, y| (surface.height(x, y) - found.mean).powi(2));
        near("sq", found.sq, variance.sqrt());
        for axis in [0, 1] {
            let tilt = mean(&|x, y| surface.gradient(x, y)[axis]);
            near("slope mean", found.slope_mean[axis], tilt);
            let variance = mean(&|x, y| (surface.gradient(x, y)[axis] - tilt).powi(2));
            near("slope variance", found.slope_variance[axis], variance);
        }
        let squares = mean(&|x, y| {
            surface
                .gradient(x, y)
                .iter()
                .map(|slope| slope * slope)
                .sum()
        });
        near("sdq", found.sdq, squares.sqrt());
        if border == Border::Periodic {
            assert_eq!(found.slope_mean, [0.0; 2]);
        }
    }
}

/// Facets lose `(k d)^2 / 12` of the slope variance of a wave, 0.3 % here, the spline a term of the fourth order alone. Neither
/// offset nor scale changes that.
#[test]
fn slopes_of_a_wave_are_nearer_than_those_of_facets() {
    let kd = TAU / 32.0;
    for (scale, offset) in [(1.0, 0.0), (1e-9, 0.0), (1.0, 1e6)] {
        let wave = (0..4 * 32).map(|i| offset + scale * (kd * f64::from(i % 32)).sin());
        let field = HeightField::new(wave.collect(), [4, 32], [0.5 * scale; 2]).unwrap();
        let expected = 0.5 * (kd / 0.5).powi(2);
        let facets = 1.0 - Roughness::of(&field).slope_variance[0] / expected;
        assert!((facets / (kd * kd / 12.0) - 1.0).abs() < 0.01, "{facets}");
        let smooth = SplineRoughness::of(&SplineSurface::through(&field));
        let off = (smooth.slope_variance[0] / expected - 1.0).abs();
        assert!(off < kd.powi(4) / 100.0, "{off}");
        assert!((smooth.sq / scale * SQRT_2 - 1.0).abs() < kd.powi(4) / 100.0);
        let [along, across] = smooth.equivalent_tau;
        let tau = SQRT_2 * smooth.sq / smooth.slope_variance[0].sqrt();
        assert_eq!((along, across), (Some(tau), None));
        assert_eq!(smooth.equivalent_smoothness, Some(2.0 / smooth.sdq));
    }
}

#[test]
fn tilted_planes_have_a_tilt_and_level_ones_nothing() {
    let plane = |tilt: [f64; 2]| {
        let height = |i: i32| tilt[0] * f64::from(i % 5) + tilt[1] * 2.0 * f64::from(i / 5) + 0.1;
        let field = HeightField::new((0..30).map(height).collect(), [6, 5], [1.0, 2.0]).unwrap();
        SplineRoughness::of(&SplineSurface::through(&field.with_border(Border::Open)))
    };
    let tilted = plane([0.3, -0.7]);
    assert!(
        (tilted.slope_mean[0] - 0.3).abs() < 1e-14 && (tilted.slope_mean[1] + 0.7).abs() < 1e-14
    );
    assert!(
        tilted
            .slope_variance
            .iter()
            .all(|variance| *variance < 1e-26)
    );
    assert!((tilted.sdq - 0.58_f64.sqrt()).abs() < 1e-14);
    assert_eq!(tilted.equivalent_tau, [None; 2]);
    let level = plane([0.0; 2]);
    assert!(level.sq < 1e-15 && (level.mean - 0.1).abs() < 1e-15);
    assert_eq!(
        (level.equivalent_tau, level.equivalent_smoothness),
        ([None; 2], None)
    );
}
