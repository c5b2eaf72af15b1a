//! Stack: the layers of a configuration, from above, with the indices of the faces between and below them.

use std::f64::consts::PI;

use asperity_optics::{Bottom, BottomSurface, Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_surface::LengthUnit;

use super::faces::{face, is_opaque, layers_of_film, unknown_absorption};
use super::named_media::NamedMedia;
use crate::config::error::ConfigError;
use crate::config::film_layer::FilmLayer;
use crate::config::layer_config::LayerConfig;
use crate::config::medium::{BottomKind, MediumConfig};
use crate::config::named_material::NamedMaterial;
use crate::config::values::OneOrMany;
use crate::settings::film_text::index;

/// Layers below a surface, of a configuration without lists.
pub(super) struct Stack<'a> {
    named: Option<&'a NamedMedia>,
    medium: &'a MediumConfig,
    unit: LengthUnit,
    /// Index of the medium above.
    n_above: f64,
    /// Layers, from above.
    layers: Vec<StackLayer>,
}

/// A layer before the faces around it are known.
struct StackLayer {
    medium: ParticipatingMedium,
    /// Index, relative to vacuum where the medium above is named.
    n: f64,
    thickness: Option<f64>,
    /// Shape of the face above it.
    shape: BottomSurface,
}

impl<'a> Stack<'a> {
    /// The layers of `medium` below a surface of a material, which absorbs itself by `absorption`, 1 / `unit`.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range, or the material transmits no light.
    pub(super) fn new(
        material: Material,
        named: Option<&'a NamedMedia>,
        medium: &'a MediumConfig,
        absorption: f64,
        unit: LengthUnit,
    ) -> Result<Self, ConfigError> {
        let Some(eta) = material.transmitting_index() else {
            return Err(ConfigError::medium_below(material));
        };
        let n_above = named.map_or(1.0, |named| named.index_above);
        let thickness = medium.thickness.as_ref();
        let thickness = thickness.map(|one| one.one("thickness")).transpose()?;
        let first = StackLayer {
            medium: with_absorption(medium.participating_medium()?, absorption)?,
            n: eta * n_above,
            thickness: thickness.map(|thickness| thickness.0),
            shape: BottomSurface::Flat,
        };
        let mut stack = Self {
            named,
            medium,
            unit,
            n_above,
            layers: vec![first],
        };
        for further in medium.layers.iter().flat_map(OneOrMany::as_slice) {
            let layer = stack.further(further)?;
            stack.layers.push(layer);
        }
        Ok(stack)
    }

    /// A layer below the first.
    fn further(&self, config: &LayerConfig) -> Result<StackLayer, ConfigError> {
        let text = &config.text;
        let [n, k] = self.index(&config.material)?;
        let given = || format!("layer {}", text.text);
        let thickness = text.thickness.in_unit(self.unit).ok_or_else(|| {
            let reason = "has a length with a unit, which the surface has not";
            ConfigError::unsuitable(given(), reason)
        })?;
        if is_opaque(k) {
            let reason = "lets no light through; give what is opaque by --bottom-material";
            return Err(ConfigError::unsuitable(given(), reason));
        }
        let phase = match text.g {
            Some(g) => PhaseFunction::henyey_greenstein(g)?,
            None => PhaseFunction::Isotropic,
        };
        let medium =
            ParticipatingMedium::from_coefficients(text.absorption, text.scattering, phase)?;
        Ok(StackLayer {
            medium: with_absorption(medium, self.absorption(&given(), k)?)?,
            n,
            thickness: Some(thickness),
            shape: text.surface,
        })
    }

    /// Index of a material of the stack.
    fn index(&self, material: &NamedMaterial) -> Result<[f64; 2], ConfigError> {
        let Some(named) = self.named else {
            return index(&material.name).ok_or_else(|| {
                let reason = "below a surface without a named material give indices, or name that one too, as by --material 1.5";
                ConfigError::unsuitable(material.name.clone(), reason)
            });
        };
        let found = material.index(named.wavelength_nm)?;
        let k = found.k.or(named.kappa);
        k.map(|k| [found.n, k])
            .ok_or_else(|| unknown_absorption(material, named.wavelength_nm))
    }

