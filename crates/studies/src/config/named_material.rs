//! Named material: a material by its name in the library, by the name of a file, or by an index.

use std::sync::Arc;

use asperity_io::{MaterialRecord, material, names_file};
use asperity_numerics::fnv1a;
use asperity_optics::ComplexIndex;
use serde::{Deserialize, Serialize, Serializer};

use crate::config::error::ConfigError;
use crate::config::memo::Memo;
use crate::settings::film_text::index;

/// Material that is clear, though its record has no absorption index.
const AIR: &str = "air";

/// A material by its name, by the name of a file, or by an index that does not depend on the wavelength.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(from = "String")]
pub(super) struct NamedMaterial {
    /// The name as it is given.
    pub(super) name: String,
    record: Memo<(), Arc<MaterialRecord>>,
}

impl From<String> for NamedMaterial {
    fn from(name: String) -> Self {
        Self {
            name,
            record: Memo::default(),
        }
    }
}

/// By its name, with the content of a file, so that results of another are told apart.
impl Serialize for NamedMaterial {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.record() {
            Ok(record) if names_file(&self.name) => {
                let content = fnv1a(format!("{:?}", record.constants).into_bytes());
                serializer.collect_str(&format_args!("{} ({content:016x})", self.name))
            }
            _ => serializer.serialize_str(&self.name),
        }
    }
}

impl NamedMaterial {
    /// Its record, read once for all copies.
    fn record(&self) -> Result<Arc<MaterialRecord>, ConfigError> {
        let read = |&(): &()| match material(&self.name) {
            Ok(record) => Ok(Arc::new(record)),
            Err(error) => Err(ConfigError::Record(error.to_string())),
        };
        self.record.measured((), read)
    }

    /// Its name; of a file that of its record, without the folder.
    pub(super) fn label(&self) -> String {
        if index(&self.name).is_some() {
            return format!("n = {}", self.name);
        }
        match self.record() {
            Ok(record) if names_file(&self.name) => record.name.clone(),
            _ => self.name.clone(),
        }
    }

    /// Its index at a wavelength in nanometres; that of air has `k` = 0.
    ///
    /// # Errors
    /// [`ConfigError`] if it has no record, or the record no index there.
    pub(super) fn index(&self, wavelength_nm: f64) -> Result<ComplexIndex, ConfigError> {
        if let Some([n, k]) = index(&self.name) {
            return Ok(ComplexIndex { n, k: Some(k) });
        }
        let record = self.record()?;
        let found = record.constants.at(wavelength_nm * 1e-3);
        let mut index =
            found.map_err(|error| ConfigError::unsuitable(self.name.clone(), error.to_string()))?;
        if record.name == AIR {
            index.k = Some(0.0);
        }
        Ok(index)
    }
}
