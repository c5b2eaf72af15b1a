//! Provenance record: how a surface was drawn, carried along by the surface.

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

/// Record of how a surface was drawn, made and read by the crate that draws.
///
/// A surface carries it along, and drops it when it is no longer the surface that was drawn.
pub trait ProvenanceRecord: Any + Debug + Send + Sync {
    /// Returns the record with all lengths converted.
    fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Arc<dyn ProvenanceRecord>;

    /// Returns `true` if `other` is equal to it.
    fn equals(&self, other: &dyn ProvenanceRecord) -> bool;
}

impl PartialEq for dyn ProvenanceRecord {
    fn eq(&self, other: &Self) -> bool {
        self.equals(other)
    }
}

/// Record of one length, for tests.
#[cfg(test)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RecordedLength(pub(crate) f64);

#[cfg(test)]
impl ProvenanceRecord for RecordedLength {
    fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Arc<dyn ProvenanceRecord> {
        Arc::new(Self(convert(self.0)))
    }

    fn equals(&self, other: &dyn ProvenanceRecord) -> bool {
        (other as &dyn Any).downcast_ref() == Some(self)
    }
}
