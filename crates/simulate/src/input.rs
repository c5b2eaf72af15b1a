//! Input of a run: cases and settings.

pub(crate) mod apertures;
pub(crate) mod case;
pub(crate) mod case_words;
pub(crate) mod cells;
pub(crate) mod coordinates;
pub(crate) mod described_shape;
pub(crate) mod estimator;
pub(crate) mod limits;
pub(crate) mod path_choice;
pub(crate) mod random_surfaces;
pub(crate) mod regions;
pub(crate) mod settings;
pub(crate) mod share;
pub(crate) mod surface_source;
pub(crate) mod target;
