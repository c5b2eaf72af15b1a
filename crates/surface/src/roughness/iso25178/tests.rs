//! Parameters of surfaces for which they are known.

use std::f64::consts::{PI, SQRT_2, TAU};

use super::angular_spectrum::AngularSpectrum;
use super::autocorrelation::Autocorrelation;
use super::*;
use crate::roughness::{Axis, all_lines, axis_autocorrelation, mean_height};
use crate::{Border, Roughness};

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!(
        (found - expected).abs() <= tolerance,
        "{found} against {expected} within {tolerance}"
    );
}

fn field([ny, nx]: [usize; 2], spacing: [f64; 2], f: impl Fn(f64, f64) -> f64) -> HeightField {
    let [dx, dy] = spacing;
    let place = |i: usize| ((i % nx) as f64 * dx, (i / nx) as f64 * dy);
    let heights = (0..nx * ny).map(place).map(|(x, y)| f(x, y)).collect();
    HeightField::new(heights, [ny, nx], spacing).unwrap()
}

/// Heights with these values, in an order that is not theirs: 7919 is prime and divides no number of samples below.
fn scattered(shape: [usize; 2], value: impl Fn(f64) -> f64) -> HeightField {
    let n = shape[0] * shape[1];
    let heights = (0..n)
        .map(|i| value(((i * 7919 % n) as f64 + 0.5) / n as f64))
        .collect();
    HeightField::new(heights, shape, [1.0, 1.0]).unwrap()
}

/// Sums over a period of even samples are those of the sine itself to rounding; `Sa` and `Sz` differ by
/// the second order of `pi / n`.
#[test]
fn sine_has_its_height_parameters() {
    let (a, n) = (0.7, 4096);
    let sine = field([4, n], [1.0, 1.0], |x, _| a * (TAU * x / n as f64).sin());
    let found = Roughness::of(&sine);
    close(found.sq, a / SQRT_2, 1e-13);
    close(found.ssk.unwrap(), 0.0, 1e-12);
    close(found.sku.unwrap(), 1.5, 1e-12);
    close(found.sa, 2.0 * a / PI, a * (PI / n as f64).powi(2));
    close(found.sz, 2.0 * a, 1e-13);
    close(found.sp, a, 1e-13);
    close(found.sv, a, 1e-13);
}

/// `c(p) = 10 + 3 (1 - p)`, which the curve between the first and the last sample is to rounding. The half step beyond
/// the ends adds less than `1 / n^2` to volumes.
#[test]
fn uniform_heights_have_a_straight_curve() {
    let shape = [100, 90];
    let found = Iso25178::of(&scattered(shape, |u| 10.0 + 3.0 * u)).functional;
    let exact = 1e-11;
    close(found.sk, 3.0, exact);
    close(found.spk, 0.0, exact);
    close(found.svk, 0.0, exact);
    close(found.smr1, 0.0, exact);
    close(found.smr2, 100.0, exact);
    let step = 3.0 / 9000.0_f64.powi(2);
    close(found.vmp, 3.0 * 0.1 * 0.1 / 2.0, step);
    close(found.vmc, 3.0 * (0.8 * 0.8 - 0.1 * 0.1) / 2.0, step);
    close(found.vvv, 3.0 * 0.2 * 0.2 / 2.0, step);
    close(found.vvc, 3.0 * (0.9 * 0.9 - 0.2 * 0.2) / 2.0, step);
}

/// A plateau with grooves below: 70 % at heights 1 to 0, the rest down to -9. The least slope is that of the plateau.
#[test]
fn plateau_with_valleys_has_its_triangles() {
    let shape = [300, 300];
    let curve = |p: f64| {
        if p < 0.7 {
            1.0 - p / 0.7
        } else {
            -30.0 * (p - 0.7)
        }
    };
    let found = Iso25178::of(&scattered(shape, |u| curve(1.0 - u))).functional;
    let slope = 1.0 / 0.7;
    close(found.sk, slope, 1e-9);
    close(found.spk, 0.0, 1e-9);
    // The lower end of the line, 1 - 1 / 0.7, is met by the steep part.
    let bottom = 1.0 - slope;
    let smr2 = 0.7 - bottom / 30.0;
    // Errors of the half steps at the ends and of the corner: their heights, 30 / n, over 0.3
    close(found.smr2, 100.0 * smr2, 1e-3);
    close(found.svk, 9.0 + bottom, 2e-3);
}

