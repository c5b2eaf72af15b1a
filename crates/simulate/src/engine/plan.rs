//! Planning of the effort that reaches a target error.

pub(crate) mod effort;
pub(crate) mod path_trial;
pub(crate) mod paths;
pub(crate) mod pilot;
pub(crate) mod spacings;
