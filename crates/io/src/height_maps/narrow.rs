//! Narrow maps: profiles and lists of points, which files of any format may hold in place of a surface.

use asperity_surface::RawHeightMap;

use crate::error::ReadProblem;

/// Most samples along the other axis of a map that is two or three samples wide.
const MAX_NARROW: usize = 15;

/// The map, unless it is a profile or a list of points by its shape. A file that states a border holds a surface.
pub(super) fn checked(map: RawHeightMap) -> Result<RawHeightMap, ReadProblem> {
    let [rows, columns] = map.shape();
    let (narrow, long) = (rows.min(columns), rows.max(columns));
    if long <= MAX_NARROW || map.border.is_some() {
        return Ok(map);
    }
    match narrow {
        2 => Err(profile(map.shape())),
        3 if !map.spacing_is_known() => Err(ReadProblem::unsupported(format_args!(
            "its {columns} x {rows} numbers (columns x rows) look like points x, y, z, but a matrix of heights is needed; points on a regular grid are read from text, one in each row (.xyz)"
        ))),
        _ => Ok(map),
    }
}

/// The refusal of a profile of this shape `[ny, nx]`.
pub(super) fn profile([rows, columns]: [usize; 2]) -> ReadProblem {
    ReadProblem::unsupported(format_args!(
        "its {columns} x {rows} numbers (columns x rows) look like a profile, positions and heights along a line, but a surface is needed; of a surface that is the same along one axis, repeat the profile in four rows or more"
    ))
}
