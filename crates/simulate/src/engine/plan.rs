//! Planning of the effort that reaches a target error.

pub(crate) mod cost;
pub(crate) mod effort;
pub(crate) mod path_trial;
pub(crate) mod paths;
pub(crate) mod pilot;
pub(crate) mod planned_work;
pub(crate) mod spacings;
