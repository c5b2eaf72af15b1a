//! Materials: the list of those that are known by name, and the optical constants of one against the wavelength.

mod constants;
mod error;
mod figure;
mod list;
mod sheet;

use asperity_io::material;
use serde::Deserialize;

use self::constants::{constants_at, constants_of_data, default_wavelengths};
pub use self::error::MaterialsError;
pub use self::list::{ListedMaterial, material_list, material_list_text};
pub use self::sheet::MaterialSheet;

use crate::config::values::{Number, OneOrMany};

/// Configuration of `asperity materials`.
#[derive(Clone, Debug, Deserialize)]
pub struct MaterialsConfig {
    materials: Selection,
}

/// The material that is selected, all unless one is, and the wavelengths in vacuum, nanometres.
#[derive(Clone, Debug, Deserialize)]
struct Selection {
    name: Option<String>,
    wavelength: Option<OneOrMany<Number>>,
}

impl MaterialsConfig {
    /// The optical constants of the selected material; `None` if none is selected.
    ///
    /// # Errors
    /// [`MaterialsError`] if the material is unknown, its file cannot be read, or a wavelength is out of the range of its data.
    pub fn sheet(&self) -> Result<Option<MaterialSheet>, MaterialsError> {
        let Some(name) = &self.materials.name else {
            return Ok(None);
        };
        let record = material(name)?;
        let given = self.materials.wavelength.as_ref().map(OneOrMany::as_slice);
        let mut shown = match given {
            Some(values) => values.iter().map(|value| value.0).collect(),
            None => default_wavelengths(&record.constants),
        };
        shown.sort_by(f64::total_cmp);
        shown.dedup();
        Ok(Some(MaterialSheet {
            rows: constants_at(&record, &shown)?,
            points: constants_of_data(&record),
            is_given: given.is_some(),
            record,
        }))
    }
}
