//! Height field: a surface sampled on a regular grid, with spacings, unit and border.

mod border;
mod border_steps;
mod error;
mod field;
mod grid;
mod length;
mod mean;
mod provenance;
mod turned_cells;
mod unit;

pub use self::border::Border;
pub use self::error::HeightFieldError;
pub use self::field::{HeightField, are_allowed};
pub use self::grid::check_grid;
pub use self::length::Length;
pub(crate) use self::mean::mean_height;
pub use self::provenance::ProvenanceRecord;
#[cfg(test)]
pub(crate) use self::provenance::RecordedLength;
pub use self::turned_cells::TurnedCells;
pub use self::unit::LengthUnit;
