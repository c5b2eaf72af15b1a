//! State: the data that pass between the stages, field by field.

pub(crate) mod arrivals;
pub(crate) mod batch;
pub(crate) mod conductors;
pub(crate) mod flights;
pub(crate) mod light_state;
pub(crate) mod path_state;
pub(crate) mod random_numbers;
pub(crate) mod scattered;
pub(crate) mod segments;
pub(crate) mod visibility_rays;
pub(crate) mod work;
