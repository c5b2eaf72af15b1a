//! Limits of structured surfaces.

/// Largest change of a period, as a fraction of it, that lets whole numbers of periods fit a tile.
pub const MAX_ADJUSTMENT: f64 = 0.1;

/// Fewest spacings that the width of a feature must span.
pub const MIN_SPACINGS_PER_WIDTH: f64 = 4.0;

/// Largest number of features of one surface.
pub const MAX_FEATURES: usize = 1 << 24;

/// Largest density of features that overlap.
pub(super) const MAX_DENSITY: f64 = 20.0;

/// Largest radius of curvature of an edge of a segment, in units of its width.
pub(super) const MAX_EDGE_RADIUS: f64 = 10.0;

/// Longest feature, in sides of the tile.
pub(super) const MAX_TILES_PER_FEATURE: f64 = 100.0;

/// Widest feature, in sides of the tile: its periodic images all reach each sample.
pub(super) const MAX_TILES_PER_WIDTH: f64 = 10.0;

/// Bytes per feature: its parameters, and about nine buckets that it may reach, with the position of each.
pub(super) const BYTES_PER_FEATURE: usize = 512;

/// Spacings that a radius of curvature must span for smooth cells to follow it.
pub(super) const SPACINGS_PER_RADIUS: f64 = 4.0;
