//! Known answers by 60-digit arithmetic, and comparison with the functions of the system.

#![allow(clippy::approx_constant, reason = "tables of values")]

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

const EXP: [[f64; 2]; 9] = [
    [0.1, 1.105_170_918_075_647_7],
    [-0.346_5, 0.707_158_819_287_271_3],
    [1.0, 2.718_281_828_459_045],
    [20.5, 799902177.475_505_4],
    [-20.5, 1.250_152_866_386_742_6e-09],
    [709.7, 1.654_984_027_680_264_4e+308],
    [-708.3, 2.450_295_530_965_988e-308],
    [300.25, 2.494_124_861_534_921_3e+130],
    [-1.0e-09, 0.999_999_999],
];
const EXP_M1: [[f64; 2]; 9] = [
    [1.0e-12, 1.000_000_000_000_5e-12],
    [-1.0e-05, -9.999_950_000_166_666e-06],
    [0.3, 0.349_858_807_576_003_1],
    [-0.4, -0.329_679_953_964_360_73],
    [1.0, 1.718_281_828_459_045_3],
    [39.9, 2.129_853_970_885_142_4e+17],
    [41.0, 6.398_434_935_300_549e+17],
    [-39.0, -1.0],
    [700.0, 1.014_232_054_735_004_5e+304],
];
const LN: [[f64; 2]; 9] = [
    [0.5, -0.693_147_180_559_945_3],
    [1.000_000_1, 9.999_999_505_838_704e-08],
    [0.999_9, -0.000_100_005_000_333_347_32],
    [1.5, 0.405_465_108_108_164_4],
    [10.0, 2.302_585_092_994_046],
    [1.0e-300, -690.775_527_898_213_7],
    [1.0e+300, 690.775_527_898_213_7],
    [5.0e-310, -712.191_940_915_72],
    [123456.789, 11.723_646_487_185_881],
];
const LN_1P: [[f64; 2]; 9] = [
    [1.0e-14, 9.999_999_999_999_95e-15],
    [-1.0e-07, -1.000_000_050_000_003_3e-07],
    [0.3, 0.262_364_264_467_491_06],
    [-0.4, -0.510_825_623_765_990_7],
    [1.0, 0.693_147_180_559_945_3],
    [-0.999_999, -13.815_510_557_935_518],
    [10_000_000_000.0, 23.025_850_930_040_455],
    [1.0e+300, 690.775_527_898_213_7],
    [-0.5, -0.693_147_180_559_945_3],
];
const SIN: [[f64; 2]; 9] = [
    [0.1, 0.099_833_416_646_828_15],
    [-0.785_3, -0.707_037_365_775_799_9],
    [1.6, 0.999_573_603_041_505_1],
    [3.141_59, 2.653_589_793_352_73e-06],
    [100.5, -0.030_959_966_783_271_346],
    [-12345.678, 0.704_081_313_753_381_6],
    [1_000_000.0, -0.349_993_502_171_292_94],
    [1.0e-05, 9.999_999_999_833_334e-06],
    [2.0, 0.909_297_426_825_681_7],
];
const COS: [[f64; 2]; 9] = [
    [0.1, 0.995_004_165_278_025_8],
    [-0.785_3, 0.707_176_189_783_577],
    [1.57, 0.000_796_326_710_733_263_3],
    [3.141_59, -0.999_999_999_996_479_3],
    [100.5, 0.999_520_625_328_351_5],
    [-12345.678, 0.710_119_358_716_062_8],
    [1_000_000.0, 0.936_752_127_533_144_7],
    [1.0e-05, 0.999_999_999_95],
    [2.0, -0.416_146_836_547_142_4],
];
const ERF: [[f64; 2]; 9] = [
    [1.0e-10, 1.128_379_167_095_512_6e-10],
    [0.3, 0.328_626_759_459_127_4],
    [-0.9, -0.796_908_212_422_832_2],
    [1.0, 0.842_700_792_949_714_9],
    [1.1, 0.880_205_069_574_081_7],
    [-2.5, -0.999_593_047_982_555],
    [5.0, 0.999_999_999_998_462_6],
    [0.5, 0.520_499_877_813_046_5],
    [-0.001, -0.001_128_378_790_969_236_5],
];
const ERFC: [[f64; 2]; 9] = [
    [1.0e-10, 0.999_999_999_887_162],
    [0.3, 0.671_373_240_540_872_6],
    [-0.9, 1.796_908_212_422_832_2],
    [1.0, 0.157_299_207_050_285_13],
    [3.5, 7.430_983_723_414_128e-07],
    [-2.5, 1.999_593_047_982_555],
    [10.0, 2.088_487_583_762_545e-45],
    [26.0, 5.663_192_408_856_143e-296],
    [0.02, 0.977_435_425_308_155_1],
];
const ATAN2: [[f64; 3]; 9] = [
    [0.1, 1.0, 0.099_668_652_491_162_04],
    [1.0, 0.1, 1.471_127_674_303_734_5],
    [-0.3, 0.4, -0.643_501_108_793_284_4],
    [0.5, -2.0, 2.896_613_990_462_929],
    [-3.0, -1.0e-05, -1.570_799_660_128_23],
    [1.0e-300, 1.0, 1.0e-300],
    [7.0, 7.1, 0.778_306_083_723_128_6],
    [0.37, 1.0, 0.354_379_919_123_437_8],
    [-0.62, -1.0, -2.586_596_926_251_206_5],
];

