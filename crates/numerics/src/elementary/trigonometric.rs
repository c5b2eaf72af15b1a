//! Sine, cosine and the angle of a point.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, PI};

use super::arithmetic::{ROUNDING, nearest_integer, short_polynomial};

/// `pi / 2` in parts of 33 bits, so that multiples of the first two up to 2^20 are exact.
const HALF_PI: [f64; 3] = [
    1.570_796_326_734_125_6,
    6.077_100_506_303_966e-11,
    2.022_266_248_795_950_6e-21,
];

/// Largest angle that is reduced, 2^50.
const MAX_ANGLE: f64 = 1_125_899_906_842_624.0;

/// `pi / 2` less its nearest number.
const REST_OF_HALF_PI: f64 = 6.123_233_995_736_766e-17;

/// Taylor coefficients of `(sin(r) - r) / r^3` in `r^2`; the first neglected term is below 1e-18 of the sine for `|r| <= pi / 4`.
const SIN: [f64; 8] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
];

/// Taylor coefficients of `(cos(r) - 1 + r^2 / 2) / r^4` in `r^2`; the first neglected term is below 3e-18.
const COS: [f64; 7] = [
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
    1.0 / 20_922_789_888_000.0,
];

/// Taylor coefficients of `(u - atan(u)) / u^3` in `u^2`; the first neglected term is below 1e-20 for `|u| <= 1/8`.
const ATAN: [f64; 9] = [
    1.0 / 3.0,
    -1.0 / 5.0,
    1.0 / 7.0,
    -1.0 / 9.0,
    1.0 / 11.0,
    -1.0 / 13.0,
    1.0 / 15.0,
    -1.0 / 17.0,
    1.0 / 19.0,
];

/// `atan(k / 4)` for k from 0 to 4, and what its nearest number leaves.
const NODES: [[f64; 2]; 5] = [
    [0.0, 0.0],
    [0.244_978_663_126_864_14, 1.069_875_561_873_445_1e-17],
    [0.463_647_609_000_806_1, 2.269_877_745_296_168_7e-17],
    [0.643_501_108_793_284_4, 1.583_478_505_144_428_6e-17],
    [FRAC_PI_4, 3.061_616_997_868_383e-17],
];

/// Sine and cosine of `x`, each to 1 unit in the last place for `|x| < 1.6e6`; beyond, to `|x|` times 2^-51 in absolute terms, about the
/// rounding error of `x` itself. Above 2^50, where neighbouring numbers are far apart, they are those of zero.
#[inline(always)]
#[must_use]
pub fn sin_cos(x: f64) -> (f64, f64) {
    let x = if x.abs() > MAX_ANGLE { 0.0 * x } else { x };
    // Reduce to -pi/4 to pi/4, with the rounding error
    let turns = nearest_integer(x * FRAC_2_PI);
    let first = x - turns * HALF_PI[0];
    let second = turns * HALF_PI[1];
    let high = first - second;
    let low = ((first - high) - second) - turns * HALF_PI[2];
    let r = high + low;
    let error = low - (r - high);
    // Sum the Taylor series
    let square = r * r;
    let sine = r + (square * r * short_polynomial(square, &SIN) + error * (1.0 - 0.5 * square));
    let half = 0.5 * square;
    let leading = 1.0 - half;
    let cosine = leading
        + (((1.0 - leading) - half)
            + (square * square * short_polynomial(square, &COS) - r * error));
    // Turn by quarters
    let quarter = turns - 4.0 * nearest_integer(0.25 * turns);
    let is_odd = quarter == 1.0 || quarter == -1.0;
    let (a, b) = if is_odd {
        (cosine, sine)
    } else {
        (sine, cosine)
    };
    let is_half = quarter == 2.0 || quarter == -2.0;
    (
        if is_half || quarter == -1.0 { -a } else { a },
        if is_half || quarter == 1.0 { -b } else { b },
    )
}

/// Sine and cosine of `2 pi turn`, off by less than 3e-16, for `|turn| < 2^49`.
#[inline(always)]
#[must_use]
pub fn sin_cos_of_turn(turn: f64) -> [f64; 2] {
    // The nearest quarter turn, and the rest: at most 45 degrees
    let rounded = 4.0 * turn + ROUNDING;
    let quarter = rounded.to_bits();
    let r = FRAC_PI_2 * (4.0 * turn - (rounded - ROUNDING));
    let square = r * r;
    let sine = r + r * square * short_polynomial(square, &SIN);
    let cosine = 1.0 + square * (square * short_polynomial(square, &COS) - 0.5);
    // Swap and change signs by the quarter
    let is_odd = quarter & 1 != 0;
    let (along, across) = if is_odd {
        (sine, cosine)
    } else {
        (cosine, sine)
    };
    let sign = |bit: u64| (bit & 2) << 62;
    [
        f64::from_bits(across.to_bits() ^ sign(quarter)),
        f64::from_bits(along.to_bits() ^ sign(quarter + 1)),
    ]
}

/// `sin(x)`, see [`sin_cos`].
#[inline(always)]
#[must_use]
pub fn sin(x: f64) -> f64 {
    sin_cos(x).0
}

/// `cos(x)`, see [`sin_cos`].
#[inline(always)]
#[must_use]
pub fn cos(x: f64) -> f64 {
    sin_cos(x).1
}

/// The angle of the point `(x, y)`, from -pi to pi, to 1 unit in the last place.
#[inline(always)]
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    let [ax, ay] = [x.abs(), y.abs()];
    let is_steep = ay > ax;
    let (low, high) = if is_steep { (ax, ay) } else { (ay, ax) };
    // Scale what would overflow, or is subnormal
    let scale = if high > 4e307 { 0.25 } else { 1.0 };
    let scale = if high < 1e-290 {
        18_014_398_509_481_984.0
    } else {
        scale
    };
    let (low, high) = (low * scale, high * scale);
    // Zero and infinity beside themselves
    let is_diagonal = low == f64::INFINITY;
    let low = if is_diagonal { 1.0 } else { low };
    let high = if high == 0.0 || is_diagonal {
        1.0
    } else {
        high
    };
    // Subtract the nearest of the nodes: tan(a - b) = (tan a - tan b) / (1 + tan a tan b)
    let mut node = [0.0, NODES[0][0], NODES[0][1]];
    for (k, [angle, rest]) in NODES.into_iter().enumerate().skip(1) {
        let tangent = 0.25 * k as f64;
        let is_beyond = low > (tangent - 0.125) * high;
        let of_k = [tangent, angle, rest];
        node = if is_beyond { of_k } else { node };
    }
    let [tangent, angle, rest] = node;
    let is_infinite = high == f64::INFINITY;
    let quotient = (low - tangent * high) / (high + tangent * low);
    let u = if is_infinite { 0.0 } else { quotient };
    let square = u * u;
    let first = angle + (u - (u * square * short_polynomial(square, &ATAN) - rest));
    // Undo the reflections
    let second = match is_steep {
        true => FRAC_PI_2 - (first - REST_OF_HALF_PI),
        false => first,
    };
    let third = match x.is_sign_negative() {
        true => PI - (second - 2.0 * REST_OF_HALF_PI),
        false => second,
    };
    if x.is_nan() | y.is_nan() {
        f64::NAN
    } else {
        third.copysign(y)
    }
}
