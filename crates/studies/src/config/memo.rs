//! Memo: keeps what was measured of surfaces, for all copies of their configuration.
//!
//! Statistics of structures and of eroded surfaces that models and bins need are measured on surfaces that take as long to draw as those of the
//! run. Every case of a sweep is a copy of one configuration, and each is planned several times: the copies share what is measured.

use std::sync::{Arc, Mutex, PoisonError};

/// The last measurement, shared by all copies, with the description of what was measured.
#[derive(Clone, Debug)]
pub(super) struct Memo<K, V>(Arc<Mutex<Option<(K, V)>>>);

impl<K, V> Default for Memo<K, V> {
    fn default() -> Self {
        Self(Arc::default())
    }
}

/// It decides nothing, so that configurations that differ in it alone are equal.
impl<K, V> PartialEq for Memo<K, V> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<K: PartialEq, V: Clone> Memo<K, V> {
    /// Returns what `measure` finds of `described`, measured unless it was measured last.
    pub(super) fn measured<E>(
        &self,
        described: K,
        measure: impl FnOnce(&K) -> Result<V, E>,
    ) -> Result<V, E> {
        let mut last = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((same, measured)) = &*last
            && *same == described
        {
            return Ok(measured.clone());
        }
        let measured = measure(&described)?;
        *last = Some((described, measured.clone()));
        Ok(measured)
    }
}

#[cfg(test)]
mod tests {
    use asperity_synthesis::MeasuredStructure;

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
        assert_eq!(
            memo.measured(synthesis, MeasuredStructure::of).unwrap(),
            foreign
        );
        assert_ne!(config.plan().unwrap().cases, cases);
        other.plan().unwrap();
        assert_eq!(config.plan().unwrap().cases, cases);
    }
}