/// Units in the last place between two numbers.
fn units(a: f64, b: f64) -> u64 {
    let ordered = |x: f64| {
        let bits = x.to_bits().cast_signed();
        if bits < 0 { i64::MIN - bits } else { bits }
    };
    ordered(a).abs_diff(ordered(b))
}

#[test]
fn values_are_those_of_60_digit_arithmetic() {
    type Function = fn(f64) -> f64;
    let tables: [(&str, Function, &[[f64; 2]], u64); 8] = [
        ("exp", exp, &EXP, 1),
        ("exp_m1", exp_m1, &EXP_M1, 1),
        ("ln", ln, &LN, 1),
        ("ln_1p", ln_1p, &LN_1P, 1),
        ("sin", sin, &SIN, 1),
        ("cos", cos, &COS, 1),
        ("erf", erf, &ERF, 2),
        ("erfc", erfc, &ERFC, 4),
    ];
    for (name, function, table, bound) in tables {
        for &[x, expected] in table {
            let found = function(x);
            assert!(units(found, expected) <= bound, "{name}({x:e}) {found:e}");
        }
    }
    for [y, x, expected] in ATAN2 {
        assert!(units(atan2(y, x), expected) <= 1, "atan2({y:e}, {x:e})");
    }
}

/// Functions of the system have errors of their own, mostly below 1 unit.
#[test]
fn values_are_within_units_of_those_of_the_system() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut largest = [0; 9];
    for _ in 0..100_000 {
        let mut within = |low: f64, high: f64| low + (high - low) * rng.random::<f64>();
        let (x, y) = (within(-1.0, 1.0), within(-1.0, 1.0));
        let wide = within(-745.0, 709.0);
        let positive = (wide * 0.99).exp();
        let long = 1e6 * x * y;
        let tail = 27.0 * x * y;
        let pairs = [
            [exp(wide), wide.exp()],
            [exp_m1(5.0 * x * y), (5.0 * x * y).exp_m1()],
            [ln(positive), positive.ln()],
            [ln_1p(x * y * y), (x * y * y).ln_1p()],
            [sin(long), long.sin()],
            [cos(long), long.cos()],
            [atan2(y, x), y.atan2(x)],
            [erf(tail), libm::erf(tail)],
            [erfc(tail), libm::erfc(tail)],
        ];
        for (largest, [own, other]) in largest.iter_mut().zip(pairs) {
            if other.is_normal() {
                *largest = units(own, other).max(*largest);
            }
        }
    }
    println!("{largest:?}");
    for (largest, bound) in largest.into_iter().zip([2, 2, 2, 2, 2, 2, 2, 3, 5]) {
        assert!(largest <= bound, "{largest}");
    }
}

