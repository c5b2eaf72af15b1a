//! Refinement against the Fourier interpolant, and coarsening.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::*;
use crate::height_field::RecordedLength;
use crate::{LengthUnit, TurnedCells};
use asperity_synthesis::{Psd, Synthesis};

const BORDERS: [Border; 2] = [Border::Periodic, Border::Mirrored];

/// Heights without any order, between -1 and 1.
fn jumble([ny, nx]: [usize; 2], border: Border) -> HeightField {
    let heights = (0..nx * ny)
        .map(|i| ((i * i) as f64 * 0.37 + i as f64).sin())
        .collect();
    HeightField::new(heights, [ny, nx], [0.5, 2.0])
        .unwrap()
        .with_border(border)
        .with_unit(LengthUnit::Micrometre)
}

/// Weight of sample `j` of a period of `n` at `x`, in samples: the mean over all waves up to the
/// Nyquist wave number, half of it at either end.
fn kernel(n: usize, j: usize, x: f64) -> f64 {
    let last = n as i64 / 2;
    let sum: f64 = (-last..=last)
        .map(|k| {
            let weight = if 2 * k.unsigned_abs() as usize == n {
                0.5
            } else {
                1.0
            };
            weight * (TAU * k as f64 * (x - j as f64) / n as f64).cos()
        })
        .sum();
    sum / n as f64
}

/// Weights of the samples along an axis at each half of a sample of the tile.
fn weights(n: usize, border: Border) -> Vec<Vec<f64>> {
    let period = match border {
        Border::Mirrored => 2 * (n - 1),
        _ => n,
    };
    (0..2 * n)
        .map(|x| {
            let mut weights = vec![0.0; n];
            for j in 0..period {
                let sample = if j < n { j } else { period - j };
                weights[sample] += kernel(period, j, x as f64 / 2.0);
            }
            weights
        })
        .collect()
}

/// The direct sum rounds each of some hundred terms; 1e-13 is ample.
#[test]
fn refined_is_the_fourier_interpolant() {
    for border in BORDERS {
        for shape in [[2, 2], [2, 3], [5, 2], [8, 6], [7, 10], [9, 11], [17, 70]] {
            let field = jumble(shape, border);
            let refined = field.refined().unwrap();
            let [along_y, along_x] = shape.map(|n| weights(n, border));
            for (iy, along_y) in along_y.iter().enumerate().take(refined.ny()) {
                for (ix, along_x) in along_x.iter().enumerate().take(refined.nx()) {
                    let found = refined.height(ix, iy);
                    let mut expected = 0.0;
                    for (row, y) in field.heights().chunks(shape[1]).zip(along_y) {
                        for (h, x) in row.iter().zip(along_x) {
                            expected += h * x * y;
                        }
                    }
                    assert!(
                        (found - expected).abs() < 1e-13,
                        "{border} {shape:?} ({ix}, {iy}): {found} against {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn refining_and_coarsening_gives_the_same_bits_and_keeps_all_else() {
    for border in BORDERS {
        // Across groups of columns and tiles of rows
        for shape in [[2, 2], [33, 200], [64, 6], [19, 130]] {
            let field = jumble(shape, border);
            let refined = field.refined().unwrap();
            assert_eq!(refined.extent(), field.extent());
            assert_eq!(refined.cells(), field.cells().map(|n| 2 * n));
            assert_eq!(refined.coarsened().unwrap(), field);
        }
    }
}

/// Waves up to just below the Nyquist wave number, at any phase, and that at it as samples see it.
#[test]
fn few_cosines_are_refined_exactly() {
    let shape = [48, 40];
    let waves: [[f64; 4]; 5] = [
        [0.3, 0.0, 0.0, 0.0],
        [1.0, 3.0, -5.0, 0.4],
        [0.7, 19.0, 23.0, 1.9],
        [0.2, 0.0, 11.0, -2.0],
        [0.5, 20.0, 24.0, 0.0],
    ];
    // The last is the product of two cosines, which at the samples is a cosine of the sum.
    let at = |x: f64, y: f64| -> f64 {
        let [ny, nx] = shape.map(|n| n as f64);
        let last = waves.len() - 1;
        waves
            .iter()
            .enumerate()
            .map(|(i, [amplitude, kx, ky, phase])| {
                let (a, b) = (TAU * kx * x / nx, TAU * ky * y / ny);
                amplitude
                    * if i == last {
                        a.cos() * b.cos()
                    } else {
                        (a + b + phase).cos()
                    }
            })
            .sum()
    };
    let sampled = |step: f64, [ny, nx]: [usize; 2]| {
        let heights = (0..nx * ny)
            .map(|i| at((i % nx) as f64 * step, (i / nx) as f64 * step))
            .collect();
        HeightField::new(heights, [ny, nx], [step, step]).unwrap()
    };
    let refined = sampled(1.0, shape).refined().unwrap();
    let expected = sampled(0.5, shape.map(|n| 2 * n));
    assert_eq!(refined.shape(), expected.shape());
    assert_eq!(refined.spacing(), expected.spacing());
    for (found, expected) in refined.heights().iter().zip(expected.heights()) {
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
}

/// A finer grid of the same tile has the same waves, and those beyond the Nyquist wave number of the
/// coarser one, `5 pi / 2` of them to the shortest length, hold `erfc(7.8) < 1e-27` of the variance.
#[test]
fn a_refined_surface_is_that_drawn_on_the_finer_grid() {
    let psd = Psd::anisotropic_gaussian(1.0, 8.0, 5.0, 0.3).unwrap();
    let draw = |shape, spacing| {
        let synthesis = Synthesis::new(psd.clone(), shape, spacing, false).unwrap();
        let heights = synthesis.draw(4, 2).unwrap().into_heights();
        let field = HeightField::new(heights, shape, spacing).unwrap();
        field.with_provenance(Some(Arc::new(RecordedLength(1.0))))
    };
    let refined = draw([65, 70], [1.0, 1.0]).refined().unwrap();
    let finer = draw([130, 140], [0.5, 0.5]);
    for (found, expected) in refined.heights().iter().zip(finer.heights()) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    assert!(refined.provenance() == finer.provenance());
}

#[test]
fn grids_without_finer_or_coarser_one_are_refused() {
    let open = jumble([4, 4], Border::Open);
    assert_eq!(open.refined(), Err(RefinementError::Open));
    let turned = TurnedCells::new([4, 4], |ix, _| ix == 1);
    let structure = jumble([4, 4], Border::Periodic).with_turned_cells(Some(Arc::new(turned)));
    assert_eq!(structure.refined(), Err(RefinementError::Edges));
    assert_eq!(structure.coarsened(), Err(CoarseningError::Edges));
    let refused = |shape, border| jumble(shape, border).coarsened().unwrap_err();
    assert_eq!(
        refused([4, 5], Border::Periodic),
        CoarseningError::OddCells {
            axis: 'x',
            cells: 5
        }
    );
    for border in [Border::Mirrored, Border::Open] {
        assert_eq!(
            refused([6, 5], border),
            CoarseningError::OddCells {
                axis: 'y',
                cells: 5
            }
        );
    }
    assert!(matches!(
        refused([4, 2], Border::Periodic),
        CoarseningError::HeightField(HeightFieldError::TooSmall { nx: 1, ny: 2 })
    ));
    let coarse = jumble([5, 7], Border::Open).coarsened().unwrap();
    assert_eq!((coarse.shape(), coarse.border()), ([3, 4], Border::Open));
    assert_eq!(coarse.extent(), [3.0, 8.0]);
}
