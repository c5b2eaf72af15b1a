//! Context of a run: who follows it, and what keeps its finished parts.

use crate::observer::Observer;
use crate::store::SurfaceStore;

/// Who follows a run, and what keeps its finished parts, if anything does.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) observer: &'a dyn Observer,
    pub(crate) store: Option<&'a dyn SurfaceStore>,
}

impl<'a> Context<'a> {
    /// The context of a run that keeps nothing.
    pub(crate) const fn without_store(observer: &'a dyn Observer) -> Self {
        Self {
            observer,
            store: None,
        }
    }
}
