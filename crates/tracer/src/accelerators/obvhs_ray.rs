//! Rays of obvhs: conversion, with bounds on the rounding.
//!
//! The hierarchies of obvhs work in f32 and only propose what a ray may meet. So that they never
//! fail to, boxes are widened by more than their rounding errors, and rays are handed over from a
//! point near the tile, set back by more than the distance at which the box test clips.

use glam::{DVec3, Vec3A};
use obvhs::ray::Ray;

use crate::geometry::Geometry;
use crate::ray::TileRay;

/// Distance by which a ray is set back before traversal; the box test of obvhs clips at 1e-4.
const SET_BACK: f64 = 0.01;

/// The sphere around a tile, from which rays are handed over.
#[derive(Clone, Copy, Debug)]
pub(super) struct Handover {
    centre: DVec3,
    radius: f64,
}

/// A ray in f32, and the parameter of the original ray at its origin.
pub(super) struct SingleRay {
    pub(super) ray: Ray,
    start: f64,
}

impl Handover {
    pub(super) fn new<G: Geometry>(geometry: &G) -> Self {
        let [ex, ey] = geometry.extent();
        let [low, high] = geometry.z_range();
        let (lowest, highest) = (DVec3::new(0.0, 0.0, low), DVec3::new(ex, ey, high));
        Self {
            centre: 0.5 * (lowest + highest),
            radius: 0.5 * (highest - lowest).length() + 1.0,
        }
    }

    /// Amount by which boxes must be wider than what they hold.
    ///
    /// Rounding of an origin within twice the tile's extent, of a direction along the tile's
    /// diagonal, and of the box itself is a few 2^-24 of that extent; 2^-20 covers it.
    pub(super) fn margin(&self) -> f32 {
        (2.0 * self.radius * 2_f64.powi(-20)) as f32
    }

    /// The ray in f32 from a point near the tile, or `None` if it passes the tile by.
    pub(super) fn single_precision(&self, ray: &TileRay) -> Option<SingleRay> {
        let to_centre = self.centre - ray.origin;
        let begin = if to_centre.length_squared() < self.radius * self.radius {
            0.0
        } else {
            let per_unit = ray.direction.length();
            let along = to_centre.dot(ray.direction) / (per_unit * per_unit);
            if along + self.radius / per_unit < 0.0 {
                return None;
            }
            (along - self.radius / per_unit).max(0.0)
        };
        let start = begin - SET_BACK;
        // Adding zero turns -0 into +0: obvhs takes the sign of a component from `< 0` in one place
        // and from the sign bit in another.
        let direction = ray.direction.as_vec3a() + Vec3A::ZERO;
        let ray = Ray::new_inf(ray.at(start).as_vec3a(), direction);
        Some(SingleRay { ray, start })
    }
}

impl SingleRay {
    /// Distance for obvhs of a hit at parameter `t`, a little later than it is, so that boxes at
    /// equal distance are still visited.
    pub(super) fn beyond(&self, t: f64) -> f32 {
        ((t - self.start) * (1.0 + 1e-6) + 1e-5) as f32
    }
}
