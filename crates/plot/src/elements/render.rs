//! Rendering: a laid-out figure, as SVG or PNG.

mod png;
mod raster;
mod svg;

use super::scene::Scene;
use crate::PlotError;

/// A figure, laid out and ready to be rendered. Equal figures render to equal bytes.
#[derive(Debug, Clone)]
pub struct Figure {
    scene: Scene,
}

impl Figure {
    pub(crate) fn new(scene: Scene) -> Self {
        Figure { scene }
    }

    /// Width and height in SVG pixels. A PNG has twice as many pixels each way.
    pub fn size(&self) -> (u32, u32) {
        (self.scene.width, self.scene.height)
    }

    /// The figure as an SVG document without external references. Texts stay texts; colours are attributes `fill` and
    /// `stroke` of the form `#1A2B3C`.
    ///
    /// # Errors
    /// [`PlotError::Backend`] if a picture in it cannot be encoded.
    pub fn svg(&self) -> Result<String, PlotError> {
        svg::render(&self.scene)
    }

    /// Pixels of the figure, one per point: red, green and blue of 8 bits, row by row from the top.
    ///
    /// # Errors
    /// [`PlotError::Backend`] if the drawing library fails.
    pub fn rgb(&self) -> Result<Vec<u8>, PlotError> {
        let mut pixels = Vec::new();
        raster::draw(&self.scene, 1, |rows| {
            pixels.extend_from_slice(rows);
            Ok(())
        })?;
        Ok(pixels)
    }

    /// The figure as a PNG file, 8-bit RGB at two pixels per point.
    ///
    /// # Errors
    /// [`PlotError::Backend`] if the drawing library or the encoder fails.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        png::render(&self.scene)
    }
}
