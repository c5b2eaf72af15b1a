//! Tests of the spectra that are not Gaussian, by direct sums over wave vectors.

use std::f64::consts::TAU;

use super::*;

/// Variance, slope covariance and fourth moments along x and y, by the midpoint rule over `cells` squares of wave vectors up to `reach`.
fn sums(psd: &Psd, reach: f64, cells: i32) -> [f64; 6] {
    let step = 2.0 * reach / f64::from(cells);
    let mut sums = [0.0; 6];
    let prepared = psd.prepared();
    for i in 0..cells {
        for j in 0..cells {
            let [kx, ky] = [i, j].map(|i| (f64::from(i) + 0.5) * step - reach);
            let power = prepared.at(kx, ky) * step * step;
            let terms = [1.0, kx * kx, kx * ky, ky * ky, kx.powi(4), ky.powi(4)];
            for (sum, term) in sums.iter_mut().zip(terms) {
                *sum += term * power;
            }
        }
    }
    sums
}

/// The midpoint rule at a sharp edge is off by some `step / reach` of the density there times the circumference: below 2e-3 of the
/// fourth moments with 1000 cells.
fn assert_sums(psd: &Psd, reach: f64) {
    let [variance, xx, xy, yy, x4, y4] = sums(psd, reach, 1000);
    let sigma = psd.sigma();
    assert!(
        (variance / (sigma * sigma) - 1.0).abs() < 1e-3,
        "{variance}"
    );
    let covariance = psd.slope_covariance();
    for (sum, expected) in [xx, xy, yy].into_iter().zip(covariance) {
        assert!(
            (sum - expected).abs() < 1e-3 * covariance[0].max(covariance[2]),
            "{sum} {expected}"
        );
    }
    // Along a principal axis of ellipses
    if psd.anisotropy().is_none_or(|[_, azimuth]| azimuth == 0.0) {
        let curvature = x4.max(y4).sqrt();
        assert!(
            (curvature / psd.curvature() - 1.0).abs() < 2e-3,
            "{curvature}"
        );
    }
    let e = (-1.0_f64).exp() * sigma * sigma;
    let [x, y] = psd.axis_correlation_lengths();
    assert!((psd.autocorrelation(x, 0.0) / e - 1.0).abs() < 1e-6);
    assert!((psd.autocorrelation(0.0, y) / e - 1.0).abs() < 1e-6);
    assert!((psd.autocorrelation(0.0, 0.0) / (sigma * sigma) - 1.0).abs() < 1e-9);
}

#[test]
fn exponential_and_matern_integrate_to_their_moments() {
    let exponential = Psd::exponential(0.3, 4.0, 1.0).unwrap();
    assert_eq!(exponential.correlation_lengths(), [4.0; 2]);
    assert_sums(&exponential, TAU);
    assert_sums(&Psd::matern(0.3, 4.0, 0.2, Some(2.0)).unwrap(), TAU / 2.0);
    assert_sums(&Psd::matern(0.3, 4.0, 1.0, Some(1.0)).unwrap(), TAU);
    assert_sums(&Psd::matern(0.3, 4.0, 2.0, Some(1.0)).unwrap(), TAU);
    let turned = exponential.clone().stretched(2.0, 0.0).unwrap();
    assert_eq!(turned.anisotropy(), Some([0.5, 0.0]));
    assert_sums(&turned, 2.0 * TAU);
    assert_sums(&exponential.stretched(6.0, 0.7).unwrap(), TAU);
}

#[test]
fn power_laws_integrate_to_their_moments() {
    for hurst in [0.3, 0.8, 1.0] {
        assert_sums(&Psd::power_law(0.2, hurst, 20.0, 2.0).unwrap(), TAU / 2.0);
    }
    let psd = Psd::power_law(0.2, 0.8, 20.0, 2.0).unwrap();
    let ratio = psd.density(0.8, 0.0) / psd.density(0.4, 0.0);
    assert!((ratio / 2.0_f64.powf(-3.6) - 1.0).abs() < 1e-12, "{ratio}");
    assert_eq!(psd.density(0.0, 0.0), psd.density(0.3, 0.0));
    assert_eq!(psd.density(3.15, 0.0), 0.0);
}

/// With all waves, Matern's family has closed autocorrelations: at nu = 1/2 `exp(-r / l)`, at 3/2 `(1 + r / l) exp(-r / l)`, and at
/// infinity a Gaussian. The cut-off of 1/200 of a correlation length leaves out less than 1e-3 of the variance.
#[test]
fn autocorrelations_without_a_cut_off_are_closed() {
    let exponential = Psd::exponential(1.0, 1.0, 0.005).unwrap();
    for r in [0.1_f64, 0.5, 1.0, 2.0, 3.0] {
        let found = exponential.autocorrelation(0.6 * r, 0.8 * r);
        assert!((found - (-r).exp()).abs() < 2e-3, "{r}: {found}");
    }
    let smooth = Psd::matern(1.0, 1.0, 1.5, None).unwrap();
    // (1 + x) exp(-x) = 1/e
    let l: f64 = 1.0 / 2.146_193_220_620_582_6;
    for r in [0.1_f64, 0.5, 1.0, 2.0, 3.0] {
        let expected = (1.0 + r / l) * (-r / l).exp();
        let found = smooth.autocorrelation(r, 0.0);
        assert!((found - expected).abs() < 1e-6, "{r}: {found} {expected}");
    }
    // Slope variance sigma^2 / (2 l^2 (nu - 1))
    let [xx, _, _] = smooth.slope_covariance();
    assert!((xx * l * l - 1.0).abs() < 1e-6, "{xx}");
    assert!(smooth.curvature().is_infinite());
    let gaussian = Psd::matern(1.0, 1.0, 100.0, None).unwrap();
    let found = gaussian.slope_covariance()[0];
    assert!((found / 2.0 - 1.0).abs() < 0.02, "{found}");
}

