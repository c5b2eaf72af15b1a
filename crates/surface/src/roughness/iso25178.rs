//! Areal surface texture parameters of ISO 25178-2 beyond those of [`Roughness`](crate::Roughness).

mod angular_spectrum;
mod autocorrelation;
mod functional;
mod hybrid;
mod material_ratio;
mod spatial;
#[cfg(test)]
mod tests;

use rayon::join;
use serde::Serialize;

use self::hybrid::developed_area_ratio;
use crate::HeightField;

pub use self::functional::FunctionalParameters;
pub use self::spatial::SpatialParameters;

/// Functional, hybrid and spatial parameters of a surface.
///
/// Height parameters and Sdq are those of [`Roughness`](crate::Roughness). Lengths are in the unit of the surface. No form is
/// removed and nothing is filtered: see [`Form`](crate::Form) and [`GaussianFilter`](crate::GaussianFilter).
///
/// # Examples
/// ```
/// use asperity_surface::{HeightField, Iso25178};
///
/// // A ramp of heights 0 to 99: its material ratio curve is a straight line
/// let heights = (0..100).map(f64::from).collect();
/// let field = HeightField::new(heights, [10, 10], [1.0, 1.0])?;
/// let parameters = Iso25178::of(&field);
/// assert!((parameters.functional.sk - 100.0).abs() < 1e-9);
/// # Ok::<(), asperity_surface::HeightFieldError>(())
/// ```
///
/// # Source
/// ISO 25178-2:2021.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Iso25178 {
    /// From the material ratio curve.
    #[serde(flatten)]
    pub functional: FunctionalParameters,
    /// Developed interfacial area ratio, percent: by how much the area of the mesh exceeds that of the mean plane.
    pub sdr: f64,
    /// From autocorrelation and spectrum.
    #[serde(flatten)]
    pub spatial: SpatialParameters,
}

impl Iso25178 {
    /// Measures a surface. Numbers do not depend on the number of threads.
    #[must_use]
    pub fn of(field: &HeightField) -> Self {
        let (functional, (sdr, spatial)) = join(
            || FunctionalParameters::of(field),
            || {
                join(
                    || developed_area_ratio(field),
                    || SpatialParameters::of(field),
                )
            },
        );
        Self {
            functional,
            sdr,
            spatial,
        }
    }
}
