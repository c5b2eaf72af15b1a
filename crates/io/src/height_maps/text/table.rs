//! Tables that are no matrix of heights: profiles, and heights beside numbers of rows and columns.

use crate::error::ReadProblem;

/// Most rows of two columns, and columns of two rows, that may be a map.
const MAX_NARROW: usize = 15;

/// Fewest numbers in equal steps that are positions or numbers of rows or columns.
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
        (3.., 2) => is_monotonic(column(0)) || is_monotonic(column(1)) || rows > MAX_NARROW,
        (2, _) => columns > MAX_NARROW && is_monotonic(row(0)),
        _ => false,
    };
    if is_profile {
        return Err(ReadProblem::unsupported(format_args!(
            "its {columns} x {rows} numbers (columns x rows) are a profile, positions and heights along a line, but a surface is needed"
        )));
    }
    let [above, beside] = [steps(row(0)), steps(column(0))];
    // Heights that rise so in the next row, too, may be those of a plane.
    let [above, beside] = [
        above * usize::from(steps(row(1)) == 0),
        beside * usize::from(steps(column(1)) == 0),
    ];
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
        "the numbers in its {place} are in equal steps, as those of rows and columns or positions are, but only heights are read from a matrix; leave them out (in pandas: header=False, index=False)"
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

fn is_monotonic(numbers: impl Iterator<Item = f64> + Clone) -> bool {
    let mut pairs = numbers.clone().zip(numbers.skip(1));
    pairs.clone().all(|(a, b)| a < b) || pairs.all(|(a, b)| a > b)
}
