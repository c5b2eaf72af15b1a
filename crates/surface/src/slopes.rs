//! Slopes of surfaces: moments, samples and means over regions.

mod moments;
mod regions;
mod samples;
mod spline_regions;

pub use self::moments::SlopeMoments;
pub use self::regions::RegionSlopes;
