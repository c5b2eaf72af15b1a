//! Fourier transform of real numbers on a grid, one half of the plane.

use rayon::prelude::*;
use realfft::RealFftPlanner;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

use crate::columns::columns;

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
        let half = nx / 2 + 1;
        let forward = RealFftPlanner::<f64>::new().plan_fft_forward(nx);
        let mut rows = vec![Complex::default(); half * ny];
        rows.par_chunks_exact_mut(half).enumerate().for_each_init(
            || (forward.make_input_vec(), forward.make_scratch_vec()),
            |(row, scratch), (iy, output)| {
                row.fill(0.0);
                fill(iy, row);
                let done = forward.process_with_scratch(row, output, scratch);
                debug_assert!(done.is_ok(), "buffers have the lengths planned");
            },
        );
        let mut turned = columns(&rows, half);
        drop(rows);
        transform(&mut turned, ny, &*FftPlanner::new().plan_fft_forward(ny));
        Self {
            shape,
            columns: turned,
        }
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
        let half = nx / 2 + 1;
        let mut powers = self.columns;
        powers
            .par_iter_mut()
            .for_each(|value| *value = value.norm_sqr().into());
        transform(&mut powers, ny, &*FftPlanner::new().plan_fft_inverse(ny));
        let mut rows = columns(&powers, ny);
        drop(powers);
        let inverse = RealFftPlanner::<f64>::new().plan_fft_inverse(nx);
        let mut numbers = vec![0.0; nx * ny];
        numbers
            .par_chunks_exact_mut(nx)
            .zip(rows.par_chunks_exact_mut(half))
            .for_each_init(
                || inverse.make_scratch_vec(),
                |scratch, (output, row)| {
                    // Rounding leaves an imaginary part where symmetry allows none.
                    row[0].im = 0.0;
                    if nx.is_multiple_of(2) {
                        row[nx / 2].im = 0.0;
                    }
                    let done = inverse.process_with_scratch(row, output, scratch);
                    debug_assert!(done.is_ok(), "buffers have the lengths planned");
                },
            );
        numbers
    }
}

fn transform(lines: &mut [Complex<f64>], length: usize, fft: &dyn Fft<f64>) {
    lines.par_chunks_exact_mut(length).for_each_init(
        || vec![Complex::default(); fft.get_inplace_scratch_len()],
        |scratch, line| fft.process_with_scratch(line, scratch),
    );
}

/// The forward transform of real numbers that are the same at `r` and `-r`, rows of `nx`: real, and the same at `k` and `-k`. Not
/// normalised; the inverse of such numbers is the same sum.
pub fn transform_plane(numbers: &[f64], shape: [usize; 2]) -> Vec<f64> {
    HalfPlane::whole(numbers, shape, |wave| wave.re)
}

/// Squared moduli of the forward transform of real numbers, rows of `nx`. Not normalised.
pub fn power_plane(numbers: &[f64], shape: [usize; 2]) -> Vec<f64> {
    HalfPlane::whole(numbers, shape, |wave| wave.norm_sqr())
}