#[test]
fn tables_integrate_to_their_moments_and_repeat_what_they_tabulate() {
    let exponential = Psd::exponential(0.3, 4.0, 1.0).unwrap();
    // Nodes on logarithmic axes
    let k: Vec<f64> = (0..400)
        .map(|i| 1e-3 * (f64::from(i) * 0.021_915).exp())
        .collect();
    let w = k.iter().map(|k| exponential.density(*k, 0.0)).collect();
    let table = RadialTable::new(k.clone(), w).unwrap();
    let psd = Psd::of_radial_table(table.clone(), None).unwrap();
    assert!((psd.sigma() / 0.3 - 1.0).abs() < 2e-3, "{}", psd.sigma());
    let [tau, _] = psd.correlation_lengths();
    assert!((tau / 4.0 - 1.0).abs() < 1e-2, "{tau}");
    assert_sums(&psd, k[399]);
    let scaled = Psd::of_radial_table(table, Some(0.6)).unwrap();
    assert!((scaled.sigma() - 0.6).abs() < 1e-15);
    // With a zero between, where pieces are linear
    let table = RadialTable::new(vec![0.5, 1.0, 2.0, 3.0], vec![1.0, 0.0, 1.0, 0.5]).unwrap();
    assert_sums(&Psd::of_radial_table(table, None).unwrap(), 3.0);

    // The plane: bilinear in an anisotropic Gaussian, of steps of a fifth of its width along the narrower axis
    let gaussian = Psd::anisotropic_gaussian(0.5, 2.0, 3.0, 0.4).unwrap();
    let axis = |n: i32| {
        (0..=2 * n)
            .map(|i| 0.1 * f64::from(i - n))
            .collect::<Vec<f64>>()
    };
    let kx = axis(40);
    for ky in [axis(40), axis(40)[40..].to_vec()] {
        let density = ky
            .iter()
            .flat_map(|y| kx.iter().map(|x| gaussian.density(*x, *y)))
            .collect();
        let psd = Psd::of_plane_table(kx.clone(), ky, density, None).unwrap();
        // Bilinear means of a curved function: off by step^2 tau^2 / 24 of its slope variance and so
        assert!((psd.sigma() / 0.5 - 1.0).abs() < 5e-3, "{}", psd.sigma());
        assert_sums(&psd, 4.0);
        for (found, expected) in psd
            .slope_covariance()
            .iter()
            .zip(gaussian.slope_covariance())
        {
            assert!((found - expected).abs() < 0.02 * gaussian.slope_covariance()[0]);
        }
        let [first, second] = psd.correlation_lengths();
        assert!((first / 3.0 - 1.0).abs() < 0.02 && (second / 2.0 - 1.0).abs() < 0.02);
    }
}

/// A table with more rows than the quadrature of a closed-form spectrum has panels.
#[test]
fn long_tables_are_integrated_to_their_end() {
    let tau = 16.0;
    let rows = 50_000;
    let wave_number: Vec<f64> = (1..=rows).map(|i| 1e-5 * f64::from(i)).collect();
    let gaussian = |k: &f64| (-0.25 * (k * tau).powi(2)).exp();
    let density = wave_number.iter().map(gaussian).collect();
    let table = RadialTable::new(wave_number, density).unwrap();
    let psd = Psd::of_radial_table(table, Some(1.0)).unwrap();
    let [found, _] = psd.correlation_lengths();
    // What lies beyond the last row is exp(-16)
    assert!((found / tau - 1.0).abs() < 1e-4, "{found}");
    let [slopes, _] = psd.slope_variance();
    assert!((slopes * tau * tau / 2.0 - 1.0).abs() < 1e-4, "{slopes}");
}

