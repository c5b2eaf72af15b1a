//! Travel: the facets that segments hit, all in their first tile together, and one by one beyond it.

pub(crate) mod search;
pub(crate) mod single;
