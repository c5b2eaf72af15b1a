//! Context of a run: who traces it, who follows it, and what keeps its finished parts.

use asperity_tracer::Engine;

use crate::observer::Observer;
use crate::store::SurfaceStore;

/// Who traces a run, who follows it, and what keeps its finished parts, if anything does.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) engine: &'a dyn Engine,
    pub(crate) observer: &'a dyn Observer,
    pub(crate) store: Option<&'a dyn SurfaceStore>,
}

#[cfg(test)]
impl<'a> Context<'a> {
    /// The context of a run on the processor that keeps nothing.
    pub(crate) const fn without_store(observer: &'a dyn Observer) -> Self {
        Self {
            engine: &asperity_tracer::CpuEngine,
            observer,
            store: None,
        }
    }
}
