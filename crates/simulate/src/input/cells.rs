//! Cells: what lies between the heights of a grid.

use std::fmt;

use asperity_tracer::Shape;
use serde::{Deserialize, Serialize};

/// Cells of a grid of heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cells {
    /// Two triangles per cell.
    Flat,
    /// Bicubic B-splines, which join smoothly.
    Smooth,
}

impl Cells {
    /// Cells of a shape; `None` for a triangle mesh.
    pub(crate) const fn of(shape: &Shape) -> Option<Self> {
        match shape {
            Shape::HeightField { .. } => Some(Self::Flat),
            Shape::Smooth { .. } => Some(Self::Smooth),
            Shape::TriangleMesh { .. } => None,
        }
    }
}

impl fmt::Display for Cells {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flat => "flat",
            Self::Smooth => "smooth",
        })
    }
}
