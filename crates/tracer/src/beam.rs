//! Collimated light on its way to a surface: where its rays start.

use std::f64::consts::TAU;

use asperity_optics::Incidence;
use asperity_surface::Border;
use glam::{DVec2, DVec3};

use crate::border::Heading;
use crate::geometry::Geometry;
use crate::ray::Medium;

/// Light that falls evenly on one period of a surface.
///
/// Its rays start where they pass the highest point of the surface (the lowest, if they come from
/// below).
pub(crate) struct Beam {
    /// Unit vector towards the light, as the surface lies.
    wi: DVec3,
    /// Period of the surface along x and y, tile coordinates.
    period: [f64; 2],
    aspect: f64,
    /// z of all starts.
    z: f64,
    /// Distance along a ray from there to the mean plane.
    to_mean_plane: f64,
}

impl Beam {
    pub(crate) fn new<G: Geometry>(surface: &G, incident: Medium, incidence: Incidence) -> Self {
        let wi = incidence.wi() * DVec3::new(1.0, 1.0, incident.sign());
        // A mirrored tile and its images make a period of two tiles along each axis.
        let tiles = match surface.border() {
            Border::Mirrored => 2.0,
            Border::Periodic | Border::Open => 1.0,
        };
        let [low, high] = surface.z_range();
        let z = match incident {
            Medium::Above => high,
            Medium::Below => low,
        };
        Self {
            wi,
            period: surface.extent().map(|e| e * tiles),
            aspect: surface.aspect(),
            z,
            to_mean_plane: (z - surface.mean_plane()) / wi.z,
        }
    }

    /// A ray that would meet the mean plane at `u`, `v`, shares of the period, and comes from the
    /// azimuth of the beam and a share `azimuth` of a full turn; and the rotation about the vertical,
    /// cosine and sine, that turns its azimuth back.
    pub(crate) fn ray(&self, [u, v, azimuth]: [f64; 3]) -> (Heading, DVec2) {
        let turned = DVec2::from_angle(TAU * azimuth);
        let wi = turned.rotate(self.wi.truncate()).extend(self.wi.z);
        let [cx, cy] = self.period;
        let heading = Heading {
            origin: DVec3::new(
                u * cx + self.to_mean_plane * wi.x,
                v * cy + self.to_mean_plane * wi.y * self.aspect,
                self.z,
            ),
            direction: -wi,
            mirrored: [false; 2],
        };
        (heading, DVec2::new(turned.x, -turned.y))
    }
}
