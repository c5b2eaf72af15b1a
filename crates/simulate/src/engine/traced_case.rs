//! Cases by their number, and how those are estimated that are traced.

use std::sync::Arc;

use crate::input::case::Case;
use crate::methods::method::Method;

/// A case, and its number among those of the run.
#[derive(Clone, Debug)]
pub(crate) struct NumberedCase {
    pub(crate) number: usize,
    pub(crate) case: Case,
}

/// A case that is traced, and how it is estimated.
#[derive(Clone, Debug)]
pub(crate) struct TracedCase {
    /// Number of the case among those of the run.
    pub(crate) number: usize,
    pub(crate) case: Case,
    pub(crate) method: Arc<Method>,
}
