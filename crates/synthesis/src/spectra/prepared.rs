//! Prepared densities: spectra with everything precomputed that does not depend on the wave vector.

use super::gaussian::PreparedGaussian;
use super::plane::PlanePsd;
use super::radial::PreparedRadial;

/// A power spectral density, with everything precomputed that does not depend on the wave vector.
#[derive(Clone, Debug)]
pub(crate) enum PreparedDensity {
    Gaussian(PreparedGaussian),
    Radial(PreparedRadial),
    Plane(PlanePsd),
    Sum(Vec<Self>),
}

impl PreparedDensity {
    /// `W(kx, ky)`, as [`Psd::density`](super::psd::Psd::density).
    pub(crate) fn at(&self, kx: f64, ky: f64) -> f64 {
        match self {
            Self::Gaussian(gaussian) => gaussian.at(kx, ky),
            Self::Radial(radial) => radial.at(kx, ky),
            Self::Plane(plane) => plane.density(kx, ky),
            Self::Sum(parts) => parts.iter().map(|part| part.at(kx, ky)).sum(),
        }
    }

    /// The factors of `W` that depend on `ky`, 1 at `ky = 0`, if it is a function of `kx` times a function of `ky`.
    pub(crate) fn factor_along_y(&self) -> Option<impl Fn(f64) -> f64> {
        match self {
            Self::Gaussian(gaussian) if gaussian.is_separable() => {
                let gaussian = *gaussian;
                Some(move |ky| gaussian.factor_along_y(ky))
            }
            _ => None,
        }
    }

    /// Largest `|ky|` at which, for this `kx`, the density is `fraction` of its peak, or not yet cut off; none if it stays below.
    pub(crate) fn reach_along_y(&self, kx: f64, fraction: f64) -> Option<f64> {
        match self {
            Self::Gaussian(gaussian) => gaussian.reach_along_y(kx, fraction),
            Self::Radial(radial) => radial.reach_along_y(kx),
            Self::Plane(plane) => {
                let [reach_x, reach_y] = plane.reach();
                (kx.abs() <= reach_x).then_some(reach_y)
            }
            Self::Sum(parts) => {
                let each = parts.iter();
                let each = each.filter_map(|part| part.reach_along_y(kx, fraction));
                each.reduce(f64::max)
            }
        }
    }
}