#[test]
fn angles_of_the_largest_and_smallest_points_are_those_of_the_system() {
    for (y, x) in [
        (1.2e308, 1.7e308),
        (1e308, -1.79e308),
        (1e-323, 1.5e-323),
        (3e-310, 2e-309),
    ] {
        assert!(units(atan2(y, x), f64::atan2(y, x)) <= 2, "{y:e} {x:e}");
    }
}

#[test]
fn limits_of_ranges_have_their_values() {
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
    const INFINITY: f64 = f64::INFINITY;
    let same = |a: f64, b: f64| assert!(a.to_bits() == b.to_bits(), "{a:e} {b:e}");
    for (found, expected) in [
        (exp(0.0), 1.0),
        (exp(INFINITY), INFINITY),
        (exp(709.79), INFINITY),
        (exp(-INFINITY), 0.0),
        (exp(-745.13), 5e-324),
        (exp_m1(0.0), 0.0),
        (exp_m1(INFINITY), INFINITY),
        (exp_m1(-INFINITY), -1.0),
        (ln(1.0), 0.0),
        (ln(0.0), -INFINITY),
        (ln(INFINITY), INFINITY),
        (ln_1p(0.0), 0.0),
        (ln_1p(-1.0), -INFINITY),
        (ln_1p(INFINITY), INFINITY),
        (sin(0.0), 0.0),
        (cos(0.0), 1.0),
        (erf(0.0), 0.0),
        (erf(INFINITY), 1.0),
        (erf(-INFINITY), -1.0),
        (erfc(0.0), 1.0),
        (erfc(INFINITY), 0.0),
        (erfc(-INFINITY), 2.0),
        (sin(1e300), 0.0),
        (cos(-1e300), 1.0),
        (atan2(0.0, 1.0), 0.0),
        (atan2(0.0, 0.0), 0.0),
        (atan2(0.0, -1.0), PI),
        (atan2(-0.0, -1.0), -PI),
        (atan2(1.0, 0.0), FRAC_PI_2),
        (atan2(-1.0, 0.0), -FRAC_PI_2),
        (atan2(1.0, 1.0), FRAC_PI_4),
        (atan2(INFINITY, INFINITY), FRAC_PI_4),
        (atan2(2.0, INFINITY), 0.0),
        (atan2(INFINITY, 2.0), FRAC_PI_2),
    ] {
        same(found, expected);
    }
    for x in [
        exp(f64::NAN),
        exp_m1(f64::NAN),
        ln(f64::NAN),
        ln(-1.0),
        ln_1p(-2.0),
        sin(f64::NAN),
        erf(f64::NAN),
        erfc(f64::NAN),
        atan2(f64::NAN, 1.0),
        atan2(1.0, f64::NAN),
        atan2(f64::INFINITY, f64::NAN),
        atan2(f64::NAN, f64::NEG_INFINITY),
        sin(f64::INFINITY),
    ] {
        assert!(x.is_nan());
    }
}

#[test]
fn sines_and_cosines_of_turns_are_the_functions() {
    use std::f64::consts::FRAC_PI_2;
    for i in -40_000..=40_000 {
        let turn = f64::from(i) / 10_007.0;
        let [sin, cos] = sin_cos_of_turn(turn);
        // The angle from the nearest quarter: 2 pi turn would be rounded.
        let quarter = (4.0 * turn).round();
        let x = FRAC_PI_2 * (4.0 * turn - quarter);
        let (expected_sin, expected_cos) = match (quarter as i64).rem_euclid(4) {
            0 => (x.sin(), x.cos()),
            1 => (x.cos(), -x.sin()),
            2 => (-x.sin(), -x.cos()),
            _ => (-x.cos(), x.sin()),
        };
        assert!((sin - expected_sin).abs() < 3e-16, "{turn}: {sin}");
        assert!((cos - expected_cos).abs() < 3e-16, "{turn}: {cos}");
    }
    assert_eq!(sin_cos_of_turn(0.25), [1.0, 0.0]);
    assert_eq!(sin_cos_of_turn(0.5), [0.0, -1.0]);
}
