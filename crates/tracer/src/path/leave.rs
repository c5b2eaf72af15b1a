//! Leave: light that escapes into the tally, and light that is shadowed or masked.

pub(crate) mod escape;
pub(crate) mod masking;
