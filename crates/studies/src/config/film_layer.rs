//! Film layer: one layer of the thin film between two media.

use asperity_simulate::short;
use serde::{Deserialize, Serialize};

use super::named_material::NamedMaterial;
use crate::settings::film_text::FilmText;

/// One layer of a thin film.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String")]
pub(super) struct FilmLayer {
    pub(super) thickness_nm: f64,
    pub(super) material: NamedMaterial,
}

impl TryFrom<String> for FilmLayer {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let film = FilmText::parse(&text).ok_or_else(|| format!("{text} is no layer of a film"))?;
        Ok(Self {
            thickness_nm: film.thickness_nm,
            material: film.material.into(),
        })
    }
}

impl FilmLayer {
    /// The layer in words, as in `SiO2 100 nm`.
    pub(super) fn label(&self) -> String {
        format!("{} {} nm", self.material.label(), short(self.thickness_nm))
    }
}
