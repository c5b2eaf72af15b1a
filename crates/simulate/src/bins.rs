//! Bins that follow the light: where lobes are narrower than bins of equal angles, and how bins refine around them.

pub(crate) mod core_slopes;
pub(crate) mod graded;
pub(crate) mod lobe;
pub(crate) mod lobe_bins;
