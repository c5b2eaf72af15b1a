//! Output: tables, numbers as text and places in result folders, for every study.

mod align;
mod basis;
mod by_side;
mod columns;
mod head;
mod line;
mod number;
mod place;
mod summary_of_cases;
mod table;

pub(crate) use align::TEXT_WIDTH;
pub use align::wrapped;
pub(crate) use align::{aligned, folded, indented, listed, note_lines};
pub(crate) use basis::Basis;
pub use basis::EstimateWithLimit;
pub(crate) use by_side::BySide;
pub(crate) use columns::{
    GridBin, bin_centre_columns, bin_columns, case_columns, grid_bin_columns, incidence_columns,
    over, projected_solid_angle, ray_count, solid_angle_column,
};
pub(crate) use head::Head;
pub(crate) use line::{fitted, percent, range, range_text, relative};
pub(crate) use number::{
    NO_SCATTER, beside, cut_short, distance, in_steps, significant, two_digits, with_error,
};
pub(crate) use place::{Place, figure_files};
pub(crate) use summary_of_cases::{CaseInFolder, SummaryOfCases};
pub(crate) use table::unit_of_lengths;
pub(crate) use table::{Cell, Column, Format, Table};
