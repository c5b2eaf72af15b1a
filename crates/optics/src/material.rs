//! Surface material: dielectric, conductor, either of them coated, mirror or Lambertian, with the fractions that a facet reflects and transmits.

use serde::{Deserialize, Serialize};

use crate::material_error::{MaterialError, valid_eta, valid_kappa};
use crate::{
    FacetMueller, Films, Fresnel, PolarisedFresnel, conductor, dielectric, polarised_conductor,
    polarised_dielectric,
};

/// Interface material, with indices relative to the medium that the light comes from.
///
/// # Examples
/// ```
/// use asperity_optics::Material;
///
/// let glass = Material::dielectric(1.5)?;
/// let fresnel = glass.fresnel(1.0);
/// assert!((fresnel.reflected - 0.04).abs() < 1e-15);
///
/// let gold = Material::conductor(0.21, 3.272)?;
/// assert!(gold.fresnel(1.0).reflected > 0.93);
/// # Ok::<(), asperity_optics::MaterialError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
#[non_exhaustive]
pub enum Material {
    /// Clear medium on both sides; `eta` = n_transmitted / n_incident, above zero.
    Dielectric {
        /// Relative refractive index.
        eta: f64,
    },
    /// Absorbing conductor of relative index `eta + i kappa`; no path is followed inside.
    Conductor {
        /// Real part of the relative index, above zero.
        eta: f64,
        /// Imaginary part, zero or more.
        kappa: f64,
    },
    /// Reflects everything.
    Mirror,
    /// Opaque and diffuse: reflects a fraction of the light in the cosine distribution about the normal of a facet, to the
    /// side that it came from, unpolarised; the rest is absorbed.
    Lambertian {
        /// Reflected fraction of the light, `[0, 1]`.
        reflectance: f64,
    },
    /// Coherent stack of thin films on a substrate of relative index `eta + i kappa`: a clear medium if `kappa` is zero, else an
    /// absorbing conductor.
    Coated {
        /// Layers, the first of which the light meets first.
        films: Films,
        /// Real part of the relative index of the substrate, above zero.
        eta: f64,
        /// Imaginary part, zero or more.
        kappa: f64,
    },
}

impl Material {
    /// A dielectric of relative index `eta`.
    ///
    /// # Errors
    /// [`MaterialError::BadEta`] unless `eta` is from 1e-6 to 1e6.
    pub fn dielectric(eta: f64) -> Result<Self, MaterialError> {
        Ok(Self::Dielectric {
            eta: valid_eta(eta)?,
        })
    }

    /// A conductor of relative index `eta + i kappa`.
    ///
    /// # Errors
    /// [`MaterialError`] unless `eta` is from 1e-6 to 1e6 and `kappa` from 0 to 1e6.
    pub fn conductor(eta: f64, kappa: f64) -> Result<Self, MaterialError> {
        Ok(Self::Conductor {
            kappa: valid_kappa(kappa)?,
            eta: valid_eta(eta)?,
        })
    }

    /// A substrate of relative index `eta + i kappa` under thin films; it transmits light if `kappa` is zero.
    ///
    /// # Errors
    /// [`MaterialError`] unless `eta` is from 1e-6 to 1e6 and `kappa` from 0 to 1e6.
    pub fn coated(films: Films, eta: f64, kappa: f64) -> Result<Self, MaterialError> {
        Ok(Self::Coated {
            films,
            kappa: valid_kappa(kappa)?,
            eta: valid_eta(eta)?,
        })
    }

    /// A diffuse material of the given `reflectance`.
    ///
    /// # Errors
    /// [`MaterialError::BadReflectance`] unless `reflectance` is from 0 to 1.
    pub fn lambertian(reflectance: f64) -> Result<Self, MaterialError> {
        if !(0.0..=1.0).contains(&reflectance) {
            return Err(MaterialError::BadReflectance(reflectance));
        }
        Ok(Self::Lambertian { reflectance })
    }

    /// Returns `true` if a facet reflects light in all directions, not in the mirror direction.
    #[must_use]
    pub const fn is_diffuse(&self) -> bool {
        matches!(self, Self::Lambertian { .. })
    }

