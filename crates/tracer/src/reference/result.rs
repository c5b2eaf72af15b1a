//! Result: the end of a path, and its contribution to a camera.

use asperity_optics::Stokes;
use asperity_tally::EventPath;
use glam::DVec3;

/// The end of a path, and what became of its flux, which begins as one: what it has left, what was
/// absorbed and what was truncated on the way add up to one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathResult {
    /// Kind of its end.
    pub end: PathEnd,
    /// Flux that it has left there.
    pub flux: f64,
    /// Flux that was absorbed on its way.
    pub absorbed: f64,
    /// Flux that roulette took on its way, less what it added; zero on average.
    pub truncated: f64,
    /// Its interactions with surfaces.
    pub path: EventPath,
    /// Number of scatterings inside the layer.
    pub scatterings: u32,
    /// `true` if [`CameraContribution::Sun`] accounts for sunlight from where it ends: a sun was given, and the path was connected to it
    /// where it was last scattered diffusely.
    pub has_connected_sun: bool,
    /// Polarisation of its light: the Stokes vector over its flux, in the
    /// [`reference_axes`](asperity_optics::reference_axes) of `direction`; unpolarised where that is not tracked.
    pub stokes: Stokes,
    /// Unit direction of its last stretch, in the world.
    pub direction: DVec3,
    /// Start of that last stretch, in the coordinates of the upper surface's tile, continued beyond it without end.
    pub origin: DVec3,
}

/// Contribution of a camera ray along its paths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CameraContribution {
    /// The end of a path.
    Path(PathResult),
    /// Sunlight that is scattered diffusely into a path.
    Sun(SunContribution),
}

/// Light from one direction of a sun that is scattered into a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunContribution {
    /// Factor of the radiance from that direction, times the solid angle of the sun: 1/sr.
    pub fraction: f64,
    /// Point where the light comes to the surface, in the coordinates of the upper surface's tile, continued beyond it.
    pub origin: DVec3,
    /// Unit direction towards the light, in the world.
    pub towards: DVec3,
}

/// Kinds of ends of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// The path left above.
    Above,
    /// The path left below.
    Below,
    /// Nothing is left of it.
    Absorbed,
    /// The path had too many interactions, or its flux was taken by roulette.
    Truncated,
    /// The path left an open patch sideways.
    LeftPatch,
    /// The path failed numerically.
    Lost,
}
