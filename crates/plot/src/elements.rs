//! Elements that figures are made of. Nothing here knows a figure.
//!
//! From below: [`theme`] (sizes, colours), [`rgb`], [`geometry`], [`numbers`], [`text`]; [`scene`], the list of shapes that
//! [`render`] turns into SVG and PNG; [`axis`], [`curve`], [`curve_axis`], [`legend`], [`colour_scale`]; [`panel`],
//! [`panel_grid`], [`polar`], [`matrix`] and [`page`], on which figures stand, and [`tile_map`], which is most of one. [`series`], [`directions`], [`lobe_axes`], [`disc`],
//! [`units`] and [`verdict`] show light and directions in the plane of incidence, light over a hemisphere, lengths and verdicts.

pub(crate) mod axis;
pub(crate) mod colour_scale;
pub(crate) mod curve;
pub(crate) mod curve_axis;
pub(crate) mod directions;
pub(crate) mod disc;
pub(crate) mod disc_bins;
pub(crate) mod geometry;
pub(crate) mod legend;
pub(crate) mod lobe_axes;
pub(crate) mod matrix;
pub(crate) mod numbers;
pub(crate) mod page;
pub(crate) mod panel;
pub(crate) mod panel_grid;
pub(crate) mod polar;
pub(crate) mod render;
pub(crate) mod rgb;
pub(crate) mod scene;
pub(crate) mod series;
pub(crate) mod text;
pub(crate) mod theme;
pub(crate) mod tile_map;
pub(crate) mod units;
pub(crate) mod verdict;
