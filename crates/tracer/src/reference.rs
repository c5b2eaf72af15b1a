//! Reference: one light path at a time, from interaction to interaction. The place to start reading this crate.
//!
//! [`PathIntegrator::trace`] sends one path, and [`PathIntegrator::follow`] is the whole algorithm on one page: find
//! the next interaction, move the path there, scatter it, and let Russian roulette decide whether it continues.
//! [`crate::Tracer`] traces the same light much faster: it follows many paths together, splits them at interfaces,
//! skips searches, and serves control variates. This module does none of that and shares no step of a path with
//! it, so that tests can hold the two against each other. It also serves cameras: light paths are reversible, so a
//! path may as well begin at the eye.
//!
//! `next_event.rs` finds what a path comes to, `interface.rs` scatters it there, `state.rs` is the path,
//! `result.rs` its end, and `hooks.rs` what else happens at its interactions. `camera.rs` splits the paths of cameras, and
//! `sunlight.rs` connects them to a sun. Polarised light is followed by its
//! electric fields: `fields.rs` has them, `amplitudes.rs` the factors of interfaces, and `facet.rs` divides them between
//! reflection and transmission.

mod amplitudes;
mod camera;
mod event;
mod facet;
mod fields;
mod hooks;
mod interface;
mod next_event;
mod result;
mod state;
mod sunlight;
#[cfg(test)]
mod tests;

use asperity_optics::{Material, Stokes};
use glam::DVec3;
use rand::{Rng, RngExt};

use self::event::NextEvent;
use self::fields::Fields;
use self::hooks::{Hooks, Visit};
use self::state::PathState;
use crate::accelerators::Accelerator;
use crate::geometry::Geometry;
use crate::interaction::stack::TracedStack;
use crate::settings::{PathSettings, Polarisation};

pub use self::event::FlightSearch;
pub use self::result::{CameraContribution, PathEnd, PathResult, SunContribution};
pub use self::sunlight::Sunlight;

/// Follows light that comes from above, one path at a time.
///
/// Takes the roulette threshold, the highest order and the averaging of polarisation from the settings; always picks one
/// branch.
pub struct PathIntegrator<'a, G: Geometry> {
    geometry: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    settings: PathSettings,
    stack: TracedStack<'a, G>,
    search: FlightSearch,
}

impl<'a, G: Geometry> PathIntegrator<'a, G> {
    /// Light from above on a surface.
    #[must_use]
    pub fn new(
        geometry: &'a G,
        accelerator: &'a dyn Accelerator<G>,
        material: Material,
        settings: PathSettings,
    ) -> Self {
        Self {
            geometry,
            accelerator,
            material,
            settings,
            stack: TracedStack::default(),
            search: FlightSearch::Full,
        }
    }

    /// This integrator with layers below the surface.
    ///
    /// # Panics
    /// If there are any, unless the surface is dielectric.
    #[must_use]
    pub fn over(self, stack: TracedStack<'a, G>) -> Self {
        assert!(
            stack.layers().is_empty() || self.material.transmitting_index().is_some(),
            "layers lie below a dielectric"
        );
        Self { stack, ..self }
    }

    /// This integrator with another way to search free flights.
    #[must_use]
    pub fn with_flight_search(self, search: FlightSearch) -> Self {
        Self { search, ..self }
    }

    /// Traces one path of light that comes from above along a straight line.
    ///
    /// `origin`: tile coordinates of the upper surface, above it, possibly over another tile; `direction`: a
    /// unit vector in the world.
    pub fn trace<R: Rng>(&self, origin: DVec3, direction: DVec3, rng: &mut R) -> PathResult {
        self.trace_visiting(origin, direction, rng, &mut |_| {})
    }

    /// Traces the path of [`PathIntegrator::trace`], and tells `visit` of each of its interactions: where it is, in the coordinates of
    /// [`PathResult::origin`].
    pub fn trace_visiting<R: Rng>(
        &self,
        origin: DVec3,
        direction: DVec3,
        rng: &mut R,
        visit: &mut impl FnMut(DVec3),
    ) -> PathResult {
        let is_averaged = self.settings.polarisation == Polarisation::Averaged;
        let fields = (!is_averaged).then(|| Fields::unpolarised(direction));
        self.trace_fields(PathState::new(origin, direction, fields), rng, visit)
    }

