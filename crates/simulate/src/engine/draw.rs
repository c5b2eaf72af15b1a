//! Drawing of surfaces, and their preparation for tracing.

pub(crate) mod built_surface;
pub(crate) mod drawer;