/// The quantile of the normal distribution, by bisection.
fn normal_quantile(p: f64) -> f64 {
    let below = |z: f64| 0.5 * asperity_numerics::elementary::erfc(-z / SQRT_2);
    let (mut from, mut to) = (-9.0, 9.0);
    for _ in 0..60 {
        let middle = 0.5 * (from + to);
        match below(middle) < p {
            true => from = middle,
            false => to = middle,
        }
    }
    0.5 * (from + to)
}

/// Expected values are integrals of the normal curve `z(p)`, of which the moments of the central region are known:
/// with `p = Phi(-z)`, `int z p dp` by parts. Discrete quantiles miss of the tails what is beyond `1 / n`: `z / n` in volume.
#[test]
fn gaussian_heights_have_the_parameters_of_the_normal_curve() {
    let phi = |z: f64| (-0.5 * z * z).exp() / TAU.sqrt();
    let above = |z: f64| 0.5 * asperity_numerics::elementary::erfc(z / SQRT_2);
    let shape = [500, 600];
    let found = Iso25178::of(&scattered(shape, normal_quantile)).functional;

    // Least squares over p from 0.3 to 0.7, by the midpoint rule, whose error is of second order in the step
    let steps = 4000;
    let moment: f64 = (0..steps)
        .map(|i| {
            let p = 0.3 + 0.4 * (f64::from(i) + 0.5) / f64::from(steps);
            (p - 0.5) * normal_quantile(1.0 - p) * 0.4 / f64::from(steps)
        })
        .sum();
    let sk = -moment / (0.4_f64.powi(3) / 12.0);
    close(found.sk, sk, 1e-6);
    let smr1 = above(0.5 * sk);
    close(found.smr1, 100.0 * smr1, 1e-4);
    close(found.smr2, 100.0 - 100.0 * smr1, 1e-4);
    let spk = 2.0 * (phi(0.5 * sk) - 0.5 * sk * smr1) / smr1;
    let tail = 5.0 / 300_000.0;
    close(found.spk, spk, 2.0 * tail / smr1);
    close(found.svk, spk, 2.0 * tail / smr1);

    // Material above level z: phi(z) - z P(Z > z); void below it: phi(z) + z P(Z < z)
    let material = |z: f64| phi(z) - z * above(z);
    let void = |z: f64| phi(z) + z * above(-z);
    let [z10, z80] = [normal_quantile(0.9), normal_quantile(0.2)];
    close(found.vmp, material(z10), tail);
    close(found.vmc, material(z80) - material(z10), tail);
    close(found.vvv, void(z80), tail);
    close(found.vvc, void(z10) - void(z80), tail);
}

#[test]
fn flat_surface_has_no_texture() {
    let found = Iso25178::of(&field([8, 9], [1.0, 1.0], |_, _| 3.7));
    let functional = found.functional;
    assert_eq!([functional.sk, functional.spk, functional.svk], [0.0; 3]);
    assert_eq!([functional.smr1, functional.smr2], [0.0, 100.0]);
    assert_eq!([functional.vmp, functional.vvc, found.sdr], [0.0; 3]);
    let spatial = found.spatial;
    assert_eq!([spatial.sal, spatial.str, spatial.std], [None; 3]);
}

/// Every facet has the gradient `(0.75, 1)`, so the area grows by `sqrt(1 + 0.5625 + 1) - 1`.
#[test]
fn plane_has_the_area_of_its_inclination() {
    let plane = field([5, 6], [0.5, 2.0], |x, y| 0.75 * x + y).with_border(Border::Open);
    let expected = 100.0 * (2.5625_f64.sqrt() - 1.0);
    close(Iso25178::of(&plane).sdr, expected, 1e-11);
}

/// The axes of the plane are found by another way in [`axis_autocorrelation`]; other lags by the definition.
#[test]
fn autocorrelation_matches_its_definition() {
    for [ny, nx] in [[2, 2], [7, 12], [16, 9]] {
        let heights = (0..nx * ny)
            .map(|i| ((i * i) as f64 * 0.37).sin())
            .collect();
        let surface = HeightField::new(heights, [ny, nx], [1.0, 1.0]).unwrap();
        for border in [Border::Periodic, Border::Open, Border::Mirrored] {
            let surface = surface.clone().with_border(border);
            let mean = mean_height(&surface);
            let found = Autocorrelation::of(&surface).unwrap();
            let along_x = axis_autocorrelation(&surface, mean, Axis::X, &all_lines(surface.ny()));
            for (lag, value) in along_x.iter().enumerate() {
                close(found.value(lag as i64, 0), value / along_x[0], 1e-13);
            }
            let [lx, ly] = [nx as i64 / 2, ny as i64 / 2];
            for (x, y) in [(lx, ly), (1, -1), (-lx, 1)] {
                let (mut sum, mut pairs) = (0.0, 0.0);
                for iy in 0..ny as i64 {
                    for ix in 0..nx as i64 {
                        let [jx, jy] = [ix + x, iy + y];
                        let [wx, wy] = [jx.rem_euclid(nx as i64), jy.rem_euclid(ny as i64)];
                        if border == Border::Periodic || (wx == jx && wy == jy) {
                            let a = surface.height(ix as usize, iy as usize) - mean;
                            let b = surface.height(wx as usize, wy as usize) - mean;
                            sum += a * b;
                            pairs += 1.0;
                        }
                    }
                }
                close(found.value(x, y), sum / pairs / along_x[0], 1e-13);
            }
        }
    }
}

