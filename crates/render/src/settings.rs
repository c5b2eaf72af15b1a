//! Settings: the content of a picture, and how it is rendered.

use asperity_tracer::{AcceleratorKind, PathSettings};

use crate::lights::Lights;
use crate::view::View;

/// Most pixels along a side.
pub const MAX_PIXELS: usize = 16_384;

/// Content of a picture, and how it is rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// The camera.
    pub view: View,
    /// Lights of the picture.
    pub lights: Lights,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Samples per pixel; rounded up to a multiple of four.
    pub samples: u64,
    /// Seed of the lines and paths.
    pub seed: u64,
    /// Limits that end paths. Polarisation is always averaged: camera paths do not know that of the light.
    pub paths: PathSettings,
    /// Accelerator that finds the hits.
    pub accelerator: AcceleratorKind,
    /// Scatterings inside a layer after which a path is truncated.
    pub most_scatterings: u32,
}
