//! Context of a run: engine, observer and store.

use asperity_tracer::Engine;

use crate::observer::Observer;
use crate::store::SurfaceStore;

/// Engine, observer and, if there is one, store of a run.
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
