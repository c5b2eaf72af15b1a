//! Hooks: what happens at the interactions of a path besides its scattering; nothing unless stated.

use glam::DVec3;
use rand::Rng;

use super::facet::Scattered;
use super::state::PathState;
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};

pub(super) trait Hooks<G: Geometry> {
    /// Called with the position of each interaction.
    fn visit(&mut self, _position: DVec3) {}

    /// Called before a path is scattered at an interface of normal `m`; may take a branch away.
    fn at_interface<R: Rng>(
        &mut self,
        _interface: Interface,
        _path: &PathState,
        _m: DVec3,
        _scattered: &mut Scattered,
        _rng: &mut R,
    ) {
    }

    /// Called before a path is scattered by the medium of a layer.
    fn in_medium<R: Rng>(&mut self, _layer: &TracedLayer<'_, G>, _path: &PathState, _rng: &mut R) {}

    /// Flux below which roulette decides, which is `setting` unless another one suits the path better.
    fn roulette_below(&self, _path: &PathState, setting: f64) -> f64 {
        setting
    }
}

/// Tells a function of the positions of all interactions.
pub(super) struct Visit<'f, F>(pub(super) &'f mut F);

impl<G: Geometry, F: FnMut(DVec3)> Hooks<G> for Visit<'_, F> {
    fn visit(&mut self, position: DVec3) {
        (self.0)(position);
    }
}
