//! Bottom: what the bottom of a layer does with light that has come to it.

use asperity_optics::{Bottom, Material, incidence_axis, reflect};
use asperity_tally::{Event, Loss};
use glam::DVec3;
use rand::{Rng, RngExt};

use super::Tracer;
use super::batch::Batch;
use super::diffuse::diffuse_direction;
use super::flight::below_the_bottom;
use super::light_state::LightState;
use super::roulette::Roulette;
use super::state::{Arrival, PathState, RayKind};
use crate::geometry::Geometry;
use crate::interaction::facet::{Branch, Scattered, scatter};
use crate::interaction::layer::{Interface, TracedLayer};
use crate::interaction::polarised::Passage;
use crate::periodic::Heading;
use crate::random::Use;
use crate::ray::HalfSpace;
use crate::settings::{Branching, Polarisation};

/// A place of a bottom, and the light that has come to it.
struct AtBottom<'s> {
    bottom: Bottom,
    half_space: HalfSpace,
    heading: Heading,
    /// Normal on the side of the light.
    m: DVec3,
    state: &'s PathState,
}

impl<G: Geometry> Tracer<'_, G> {
    /// Reflects, transmits or absorbs light at a facet of the layer's bottom.
    pub(super) fn interact_at_bottom(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let (Some(bottom), Some(geometry)) = (
            self.layer.as_ref().and_then(TracedLayer::bottom),
            self.geometry_of(Interface::Bottom),
        ) else {
            return;
        };
        if self.is_truncated(state, batch) {
            return;
        }
        let half_space = at.region.half_space;
        let place = AtBottom {
            bottom,
            half_space,
            heading: at.heading,
            m: half_space.sign() * geometry.normal_at(at.facet, at.heading.origin),
            state,
        };
        for (branch, state) in self.branches_at_bottom(&place, batch) {
            let ray = at.leave(&branch, 1.0, &state);
            self.trace(ray, RayKind::Path, batch);
        }
    }

    /// The same at a flat bottom.
    pub(super) fn interact_at_flat_bottom(
        &self,
        mut heading: Heading,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let Some(bottom) = self.layer.as_ref().and_then(TracedLayer::bottom) else {
            return;
        };
        if bottom == Bottom::Open {
            let departure = below_the_bottom(&heading, *state);
            self.push_exit(&departure, batch);
            return;
        }
        if self.is_truncated(state, batch) {
            return;
        }
        let place = AtBottom {
            bottom,
            half_space: HalfSpace::Above,
            heading,
            m: DVec3::Z,
            state,
        };
        for (branch, state) in self.branches_at_bottom(&place, batch) {
            let state = state.after(&branch, 1.0);
            heading.direction = branch.direction;
            match branch.event {
                Event::Reflection => batch.entering.push(&heading, HalfSpace::Below, &state),
                Event::Transmission => {
                    let departure = below_the_bottom(&heading, state);
                    self.push_exit(&departure, batch);
                }
            }
        }
    }

    /// The branches that go on from a bottom, each with the flux and the light that it carries: see [`Roulette`].
    fn branches_at_bottom(
        &self,
        place: &AtBottom<'_>,
        batch: &mut Batch<'_, G::Facet>,
    ) -> impl Iterator<Item = (Branch, PathState)> + use<G> {
        let state = *place.state;
        let mut diffuse = batch.stream.draws(state.ray, state.step(), Use::Diffuse);
        let mut scattered = scatter_at_bottom(place, &mut diffuse);
        let lights = self.polarise_at_bottom(place, &mut scattered);
        let fluxes = self.fluxes_at_bottom(place, &scattered, batch);
        let leave = |b: usize| {
            let state = PathState {
                flux: fluxes[b],
                light: lights[b],
                ..state
            };
            (scattered.branches[b], state)
        };
        [leave(0), leave(1)]
            .into_iter()
            .filter(|(_, state)| state.flux > 0.0)
    }

    /// Whether a path has reached the highest order, and is ended.
    fn is_truncated(&self, state: &PathState, batch: &mut Batch<'_, G::Facet>) -> bool {
        let is_last = state.events.order() >= self.settings.max_order;
        if is_last {
            batch.add_loss(state, Loss::Truncated, state.flux);
        }
        is_last
    }

    /// The flux of each branch after one was picked, where one is, and after roulette.
    fn fluxes_at_bottom(
        &self,
        place: &AtBottom<'_>,
        scattered: &Scattered,
        batch: &mut Batch<'_, G::Facet>,
    ) -> [f64; 2] {
        let state = place.state;
        batch.add_loss(state, Loss::Absorbed, state.flux * scattered.absorbed);
        let [transmitted, reflected] = scattered.branches;
        let pair = batch.stream.pair(state.ray, state.step(), Use::Interaction);
        let divides = matches!(place.bottom, Bottom::Interface { .. });
        let (shares, numbers) = if divides && self.settings.branching == Branching::Pick {
            let is_reflected = pair[0] < reflected.fraction;
            let shares = if is_reflected { [0.0, 1.0] } else { [1.0, 0.0] };
            (shares, [pair[1]; 2])
        } else {
            ([transmitted.fraction, reflected.fraction], pair)
        };
        let roulette = Roulette::below(self.settings.roulette_below);
        let tally = batch.tally_of(state.ray);
        let mut survive = |b: usize| roulette.play(state.flux * shares[b], numbers[b], tally);
        [survive(0), survive(1)]
    }

    /// What the branches carry of the light, which changes their fractions at interfaces. A Lambertian bottom
    /// depolarises.
    fn polarise_at_bottom(
        &self,
        place: &AtBottom<'_>,
        scattered: &mut Scattered,
    ) -> [LightState; 2] {
        let polarisation = self.settings.polarisation;
        let light = place.state.light;
        let material = match place.bottom {
            _ if polarisation == Polarisation::Averaged => return [light; 2],
            Bottom::Interface { .. } | Bottom::Mirror => place.material(),
            _ => return [light.depolarised(polarisation); 2],
        };
        let (k, m) = (place.heading.direction, place.m);
        let fresnel = material.polarised_fresnel((-k.dot(m)).clamp(0.0, 1.0));
        let axis = incidence_axis(k, m);
        let handedness = self.handedness(&place.heading);
        let [transmission, reflection] = &mut scattered.branches;
        [
            (transmission, fresnel.transmitted),
            (reflection, fresnel.reflected),
        ]
        .map(|(branch, facet)| {
            let passage = Passage::new([k, branch.direction], axis, facet, handedness);
            let (light, fraction) = light.after(polarisation, &passage);
            branch.fraction = fraction;
            light
        })
    }

    /// Minus one where directions of a heading are mirrored against the world with +z on the incident side.
    pub(super) fn handedness(&self, heading: &Heading) -> f64 {
        let [x, y] = heading.mirrored;
        let incident = self.incident.sign();
        if x == y { incident } else { -incident }
    }
}

