//! Case: one surface source, one material, one direction of light.
//!
//! A wavelength will join here as one more coordinate, and from it the material. A sweep over wavelengths then
//! makes one case per wavelength; cases that differ in it alone share their surfaces as they do today.

use asperity_optics::{Incidence, Material};
use asperity_tally::HemisphereGrid;
use asperity_tracer::{HalfSpace, LayerBelow};
use serde::{Deserialize, Serialize};

use super::coordinates::Coordinates;
use super::surface_source::SurfaceSource;

/// Case: a surface, its material, the layer below it, and the light.
///
/// # Examples
/// ```
/// use asperity_optics::{Incidence, Material};
/// use asperity_simulate::{Case, Light, SurfaceSource};
/// use asperity_surface::HeightField;
///
/// let field = HeightField::new(vec![0.0, 1.0, 0.0, -1.0], [2, 2], [4.0, 4.0])?;
/// let light = Light::from_above(Incidence::from_degrees(45.0, 0.0)?);
/// let case = Case::new(SurfaceSource::height_field(field), Material::Mirror, light);
/// assert!(case.layer.is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Source of the surface.
    pub surface: SurfaceSource,
    /// The material of the interface.
    pub material: Material,
    /// The layer of a medium below the surface, if there is one.
    pub layer: Option<LayerBelow>,
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

/// Collimated light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Light {
    /// The direction towards the light.
    pub incidence: Incidence,
    /// The half space that it comes from.
    pub from: HalfSpace,
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
    /// Light on a surface without a layer below it.
    #[must_use]
    pub fn new(surface: SurfaceSource, material: Material, light: Light) -> Self {
        Self {
            surface,
            material,
            layer: None,
            light,
            bins: None,
            at: Coordinates::default(),
        }
    }
}
