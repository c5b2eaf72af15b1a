//! Camera paths: split where the surface divides their light, and connected to a sun.

use glam::DVec3;
use rand::Rng;

use super::PathIntegrator;
use super::facet::Scattered;
use super::hooks::Hooks;
use super::result::{CameraContribution, PathEnd, PathResult};
use super::state::{PathState, Space};
use super::sunlight::Sunlight;
use crate::geometry::Geometry;
use crate::interaction::stack::{Interface, TracedLayer};

/// Flux of the weaker branch below which only one of both is followed, picked by its flux.
const MIN_SPLIT: f64 = 1e-3;

impl<G: Geometry> PathIntegrator<'_, G> {
    /// Traces a camera ray: a path from above as in [`PathIntegrator::trace`], but where the surface divides the
    /// light both branches are followed, each with its fraction of the flux, unless one is very weak. There are as many ends
    /// as there are branches.
    ///
    /// With `sunlight` it also tells of sunlight that is scattered into the path by a Lambertian facet or bottom, or by the medium of the first
    /// layer.
    ///
    /// Light counts as unpolarised at every interface, whatever the settings say: a path that begins at the eye does not know the
    /// polarisation of the light that comes along it.
    pub fn trace_camera_ray<R: Rng>(
        &self,
        origin: DVec3,
        direction: DVec3,
        sunlight: Option<&Sunlight<'_, G>>,
        rng: &mut R,
        contribute: impl FnMut(CameraContribution),
    ) {
        let mut branches = Branches {
            integrator: self,
            sunlight,
            waiting: vec![PathState::new(origin, direction, None)],
            contribute,
        };
        while let Some(mut path) = branches.waiting.pop() {
            let end = self.follow(&mut path, rng, &mut branches);
            let is_connected = sunlight.is_some_and(|sunlight| sunlight.is_connected(&path));
            (branches.contribute)(CameraContribution::Path(PathResult {
                has_connected_sun: end == PathEnd::Above && is_connected,
                ..path.ended(end)
            }));
        }
    }
}

/// The branches of a camera path that are still to be followed.
struct Branches<'a, 'g, G: Geometry, C> {
    integrator: &'a PathIntegrator<'g, G>,
    sunlight: Option<&'a Sunlight<'a, G>>,
    waiting: Vec<PathState>,
    contribute: C,
}

impl<G: Geometry, C: FnMut(CameraContribution)> Hooks<G> for Branches<'_, '_, G, C> {
    fn at_interface<R: Rng>(
        &mut self,
        interface: Interface,
        path: &PathState,
        m: DVec3,
        scattered: &mut Scattered,
        rng: &mut R,
    ) {
        // Connect a diffuse face to the sun
        if scattered.is_diffuse {
            if let Some(sunlight) = self.sunlight {
                let [_, reflection] = &scattered.branches;
                let face = (interface, m, reflection.fraction);
                self.integrator
                    .add_sun_at_face(face, path, sunlight, rng, &mut self.contribute);
            }
            return;
        }

        // Leave the weaker branch for later
        let [transmission, reflection] = &mut scattered.branches;
        let weaker = match transmission.fraction < reflection.fraction {
            true => transmission,
            false => reflection,
        };
        if path.flux * weaker.fraction >= MIN_SPLIT {
            let mut later = *path;
            later.flux *= weaker.fraction;
            (later.absorbed, later.truncated) = (0.0, 0.0);
            later.leave_interface(interface, weaker, false);
            self.waiting.push(later);
            weaker.fraction = 0.0;
        }
    }

    fn in_medium<R: Rng>(&mut self, layer: &TracedLayer<'_, G>, path: &PathState, rng: &mut R) {
        if let Some(sunlight) = self.sunlight {
            self.integrator
                .add_sun_in_medium(layer, path, sunlight, rng, &mut self.contribute);
        }
    }

    /// Paths between smooth faces end soon, and may see a bright sun.
    fn roulette_below(&self, path: &PathState, setting: f64) -> f64 {
        match path.space == Space::ABOVE && path.events_since != Some(0) {
            true => MIN_SPLIT,
            false => setting,
        }
    }
}
