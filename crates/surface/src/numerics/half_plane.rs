//! Fourier transform of real numbers on a grid, one half of the plane.

use rayon::prelude::*;
use realfft::RealFftPlanner;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// The forward transform of a real grid of shape `[ny, nx]`, not normalised, for wave numbers `kx` from 0 to `nx / 2`. The rest
/// is its complex conjugate.
pub(crate) struct HalfPlane {
    shape: [usize; 2],
    /// `ny` numbers for each `kx`.
    columns: Vec<Complex<f64>>,
}

impl HalfPlane {
    /// `fill`: writes row `iy` into a row of zeros.
    pub(crate) fn of(shape: [usize; 2], fill: impl Fn(usize, &mut [f64]) + Sync) -> Self {
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
        let mut columns = turned(&rows, half);
        drop(rows);
        transform(&mut columns, ny, &*FftPlanner::new().plan_fft_forward(ny));
        Self { shape, columns }
    }

    /// The `ny` numbers of each `kx`, in order.
    pub(crate) fn columns(&self) -> impl IndexedParallelIterator<Item = &[Complex<f64>]> {
        self.columns.par_chunks_exact(self.shape[0])
    }

    /// The inverse transform of the squared magnitudes, not normalised: the circular autocorrelation times the number of samples
    /// squared, shape `[ny, nx]`.
    pub(crate) fn circular_autocorrelation(self) -> Vec<f64> {
        let [ny, nx] = self.shape;
        let half = nx / 2 + 1;
        let mut columns = self.columns;
        columns
            .par_iter_mut()
            .for_each(|value| *value = value.norm_sqr().into());
        transform(&mut columns, ny, &*FftPlanner::new().plan_fft_inverse(ny));
        let mut rows = turned(&columns, ny);
        drop(columns);
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

/// Lines of `length` become columns.
fn turned(lines: &[Complex<f64>], length: usize) -> Vec<Complex<f64>> {
    let count = lines.len() / length;
    let mut turned = vec![Complex::default(); lines.len()];
    turned
        .par_chunks_exact_mut(count)
        .enumerate()
        .for_each(|(i, column)| {
            for (value, line) in column.iter_mut().zip(lines.chunks_exact(length)) {
                *value = line[i];
            }
        });
    turned
}
