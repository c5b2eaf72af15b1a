//! Coordinates: the values that tell the cases of a run apart.
//!
//! A further quantity that cases differ in is one more [`Coordinate`] of [`Coordinates::others`]; nothing else has to know of it.

use asperity_surface::LengthUnit;
use serde::{Deserialize, Serialize};

use crate::text::short;

/// Coordinates that distinguish a case from others, beside its material, layer and light.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coordinates {
    /// `tau / sigma` of random surfaces, by the first principal axis.
    pub smoothness: Option<f64>,
    /// Unit of the lengths of the surface and of the layer below it.
    pub unit: LengthUnit,
    /// Name of the material, where it has one, as in `gold`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Refractive index of the medium above, where it is not one: lengths are judged by the wavelength there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub index_above: Option<f64>,
    /// Further quantities.
    pub others: Vec<Coordinate>,
}

impl Coordinates {
    /// The wavelength in vacuum, nanometres, where the material depends on it.
    #[must_use]
    pub fn wavelength_nm(&self) -> Option<f64> {
        let mut others = self.others.iter();
        let found = others.find(|one| one.name == Coordinate::WAVELENGTH)?;
        Some(found.value)
    }
}

/// The value of a further quantity.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coordinate {
    /// Name, as in `wavelength`: that of the part of a folder's name, and with the unit of the column and the JSON member.
    pub name: String,
    /// Symbol in text and figures, as in `lambda`.
    pub symbol: String,
    /// Value.
    pub value: f64,
    /// Unit; empty for pure numbers.
    pub unit: String,
    /// Description of the column.
    pub about: String,
}

impl Coordinate {
    /// Name of the wavelength.
    const WAVELENGTH: &str = "wavelength";

    /// The wavelength in vacuum, nanometres, at which the index of a material is taken.
    #[must_use]
    pub fn wavelength(nanometres: f64) -> Self {
        Self {
            name: Self::WAVELENGTH.to_owned(),
            symbol: "lambda".to_owned(),
            value: nanometres,
            unit: "nm".to_owned(),
            about: "wavelength in vacuum".to_owned(),
        }
    }

    /// Name of the column and the JSON member, with the unit, as in `wavelength_nm`.
    pub(crate) fn column(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{}_{unit}", self.name),
        }
    }

    /// Value and unit.
    pub(crate) fn value_text(&self) -> String {
        match self.unit.as_str() {
            "" => short(self.value),
            unit => format!("{} {unit}", short(self.value)),
        }
    }

    /// Symbol and value, as in `lambda = 550 nm`.
    pub(crate) fn text(&self) -> String {
        format!("{} = {}", self.symbol, self.value_text())
    }
}
