//! Figures, one per file.

pub(crate) mod angle_grid;
pub(crate) mod brightness_scale;
pub(crate) mod cell_map;
pub(crate) mod curves;
pub(crate) mod diagram;
pub(crate) mod error_over_time;
pub(crate) mod height_map;
pub(crate) mod hemispheres;
pub(crate) mod in_plane_curves;
pub(crate) mod log_curves;
pub(crate) mod polar_lobes;
pub(crate) mod profile_grid;
pub(crate) mod reliefs;
pub(crate) mod validity_map;