/// A bump `exp(-2 u^2 / a^2 - 2 v^2 / b^2)`, whose autocorrelation is `exp(-u^2 / a^2 - v^2 / b^2)` and spectrum Gaussian, with
/// the axis `u` at `azimuth`. Sums over the samples are the integrals to rounding.
fn bump(lengths: [f64; 2], azimuth: f64) -> HeightField {
    let (sin, cos) = azimuth.sin_cos();
    let side = 256.0;
    field([256, 512], [0.5, 1.0], |x, y| {
        let (x, y) = (x - side / 2.0, y - side / 2.0);
        let (u, v) = (x * cos + y * sin, y * cos - x * sin);
        (-2.0 * (u / lengths[0]).powi(2) - 2.0 * (v / lengths[1]).powi(2)).exp()
    })
}

/// The mean height of the bump, `pi a b / (2 A)`, takes the fraction `rho = pi a b / A` from its autocorrelation, which is then
/// `(exp(-r^2 / a^2) - rho) / (1 - rho)`. It falls to 0.2 at `r = a sqrt(ln(1 / (0.2 + 0.8 rho)))`, nearly `a sqrt(ln 5)`. Cubic
/// convolution of a Gaussian errs by third order of spacing over length, times its third derivative: below 1e-3 of the length.
#[test]
fn gaussian_autocorrelation_has_its_decay_and_direction() {
    for ([a, b], azimuth) in [
        ([10.0, 10.0], 0.0),
        ([8.0, 16.0], 0.0),
        ([8.0, 24.0], 0.5),
        ([8.0, 24.0], 2.6),
    ] {
        let found = SpatialParameters::of(&bump([a, b], azimuth));
        let rho = PI * a * b / (256.0 * 256.0);
        let decay = a * (-(0.2 + 0.8 * rho).ln()).sqrt();
        close(found.sal.unwrap(), decay, 1e-3 * decay);
        close(found.str.unwrap(), a / b, 1e-3);
        if a < b {
            // Half of the angle that a cell covers at the wave number 2 / a of most power, `2 pi / L` over it
            let half = (0.5 * PI * a / 256.0).to_degrees();
            close(found.std.unwrap(), azimuth.to_degrees(), half);
        }
    }
}

/// A plane wave has its own direction, periodic or tapered, within a quarter of a bin: triangles about it are symmetric, and a parabola
/// through three of their points is off by less than that.
#[test]
fn wave_has_its_direction() {
    for (mx, my) in [(12.0, 0.0), (12.0, 7.0), (-5.0, 20.0), (0.0, 9.0)] {
        let wave = field([128, 200], [0.5, 1.0], |x, y| {
            (TAU * (mx * x / 100.0 + my * y / 128.0)).sin()
        });
        let expected = (my / 128.0_f64).atan2(mx / 100.0).to_degrees();
        for border in [Border::Periodic, Border::Open] {
            let wave = wave.clone().with_border(border);
            let found = AngularSpectrum::of(&wave).direction_degrees().unwrap();
            let difference = (found - expected + 90.0).rem_euclid(180.0) - 90.0;
            close(difference, 0.0, 0.25);
        }
    }
}

/// A grating does not decay along its grooves, and `cos` falls to 0.2 at `acos(0.2) / 2 pi` of its period. Sal is across the
/// grooves; interpolation errs by third order of `2 pi / 32`, below 1 %.
#[test]
fn grating_has_no_aspect_ratio() {
    let grating = field([64, 128], [1.0, 1.0], |x, _| (TAU * x / 32.0).cos());
    let found = SpatialParameters::of(&grating);
    let expected = 32.0 * 0.2_f64.acos() / TAU;
    close(found.sal.unwrap(), expected, 0.01 * expected);
    assert_eq!(found.str, None);
}
