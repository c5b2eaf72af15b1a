//! Provenance: recipe and random stream by which a surface was drawn.

use std::any::Any;
use std::sync::Arc;

use asperity_surface::ProvenanceRecord;
use serde::{Deserialize, Serialize};

use super::surface_recipe::SurfaceRecipe;

/// Recipe and random stream by which a surface was drawn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Provenance {
    /// Recipe it was drawn by.
    #[serde(rename = "psd")]
    pub recipe: SurfaceRecipe,
    /// The seed.
    pub seed: u64,
    /// The realisation drawn from that seed, counted from zero.
    pub realisation: u64,
}

impl Provenance {
    /// Returns the provenance that a surface carries as `record`, if it was drawn by this crate.
    #[must_use]
    pub fn of(record: Option<&Arc<dyn ProvenanceRecord>>) -> Option<&Self> {
        (record?.as_ref() as &dyn Any).downcast_ref()
    }
}

impl ProvenanceRecord for Provenance {
    fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Arc<dyn ProvenanceRecord> {
        Arc::new(Self {
            recipe: self.recipe.converted(convert),
            ..*self
        })
    }

    fn equals(&self, other: &dyn ProvenanceRecord) -> bool {
        (other as &dyn Any).downcast_ref() == Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Psd;

    fn drawn(sigma: f64, tau_x: f64, tau_y: f64) -> Provenance {
        let psd = Psd::anisotropic_gaussian(sigma, tau_x, tau_y, 0.5).unwrap();
        Provenance {
            recipe: psd.into(),
            seed: 3,
            realisation: 1,
        }
    }

    #[test]
    fn lengths_of_a_record_are_converted_and_its_stream_stays() {
        let record = drawn(0.25, 8.0, 16.0).converted(&|length| 1e3 * length);
        let expected = drawn(250.0, 8e3, 16e3);
        assert_eq!(Provenance::of(Some(&record)), Some(&expected));
        assert!(expected.equals(record.as_ref()) && !drawn(1.0, 8e3, 16e3).equals(record.as_ref()));
    }
}
