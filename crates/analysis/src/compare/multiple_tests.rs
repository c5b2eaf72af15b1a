//! Statistics of several tests taken together.

use std::f64::consts::SQRT_2;

use asperity_numerics::elementary::{exp, exp_m1, lgamma, ln, ln_1p};

/// The level at which each of `n` tests must reject so that all of them together reject falsely
/// with probability `level`: `1 - (1 - level)^(1 / n)`.
///
/// Exact for independent tests, conservative for positively dependent ones.
///
/// # Source
/// Sidak 1967.
#[must_use]
pub fn sidak_level(level: f64, n: usize) -> f64 {
    -exp_m1(ln_1p(-level) / n.max(1) as f64)
}

/// The bound that the largest `|z|` of `n` standard normal values exceeds with probability `level`.
///
/// `level` in `(0, 1)`; at least one value is assumed.
#[must_use]
pub fn sidak_z_threshold(level: f64, n: usize) -> f64 {
    let p = sidak_level(level, n);
    // erfc(z / sqrt 2) falls from 1 at z = 0 to the least double before z = 39.
    let (mut lo, mut hi) = (0.0, 39.0);
    while hi - lo > 1e-13 * hi {
        let middle = 0.5 * (lo + hi);
        if asperity_numerics::elementary::erfc(middle / SQRT_2) > p {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    0.5 * (lo + hi)
}

/// Mean square of z-scores: close to one if each is standard normal. `None` without any.
///
/// With `n` independent values its standard deviation is `sqrt(2 / n)`; values that share surfaces
/// scatter more.
#[must_use]
pub fn chi_squared_per_degree(z: &[f64]) -> Option<f64> {
    (!z.is_empty()).then(|| z.iter().map(|z| z * z).sum::<f64>() / z.len() as f64)
}

/// Probability that chi-squared of `degrees` degrees of freedom exceeds `chi_squared >= 0`.
///
/// Holds for *independent* normal values only; bins that share surfaces are not, see
/// [`compare`](fn@crate::compare).
///
/// # Source
/// The regularised incomplete gamma function `Q(degrees / 2, chi_squared / 2)`: series below the
/// mean, Lentz's continued fraction above it.
#[must_use]
pub fn chi_squared_survival(chi_squared: f64, degrees: usize) -> f64 {
    let (a, x) = (0.5 * degrees as f64, 0.5 * chi_squared);
    if x <= 0.0 {
        return 1.0;
    }
    let front = exp(a * ln(x) - x - lgamma(a));
    if x < a + 1.0 {
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-17 {
            k += 1.0;
            term *= x / k;
            sum += term;
        }
        return (1.0 - front * sum).max(0.0);
    }
    let mut b = x + 1.0 - a;
    let mut c = f64::INFINITY;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for i in 1..100_000 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        let step = c * d;
        fraction *= step;
        if (step - 1.0).abs() < 1e-16 {
            break;
        }
    }
    front * fraction
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_test_keeps_its_level() {
        assert!((sidak_level(0.01, 1) - 0.01).abs() < 1e-17);
        assert!((sidak_level(0.05, 2) - (1.0 - 0.95_f64.sqrt())).abs() < 1e-16);
        // Small levels do not vanish in the difference from one.
        assert!((sidak_level(1e-20, 10) / 1e-21 - 1.0).abs() < 1e-14);
    }

    #[test]
    fn thresholds_are_those_of_the_normal_tables() {
        for (level, n, expected) in [
            (0.05, 1, 1.959_963_985),
            (0.01, 1, 2.575_829_304),
            (0.05, 2, 2.236_476_645),
        ] {
            let z = sidak_z_threshold(level, n);
            assert!((z - expected).abs() < 1e-6, "{level} {n} {z}");
        }
    }

    #[test]
    fn chi_squared_has_its_tabulated_quantiles() {
        for (x, k, p) in [
            (3.841_458_821, 1, 0.05),
            (18.307_038_05, 10, 0.05),
            (29.588_298_45, 10, 0.001),
            (2.558_212_16, 10, 0.99),
            (124.342_113_4, 100, 0.05),
        ] {
            let q = chi_squared_survival(x, k);
            assert!((q / p - 1.0).abs() < 1e-7, "{x} {k} {q}");
        }
        // Two degrees: exp(-x / 2).
        assert!((chi_squared_survival(50.0, 2) / (-25.0_f64).exp() - 1.0).abs() < 1e-12);
        assert_eq!(chi_squared_survival(0.0, 3), 1.0);
    }

    #[test]
    fn chi_squared_per_degree_is_the_mean_square() {
        assert_eq!(chi_squared_per_degree(&[1.0, -3.0]), Some(5.0));
        assert_eq!(chi_squared_per_degree(&[]), None);
    }
}
