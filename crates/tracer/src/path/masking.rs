//! Shadowing and masking: visibility rays towards the light, and what the control variate needs to know of light
//! that is shadowed before its first facet or masked behind it.

use asperity_tally::{Event, Loss};

use super::Tracer;
use super::batch::Batch;
use super::sightlines::turned_round;
use super::state::{Arrival, Departure, PathRay, PathState, RayKind, SingleSegment};
use crate::geometry::Geometry;
use crate::interaction::facet::{Incident, scatter};
use crate::interaction::layer::Interface;
use crate::interaction::polarised::AveragedLight;
use crate::periodic::{Traversal, TraversalEnd, begin};
use crate::random::{PathStream, Use};

impl<G: Geometry> Tracer<'_, G> {
    /// Traces a visibility ray from a facet towards the light.
    #[inline(never)]
    pub(super) fn trace_visibility(
        &self,
        at: Arrival<G::Facet>,
        state: PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let mut towards_light = turned_round(&at.heading);
        // Most facets see the light without a search, and need not be kept.
        match begin(self.geometry, &mut towards_light, self.incident) {
            Some(end) => {
                batch.work.count(end);
                self.end_visibility(end, &state, &at, batch);
            }
            None => batch.singles.push(SingleSegment {
                interface: Interface::Top,
                query: towards_light.query(self.geometry, self.incident),
                traversal: Traversal::begin(&towards_light),
                state,
                kind: RayKind::Visibility(Box::new(at)),
                flight: f64::INFINITY,
            }),
        }
    }

    /// Lets a path start at a facet from which the visibility ray has met nothing.
    pub(super) fn end_visibility(
        &self,
        end: TraversalEnd,
        state: &PathState,
        at: &Arrival<G::Facet>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        match end {
            TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_) => {
                batch.arrivals.push(at, state);
            }
            TraversalEnd::LeftPatch | TraversalEnd::Lost => {
                self.tally_shadowed(at, state, batch);
                batch.add_loss(state, Loss::Lost, state.flux);
            }
        }
    }

    /// Continues the straight lines of incident light behind the first facets of this round, each with the probability
    /// that the control variate sets.
    pub(super) fn trace_behind_first_facets(&self, batch: &mut Batch<'_, G::Facet>) {
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
    pub(super) fn tally_masked(&self, departure: &Departure, batch: &mut Batch<'_, G::Facet>) {
        if departure.state.events.order() == 1 && batch.tallies.control_variate().is_some() {
            let exit = self.exit(departure);
            let number = PathStream::batch_of(departure.state.ray);
            batch.exits.push_masked(&exit, number);
        }
    }

    /// Tallies that a facet that faces the light is shadowed.
    #[inline(never)]
    pub(super) fn tally_shadowed(
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
