//! The random spectrum, a column of equal `kx` at a time.

use num_complex::Complex;

use super::filter::Filter;
use super::noise::{Noise, Side};

/// Fills `column` with column `ix` of the half spectrum of a surface, rows in the order of an FFT.
///
/// `amplitudes` is room for `ny / 2 + 1` numbers.
pub(super) fn fill_column(
    filter: &Filter,
    noise: &Noise,
    nx: usize,
    ix: usize,
    amplitudes: &mut [f64],
    column: &mut [Complex<f64>],
) {
    let ny = column.len();

    // The waves of positive ky stand at the beginning, those of negative ky backwards from the end.
    let positive = filter.rows(ix, Side::Positive);
    filter.fill(ix, Side::Positive, &mut amplitudes[..positive]);
    noise.waves(ix, Side::Positive, positive, |first, re, im| {
        let waves = re.iter().zip(im).zip(&amplitudes[first..]);
        for (value, wave) in column[first..].iter_mut().zip(waves) {
            *value = scaled(wave);
        }
    });
    let negative = filter.rows(ix, Side::Negative);
    column[positive..ny - negative].fill(Complex::default());

    // Where kx and -kx are one, so are the waves of k and -k.
    if ix == 0 || 2 * ix == nx {
        for iy in 1..=negative {
            column[ny - iy] = column[iy].conj();
        }
        // Waves that are their own opposites are real, and as strong as the others.
        column[0] = real(column[0]);
        if ny.is_multiple_of(2) {
            column[ny / 2] = real(column[ny / 2]);
        }
        if ix == 0 {
            column[0] = Complex::default();
        }
        return;
    }
    filter.fill(ix, Side::Negative, &mut amplitudes[..negative]);
    noise.waves(ix, Side::Negative, negative, |first, re, im| {
        let waves = re.iter().zip(im).zip(&amplitudes[first..]);
        for (value, wave) in column[..ny - first].iter_mut().rev().zip(waves) {
            *value = scaled(wave);
        }
    });
}

/// The amplitude times the complex normal number.
fn scaled(((&re, &im), &amplitude): ((&f32, &f32), &f64)) -> Complex<f64> {
    Complex {
        re: amplitude * f64::from(re),
        im: amplitude * f64::from(im),
    }
}

/// A real number of the variance that the complex one has.
fn real(value: Complex<f64>) -> Complex<f64> {
    Complex {
        re: std::f64::consts::SQRT_2 * value.re,
        im: 0.0,
    }
}
