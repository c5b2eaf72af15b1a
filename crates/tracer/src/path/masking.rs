//! Shadowing and masking: visibility rays towards the light, and what the control variate needs to know of light
//! that is shadowed before its first facet or masked behind it.

use rand::{Rng, RngExt};

use asperity_tally::Loss;

use super::Tracer;
use super::batch::Batch;
use super::state::{Arrival, Departure, PathRay, PathSegment, PathState, RayKind};
use crate::geometry::Geometry;
use crate::interaction::layer::Interface;
use crate::periodic::{Heading, Traversal, TraversalEnd, begin};

impl<G: Geometry> Tracer<'_, G> {
    /// Traces a visibility ray from a facet towards the light.
    #[inline(never)]
    pub(super) fn trace_visibility<R: Rng>(
        &self,
        at: Arrival<G::Facet>,
        state: PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let mut towards_light = Heading {
            direction: -at.heading.direction,
            ..at.heading
        };
        // Most facets see the light without a search, and need not be kept.
        match begin(self.geometry, &mut towards_light, self.incident) {
            Some(end) => {
                batch.work.count(end);
                self.end_visibility(end, &state, &at, batch);
            }
            None => {
                let query = towards_light.query(self.geometry, self.incident);
                let segment = PathSegment {
                    traversal: Traversal::begin(&towards_light),
                    state,
                    kind: RayKind::Visibility(Box::new(at)),
                    flight: f64::INFINITY,
                };
                self.push(Interface::Top, segment, query, batch);
            }
        }
    }

    /// Lets a path start at a facet from which the visibility ray has met nothing.
    pub(super) fn end_visibility<R: Rng>(
        &self,
        end: TraversalEnd,
        state: &PathState,
        at: &Arrival<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        match end {
            TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_) => {
                self.interact_at_surface(at, state, batch);
            }
            TraversalEnd::LeftPatch | TraversalEnd::Lost => {
                self.tally_shadowed(at, state, batch);
                batch.tally.add_loss(Loss::Lost, state.flux);
            }
        }
    }

    /// Continues the straight line of incident light behind the first facet that it has met, with the probability
    /// that the control variate sets.
    #[inline(never)]
    pub(super) fn trace_behind_first_facet<R: Rng>(
        &self,
        at: Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let Some(control_variate) = batch.tally.control_variate() else {
            return;
        };
        let probability = control_variate.shadow_probability();
        let is_first = state.events.order() == 0;
        if !is_first || probability < 1.0 && batch.rng.random::<f64>() >= probability {
            return;
        }
        let ray = PathRay {
            region: at.region.behind(),
            heading: at.heading,
            state: PathState {
                flux: state.flux / probability,
                ..*state
            },
        };
        self.trace(ray, RayKind::BehindFirstFacet, batch);
    }

    /// Tallies that light is masked on its way from its first facet.
    #[inline(always)]
    pub(super) fn tally_masked<R>(
        &self,
        departure: &Departure,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if departure.state.events.order() == 1 && batch.tally.control_variate().is_some() {
            let exit = self.exit(departure);
            batch.tally.add_masked(&exit);
        }
    }

    /// Tallies that a facet that faces the light is shadowed.
    #[inline(never)]
    pub(super) fn tally_shadowed<R>(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if batch.tally.control_variate().is_none() {
            return;
        }
        let scattered = self.scattered(at);
        for branch in scattered.branches {
            if branch.fraction > 0.0 {
                let ray = at.leave(&branch, branch.fraction, state);
                let exit = self.exit(&Departure {
                    region: ray.region,
                    direction: ray.heading.world_direction(),
                    state: ray.state,
                });
                batch.tally.add_masked(&exit);
            }
        }
        batch
            .tally
            .add_shadowed_absorbed(state.flux * scattered.absorbed);
    }
}
