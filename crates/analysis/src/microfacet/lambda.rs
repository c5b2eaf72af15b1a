//! Smith's function Lambda of Gaussian slopes.

use asperity_numerics::elementary::{exp, polynomial};

/// `Lambda(a) exp(a^2) 2 sqrt(pi) a (1 + 2 a^2)` as a polynomial in `(a - 3) / (a + 3)`, from its Chebyshev expansion by 50-digit
/// arithmetic; to 6e-17 for all `a >= 0`.
const SCALED: [f64; 26] = [
    0.915_537_055_505_420_6,
    0.259_811_687_963_364_96,
    -0.287_434_778_400_719_85,
    0.078_619_765_188_692_22,
    0.166_513_466_065_496_33,
    -0.263_882_971_395_597_9,
    0.199_733_887_684_197_86,
    -0.083_360_244_236_698_45,
    0.008_940_835_939_715_58,
    0.009_561_582_793_489_827,
    -0.003_962_917_964_473_717,
    -0.000_818_560_540_333_754_2,
    0.000_800_454_751_966_379_3,
    8.104_660_502_681_3e-05,
    -0.000_153_043_486_705_333_46,
    -1.649_716_474_991_035e-05,
    2.990_858_787_016_764e-05,
    5.691_093_994_464_75e-06,
    -5.724_794_520_137_679e-06,
    -1.947_331_747_190_591_4e-06,
    9.722_368_824_472_405e-07,
    5.423_487_607_721_006e-07,
    -1.248_458_057_942_572_5e-07,
    -1.059_104_231_115_067_1e-07,
    8.720_675_449_086_444e-09,
    1.058_622_135_841_937_3e-08,
];

/// Smith's Lambda of Gaussian slopes at `a = cot(theta) / (sqrt 2 deviation) >= 0`, which is
/// `s / (2 tan theta)` for smoothness `s`.
///
/// `Lambda = (exp(-a^2) / (a sqrt pi) - erfc(a)) / 2`, to a relative accuracy of about
/// `4e-15 + 2 a^2 eps` where it is a normal number; infinite at zero.
///
/// # Source
/// Smith 1967; Walter et al. 2007, Sec. 5.2, without their rational fit.
#[inline(always)]
pub(crate) fn smith_lambda(a: f64) -> f64 {
    // Beyond, the result is zero.
    let is_beyond = a > 27.3;
    let a = if is_beyond { 27.3 } else { a };
    let a2 = a * a;
    let scale = 2.0 * SQRT_PI * a * (1.0 + 2.0 * a2);
    let lambda = exp(-a2) * polynomial((a - 3.0) / (a + 3.0), &SCALED) / scale;
    if is_beyond { 0.0 } else { lambda }
}

const SQRT_PI: f64 = 1.772_453_850_905_516;

#[cfg(test)]
mod tests {
    use super::*;

    /// Lambda by 50-digit arithmetic: (s, theta in degrees, value).
    const LAMBDA: [(f64, f64, f64); 8] = [
        (1.0, 2.0, 4.409_470_606_666_315e-94),
        (1.0, 3.0, 4.710_564_609_628_956e-44),
        (1.0, 4.0, 2.342_968_593_647_176_6e-26),
        (1.0, 5.0, 4.727_370_102_536_558e-18),
        (3.0, 40.0, 0.000_726_420_395_639_953_3),
        (3.0, 43.0, 0.001_732_243_294_448_144_3),
        (3.0, 88.0, 4.900_194_968_621_081),
        (3.0, 89.9, 107.252_902_386_690_32),
    ];

    #[test]
    fn lambda_is_exact_where_its_two_terms_nearly_cancel() {
        for (s, theta, expected) in LAMBDA {
            let a = s / (2.0 * f64::to_radians(theta).tan());
            // d ln Lambda / d ln a is close to -2 a^2, and a itself carries some two roundings.
            let tolerance = 1e-13 + 8.0 * a * a * f64::EPSILON;
            let error = (smith_lambda(a) / expected - 1.0).abs();
            assert!(error < tolerance, "s {s} theta {theta}: {error:e}");
        }
    }

    #[test]
    fn lambda_is_the_difference_of_its_terms_where_they_do_not_cancel() {
        for i in 1..=2000 {
            let a = 1e-3 * f64::from(i);
            let leading = exp(-a * a) / (a * SQRT_PI);
            let difference = 0.5 * (leading - asperity_numerics::elementary::erfc(a));
            // The difference magnifies rounding at most 2 a^2 + 1 times.
            let error = (smith_lambda(a) / difference - 1.0).abs();
            assert!(error < 8.0 * f64::EPSILON * (2.0 + 2.0 * a * a), "{a}");
        }
        assert_eq!(smith_lambda(0.0), f64::INFINITY);
        assert_eq!(smith_lambda(f64::INFINITY), 0.0);
    }
}
