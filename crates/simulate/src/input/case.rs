//! Case: one surface source, one material over its layers, one direction of light or a patch of them.

use asperity_optics::{Bottom, Incidence, Layer, Material, Spread};
use asperity_tally::HemisphereGrid;
use asperity_tracer::HalfSpace;
use serde::{Deserialize, Serialize};

use super::coordinates::Coordinates;
use super::surface_source::SurfaceSource;

/// Case: a surface, its material, the layers below it, and the light.
///
/// # Examples
/// ```
/// use asperity_optics::{Bottom, Incidence, Layer, Material, Spread};
/// use asperity_simulate::{Case, Light, SurfaceSource};
/// use asperity_surface::HeightField;
///
/// let field = HeightField::new(vec![0.0, 1.0, 0.0, -1.0], [2, 2], [4.0, 4.0])?;
/// let light = Light::from_above(Incidence::from_degrees(45.0, 0.0)?);
/// let case = Case::new(SurfaceSource::height_field(field), Material::Mirror, light);
/// assert!(case.layers.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Source of the surface.
    pub surface: SurfaceSource,
    /// The material of the interface, with indices relative to the medium of the light; with layers below, to the medium above.
    pub material: Material,
    /// The layers of media below the surface, from above, wherever the light comes from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
    /// The light.
    pub light: Light,
    /// Bins of its own, as around narrow lobes; `None` for the bins that all cases have by the settings.
    pub bins: Option<CaseBins>,
    /// Further coordinates that distinguish it from others.
    pub at: Coordinates,
}

/// Bins of a case.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CaseBins {
    /// The bins.
    pub grid: HemisphereGrid,
    /// Half width of the in-plane slice, radians, unless that of the settings is smaller.
    pub in_plane_half_width: f64,
}

/// Light from one direction, or from several around it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// The direction towards the light.
    pub incidence: Incidence,
    /// The half space that it comes from.
    pub from: HalfSpace,
    /// Directions around that of incidence from which rays come, in place of it alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spread: Option<Spread>,
    /// `true` if each ray comes from a random azimuth. Light that leaves is turned back to the azimuth of `incidence`.
    pub random_azimuth: bool,
    /// Q, U and V over I, in the axes of its ray; zeros for unpolarised light. Only tracked polarisation obeys it.
    pub stokes: [f64; 3],
}

impl Light {
    /// Light from above, of one azimuth.
    #[must_use]
    pub const fn from_above(incidence: Incidence) -> Self {
        Self {
            incidence,
            from: HalfSpace::Above,
            spread: None,
            random_azimuth: false,
            stokes: [0.0; 3],
        }
    }

    /// Returns `true` if it is polarised.
    #[must_use]
    pub fn is_polarised(&self) -> bool {
        self.stokes != [0.0; 3]
    }
}

impl Case {
    /// Light on a surface without layers below it.
    #[must_use]
    pub fn new(surface: SurfaceSource, material: Material, light: Light) -> Self {
        Self {
            surface,
            material,
            layers: Vec::new(),
            light,
            bins: None,
            at: Coordinates::default(),
        }
    }

    /// Returns `true` if layers are lit from below.
    #[must_use]
    pub fn is_turned_over(&self) -> bool {
        self.light.from == HalfSpace::Below && !self.layers.is_empty()
    }

    /// Returns `true` if light that falls on the sample may leave on its other side.
    #[must_use]
    pub fn transmits(&self) -> bool {
        self.material.transmitting_index().is_some() && self.layers.iter().all(Layer::transmits)
    }

    /// The material of the first interface and the layers behind it, in the order in which the light meets them; `None` if layers are lit
    /// through a lowest one that has no end, or one that lets no light in.
    #[must_use]
    pub fn towards_light(&self) -> Option<(Material, Vec<Layer>)> {
        if !self.is_turned_over() {
            return Some((self.material, self.layers.clone()));
        }
        let mut above = self.material;
        let mut turned = Vec::new();
        for layer in &self.layers {
            let end = layer.end()?;
            let face = Bottom::Face(above.reversed());
            turned.push(Layer::slab(layer.medium(), end.thickness, face).ok()?);
            above = end.bottom.material();
        }
        above.transmitting_index()?;
        turned.reverse();
        Some((above.reversed(), turned))
    }
}
