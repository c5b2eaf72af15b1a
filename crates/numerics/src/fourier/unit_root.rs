//! Roots of one: the factors of Fourier transforms.

use std::f64::consts::FRAC_PI_4;

use num_complex::Complex;

use crate::elementary::sin_cos;

/// `exp(-2 pi i k / n)` for `k < n`: the fraction, exact, is reduced to an angle of at most an eighth of a turn.
pub(super) fn unit_root(k: usize, n: usize) -> Complex<f64> {
    let (octant, rest) = (8 * k / n, 8 * k % n);
    let of_part = |part: usize| sin_cos(FRAC_PI_4 * (part as f64 / n as f64));
    let (sin, cos) = match octant % 2 {
        0 => of_part(rest),
        _ => {
            let (sin, cos) = of_part(n - rest);
            (cos, sin)
        }
    };
    match octant / 2 {
        0 => Complex::new(cos, -sin),
        1 => Complex::new(-sin, -cos),
        2 => Complex::new(-cos, sin),
        _ => Complex::new(sin, cos),
    }
}
