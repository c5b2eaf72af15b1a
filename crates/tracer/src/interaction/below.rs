//! Below the surface: a layer, and the shape of its bottom.

use std::fmt;
use std::str::FromStr;

use asperity_optics::Layer;
use serde::{Deserialize, Serialize};

use super::layer::{TracedLayer, TracedLayerError};
use crate::accelerators::SearchedSurface;
use crate::geometry::Geometry;

/// The shape of a layer's bottom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BottomSurface {
    /// A plane.
    #[default]
    Flat,
    /// The surface above, moved down.
    Same,
    /// Another surface of the same statistics, of a realisation of its own.
    Independent,
}

impl fmt::Display for BottomSurface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Flat => "flat",
            Self::Same => "same",
            Self::Independent => "independent",
        })
    }
}

impl FromStr for BottomSurface {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        [Self::Flat, Self::Same, Self::Independent]
            .into_iter()
            .find(|shape| shape.to_string() == text)
            .ok_or_else(|| {
                format!("unknown bottom surface `{text}`; allowed are flat, same and independent")
            })
    }
}

/// A layer of a medium below a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerBelow {
    /// The medium, the thickness, and what it ends on.
    pub layer: Layer,
    /// The shape of its bottom, unless the given surface has a bottom of its own.
    pub bottom: BottomSurface,
}

impl LayerBelow {
    /// The layer below `top`, as paths meet it; `bottom` is the surface that it ends on, if it has one of its own.
    ///
    /// # Errors
    /// [`TracedLayerError`] if the layer does not fit below the surface.
    pub fn traced<'a, G: Geometry>(
        &self,
        top: SearchedSurface<'a, G>,
        bottom: Option<SearchedSurface<'a, G>>,
        max_scatterings: u32,
    ) -> Result<TracedLayer<'a, G>, TracedLayerError> {
        let bottom = bottom.or((self.bottom == BottomSurface::Same).then_some(top));
        TracedLayer::new(top.geometry, &self.layer, bottom, max_scatterings)
    }
}
