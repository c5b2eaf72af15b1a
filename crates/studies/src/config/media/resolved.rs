//! Resolved material: what a surface is made of at one wavelength, and the layer below it.

use asperity_optics::{Layer, Material, ParticipatingMedium, PhaseFunction};
use asperity_simulate::{Coordinate, Coordinates, short};
use asperity_surface::LengthUnit;
use asperity_tracer::HalfSpace;

use super::named_media::NamedMedia;
use super::stack::Stack;
use crate::config::error::ConfigError;
use crate::config::medium::MediumConfig;

/// Optical thickness beyond which no light reaches the bottom of a slab: 2e-9 of it is left.
const OPAQUE_THICKNESS: f64 = 20.0;

/// Material of a surface at one wavelength.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Resolved {
    /// Material of the interface, for light from above.
    pub(crate) material: Material,
    /// The media that it is between, where they are named.
    pub(crate) named: Option<NamedMedia>,
}

impl Resolved {
    /// Material for light from the half space `from`, with indices relative to the medium there.
    ///
    /// # Errors
    /// [`ConfigError`] if light is to come from a named medium that absorbs it.
    pub(crate) fn seen_from(self, from: HalfSpace) -> Result<Self, ConfigError> {
        let Some(named) = self.named.as_ref().filter(|_| from == HalfSpace::Below) else {
            return Ok(self);
        };
        if self.is_opaque() || self.has_body() {
            let given = format!("light from below, through {}", named.words);
            return Err(ConfigError::unsuitable(
                given,
                "needs a medium below that does not absorb",
            ));
        }
        Ok(Self {
            material: self.material.reversed(),
            ..self
        })
    }

    /// The material, and the layers of `medium` below it, for light from the half space `from`. Indices are relative to the medium above
    /// where there are layers, and to that of the light elsewhere.
    ///
    /// # Errors
    /// As of [`Self::layers`] and [`Self::seen_from`], or if no light comes in through the lowest layer.
    pub(crate) fn over_layers(
        self,
        medium: Option<&MediumConfig>,
        unit: LengthUnit,
        from: HalfSpace,
    ) -> Result<(Self, Vec<Layer>), ConfigError> {
        let layers = self.layers(medium, unit)?;
        let Some(lowest) = layers.last() else {
            return Ok((self.seen_from(from)?, layers));
        };
        if from == HalfSpace::Below && !(lowest.end().is_some() && lowest.transmits()) {
            let reason = match lowest.end() {
                None => "needs layers that end: give --thickness",
                Some(_) => {
                    "needs a bottom that lets light in; the one given is opaque: take --bottom interface or open, or a --bottom-material that transmits"
                }
            };
            return Err(ConfigError::unsuitable("light from below", reason));
        }
        Ok((self, layers))
    }

    fn is_opaque(&self) -> bool {
        self.material.transmitting_index().is_none()
    }

    /// Returns `true` if the body below absorbs along the path of light.
    pub(crate) fn has_body(&self) -> bool {
        self.named.as_ref().is_some_and(|named| named.has_body)
    }

    /// Coordinates `at` with the names of the media and the wavelength.
    pub(crate) fn coordinates(&self, mut at: Coordinates) -> Coordinates {
        if let Some(named) = &self.named {
            at.material = Some(named.words.clone());
            at.index_above = (named.index_above != 1.0).then_some(named.index_above);
            at.others.push(Coordinate::wavelength(named.wavelength_nm));
        }
        at
    }

    /// The layers below the surface, whose lengths are in `unit`, from above: of media that are configured, and of a body that absorbs. None
    /// where there is neither, and below an opaque body that is thicker than light gets.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range, the material transmits no light, or a body absorbs over lengths without a unit.
    pub(crate) fn layers(
        &self,
        medium: Option<&MediumConfig>,
        unit: LengthUnit,
    ) -> Result<Vec<Layer>, ConfigError> {
        let absorption = self.absorption(medium, unit)?;
        match medium {
            Some(medium) if self.is_thick(medium, absorption)? => Ok(Vec::new()),
            Some(medium) => {
                let named = self.named.as_ref();
                Stack::new(self.material, named, medium, absorption, unit)?.layers()
            }
            None if !self.has_body() => Ok(Vec::new()),
            None => {
                let isotropic = PhaseFunction::Isotropic;
                let body = ParticipatingMedium::from_coefficients(absorption, 0.0, isotropic)?;
                Ok(vec![Layer::half_space(body)])
            }
        }
    }

    /// Returns `true` if a slab of an opaque body is thicker than light gets.
    ///
    /// # Errors
    /// [`ConfigError`] if a slab of such a body is thinner.
    fn is_thick(&self, medium: &MediumConfig, absorption: f64) -> Result<bool, ConfigError> {
        let named = self.named.as_ref().filter(|_| self.is_opaque());
        let (Some(named), Some(thickness)) = (named, &medium.thickness) else {
            return Ok(false);
        };
        if thickness.one("thickness")?.0 * absorption > OPAQUE_THICKNESS {
            return Ok(true);
        }
        let [nm, wavelength] =
            [OPAQUE_THICKNESS / named.absorption, named.wavelength_nm].map(short);
        let given = format!("a slab of {}", named.words);
        let reason = format!(
            "must be thicker than {nm} nm at {wavelength} nm, in lengths with a unit, since light gets through a thinner one; give that as a film"
        );
        Err(ConfigError::unsuitable(given, reason))
    }

    /// Absorption coefficient of the medium below, 1 / `unit`; zero of an opaque one over lengths without a unit.
    fn absorption(
        &self,
        medium: Option<&MediumConfig>,
        unit: LengthUnit,
    ) -> Result<f64, ConfigError> {
        let named = self.named.as_ref().filter(|named| named.absorption > 0.0);
        let Some(named) = named else {
            return Ok(0.0);
        };
        let matters = self.has_body() || medium.is_some() && !self.is_opaque();
        match LengthUnit::Nanometre.conversion(unit) {
            Some(nm) => Ok(named.absorption / nm(1.0)),
            None if !matters => Ok(0.0),
            None => {
                let given = format!("{} at {} nm", named.words, short(named.wavelength_nm));
                let reason = "absorbs over a length, but the lengths of the surface have no unit: give one by --unit, or to a file by --assume-unit";
                Err(ConfigError::unsuitable(given, reason))
            }
        }
    }
}
