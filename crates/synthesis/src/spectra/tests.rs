//! Tests of spectra.

use std::f64::consts::PI;

use super::*;

#[test]
fn refuses_lengths_that_are_not_positive() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Psd::gaussian(bad, 1.0).is_err());
        assert!(Psd::gaussian(1.0, bad).is_err());
    }
    assert!(Psd::anisotropic_gaussian(1.0, 1.0, 1.0, f64::NAN).is_err());
}

/// The trapezium rule converges faster than any power for a Gaussian; at 24 correlation lengths
/// and steps of a quarter of the narrower width only rounding is left.
#[test]
fn density_integrates_to_variance_and_to_slope_covariance() {
    let psd = Psd::anisotropic_gaussian(0.3, 2.0, 0.7, 0.4).unwrap();
    let step = 0.1;
    let (mut variance, mut slopes) = (0.0, [0.0; 3]);
    for i in -250..=250 {
        for j in -250..=250 {
            let (kx, ky) = (f64::from(i) * step, f64::from(j) * step);
            let power = psd.density(kx, ky) * step * step;
            variance += power;
            for (sum, square) in slopes.iter_mut().zip([kx * kx, kx * ky, ky * ky]) {
                *sum += square * power;
            }
        }
    }
    assert!((variance / 0.09 - 1.0).abs() < 1e-12, "{variance}");
    for (sum, expected) in slopes.into_iter().zip(psd.slope_covariance()) {
        assert!((sum / expected - 1.0).abs() < 1e-12, "{sum}");
    }
    let [xx, _, yy] = psd.slope_covariance();
    assert_eq!(psd.slope_variance(), [xx, yy]);
}

#[test]
fn density_falls_to_the_fraction_at_its_reach_and_not_beyond() {
    let psd = Psd::anisotropic_gaussian(0.3, 2.0, 0.7, 0.4).unwrap();
    let [reach_x, reach_y] = psd.reach(1e-6);
    let peak = psd.density(0.0, 0.0);
    let reach_along_y = |kx| psd.prepared().reach_along_y(kx, 1e-6);
    for kx in [0.0, 0.3, -0.7 * reach_x] {
        let ky = reach_along_y(kx).unwrap();
        let at = |ky| psd.density(kx, ky).max(psd.density(kx, -ky)) / peak;
        assert!((at(ky) / 1e-6 - 1.0).abs() < 1e-9, "{}", at(ky));
        assert!(at(1.01 * ky) < 1e-6);
    }
    assert_eq!(reach_along_y(1.001 * reach_x), None);
    let largest = |density: &dyn Fn(f64) -> f64| {
        (-100_000..=100_000)
            .map(|i| density(f64::from(i) * 1e-3) / peak)
            .fold(0.0, f64::max)
    };
    let along_x = largest(&|ky| psd.density(reach_x, ky));
    let along_y = largest(&|kx| psd.density(kx, reach_y));
    assert!((along_x / 1e-6 - 1.0).abs() < 1e-4, "{along_x}");
    assert!((along_y / 1e-6 - 1.0).abs() < 1e-4, "{along_y}");
}

#[test]
fn axis_lengths_are_where_the_autocorrelation_is_one_over_e() {
    let psd = Psd::anisotropic_gaussian(1.0, 2.0, 0.7, 0.4).unwrap();
    let [x, y] = psd.axis_correlation_lengths();
    let e = (-1.0_f64).exp();
    assert!((psd.autocorrelation(x, 0.0) - e).abs() < 1e-15);
    assert!((psd.autocorrelation(0.0, y) - e).abs() < 1e-15);
    // The contour's farthest reach, by walking around it.
    let (mut reach_x, mut reach_y) = (0.0_f64, 0.0_f64);
    for i in 0..10_000 {
        let (sin, cos) = (f64::from(i) * 2.0 * PI / 1e4).sin_cos();
        let length = (-psd.autocorrelation(cos, sin).ln()).sqrt().recip();
        reach_x = reach_x.max(length * cos);
        reach_y = reach_y.max(length * sin);
    }
    let [extent_x, extent_y] = psd.correlation_extents();
    assert!((extent_x / reach_x - 1.0).abs() < 1e-6, "{extent_x}");
    assert!((extent_y / reach_y - 1.0).abs() < 1e-6, "{extent_y}");
}
