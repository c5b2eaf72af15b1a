//! Output: tables, numbers as text, checkpoints and result folders, for every study.

mod align;
mod columns;
mod number;
mod table;

pub(crate) use align::{aligned, listed, wrapped};
pub(crate) use columns::{
    bin_centre_columns, bin_columns, material_columns, over, projected_solid_angle, ray_count,
    solid_angle_column,
};
pub(crate) use number::{distance, significant, two_digits, with_error};
pub(crate) use table::{Cell, Column, Format, Table};