impl AtBottom<'_> {
    /// The material of an interface for light from this side; a mirror otherwise.
    fn material(&self) -> Material {
        match self.bottom {
            Bottom::Interface { eta } if self.half_space == HalfSpace::Above => {
                Material::Dielectric { eta }
            }
            Bottom::Interface { eta } => Material::Dielectric { eta: 1.0 / eta },
            _ => Material::Mirror,
        }
    }
}

/// What a bottom does with unpolarised light.
fn scatter_at_bottom<R: Rng>(place: &AtBottom<'_>, rng: &mut R) -> Scattered {
    let (wi, m) = (-place.heading.direction, place.m);
    let reflected = |fraction, direction| {
        let branch = |event, fraction| Branch {
            event,
            direction,
            fraction,
        };
        Scattered {
            branches: [
                branch(Event::Transmission, 0.0),
                branch(Event::Reflection, fraction),
            ],
            absorbed: 1.0 - fraction,
        }
    };
    match place.bottom {
        Bottom::Interface { eta } => {
            let material = Material::Dielectric { eta };
            scatter(material, place.half_space == HalfSpace::Above, wi, m)
        }
        Bottom::Mirror => reflected(1.0, reflect(wi, m)),
        Bottom::Lambertian { reflectance } => {
            let numbers = [rng.random::<f64>(), rng.random::<f64>()];
            reflected(reflectance, diffuse_direction(m, numbers))
        }
        _ => reflected(0.0, DVec3::ZERO),
    }
}
