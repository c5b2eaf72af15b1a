//! Extremes of a smooth surface: between which heights each of its cells lies, and how steep its blocks are, from the
//! Bezier points of its patches.

use std::ops::Range;

use asperity_surface::SplineSurface;
use rayon::prelude::*;

use super::patch::Patch;
use crate::geometry::slope_bounds::{SMALLEST, Support};

/// The patch of a cell, in the unit of the surface.
#[inline(always)]
pub(super) fn patch_of(spline: &SplineSurface, [ix, iy]: [u32; 2]) -> Patch {
    let (coefficients, stride) = (spline.coefficients(), spline.stride());
    let first = iy as usize * stride + ix as usize;
    let all = &coefficients[first..first + 3 * stride + 4];
    let mut rows = [[0.0; 4]; 4];
    for (row, four) in rows.iter_mut().enumerate() {
        four.copy_from_slice(&all[row * stride..row * stride + 4]);
    }
    Patch(rows)
}

/// Bounds of the heights of all cells above `offset`, row by row: `[lowest, highest]`, in the unit of the surface.
pub(super) fn cell_ranges(spline: &SplineSurface, offset: f64) -> Vec<[f64; 2]> {
    let [cx, cy] = spline.cells();
    (0..cy as u32)
        .into_par_iter()
        .flat_map_iter(|iy| (0..cx as u32).map(move |ix| [ix, iy]))
        .map(|cell| {
            let Patch(rows) = patch_of(spline, cell);
            let above = Patch(rows.map(|row| row.map(|height| height - offset)));
            extremes(above.bezier().into_iter().flatten())
        })
        .collect()
}

/// How steep the blocks of some rows of cells are, heights being measured in units of `1 / per_unit`.
pub(super) fn supports(spline: &SplineSurface, rows: Range<usize>, per_unit: f64) -> Vec<Support> {
    let [cx, _] = spline.cells();
    let columns = cx.div_ceil(SMALLEST);
    let block = |column: usize| {
        let columns = column * SMALLEST..((column + 1) * SMALLEST).min(cx);
        let mut block = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
        for iy in rows.clone() {
            for ix in columns.clone() {
                let patch = patch_of(spline, [ix as u32, iy as u32]);
                for (block, cell) in block.iter_mut().zip(rises(&patch)) {
                    *block = [block[0].min(cell[0]), block[1].max(cell[1])];
                }
            }
        }
        Support::from_extremes(block.map(|ends| ends.map(|rise| rise * per_unit)))
    };
    (0..columns).map(block).collect()
}

/// Least and greatest rise of a patch along x, along y, along the diagonal and along the other diagonal: between
/// those of the Bezier points of the derivatives.
fn rises(patch: &Patch) -> [[f64; 2]; 4] {
    // `points[k][l]`: number k along x, l along y
    let points = patch.bezier();
    let along_x: [[f64; 4]; 3] =
        std::array::from_fn(|k| std::array::from_fn(|l| 3.0 * (points[k + 1][l] - points[k][l])));
    let along_y: [[f64; 3]; 4] =
        std::array::from_fn(|k| std::array::from_fn(|l| 3.0 * (points[k][l + 1] - points[k][l])));
    // Both as cubics in x and y, so that they can be added
    let of_x = |k: usize, l: usize| {
        let column = [along_x[0][l], along_x[1][l], along_x[2][l]];
        raised(column)[k]
    };
    let of_y = |k: usize, l: usize| raised(along_y[k])[l];
    let places = || (0..4).flat_map(|k| (0..4).map(move |l| (k, l)));
    [
        extremes(along_x.into_iter().flatten()),
        extremes(along_y.into_iter().flatten()),
        extremes(places().map(|(k, l)| of_x(k, l) + of_y(k, l))),
        extremes(places().map(|(k, l)| of_x(k, l) - of_y(k, l))),
    ]
}

/// Bernstein coefficients of a parabola as those of a cubic.
fn raised([a, b, c]: [f64; 3]) -> [f64; 4] {
    [a, (a + 2.0 * b) / 3.0, (2.0 * b + c) / 3.0, c]
}

/// The least and the greatest.
fn extremes(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [low.min(x), high.max(x)]
    })
}
