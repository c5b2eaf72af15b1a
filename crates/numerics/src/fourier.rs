//! Fourier transform of real numbers on a grid, one half of the plane.

mod cyclic;
mod pair;
mod stockham;
#[cfg(test)]
mod tests;
mod transform;
mod unit_root;

use num_complex::Complex;
use rayon::prelude::*;

pub use self::pair::ComplexPair;
pub use self::transform::{FourierTransform, RealFourierTransform};

/// The forward transform of a real grid of shape `[ny, nx]`, not normalised, for wave numbers `kx` from 0 to `nx / 2`. The rest
/// is its complex conjugate.
pub struct HalfPlane {
    shape: [usize; 2],
    /// `ny` numbers for each `kx`.
    columns: Vec<Complex<f64>>,
}

impl HalfPlane {
    /// `fill`: writes row `iy` into a row of zeros.
    pub fn of(shape: [usize; 2], fill: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let [ny, nx] = shape;
        let along_x = RealFourierTransform::new(nx);
        let half = along_x.waves();
        // Two rows in one; with an odd number the last is beside zeros
        let mut rows = vec![ComplexPair::default(); half * ny.div_ceil(2)];
        rows.par_chunks_exact_mut(half).enumerate().for_each_init(
            || (vec![0.0; 2 * nx], along_x.scratch()),
            |(two, scratch), (i, spectra)| {
                two.fill(0.0);
                for (iy, row) in (2 * i..ny).zip(two.chunks_exact_mut(nx)) {
                    fill(iy, row);
                }
                let (first, second) = two.split_at(nx);
                along_x.forward([first, second], spectra, scratch);
            },
        );
        let mut columns = vec![Complex::default(); half * ny];
        let along_y = FourierTransform::forward(ny);
        columns.par_chunks_mut(2 * ny).enumerate().for_each_init(
            || along_y.scratch(),
            |scratch, (i, two)| {
                let [kx, next] = [2 * i, (2 * i + 1).min(half - 1)];
                let numbers = rows.chunks_exact(half).flat_map(|row| {
                    let [[a, b], [c, d]] = [row[kx].numbers(), row[next].numbers()];
                    [ComplexPair::new([a, c]), ComplexPair::new([b, d])]
                });
                write(along_y.transform(numbers, scratch), two);
            },
        );
        Self { shape, columns }
    }

    /// The `ny` numbers of each `kx`, in order.
    pub fn columns(&self) -> impl IndexedParallelIterator<Item = &[Complex<f64>]> {
        self.columns.par_chunks_exact(self.shape[0])
    }

    /// Values of `number` of the transform of a grid of numbers, at all wave vectors, shape `[ny, nx]`. `number` must give the same for a
    /// number and its complex conjugate.
    fn whole(
        numbers: &[f64],
        shape: [usize; 2],
        number: impl Fn(Complex<f64>) -> f64 + Sync,
    ) -> Vec<f64> {
        let [ny, nx] = shape;
        let plane = Self::of(shape, |iy, row| {
            row.copy_from_slice(&numbers[iy * nx..][..nx]);
        });
        let mut all = vec![0.0; ny * nx];
        all.par_chunks_exact_mut(nx)
            .enumerate()
            .for_each(|(iy, row)| {
                for (ix, value) in row.iter_mut().enumerate() {
                    // Beyond the half plane stands the opposite wave vector
                    let (kx, ky) = match ix <= nx / 2 {
                        true => (ix, iy),
                        false => (nx - ix, (ny - iy) % ny),
                    };
                    *value = number(plane.columns[kx * ny + ky]);
                }
            });
        all
    }

    /// The inverse transform of the squared magnitudes, not normalised: the circular autocorrelation times the number of samples
    /// squared, shape `[ny, nx]`.
    pub fn circular_autocorrelation(self) -> Vec<f64> {
        let [ny, nx] = self.shape;
        let mut columns = self.columns;
        let along_y = FourierTransform::inverse(ny);
        columns.par_chunks_mut(2 * ny).for_each_init(
            || along_y.scratch(),
            |scratch, two| {
                let power = |value: Complex<f64>| value.norm_sqr().into();
                let second = two.len() - ny;
                let numbers =
                    (0..ny).map(|iy| ComplexPair::new([two[iy], two[second + iy]].map(power)));
                write(along_y.transform(numbers, scratch), two);
            },
        );
        let along_x = RealFourierTransform::new(nx);
        let mut numbers = vec![0.0; nx * ny];
        numbers.par_chunks_mut(2 * nx).enumerate().for_each_init(
            || (along_x.spectra(), along_x.scratch()),
            |(spectra, scratch), (i, rows)| {
                let [iy, next] = [2 * i, (2 * i + 1).min(ny - 1)];
                for (pair, column) in spectra.iter_mut().zip(columns.chunks_exact(ny)) {
                    *pair = ComplexPair::new([column[iy], column[next]]);
                }
                let (first, second) = rows.split_at_mut(nx);
                along_x.inverse(spectra, [first, second], scratch);
            },
        );
        numbers
    }
}

/// Writes the first, or both, of two lines.
fn write(pairs: &[ComplexPair], lines: &mut [Complex<f64>]) {
    for (i, line) in lines.chunks_exact_mut(pairs.len()).enumerate() {
        for (value, pair) in line.iter_mut().zip(pairs) {
            *value = pair.numbers()[i];
        }
    }
}

/// The forward transform of real numbers that are the same at `r` and `-r`, rows of `shape[1]`: real, and the same at `k` and `-k`. Not
/// normalised; the inverse of such numbers is the same sum.
pub fn transform_plane(numbers: &[f64], shape: [usize; 2]) -> Vec<f64> {
    HalfPlane::whole(numbers, shape, |wave| wave.re)
}

/// Squared moduli of the forward transform of real numbers, rows of `shape[1]`. Not normalised.
pub fn power_plane(numbers: &[f64], shape: [usize; 2]) -> Vec<f64> {
    HalfPlane::whole(numbers, shape, |wave| wave.norm_sqr())
}
