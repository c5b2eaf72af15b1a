//! Elements that figures are made of. Nothing here knows a figure.

pub(crate) mod axis;
pub(crate) mod colour_bar;
pub(crate) mod disc;
pub(crate) mod figure;
pub(crate) mod legend;
pub(crate) mod scene;
pub(crate) mod series;
pub(crate) mod text;
pub(crate) mod theme;
