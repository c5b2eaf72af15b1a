//! Shadowing and masking: tallies, for the control variate, light that is shadowed before its first facet or masked behind it.

use asperity_tally::Event;

use crate::geometry::Geometry;
use crate::interaction::facet::{Incident, scatter};
use crate::interaction::polarised::AveragedLight;
use crate::path::state::batch::Batch;
use crate::path::state::path_state::{Arrival, Departure, PathRay, PathState, RayKind};
use crate::path::tracer::Tracer;
use crate::random::{PathStream, Use};

impl<G: Geometry> Tracer<'_, G> {
    /// Continues the straight lines of incident light behind the first facets of this round, each with the probability
    /// that the control variate sets.
    pub(crate) fn trace_behind_first_facets(&self, batch: &mut Batch<'_, G::Facet>) {
        let Some(control) = batch.tallies.control_variate() else {
            return;
        };
        let probability = control.shadow_probability();
        for i in 0..batch.arrivals.len() {
            if batch.arrivals.at.order[i] > 0 {
                continue;
            }
            let (at, state) = self.arrival(i, batch);
            let [u, _] = batch.stream.pair(state.ray, state.step(), Use::Shadow);
            if u >= probability {
                continue;
            }
            let ray = PathRay {
                region: at.region.behind(),
                heading: at.heading,
                state: PathState {
                    flux: state.flux / probability,
                    ..state
                },
            };
            self.trace(ray, RayKind::BehindFirstFacet, batch);
        }
    }

    /// Tallies that light is masked on its way from its first facet.
    #[inline(always)]
    pub(crate) fn tally_masked(&self, departure: &Departure, batch: &mut Batch<'_, G::Facet>) {
        if departure.state.events.order() == 1 && batch.tallies.control_variate().is_some() {
            let exit = self.exit(departure);
            let number = batch.number_of(&departure.state);
            batch.exits.push_masked(&exit, number);
        }
    }

    /// Tallies that a facet that faces the light is shadowed.
    #[inline(never)]
    pub(crate) fn tally_shadowed(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        if batch.tallies.control_variate().is_none() {
            return;
        }
        let half_space = at.region.half_space;
        let m = half_space.sign() * self.geometry.normal_at(at.facet, at.heading.origin);
        let light = Incident::averaged(half_space == self.incident, -at.heading.direction, m);
        let scattered = scatter::<AveragedLight, 0>(self.material, &light);
        if let Some(conductors) = &mut batch.conductors {
            let slot = conductors.begin_shadowed(state, light.cos_theta_i());
            let exit = self.exit(&Departure {
                region: at.region,
                direction: at.heading.to_world(scattered.reflected.direction),
                state: PathState {
                    events: state.events.then(Event::Reflection),
                    ..*state
                },
            });
            return batch.exits.push_masked(&exit, slot);
        }
        for (event, out) in scattered.branches() {
            if out.passed.fraction > 0.0 {
                let exit = self.exit(&Departure {
                    region: match event {
                        Event::Reflection => at.region,
                        Event::Transmission => at.region.behind(),
                    },
                    direction: at.heading.to_world(out.direction),
                    state: PathState {
                        flux: state.flux * out.passed.fraction,
                        events: state.events.then(event),
                        ..*state
                    },
                });
                batch
                    .exits
                    .push_masked(&exit, PathStream::batch_of(state.ray));
            }
        }
        batch
            .tally_of(state.ray)
            .add_shadowed_absorbed(state.flux * scattered.absorbed);
    }
}
