//! Limits of the walk: rules by which a path ends.

/// Interactions after which a path is truncated.
pub(super) const MAX_INTERACTIONS: u32 = 1000;

/// Russian roulette begins below this fraction of the weight with which the light leaves the first facet. It is
/// relative, so that the rarity of multiple scattering does not matter.
pub(super) const ROULETTE_THRESHOLD: f64 = 0.25;

/// Weight below which a path is not followed: a hundredth of the rounding of energies near one. Most light on
/// a smooth surface leaves less behind.
pub(super) const MIN_WEIGHT: f64 = 1e-18;