    /// Fresnel terms for light that meets the interface from the incident medium; of a diffuse material its
    /// fractions, whatever the angle.
    #[must_use]
    #[inline(always)]
    pub fn fresnel(&self, cos_theta_i: f64) -> Fresnel {
        match *self {
            Self::Dielectric { eta } => dielectric(cos_theta_i, eta),
            Self::Conductor { eta, kappa } => conductor(cos_theta_i, eta, kappa),
            Self::Mirror => Fresnel::TOTAL_REFLECTION,
            Self::Lambertian { reflectance } => Fresnel {
                reflected: reflectance,
                transmitted: 1.0 - reflectance,
                ..Fresnel::TOTAL_REFLECTION
            },
            Self::Coated { films, eta, kappa } => {
                let fresnel = films.fresnel(cos_theta_i, eta, kappa);
                let reflected = fresnel.reflected.m00;
                Fresnel {
                    reflected,
                    transmitted: if kappa == 0.0 {
                        fresnel.transmitted.m00
                    } else {
                        1.0 - reflected
                    },
                    cos_theta_t: fresnel.cos_theta_t,
                }
            }
        }
    }

    /// Returns `true` if an interface absorbs light: not one between clear media, or of a mirror, or under clear films.
    #[must_use]
    pub fn absorbs(&self) -> bool {
        match *self {
            Self::Dielectric { .. } | Self::Mirror => false,
            Self::Conductor { .. } => true,
            Self::Lambertian { reflectance } => reflectance < 1.0,
            Self::Coated { films, kappa, .. } => kappa > 0.0 || films.absorbs(),
        }
    }

    /// Fraction of the light that the interface absorbs, of the fractions of [`Self::fresnel`].
    #[must_use]
    pub fn absorbed(&self, fresnel: &Fresnel) -> f64 {
        match self.transmitting_index() {
            None => fresnel.transmitted,
            Some(_) if self.absorbs() => (1.0 - fresnel.reflected - fresnel.transmitted).max(0.0),
            Some(_) => 0.0,
        }
    }

    /// Fresnel terms for polarised light, in the axes of the plane of incidence.
    ///
    /// `m00` is the fraction that [`Self::fresnel`] gives: bit by bit, but for conductors to rounding. A
    /// diffuse material depolarises, which no [`FacetMueller`] does: of it `m00` alone is given.
    #[must_use]
    #[inline(always)]
    pub fn polarised_fresnel(&self, cos_theta_i: f64) -> PolarisedFresnel {
        match *self {
            Self::Dielectric { eta } => polarised_dielectric(cos_theta_i, eta),
            Self::Conductor { eta, kappa } => polarised_conductor(cos_theta_i, eta, kappa),
            Self::Mirror => PolarisedFresnel::MIRROR,
            Self::Lambertian { reflectance } => PolarisedFresnel {
                reflected: FacetMueller {
                    m00: reflectance,
                    ..FacetMueller::NONE
                },
                ..PolarisedFresnel::MIRROR
            },
            Self::Coated { films, eta, kappa } => films.fresnel(cos_theta_i, eta, kappa),
        }
    }

    /// Index of the transmitted medium relative to the incident one, where light is transmitted.
    #[must_use]
    #[inline(always)]
    pub const fn transmitting_index(&self) -> Option<f64> {
        match *self {
            Self::Dielectric { eta } => Some(eta),
            Self::Coated {
                eta, kappa: 0.0, ..
            } => Some(eta),
            Self::Conductor { .. }
            | Self::Mirror
            | Self::Lambertian { .. }
            | Self::Coated { .. } => None,
        }
    }

    /// This interface for light from the other side: a dielectric has the inverse index, its films are in reverse order, an opaque
    /// material is unchanged.
    #[must_use]
    pub const fn reversed(self) -> Self {
        match self {
            Self::Dielectric { eta } => Self::Dielectric { eta: 1.0 / eta },
            Self::Coated {
                films,
                eta,
                kappa: 0.0,
            } => Self::Coated {
                films: films.reversed(eta),
                eta: 1.0 / eta,
                kappa: 0.0,
            },
            opaque => opaque,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_out_of_range_are_refused() {
        assert_eq!(Material::dielectric(0.0), Err(MaterialError::BadEta(0.0)));
        assert_eq!(Material::dielectric(-1.5), Err(MaterialError::BadEta(-1.5)));
        assert!(Material::dielectric(f64::INFINITY).is_err());
        assert!(Material::dielectric(1e300).is_err());
        assert_eq!(
            Material::conductor(0.2, -1.0),
            Err(MaterialError::BadKappa(-1.0))
        );
        assert!(Material::conductor(0.2, 3.0).is_ok());
        for reflectance in [-0.1, 1.2, f64::NAN] {
            assert!(matches!(
                Material::lambertian(reflectance),
                Err(MaterialError::BadReflectance(_))
            ));
        }
        assert!(Material::lambertian(1.0).is_ok());
    }
}