    /// Absorption coefficient of an absorption index, 1 / length unit.
    fn absorption(&self, given: &str, k: f64) -> Result<f64, ConfigError> {
        if k == 0.0 {
            return Ok(0.0);
        }
        let nm = LengthUnit::Nanometre.conversion(self.unit);
        let (Some(named), Some(nm)) = (self.named, nm) else {
            let reason = "has an absorption index, which needs lengths with a unit and the wavelength of a named material; or give absorption";
            return Err(ConfigError::unsuitable(given.to_owned(), reason));
        };
        Ok(4.0 * PI * k / (named.wavelength_nm * nm(1.0)))
    }

    /// The layers with their faces.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range.
    pub(super) fn layers(&self) -> Result<Vec<Layer>, ConfigError> {
        let with_bottom = |(number, layer): (usize, &StackLayer)| {
            let Some(thickness) = layer.thickness else {
                return Ok(Layer::half_space(layer.medium));
            };
            let (bottom, shape) = match self.layers.get(number + 1) {
                Some(next) => (Bottom::interface(next.n / layer.n), next.shape),
                None => (
                    self.lowest_bottom(layer.n)?,
                    self.medium.bottom_surface.named(),
                ),
            };
            Ok(Layer::slab(layer.medium, thickness, bottom)?.on(shape))
        };
        self.layers.iter().enumerate().map(with_bottom).collect()
    }

    /// Bottom of the lowest layer, whose index is `n`.
    fn lowest_bottom(&self, n: f64) -> Result<Bottom, ConfigError> {
        let medium = self.medium;
        Ok(match medium.bottom.unwrap_or(BottomKind::Interface) {
            BottomKind::Open => Bottom::Open,
            BottomKind::Interface => Bottom::Face(self.lowest_face(n)?),
            BottomKind::Absorbing => Bottom::ABSORBING,
            BottomKind::Mirror => Bottom::MIRROR,
            BottomKind::Lambertian => {
                Bottom::lambertian(medium.bottom_reflectance.map_or(1.0, |fraction| fraction.0))
            }
        })
    }

    fn lowest_face(&self, n: f64) -> Result<Material, ConfigError> {
        let medium = self.medium;
        let films = medium
            .bottom_film
            .as_ref()
            .map_or(&[][..], OneOrMany::as_slice);
        let films = match (films, self.named) {
            ([], _) => Vec::new(),
            ([first, ..], None) => {
                let given = format!("bottom_film {}", FilmLayer::label(first));
                let reason = "needs a named material, as by --material 1.5, at a wavelength";
                return Err(ConfigError::unsuitable(given, reason));
            }
            (films, Some(named)) => {
                let of = |material: &NamedMaterial| self.index(material);
                layers_of_film(films, n, named.wavelength_nm, of)?
            }
        };
        match &medium.bottom_material {
            None => {
                let eta = medium.bottom_eta.map_or(self.n_above / n, |eta| eta.0);
                face(&films, [eta, 0.0], false)
            }
            Some(material) => {
                let [beyond, k] = self.index(material)?;
                face(&films, [beyond / n, k / n], is_opaque(k))
            }
        }
    }
}

/// A medium that absorbs more, by a coefficient.
fn with_absorption(
    medium: ParticipatingMedium,
    absorption: f64,
) -> Result<ParticipatingMedium, ConfigError> {
    if absorption == 0.0 {
        return Ok(medium);
    }
    let own = medium.extinction() * (1.0 - medium.albedo());
    let scattering = medium.extinction() * medium.albedo();
    Ok(ParticipatingMedium::from_coefficients(
        own + absorption,
        scattering,
        medium.phase(),
    )?)
}
