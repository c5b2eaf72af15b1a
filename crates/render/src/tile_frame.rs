//! Tile frame: conversion between world lengths and tile coordinates.

use asperity_tracer::Geometry;
use glam::{DVec2, DVec3};

/// Converts between world coordinates, z from the mean plane, and tile coordinates.
#[derive(Clone, Copy)]
pub(crate) struct TileFrame {
    unit: f64,
    aspect: f64,
    mean_plane: f64,
    highest: f64,
}

impl TileFrame {
    pub(crate) fn of<G: Geometry>(geometry: &G) -> Self {
        Self {
            unit: geometry.unit(),
            aspect: geometry.aspect(),
            mean_plane: geometry.mean_plane(),
            highest: geometry.z_range()[1],
        }
    }

    /// Height of the highest point.
    pub(crate) fn highest(&self) -> f64 {
        (self.highest - self.mean_plane) * self.unit
    }

    /// Tile coordinates of a point of the world.
    pub(crate) fn in_tile(&self, p: DVec3) -> DVec3 {
        let p = p / self.unit;
        DVec3::new(p.x, p.y * self.aspect, p.z + self.mean_plane)
    }

    /// Point where a straight line meets the mean plane; `origin` in tile coordinates, the rest in the world.
    pub(crate) fn on_mean_plane(&self, origin: DVec3, direction: DVec3) -> DVec2 {
        let back = (origin.z - self.mean_plane) / direction.z;
        let there = DVec2::new(origin.x, origin.y / self.aspect) - back * direction.truncate();
        there * self.unit
    }
}
