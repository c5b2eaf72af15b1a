//! Fourier transforms of complex and of real lines of any length, two lines at a time; not normalised.
//!
//! They consist of sums and products in a fixed order, with factors of their own (`unit_root`). So they have the same bits on every
//! machine, and those of a line do not depend on the other line.

use num_complex::Complex;

use super::cyclic::Cyclic;
use super::pair::ComplexPair;
use super::unit_root::unit_root;

/// Transform of complex lines.
#[derive(Debug)]
pub struct FourierTransform {
    cyclic: Cyclic,
    inverse: bool,
}

impl FourierTransform {
    /// `sum_j x[j] exp(-2 pi i j k / length)`, of a length of at least 1.
    #[must_use]
    pub fn forward(length: usize) -> Self {
        Self {
            cyclic: Cyclic::new(length),
            inverse: false,
        }
    }

    /// `sum_k x[k] exp(2 pi i j k / length)`, of a length of at least 1.
    #[must_use]
    pub fn inverse(length: usize) -> Self {
        Self {
            cyclic: Cyclic::new(length),
            inverse: true,
        }
    }

    /// Scratch memory of a transform.
    #[must_use]
    pub fn scratch(&self) -> Vec<ComplexPair> {
        vec![ComplexPair::default(); self.scratch_len()]
    }

    /// Length of [`FourierTransform::scratch`].
    #[must_use]
    pub const fn scratch_len(&self) -> usize {
        self.cyclic.scratch_len()
    }

    /// Transforms two lines, in `scratch`.
    pub fn transform<'a>(
        &self,
        mut numbers: impl Iterator<Item = ComplexPair>,
        scratch: &'a mut [ComplexPair],
    ) -> &'a [ComplexPair] {
        self.cyclic.transform(scratch, |places| {
            if self.inverse {
                // The forward transform of the numbers in reverse order, but for the first
                let (first, others) = places.split_at_mut(1);
                for (place, number) in first.iter_mut().zip(&mut numbers) {
                    *place = number;
                }
                for (place, number) in others.iter_mut().rev().zip(numbers) {
                    *place = number;
                }
            } else {
                for (place, number) in places.iter_mut().zip(numbers) {
                    *place = number;
                }
            }
        })
    }
}

/// Transform of real lines to half their spectrum, wave numbers 0 to `length / 2`, and back.
#[derive(Debug)]
pub struct RealFourierTransform {
    length: usize,
    /// Of half the length if that is even, or else of all.
    cyclic: Cyclic,
    /// Factors `exp(-2 pi i k / length)` of the lower half of the spectrum; of an even length.
    roots: Vec<Complex<f64>>,
}

impl RealFourierTransform {
    /// `length`: at least 1.
    #[must_use]
    pub fn new(length: usize) -> Self {
        let (cyclic, roots) = match length.is_multiple_of(2) {
            true => (length / 2, length / 4 + 1),
            false => (length, 0),
        };
        Self {
            length,
            cyclic: Cyclic::new(cyclic),
            roots: (0..roots).map(|k| unit_root(k, length)).collect(),
        }
    }

    /// Numbers of a line.
    #[must_use]
    pub const fn length(&self) -> usize {
        self.length
    }

    /// Wave numbers of half the spectrum.
    #[must_use]
    pub const fn waves(&self) -> usize {
        self.length / 2 + 1
    }

    /// Memory for half the spectra of two lines.
    #[must_use]
    pub fn spectra(&self) -> Vec<ComplexPair> {
        vec![ComplexPair::default(); self.waves()]
    }

    /// Scratch memory of a transform.
    #[must_use]
    pub fn scratch(&self) -> Vec<ComplexPair> {
        vec![ComplexPair::default(); self.scratch_len()]
    }

    /// Length of [`RealFourierTransform::scratch`].
    #[must_use]
    pub const fn scratch_len(&self) -> usize {
        self.cyclic.scratch_len()
    }

    /// Returns `true` if two samples at a time are a complex number.
    const fn is_even(&self) -> bool {
        self.length.is_multiple_of(2)
    }

    /// Transforms two lines, `sum_j x[j] exp(-2 pi i j k / length)`. The second may be empty; it then counts as the first.
    pub fn forward(
        &self,
        lines: [&[f64]; 2],
        spectra: &mut [ComplexPair],
        scratch: &mut [ComplexPair],
    ) {
        let half = self.length / 2;
        let lines = match lines {
            [line, []] => [line, line],
            both => both,
        };
        if !self.is_even() {
            let results = self.cyclic.transform(scratch, |places| {
                for ((place, a), b) in places.iter_mut().zip(lines[0]).zip(lines[1]) {
                    *place = ComplexPair::new([a.into(), b.into()]);
                }
            });
            spectra.copy_from_slice(&results[..=half]);
            return;
        }
        // Even samples as real parts, odd ones as imaginary parts
        let results = self.cyclic.transform(scratch, |places| {
            let [a, b] = lines.map(|line| line.as_chunks::<2>().0);
            for ((place, a), b) in places.iter_mut().zip(a).zip(b) {
                *place = ComplexPair::new([a, b].map(|&[re, im]| Complex { re, im }));
            }
        });
        for (k, root) in self.roots.iter().enumerate() {
            let (low, high) = (results[k], results[(half - k) % half].conj());
            let even = (low + high) * 0.5;
            let odd = (high - low).times_i() * (root * 0.5);
            spectra[half - k] = (even - odd).conj();
            spectra[k] = even + odd;
        }
    }

    /// Transforms half the spectra of two lines back, `sum_k x[k] exp(2 pi i j k / length)` over all wave numbers, those of the other half
    /// being conjugates. Imaginary parts at wave numbers that are their own opposites are ignored. The second line may be empty.
    pub fn inverse(
        &self,
        spectra: &[ComplexPair],
        lines: [&mut [f64]; 2],
        scratch: &mut [ComplexPair],
    ) {
        let half = self.length / 2;
        // The forward transform of the numbers in reverse order, but for the first
        let results = self.cyclic.transform(scratch, |places| {
            if !self.is_even() {
                places[0] = spectra[0].real();
                for k in 1..=half {
                    places[k] = spectra[k].conj();
                    places[self.length - k] = spectra[k];
                }
                return;
            }
            let ends = [spectra[0], spectra[half]].map(ComplexPair::real);
            places[0] = ends[0] + ends[1] + (ends[0] - ends[1]).times_i();
            for (k, root) in self.roots.iter().enumerate().skip(1) {
                let (low, high) = (spectra[k], spectra[half - k].conj());
                let even = low + high;
                let odd = ((low - high) * root.conj()).times_i();
                places[k] = (even - odd).conj();
                places[half - k] = even + odd;
            }
        });
        for (i, line) in lines.into_iter().enumerate() {
            if self.is_even() {
                for (values, pair) in line.as_chunks_mut::<2>().0.iter_mut().zip(results) {
                    let Complex { re, im } = pair.numbers()[i];
                    *values = [re, im];
                }
            } else {
                for (value, pair) in line.iter_mut().zip(results) {
                    *value = pair.numbers()[i].re;
                }
            }
        }
    }
}
