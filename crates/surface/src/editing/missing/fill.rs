//! Filling: replaces missing points by heights interpolated from around their gap.

use super::error::MissingError;
use super::laplace::GapEquations;
use crate::{Border, HeightFieldError};

/// Replaces NaN by the solution of Laplace's equation over each gap, in its five-point form on the
/// grid: each filled point is the mean of its neighbours, weighted by one over the spacing squared.
pub(super) fn fill(
    heights: &mut [f64],
    [ny, nx]: [usize; 2],
    [dx, dy]: [f64; 2],
    border: Border,
) -> Result<(), MissingError> {
    // Number the missing points, and take heights relative to the mean of the known ones.
    let gaps: Vec<usize> = (0..heights.len())
        .filter(|&i| heights[i].is_nan())
        .collect();
    if u32::try_from(gaps.len()).is_err() {
        return Err(HeightFieldError::TooLarge { nx, ny }.into());
    }
    let (mut mean, mut count) = (0.0, 0.0);
    for h in heights.iter().filter(|h| !h.is_nan()) {
        count += 1.0;
        mean += (h - mean) / count;
    }

    let periodic = border == Border::Periodic;
    let before = |i: usize, n: usize| match i {
        0 => periodic.then_some(n - 1),
        _ => Some(i - 1),
    };
    let after = |i: usize, n: usize| match i + 1 {
        next if next < n => Some(next),
        _ => periodic.then_some(0),
    };
    // Only the ratio of the weights counts; this one has the product 1.
    let (weight_x, weight_y) = (dy / dx, dx / dy);

    let mut equations = GapEquations::with_capacity(gaps.len());
    for &i in &gaps {
        let (ix, iy) = (i % nx, i / nx);
        let neighbours = [
            (before(ix, nx).map(|x| iy * nx + x), weight_x),
            (after(ix, nx).map(|x| iy * nx + x), weight_x),
            (before(iy, ny).map(|y| y * nx + ix), weight_y),
            (after(iy, ny).map(|y| y * nx + ix), weight_y),
        ];
        let neighbours = neighbours
            .into_iter()
            .filter_map(|(j, weight)| Some((j?, weight)));
        let (unknown, given): (Vec<_>, Vec<_>) =
            neighbours.partition(|(j, _)| heights[*j].is_nan());
        let number = |j| gaps.binary_search(j).ok().map(|number| number as u32);
        equations.push(
            unknown.iter().filter_map(|(j, w)| Some((number(j)?, *w))),
            given.iter().map(|(j, w)| (*w, heights[*j] - mean)),
        );
    }
    let solution = equations.solve()?;
    for (&i, h) in gaps.iter().zip(solution) {
        heights[i] = mean + h;
    }
    Ok(())
}
