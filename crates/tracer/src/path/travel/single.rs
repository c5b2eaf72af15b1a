//! Single rays: begin, hit and end of rays that are traced one by one.

use asperity_tally::Loss;

use crate::accelerators::SearchedSurface;
use crate::geometry::Geometry;
use crate::interaction::stack::Interface;
use crate::path::state::batch::Batch;
use crate::path::state::path_state::{
    Arrival, Departure, PathRay, PathState, RayKind, SingleSegment,
};
use crate::path::state::work::Work;
use crate::path::tracer::Tracer;
use crate::periodic::{Traversal, TraversalEnd, begin};
use crate::ray::HalfSpace;

impl<G: Geometry> Tracer<'_, G> {
    /// Begins to trace a ray. It ends at once if bounds exclude a hit, and is searched in the next round otherwise. A ray into the
    /// layer waits for its free flight.
    pub(crate) fn trace(
        &self,
        mut ray: PathRay,
        kind: RayKind<G::Facet>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let region = ray.region;
        if let Some(layer) = self.stack.layer_at(region.interface, region.half_space) {
            let heading = self.stack.to_uppermost(region.interface, ray.heading);
            let entering = &mut batch.layers[layer.number()].entering;
            entering.push(&heading, HalfSpace::Below, &ray.state);
            return;
        }
        let departure = |ray: &PathRay| Departure {
            region,
            direction: ray.heading.world_direction(),
            state: ray.state,
        };
        let Some(SearchedSurface { geometry, .. }) = self.surface(region.interface) else {
            // Nothing lies below the last bottom if it is flat.
            return self.push_exit(&departure(&ray), batch);
        };
        if let Some(end) = begin(geometry, &mut ray.heading, region.half_space) {
            self.end(end, &departure(&ray), &kind, batch);
        } else if matches!(kind, RayKind::Path) && region.interface == Interface::TOP {
            let segments = &mut batch.segments;
            segments.make_room(segments.len + 1);
            batch.searched.push(segments.len as u32);
            segments.push(&ray.heading, region.half_space, &ray.state);
        } else {
            batch.singles.push(SingleSegment {
                interface: region.interface,
                query: ray.heading.query(geometry, region.half_space),
                traversal: Traversal::begin(&ray.heading),
                state: ray.state,
                kind,
                flight: f64::INFINITY,
            });
        }
    }

    /// Takes a path to the facet at which it has arrived, to interact there with all others of the round.
    pub(crate) fn arrive(
        &self,
        at: &Arrival<G::Facet>,
        state: &PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let interface = at.region.interface;
        match self.stack.surface(interface) {
            Some(SearchedSurface { geometry, .. }) => {
                let normal = geometry.normal_at(at.facet, at.heading.origin);
                let half_space = at.region.half_space;
                let above = &mut batch.layers[interface.number() - 1];
                above.at_bottom.push(&at.heading, half_space, normal, state);
            }
            None => batch.arrivals.push(at, state),
        }
    }

    /// Continues a single segment at the facet that it has hit, by the kind of its ray.
    pub(crate) fn meet(
        &self,
        single: &SingleSegment<G::Facet>,
        at: Arrival<G::Facet>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let state = &single.state;
        match &single.kind {
            RayKind::Path => {
                let departure = Departure {
                    region: at.region,
                    direction: single.traversal.world_direction(),
                    state: *state,
                };
                self.tally_masked(&departure, batch);
                self.arrive(&at, state, batch);
            }
            RayKind::Visibility(lit) => self.tally_shadowed(lit, state, batch),
            RayKind::BehindFirstFacet => {
                if at.region.half_space == self.incident {
                    self.tally_shadowed(&at, state, batch);
                }
                let ray = PathRay {
                    region: at.region.behind(),
                    heading: at.heading,
                    state: *state,
                };
                self.trace(ray, RayKind::BehindFirstFacet, batch);
            }
        }
    }

    /// Ends a ray that does not hit the surface: a path escapes into the tally or is lost, and a path starts at the facet of a
    /// visibility ray.
    pub(crate) fn end(
        &self,
        end: TraversalEnd,
        departure: &Departure,
        kind: &RayKind<G::Facet>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let mut counted = Work::default();
        counted.count(end);
        batch.work += counted;
        let state = &departure.state;
        match (kind, end) {
            (RayKind::BehindFirstFacet, _) => {}
            (RayKind::Visibility(at), _) => self.end_visibility(end, state, at, batch),
            (RayKind::Path, TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_)) => {
                self.push_exit(departure, batch);
            }
            (RayKind::Path, TraversalEnd::LeftPatch) => {
                batch.add_loss(state, Loss::LeftPatch, state.flux);
                self.tally_masked(departure, batch);
            }
            (RayKind::Path, TraversalEnd::Lost) => {
                batch.add_loss(state, Loss::Lost, state.flux);
                self.tally_masked(departure, batch);
            }
        }
        if matches!(kind, RayKind::Path) {
            batch.end_path(state, counted);
        }
    }
}
