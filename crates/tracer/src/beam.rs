//! Collimated light on its way to a surface: where its rays start.

use std::f64::consts::TAU;

use asperity_optics::Incidence;
use asperity_surface::Border;
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

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
    /// Whether each ray comes from an azimuth of its own.
    any_azimuth: bool,
    /// Strata along either side of the period.
    strata: u32,
    /// Period of the surface along x and y, tile coordinates.
    period: [f64; 2],
    aspect: f64,
    /// z of all starts.
    z: f64,
    /// Distance along a ray from there to the mean plane.
    to_mean_plane: f64,
}

impl Beam {
    pub(crate) fn new<G: Geometry>(
        surface: &G,
        incident: Medium,
        incidence: Incidence,
        any_azimuth: bool,
        strata: u32,
    ) -> Self {
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
            any_azimuth,
            strata,
            period: surface.extent().map(|e| e * tiles),
            aspect: surface.aspect(),
            z,
            to_mean_plane: (z - surface.mean_plane()) / wi.z,
        }
    }

    /// A ray that would meet the mean plane in a random point of the stratum at `[column, row]`, and
    /// the rotation about the vertical, cosine and sine, that turns its azimuth back.
    pub(crate) fn ray<R: Rng>(&self, [column, row]: [u32; 2], rng: &mut R) -> (Heading, DVec2) {
        let width = 1.0 / f64::from(self.strata);
        let u = (f64::from(column) + rng.random::<f64>()) * width;
        let v = (f64::from(row) + rng.random::<f64>()) * width;
        let turned = if self.any_azimuth {
            DVec2::from_angle(TAU * rng.random::<f64>())
        } else {
            DVec2::X
        };
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
