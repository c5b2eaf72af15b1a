//! Slopes of surfaces: moments, samples and means over regions.

mod moments;
mod regions;
mod samples;

pub use self::moments::SlopeMoments;
pub use self::regions::RegionSlopes;
pub(crate) use self::regions::by_region;
