//! Fourier transforms of numbers on a grid.

use rayon::prelude::*;
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};

/// The forward transform of real numbers that are the same at `r` and `-r`, rows of `nx`: real, and the same at `k` and `-k`. Not
/// normalised; the inverse of such numbers is the same sum.
pub(crate) fn transform_plane(numbers: &[f64], shape: [usize; 2]) -> Vec<f64> {
    of_transform(numbers, shape, |wave| wave.re)
}

/// Squared moduli of the forward transform of real numbers, rows of `nx`. Not normalised.
pub(crate) fn power_plane(numbers: &[f64], shape: [usize; 2]) -> Vec<f64> {
    of_transform(numbers, shape, |wave| wave.norm_sqr())
}

fn of_transform(
    numbers: &[f64],
    [ny, nx]: [usize; 2],
    number: impl Fn(Complex<f64>) -> f64 + Sync,
) -> Vec<f64> {
    let number = &number;
    let complex = numbers.iter().map(|re| Complex { re: *re, im: 0.0 });
    let mut plane: Vec<Complex<f64>> = complex.collect();
    let mut planner = FftPlanner::new();
    transform_rows(&mut plane, nx, &*planner.plan_fft_forward(nx));
    let mut turned = turned(&plane, [ny, nx]);
    drop(plane);
    transform_rows(&mut turned, ny, &*planner.plan_fft_forward(ny));
    let row = |iy: usize| (0..nx).map(move |ix| (ix, iy));
    let turned = &turned;
    (0..ny)
        .into_par_iter()
        .flat_map_iter(|iy| row(iy).map(move |(ix, iy)| number(turned[ix * ny + iy])))
        .collect()
}

fn transform_rows(plane: &mut [Complex<f64>], length: usize, fft: &dyn Fft<f64>) {
    plane.par_chunks_exact_mut(length).for_each_init(
        || vec![Complex::default(); fft.get_inplace_scratch_len()],
        |scratch, row| fft.process_with_scratch(row, scratch),
    );
}

/// Rows become columns.
fn turned(plane: &[Complex<f64>], [ny, nx]: [usize; 2]) -> Vec<Complex<f64>> {
    (0..nx)
        .into_par_iter()
        .flat_map_iter(|ix| (0..ny).map(move |iy| plane[iy * nx + ix]))
        .collect()
}