    /// Traces one path of incident light of any polarisation. `incident` is its Stokes vector in the
    /// [`reference_axes`](asperity_optics::reference_axes) of `direction`, and its flux counts as one.
    ///
    /// # Panics
    /// If the settings average polarisation, or if there is no light, or more polarised light than light.
    pub fn trace_polarised<R: Rng>(
        &self,
        origin: DVec3,
        direction: DVec3,
        incident: Stokes,
        rng: &mut R,
    ) -> PathResult {
        assert!(
            self.settings.polarisation != Polarisation::Averaged,
            "averaged paths have no polarisation"
        );
        let Stokes([i, q, u, v]) = incident;
        assert!(
            i > 0.0 && q * q + u * u + v * v <= i * i * (1.0 + 1e-9),
            "{incident:?} is no light"
        );
        let fields = Fields::from_stokes(direction, incident);
        let path = PathState::new(origin, direction, Some(fields));
        self.trace_fields(path, rng, &mut |_| {})
    }

    fn trace_fields<R: Rng>(
        &self,
        mut path: PathState,
        rng: &mut R,
        visit: &mut impl FnMut(DVec3),
    ) -> PathResult {
        let end = self.follow(&mut path, rng, &mut Visit(visit));
        path.ended(end)
    }

    /// Follows a path to its end, and calls `hooks` at its interactions.
    fn follow<R: Rng>(
        &self,
        path: &mut PathState,
        rng: &mut R,
        hooks: &mut impl Hooks<G>,
    ) -> PathEnd {
        loop {
            // Find what the path comes to next, and move it there
            match self.next_event(path, rng) {
                NextEvent::End(end) => {
                    if end == PathEnd::Absorbed {
                        path.absorbed += std::mem::take(&mut path.flux);
                    }
                    return end;
                }

                NextEvent::Interface(hit) => {
                    // Absorb along the way through a medium that does not scatter
                    let layer = self.layer_of(path.space);
                    if let Some(left) = layer.and_then(|layer| layer.transmittance(hit.t)) {
                        path.absorbed += path.flux * (1.0 - left);
                        path.flux *= left;
                    }
                    if path.flux == 0.0 {
                        return PathEnd::Absorbed;
                    }
                    if let Some(end) = self.move_to_interface(path, &hit) {
                        return end;
                    }
                    hooks.visit(path.position());

                    // End the path at the highest order
                    if path.events.order() >= self.settings.max_order {
                        return PathEnd::Truncated;
                    }

                    // Compute what the interface reflects, transmits and absorbs
                    let m = self.normal(&hit, path.space);
                    let mut scattered = self.scattered(hit.interface, path, m, rng);
                    hooks.at_interface(hit.interface, path, m, &mut scattered, rng);
                    let [transmission, reflection] = &scattered.branches;
                    let kept = transmission.fraction + reflection.fraction;
                    path.absorbed += path.flux * scattered.absorbed;
                    path.flux *= kept;
                    if path.flux == 0.0 {
                        return PathEnd::Absorbed;
                    }

                    // Sample reflection or transmission by their fractions
                    let is_reflected = rng.random::<f64>() * kept < reflection.fraction;
                    let wo = if is_reflected {
                        reflection
                    } else {
                        transmission
                    };
                    path.leave_interface(hit.interface, wo, scattered.is_diffuse);
                }

                NextEvent::Medium(layer, t) => {
                    if !self.move_inside(path, t) {
                        return PathEnd::LeftPatch;
                    }
                    hooks.visit(path.position());

                    // Absorb by the albedo of the medium
                    let kept = path.flux * layer.albedo();
                    path.absorbed += path.flux - kept;
                    path.flux = kept;
                    if path.flux == 0.0 {
                        return PathEnd::Absorbed;
                    }

                    // End the path at the largest number of scatterings
                    if path.scatterings == layer.max_scatterings() {
                        return PathEnd::Truncated;
                    }
                    path.scatterings += 1;
                    hooks.in_medium(layer, path, rng);

                    // Sample the phase function
                    path.scatter_inside(layer, rng);
                }
            }

            // Possibly terminate the path with Russian roulette
            let threshold = hooks.roulette_below(path, self.settings.roulette_below);
            if path.flux < threshold {
                let survives = rng.random::<f64>() * threshold < path.flux;
                let kept = if survives { threshold } else { 0.0 };
                path.truncated += path.flux - kept;
                path.flux = kept;
                if !survives {
                    return PathEnd::Truncated;
                }
            }
        }
    }
}
