//! Spline surface: a height field whose cells are bicubic and join smoothly.

mod bounds;
mod deviation;
mod interpolation;
mod mean;
mod padding;
mod patch;
mod roughness;
mod surface;
mod tessellation;

pub(crate) use self::patch::{Place, dot};
pub(crate) use self::roughness::RULE;
pub use self::roughness::SplineRoughness;
pub use self::surface::SplineSurface;
