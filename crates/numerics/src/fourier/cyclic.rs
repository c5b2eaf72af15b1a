//! Forward transform of lines of any length, two at a time: by factors of the length, or as a convolution.

use num_complex::Complex;

use super::pair::ComplexPair;
use super::stockham::Stockham;
use super::unit_root::unit_root;

/// The forward transform of lines of one length, not normalised.
#[derive(Debug)]
pub(super) enum Cyclic {
    /// The length has small factors.
    Factored(Stockham),
    /// It has others.
    Convolved(Bluestein),
}

impl Cyclic {
    /// `length`: at least 1.
    pub(super) fn new(length: usize) -> Self {
        match Stockham::takes(length) {
            true => Self::Factored(Stockham::new(length)),
            false => Self::Convolved(Bluestein::new(length)),
        }
    }

    /// Length of the scratch memory that [`Cyclic::transform`] takes.
    pub(super) const fn scratch_len(&self) -> usize {
        match self {
            Self::Factored(stockham) => 2 * stockham.length(),
            Self::Convolved(bluestein) => 2 * bluestein.inner.length(),
        }
    }

    /// The transform of the numbers that `fill` writes, in `scratch`.
    pub(super) fn transform<'a>(
        &self,
        scratch: &'a mut [ComplexPair],
        fill: impl FnOnce(&mut [ComplexPair]),
    ) -> &'a [ComplexPair] {
        let (x, y) = scratch[..self.scratch_len()].split_at_mut(self.scratch_len() / 2);
        match self {
            Self::Factored(stockham) => {
                fill(x);
                stockham.transform(x, y)[0]
            }
            Self::Convolved(bluestein) => {
                let (numbers, padding) = x.split_at_mut(bluestein.chirp.len());
                fill(numbers);
                padding.fill(ComplexPair::default());
                bluestein.transform(x, y)
            }
        }
    }
}

/// Bluestein's transform: a convolution with a chirp, by transforms of a length with small factors.
///
/// # Source
/// Bluestein, IEEE Trans. Audio Electroacoust. 18, 451 (1970).
#[derive(Debug)]
pub(super) struct Bluestein {
    inner: Stockham,
    /// `exp(-pi i k^2 / n)`.
    chirp: Vec<Complex<f64>>,
    /// Transform of the conjugate of the chirp, divided by its length.
    transfer: Vec<Complex<f64>>,
}

impl Bluestein {
    fn new(length: usize) -> Self {
        // Twice the length, so that the ends of the convolution do not meet
        let padded = |factor: usize| factor * (2 * length).div_ceil(factor).next_power_of_two();
        let least = [3, 5, 9, 15].map(padded);
        let least = least.into_iter().fold(padded(1), usize::min);
        let inner = Stockham::new(least);
        let chirp = (0..length).map(|k| unit_root(k * k % (2 * length), 2 * length));
        let chirp: Vec<Complex<f64>> = chirp.collect();
        let mut weights = vec![ComplexPair::default(); 2 * least];
        for (k, value) in chirp.iter().enumerate() {
            let value = ComplexPair::new([value.conj() / least as f64; 2]);
            weights[k] = value;
            weights[(least - k) % least] = value;
        }
        let (x, y) = weights.split_at_mut(least);
        let [transfer, _] = inner.transform(x, y);
        let transfer = transfer.iter().map(|value| value.numbers()[0]).collect();
        Self {
            inner,
            chirp,
            transfer,
        }
    }

    /// Transforms the numbers at the beginning of `x`, with zeros behind them.
    fn transform<'a>(
        &self,
        x: &'a mut [ComplexPair],
        y: &'a mut [ComplexPair],
    ) -> &'a [ComplexPair] {
        for (value, chirp) in x.iter_mut().zip(&self.chirp) {
            *value = *value * *chirp;
        }
        let [x, y] = self.inner.transform(x, y);
        for (value, transfer) in x.iter_mut().zip(&self.transfer) {
            *value = (*value * *transfer).conj();
        }
        let [x, _] = self.inner.transform(x, y);
        for (value, chirp) in x.iter_mut().zip(&self.chirp) {
            *value = value.conj() * *chirp;
        }
        &x[..self.chirp.len()]
    }
}
