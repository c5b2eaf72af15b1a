//! Grid: checks of shape and spacing.

use super::error::HeightFieldError;

/// Checks a grid's shape `[ny, nx]` and spacing `[dx, dy]` before heights are allocated.
///
/// # Errors
/// [`HeightFieldError`] if the shape is below `[2, 2]` or beyond memory, or a spacing is not
/// positive and finite.
pub fn check_grid(shape: [usize; 2], spacing: [f64; 2]) -> Result<(), HeightFieldError> {
    let [ny, nx] = shape;
    if nx < 2 || ny < 2 {
        return Err(HeightFieldError::TooSmall { nx, ny });
    }
    let bytes = nx
        .checked_mul(ny)
        .and_then(|n| n.checked_mul(size_of::<f64>()));
    if bytes.is_none_or(|b| b > isize::MAX as usize) {
        return Err(HeightFieldError::TooLarge { nx, ny });
    }
    for (axis, value) in ['x', 'y'].into_iter().zip(spacing) {
        if !(value.is_finite() && value > 0.0) {
            return Err(HeightFieldError::BadSpacing { axis, value });
        }
    }
    Ok(())
}
