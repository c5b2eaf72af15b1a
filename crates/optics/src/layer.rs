//! Layer below a surface: a participating medium and its lower boundary.

use serde::{Deserialize, Serialize};

use crate::material_error::valid_eta;
use crate::{MaterialError, ParticipatingMedium};

/// Lower boundary of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Bottom {
    /// None: the particles end, but not the material around them. Light leaves undeviated.
    Open,
    /// An interface to a clear third medium, of index `eta` relative to the layer's.
    Interface {
        /// n_beyond / n_layer.
        eta: f64,
    },
    /// Absorbs all light.
    Absorbing,
    /// Reflects all light as a mirror does.
    Mirror,
    /// Reflects a fraction of the light into all directions, by Lambert's law.
    Lambertian {
        /// Reflected fraction of the light, `[0, 1]`; the rest is absorbed.
        reflectance: f64,
    },
}

/// A medium below a surface, semi-infinite or down to a bottom.
///
/// # Examples
/// ```
/// use asperity_optics::{Bottom, Layer, ParticipatingMedium, PhaseFunction};
///
/// let phase = PhaseFunction::henyey_greenstein(0.8)?;
/// let medium = ParticipatingMedium::from_mean_free_path(2.0, 0.9, phase)?;
/// let layer = Layer::slab(medium, 40.0, Bottom::Absorbing)?;
/// assert!(!layer.transmits());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layer {
    medium: ParticipatingMedium,
    slab: Option<Slab>,
}

/// Thickness and lower boundary of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Slab {
    /// Distance from the mean plane of the surface to that of the bottom, in the unit of the surface.
    pub thickness: f64,
    /// Lower boundary.
    pub bottom: Bottom,
}

/// Error of an invalid layer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayerError {
    /// The thickness is out of range.
    #[error("the thickness is {0:?}; it must be a length above zero")]
    BadThickness(f64),
    /// The bottom's reflectance is out of range.
    #[error("the bottom's reflectance is {0:?}; it must be from 0 to 1")]
    BadReflectance(f64),
    /// The index beyond the bottom is out of range.
    #[error("beyond the bottom, {0}")]
    BadIndex(MaterialError),
}

impl Layer {
    /// A semi-infinite medium.
    #[must_use]
    pub const fn half_space(medium: ParticipatingMedium) -> Self {
        Self { medium, slab: None }
    }

    /// A medium down to `thickness` below the mean plane.
    ///
    /// # Errors
    /// [`LayerError`] unless `0 < thickness <= 1e150`, a reflectance is from 0 to 1, and an index is in the range of [`Material`](crate::Material).
    pub fn slab(
        medium: ParticipatingMedium,
        thickness: f64,
        bottom: Bottom,
    ) -> Result<Self, LayerError> {
        if !(thickness > 0.0 && thickness <= 1e150) {
            return Err(LayerError::BadThickness(thickness));
        }
        match bottom {
            Bottom::Lambertian { reflectance } if !(0.0..=1.0).contains(&reflectance) => {
                return Err(LayerError::BadReflectance(reflectance));
            }
            Bottom::Interface { eta } => {
                valid_eta(eta).map_err(LayerError::BadIndex)?;
            }
            _ => {}
        }
        Ok(Self {
            medium,
            slab: Some(Slab { thickness, bottom }),
        })
    }

    /// The medium.
    #[must_use]
    pub const fn medium(&self) -> ParticipatingMedium {
        self.medium
    }

    /// Thickness and lower boundary; `None` if it is semi-infinite.
    #[must_use]
    pub const fn end(&self) -> Option<Slab> {
        self.slab
    }

    /// Returns `true` if light that enters may leave on the other side.
    #[must_use]
    pub fn transmits(&self) -> bool {
        match self.slab {
            None => self.medium.is_clear(),
            Some(slab) => matches!(slab.bottom, Bottom::Open | Bottom::Interface { .. }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PhaseFunction;

    fn medium(extinction: f64) -> ParticipatingMedium {
        let phase = PhaseFunction::Isotropic;
        ParticipatingMedium::from_coefficients(0.0, extinction, phase).unwrap()
    }

    #[test]
    fn only_clear_half_spaces_open_bottoms_and_interfaces_transmit() {
        let slab = |bottom| Layer::slab(medium(1.0), 2.0, bottom).unwrap();
        assert!(!Layer::half_space(medium(1.0)).transmits());
        assert!(Layer::half_space(medium(0.0)).transmits());
        assert!(slab(Bottom::Open).transmits());
        assert!(slab(Bottom::Interface { eta: 1.2 }).transmits());
        for bottom in [
            Bottom::Absorbing,
            Bottom::Mirror,
            Bottom::Lambertian { reflectance: 0.5 },
        ] {
            assert!(!slab(bottom).transmits());
        }
    }

    #[test]
    fn invalid_layers_are_refused() {
        let refusal = |thickness, bottom| {
            let layer = Layer::slab(medium(1.0), thickness, bottom);
            layer.unwrap_err().to_string()
        };
        for thickness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(refusal(thickness, Bottom::Open).contains("thickness"));
        }
        assert!(refusal(1.0, Bottom::Interface { eta: -1.0 }).contains("eta is -1"));
        let lambertian = |reflectance| Bottom::Lambertian { reflectance };
        assert!(refusal(1.0, lambertian(1.1)).contains("1.1"));
    }
}
