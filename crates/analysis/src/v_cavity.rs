//! The microfacet model of V-shaped grooves.
//!
//! Every facet is one side of a symmetric groove as long as the surface, whose rim lies in the mean plane; its
//! neighbour alone shadows and masks it.

use glam::DVec3;

/// Share of a facet `m` that `w` sees, in a groove whose other side is tilted as much the other way:
/// `min(1, 2 cos(theta_m) |cos(theta_w)| / |w . m|)`.
///
/// `w` and `m` are unit vectors, `m.z > 0`. Zero where the facet looks away from `w`; a `w` below the
/// mean plane sees its underside, and counts by its angle from -z.
///
/// # Source
/// Torrance and Sparrow 1967; Blinn 1977; Heitz 2014, Eq. 76.
#[must_use]
pub fn v_cavity_g1(w: DVec3, m: DVec3) -> f64 {
    let facing = if w.z >= 0.0 { w.dot(m) } else { -w.dot(m) };
    if facing <= 0.0 {
        return 0.0;
    }
    (2.0 * m.z * w.z.abs() / facing).min(1.0)
}