/// A Gaussian over the plane, turned against its grid: lags and waves along axes that are known.
#[test]
fn tables_over_the_plane_have_the_lengths_of_what_they_tabulate() {
    let (tau_x, tau_y, azimuth) = (8.0, 3.0, 0.4);
    let expected = Psd::anisotropic_gaussian(0.7, tau_x, tau_y, azimuth).unwrap();
    let k: Vec<f64> = (-120..=120).map(|i| 0.02 * f64::from(i)).collect();
    let prepared = expected.prepared();
    let row = |ky: &f64| k.iter().map(|kx| prepared.at(*kx, *ky)).collect::<Vec<_>>();
    let density = k.iter().flat_map(row).collect();
    let psd = Psd::of_plane_table(k.clone(), k.clone(), density, None).unwrap();
    // A cubic hat widens waves by 0.02^2 / 6 of their square, 1e-4 of the longer length
    for (found, expected) in [
        (psd.correlation_lengths(), [tau_x, tau_y]),
        (
            psd.axis_correlation_lengths(),
            expected.axis_correlation_lengths(),
        ),
    ] {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 2e-3, "{found} {expected}");
        }
    }
    // Of a Gaussian of variance v along an axis, waves beyond k hold erfc(u) + 2 u exp(-u^2) / sqrt(pi) of the slopes, u^2 = k^2 / (2 v).
    // Nodes of the quadrature are a third of 0.02 apart, 1 % of this k, whose 6.5th power the fraction falls with
    let [xx, _, _] = psd.slope_covariance();
    let variance = xx / psd.sigma().powi(2);
    let [wavelength, _] = psd.wavelengths_holding(0.05).unwrap();
    let u = TAU / wavelength / (2.0 * variance).sqrt();
    let held = asperity_numerics::elementary::erfc(u)
        + 2.0 * u * (-u * u).exp() / std::f64::consts::PI.sqrt();
    assert!((held / 0.05 - 1.0).abs() < 0.07, "{held}");
}

#[test]
fn sums_add_power() {
    let rough = Psd::gaussian(0.3, 1.0).unwrap();
    let long = Psd::gaussian(0.4, 8.0).unwrap();
    let sum = rough.clone().plus(long.clone());
    assert!((sum.sigma() - 0.5).abs() < 1e-15);
    assert_sums(&sum, 8.0);
    assert!(sum.is_isotropic());
    let grooves = long.stretched(4.0, 0.3).unwrap().plus(rough);
    assert!(!grooves.is_isotropic() && !grooves.is_mirror_symmetric());
    assert_sums(&grooves, 8.0);
}

/// `8 pi^2` times the integral of `W^2` is the integral of `2 C^2`.
#[test]
fn correlation_areas_are_integrals_of_the_square() {
    for psd in [
        Psd::exponential(0.3, 4.0, 1.0).unwrap(),
        Psd::power_law(0.3, 0.5, 20.0, 2.0).unwrap(),
        Psd::matern(0.3, 2.0, 3.0, None).unwrap(),
    ] {
        let reach = TAU;
        let step = 2.0 * reach / 1000.0;
        let prepared = psd.prepared();
        let mut sum = 0.0;
        for i in 0..1000 {
            for j in 0..1000 {
                let [kx, ky] = [i, j].map(|i| (f64::from(i) + 0.5) * step - reach);
                sum += (prepared.at(kx, ky) * step).powi(2);
            }
        }
        let expected = 2.0 * TAU * TAU * sum / psd.sigma().powi(4);
        let found = psd.correlation_area().unwrap();
        assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected}");
    }
}

#[test]
fn waves_that_hold_the_slopes_are_found() {
    // Slope variance of an exponential spectrum grows nearly as k: 3 % lie beyond 97 % of the cut-off
    let psd = Psd::exponential(0.3, 4.0, 0.25).unwrap();
    let [wave, _] = psd.wavelengths_holding(0.03).unwrap();
    assert!(wave > 0.25 && wave < 0.25 / 0.96, "{wave}");
    let plane = Psd::of_plane_table(vec![-1.0, 0.0, 1.0], vec![0.0, 1.0], vec![1.0; 6], None);
    // Of a level density, k^2 from the edge inwards: 1 - k^3 = 0.03
    let [wave, _] = plane.unwrap().wavelengths_holding(0.03).unwrap();
    assert!((TAU / wave - 0.97_f64.cbrt()).abs() < 0.12, "{wave}");
}

#[test]
fn bad_parameters_get_one_sentence() {
    let said = |psd: Result<Psd, PsdError>| psd.unwrap_err().to_string();
    assert!(
        said(Psd::matern(1.0, 1.0, 0.8, None))
            .starts_with("with nu = 0.8, slopes have no finite variance")
    );
    assert!(
        said(Psd::exponential(1.0, 1.0, 3.0)).contains("at most twice the correlation length of 1")
    );
    assert!(said(Psd::power_law(1.0, 0.5, 1.0, 1.0)).contains("must be shorter than the roll-off"));
    assert!(said(Psd::power_law(1.0, 1.5, 2.0, 1.0)).contains("hurst is 1.5"));
    assert!(Psd::matern(1.0, 1.0, 0.0, Some(0.1)).is_err());
    assert!(Psd::matern(1.0, f64::NAN, 2.0, None).is_err());
    assert!(RadialTable::new(vec![1.0], vec![1.0]).is_err());
    assert!(RadialTable::new(vec![1.0, 1.0], vec![1.0, 1.0]).is_err());
    assert!(RadialTable::new(vec![0.0, 1.0], vec![1.0, 1.0]).is_err());
    assert!(RadialTable::new(vec![1.0, 2.0], vec![1.0, -1.0]).is_err());
    assert!(RadialTable::new(vec![1.0, 2.0], vec![0.0, 0.0]).is_err());
}
