//! Layer below a surface: a participating medium and its lower boundary.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::material_error::valid_eta;
use crate::{Material, MaterialError, ParticipatingMedium};

/// Lower boundary of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[expect(clippy::large_enum_variant, reason = "there are a few per case")]
pub enum Bottom {
    /// None: the particles end, but not the material around them. Light leaves undeviated.
    Open,
    /// A face of this material, whose indices are relative to the layer: an interface to the medium beyond, or opaque.
    Face(Material),
}

impl Bottom {
    /// A bottom that absorbs all light.
    pub const ABSORBING: Self = Self::Face(Material::Lambertian { reflectance: 0.0 });

    /// A bottom that reflects all light as a mirror does.
    pub const MIRROR: Self = Self::Face(Material::Mirror);

    /// An interface to a clear medium, of index `eta` = n_beyond / n_layer.
    #[must_use]
    pub const fn interface(eta: f64) -> Self {
        Self::Face(Material::Dielectric { eta })
    }

    /// A bottom that reflects the fraction `reflectance` of the light by Lambert's law, and absorbs the rest.
    #[must_use]
    pub const fn lambertian(reflectance: f64) -> Self {
        Self::Face(Material::Lambertian { reflectance })
    }

    /// n_beyond / n_layer, where light leaves the layer through it.
    #[must_use]
    pub const fn index_beyond(&self) -> Option<f64> {
        match self {
            Self::Open => Some(1.0),
            Self::Face(material) => material.transmitting_index(),
        }
    }

    /// Material of the bottom: of an open one, an interface that does nothing.
    #[must_use]
    pub const fn material(&self) -> Material {
        match self {
            Self::Open => Material::Dielectric { eta: 1.0 },
            Self::Face(material) => *material,
        }
    }
}

/// The shape of a layer's bottom.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BottomSurface {
    /// A plane.
    #[default]
    Flat,
    /// The uppermost surface, moved down.
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

/// A medium below a surface, semi-infinite or down to a bottom.
///
/// # Examples
/// ```
/// use asperity_optics::{Bottom, Layer, ParticipatingMedium, PhaseFunction};
///
/// let phase = PhaseFunction::henyey_greenstein(0.8)?;
/// let medium = ParticipatingMedium::from_mean_free_path(2.0, 0.9, phase)?;
/// let layer = Layer::slab(medium, 40.0, Bottom::ABSORBING)?;
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
    /// Shape of the bottom, unless the given surface has a bottom of its own.
    pub shape: BottomSurface,
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

    /// A medium down to a flat bottom `thickness` below the mean plane of what it lies under.
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
            Bottom::Face(Material::Lambertian { reflectance })
                if !(0.0..=1.0).contains(&reflectance) =>
            {
                return Err(LayerError::BadReflectance(reflectance));
            }
            Bottom::Face(Material::Dielectric { eta }) => {
                valid_eta(eta).map_err(LayerError::BadIndex)?;
            }
            _ => {}
        }
        Ok(Self {
            medium,
            slab: Some(Slab {
                thickness,
                bottom,
                shape: BottomSurface::Flat,
            }),
        })
    }

    /// This layer with a bottom of that shape, if it has an end.
    #[must_use]
    pub fn on(self, shape: BottomSurface) -> Self {
        Self {
            slab: self.slab.map(|slab| Slab { shape, ..slab }),
            ..self
        }
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
            Some(slab) => slab.bottom.index_beyond().is_some(),
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
        assert!(slab(Bottom::interface(1.2)).transmits());
        for bottom in [Bottom::ABSORBING, Bottom::MIRROR, Bottom::lambertian(0.5)] {
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
        assert!(refusal(1.0, Bottom::interface(-1.0)).contains("eta is -1"));
        assert!(refusal(1.0, Bottom::lambertian(1.1)).contains("1.1"));
    }
}
