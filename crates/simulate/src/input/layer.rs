//! What lies below a surface: the shape of a layer's bottom, and names of layers.

use asperity_surface::LengthUnit;
use std::fmt;
use std::str::FromStr;

use asperity_optics::{Bottom, Layer, PhaseFunction};
use asperity_tracer::{Accelerator, BottomShape, Geometry, TracedLayer, TracedLayerError};
use serde::{Deserialize, Serialize};

use crate::text::short;

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

/// A layer with lengths in `unit` for people, as in `mean free path 0.1 um, albedo 0.9, g = 0.5, 2 um thick on a mirror`.
#[must_use]
pub fn layer_name(layer: &Layer, unit: LengthUnit) -> String {
    let unit = unit.suffix();
    let medium = layer.medium();
    let mut name = if medium.is_clear() {
        "clear".to_owned()
    } else {
        let path = short(medium.mean_free_path());
        format!(
            "mean free path {path}{unit}, albedo {}",
            short(medium.albedo())
        )
    };
    match medium.phase() {
        PhaseFunction::Isotropic => {}
        PhaseFunction::Rayleigh => name.push_str(", Rayleigh"),
        phase => name.push_str(&format!(", g = {}", short(phase.mean_cosine()))),
    }
    if let Some(slab) = layer.end() {
        let bottom = match slab.bottom {
            Bottom::Open => "open below".to_owned(),
            Bottom::Interface { eta } => format!("on an interface of n = {}", short(eta)),
            Bottom::Absorbing => "on an absorbing bottom".to_owned(),
            Bottom::Mirror => "on a mirror".to_owned(),
            Bottom::Lambertian { reflectance } => {
                format!(
                    "on a Lambertian bottom of reflectance {}",
                    short(reflectance)
                )
            }
            _ => String::new(),
        };
        name.push_str(&format!(", {}{unit} thick {bottom}", short(slab.thickness)));
    }
    name
}

/// The same as a part of a folder's name, as in `mfp0.1_albedo0.9_g0.5_d2`.
#[must_use]
pub fn layer_folder(layer: &Layer) -> String {
    let medium = layer.medium();
    let path = if medium.is_clear() {
        "clear".to_owned()
    } else {
        format!("mfp{}", short(medium.mean_free_path()))
    };
    let mut name = format!("{path}_albedo{}", short(medium.albedo()));
    match medium.phase() {
        PhaseFunction::Isotropic => {}
        PhaseFunction::Rayleigh => name.push_str("_rayleigh"),
        phase => name.push_str(&format!("_g{}", short(phase.mean_cosine()))),
    }
    if let Some(slab) = layer.end() {
        name.push_str(&format!("_d{}", short(slab.thickness)));
    }
    name
}

/// A layer of a medium below a surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerBelow {
    /// The medium, the thickness, and what it ends on.
    pub layer: Layer,
    /// The shape of its bottom, unless the given surface has a bottom of its own.
    pub bottom: BottomSurface,
}

/// A surface, and how hits on it are found.
pub struct SearchedSurface<'a, G: Geometry> {
    /// The surface.
    pub geometry: &'a G,
    /// How hits on it are found.
    pub accelerator: &'a dyn Accelerator<G>,
}

impl<G: Geometry> Clone for SearchedSurface<'_, G> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<G: Geometry> Copy for SearchedSurface<'_, G> {}

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
        let surface = |surface: SearchedSurface<'a, G>| BottomShape::Surface {
            geometry: surface.geometry,
            accelerator: surface.accelerator,
        };
        let shape = match (bottom, self.bottom) {
            (Some(own), _) => surface(own),
            (None, BottomSurface::Same) => surface(top),
            (None, BottomSurface::Flat | BottomSurface::Independent) => BottomShape::Flat,
        };
        TracedLayer::new(top.geometry, &self.layer, shape, max_scatterings)
    }
}
