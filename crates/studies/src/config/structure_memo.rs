//! Structure memo: keeps what was measured of a structure, for all copies of its configuration.
//!
//! Statistics of a structure that models and bins need are measured on surfaces that take as long to draw as those of the run. Every case of
//! a sweep is a copy of one configuration, and each is planned several times: the copies share what is measured.

use std::sync::{Arc, Mutex, PoisonError};

use asperity_synthesis::{MeasuredStructure, StructureError, StructureSynthesis};

/// The last measurement, shared by all copies.
#[derive(Clone, Debug, Default)]
pub(super) struct StructureMemo(Arc<Mutex<Option<(StructureSynthesis, MeasuredStructure)>>>);

/// It decides nothing, so that configurations that differ in it alone are equal.
impl PartialEq for StructureMemo {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl StructureMemo {
    /// Returns the surfaces that `synthesis` draws, measured unless they were measured last.
    pub(super) fn measured(
        &self,
        synthesis: StructureSynthesis,
    ) -> Result<MeasuredStructure, StructureError> {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((same, measured)) = &*last
            && *same == synthesis
        {
            return Ok(measured.clone());
        }
        let measured = MeasuredStructure::of(&synthesis)?;
        *last = Some((synthesis, measured.clone()));
        Ok(measured)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::VerifyConfig;
    use crate::config::values::{Number, OneOrMany};

    #[test]
    fn copies_of_a_configuration_share_what_is_measured() {
        let text = "[surface]\nstructure = \"pits\"\nsize = 128\nsigma = [0.1, 0.2]\n[light]\ntheta = [0, 30]";
        let config = VerifyConfig::from_toml(text).unwrap();
        let memo = config.surface.measured.clone();
        let is_kept = || memo.0.lock().unwrap().is_some();
        assert!(!is_kept());
        let cases = config.plan().unwrap().cases;
        assert!(is_kept());
        assert_eq!(cases.len(), 4);
        // A marked measurement comes back for the same structure, and another one is measured anew
        let synthesis_of = |config: &VerifyConfig| {
            let structure = config.surface.structure.as_ref().unwrap();
            config.surface.structure_synthesis(structure).unwrap()
        };
        let synthesis = synthesis_of(&config);
        let mut other = config.clone();
        other.surface.structure.as_mut().unwrap().depth = Some(OneOrMany::One(Number(2.0)));
        let foreign = MeasuredStructure::of(&synthesis_of(&other)).unwrap();
        *memo.0.lock().unwrap() = Some((synthesis, foreign.clone()));
        assert_eq!(memo.measured(synthesis).unwrap(), foreign);
        assert_ne!(config.plan().unwrap().cases, cases);
        other.plan().unwrap();
        assert_eq!(config.plan().unwrap().cases, cases);
    }
}
