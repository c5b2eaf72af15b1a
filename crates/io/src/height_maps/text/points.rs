//! Lists of points: x, y and z in each row, on a regular grid.

use std::path::Path;

use asperity_surface::RawHeightMap;

use crate::error::ReadProblem;
use crate::limits::room;

/// Rows from which three columns are taken for a list of points in a file whose name leaves it open.
const MIN_ROWS_OF_LIST: usize = 16;
/// The ending of files that hold lists of points alone.
const LIST_ENDING: &str = "xyz";
/// Fewest points of a list: two along each axis.
const MIN_POINTS: usize = 4;
/// Most places of the grid for each point of the list.
const MAX_PLACES_PER_POINT: usize = 2;
/// Largest distance of a point from its place, in spacings: coordinates are rounded in a file.
const TOLERANCE: f64 = 0.1;

/// Returns `true` if a line names the columns of a list, and perhaps further ones: `x y z`.
pub(super) fn is_heading(line: &str) -> bool {
    let names = line.split([' ', '\t', ',', ';', '"']);
    let names = names.filter(|name| !name.is_empty()).take(3);
    names.map(str::to_ascii_lowercase).eq(["x", "y", "z"])
}

/// Returns `true` if the name of the file says that it is a list.
pub(super) fn is_named_as_list(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ending.eq_ignore_ascii_case(LIST_ENDING))
}

/// The map of a list of rows x, y, z; `None` where they rather are a matrix. `is_list` if the file says that it is a list.
///
/// Row 0 of the map has the least y. Places of the grid that no point is on are missing.
pub(super) fn map_of(
    is_list: bool,
    columns: usize,
    numbers: &[f64],
) -> Result<Option<RawHeightMap>, ReadProblem> {
    let is_long = numbers.len() >= MIN_ROWS_OF_LIST * columns;
    if columns < 3 || (columns > 3 && !is_long) {
        return if is_list {
            Err(wrong_columns(columns))
        } else {
            Ok(None)
        };
    }
    let rows = numbers.chunks_exact(columns);
    let rows: Vec<[f64; 3]> = rows.map(|row| [row[0], row[1], row[2]]).collect();
    match placed(&rows)? {
        None if columns > 3 && !is_list => Ok(None),
        _ if columns > 3 => Err(wrong_columns(columns)),
        Some(Placed { heights, x, y }) => {
            let (shape, spacing) = ([y.count, x.count], [x.step, y.step]);
            let mut map = RawHeightMap::new(heights, shape, spacing)?;
            map.y_is_north = true;
            Ok(Some(map))
        }
        None if !is_long && !is_list => Ok(None),
        None => Err(ReadProblem::unsupported(format_args!(
            "its {} rows of three numbers look like points x, y, z, but x and y do not lie on a regular grid, one point on each place; interpolate them on one first",
            rows.len()
        ))),
    }
}

/// The refusal of a list of points with another number of columns.
fn wrong_columns(columns: usize) -> ReadProblem {
    ReadProblem::unsupported(format_args!(
        "its rows have {columns} numbers, but three are needed in a list of points x, y, z; matrices are read from .txt, .csv and .asc"
    ))
}

/// The points in the order of their grid; `None` if the points are on none.
fn placed(rows: &[[f64; 3]]) -> Result<Option<Placed>, ReadProblem> {
    if rows.len() < MIN_POINTS {
        return Ok(None);
    }
    let axis = |k: usize| Axis::of(rows.iter().map(|row| row[k]).collect());
    let (Some(x), Some(y)) = (axis(0), axis(1)) else {
        return Ok(None);
    };
    let places = x.count.saturating_mul(y.count);
    if rows.len() > places || places > rows.len().saturating_mul(MAX_PLACES_PER_POINT) {
        return Ok(None);
    }
    let mut heights = room(x.count as u64, y.count as u64)?;
    heights.resize(places, f64::NAN);
    let mut taken = vec![false; places];
    for [px, py, z] in rows {
        let (Some(ix), Some(iy)) = (x.place(*px), y.place(*py)) else {
            return Ok(None);
        };
        let k = iy * x.count + ix;
        if std::mem::replace(&mut taken[k], true) {
            return Ok(None);
        }
        heights[k] = *z;
    }
    Ok(Some(Placed { heights, x, y }))
}

/// Points in the order of their grid.
struct Placed {
    heights: Vec<f64>,
    x: Axis,
    y: Axis,
}

/// Equidistant coordinates along one axis.
struct Axis {
    first: f64,
    step: f64,
    count: usize,
}

impl Axis {
    /// The axis of these coordinates, whose largest gap is the step.
    fn of(mut coordinates: Vec<f64>) -> Option<Self> {
        if coordinates.iter().any(|x| !x.is_finite()) {
            return None;
        }
        coordinates.sort_by(f64::total_cmp);
        let (first, last) = (*coordinates.first()?, *coordinates.last()?);
        let gaps = coordinates.windows(2).map(|pair| pair[1] - pair[0]);
        let largest = gaps.fold(0.0, f64::max);
        let steps = ((last - first) / largest).round();
        // At least two coordinates, and no more than there are points
        let in_range = steps >= 1.0 && steps < coordinates.len() as f64;
        in_range.then(|| Self {
            first,
            step: (last - first) / steps,
            count: steps as usize + 1,
        })
    }

    /// The number of the place that `x` is on.
    fn place(&self, x: f64) -> Option<usize> {
        let place = (x - self.first) / self.step;
        let nearest = place.round();
        ((place - nearest).abs() <= TOLERANCE).then_some(nearest as usize)
    }
}
