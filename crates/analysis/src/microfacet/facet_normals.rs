//! Facet normals: the density that single scattering needs of a distribution of facets.

use glam::DVec3;

/// A distribution of facet normals.
pub(crate) trait FacetNormals {
    /// Density of facet normals `D(m)` in 1/sr, with the integral of `D cos(theta_m)` equal to one; zero for `m.z <= 0`.
    fn d(&self, m: DVec3) -> f64;

    /// Smith's Lambda of direction `w`, up or down.
    fn lambda(&self, w: DVec3) -> f64;
}
