//! Tables that are no matrix of heights: profiles, and heights beside numbers of rows and columns.

use std::iter::zip;

use crate::error::ReadProblem;
use crate::height_maps::narrow::profile;

/// Fewest numbers in ascending or descending order that are positions or numbers of rows or columns.
const MIN_STEPS: usize = 8;

/// Fewest numbers in equal steps, of a row above and of a column beside the heights, that are positions.
const MIN_STEPS_OF_BOTH: usize = 3;

/// Checks the numbers of a file that states `nx` x `ny` of them, in that many lines, which may end anywhere; `longest` is
/// the most numbers of a line.
pub(super) fn check_lines(
    [nx, ny]: [u64; 2],
    [lines, longest]: [usize; 2],
    found: usize,
) -> Result<(), ReadProblem> {
    let (found, needed) = (found as u64, nx.saturating_mul(ny));
    let what = format!("{nx} x {ny} numbers were expected (columns x rows), but {found} are there");
    if found < needed {
        return Err(ReadProblem::truncated(what));
    }
    if found > needed {
        return Err(ReadProblem::malformed(what));
    }
    if nx != ny && [lines as u64, longest as u64] == [nx, ny] {
        return Err(ReadProblem::malformed(format_args!(
            "its header states {nx} columns and {ny} rows, but its {lines} lines have {longest} numbers each, as if these were exchanged"
        )));
    }
    Ok(())
}

/// Refuses numbers that are no heights of a surface, in a file without a header.
pub(super) fn check_matrix(columns: usize, numbers: &[f64]) -> Result<(), ReadProblem> {
    let rows = numbers.len() / columns;
    let row = |y: usize| numbers.iter().skip(y * columns).take(columns).copied();
    let column = |x: usize| numbers.iter().skip(x).step_by(columns).copied();
    let is_profile = match (rows, columns) {
        (3.., 2) => is_monotonic(column(0)) || is_monotonic(column(1)),
        (2, _) => columns > MIN_STEPS && is_monotonic(row(0)),
        _ => false,
    };
    if is_profile {
        return Err(profile([rows, columns]));
    }
    let above = positions(row(0), (1..rows).map(row));
    let beside = positions(column(0), (1..columns).map(column));
    let place = if above.min(beside) >= MIN_STEPS_OF_BOTH {
        "first row and first column"
    } else if above >= MIN_STEPS {
        "first row"
    } else if beside >= MIN_STEPS {
        "first column"
    } else {
        return Ok(());
    };
    Err(ReadProblem::unsupported(format_args!(
        "the numbers in its {place} are in ascending or descending order, as those of rows and columns or positions are, but only heights are read from a matrix; leave them out (in pandas: header=False, index=False)"
    )))
}

/// Largest difference of two equal steps, over the step. Numbers of single precision, or of seven digits, are rounded by up to 6e-8 of
/// themselves: steps of the first ten or so agree to 1e-6, and heights that agree as well by chance do so once in a million.
const EQUAL: f64 = 1e-6;

/// Number of numbers that differ by one step from each to the next; 0 of others. Missing ones may be any number, and the first, that of
/// the corner, does not count.
fn steps(numbers: impl Iterator<Item = f64>) -> usize {
    let numbers: Vec<f64> = numbers.skip(1).collect();
    let steps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
    let mut steps = steps.filter(|step| !step.is_nan());
    let Some(step) = steps.next() else {
        return 1;
    };
    let is_equal = step != 0.0 && steps.all(|other| (other - step).abs() <= EQUAL * step.abs());
    if is_equal { numbers.len() } else { 0 }
}

/// Fewest numbers in uneven steps that are positions, if those along the other axis are, too.
const MIN_UNEVEN_OF_BOTH: usize = 5;

/// Largest correlation of positions with the heights beside them. Rows and columns of a smooth surface, a row or column of which
/// may rise by chance, have a larger one.
const UNRELATED: f64 = 0.9;

/// Number of numbers that are positions: in equal steps, unlike the next row or column, or all rising or all falling, unlike any
/// `others`; 0 of others. Heights that rise in the next row, too, may be those of a plane.
fn positions<I: Iterator<Item = f64> + Clone>(
    own: I,
    mut others: impl Iterator<Item = I> + Clone,
) -> usize {
    let Some(next) = others.clone().next() else {
        return 0;
    };
    let even = steps(own.clone());
    if even > 0 {
        return even * usize::from(steps(next) == 0);
    }
    let known = |numbers: I| numbers.skip(1).filter(|x| !x.is_nan());
    let is_unlike = is_monotonic(known(own.clone()))
        && !others.any(|other| is_monotonic(known(other)))
        && correlation(zip(own.clone(), next).skip(1)).abs() < UNRELATED;
    let count = known(own).count();
    count * usize::from(is_unlike && count >= MIN_UNEVEN_OF_BOTH)
}

/// Correlation of the numbers of pairs, without those that are missing.
fn correlation(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    let pairs = pairs.filter(|(x, y)| !x.is_nan() && !y.is_nan());
    let (x, y): (Vec<f64>, Vec<f64>) = pairs.unzip();
    let centred = |numbers: Vec<f64>| {
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        numbers.into_iter().map(move |x| x - mean)
    };
    let of = zip(centred(x), centred(y)).fold([0.0; 3], |[xx, xy, yy], (x, y)| {
        [xx + x * x, xy + x * y, yy + y * y]
    });
    of[1] / (of[0] * of[2]).sqrt()
}

fn is_monotonic(numbers: impl Iterator<Item = f64> + Clone) -> bool {
    let mut pairs = numbers.clone().zip(numbers.skip(1));
    pairs.clone().all(|(a, b)| a < b) || pairs.all(|(a, b)| a > b)
}
