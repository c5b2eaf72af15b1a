//! Traversal: takes path segments from tile to tile until they meet a facet or end.

use asperity_tally::Loss;
use rand::Rng;

use super::Tracer;
use super::batch::Batch;
use super::state::{Arrival, Departure, LayerRay, PathRay, PathSegment, RayKind, Region};
use crate::geometry::Geometry;
use crate::interaction::layer::Interface;
use crate::periodic::{Traversal, TraversalEnd, begin};
use crate::ray::{Hit, Query};

impl<G: Geometry> Tracer<'_, G> {
    /// Begins to trace a ray: it ends at once if it can be told that it meets nothing, and is searched in the next
    /// round otherwise. A ray into the layer waits for its free flight.
    pub(super) fn trace<R: Rng>(
        &self,
        mut ray: PathRay,
        kind: RayKind<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let region = ray.region;
        if let Some(layer) = &self.layer
            && region == Region::inside(region.interface)
        {
            batch.inside.push(LayerRay {
                heading: layer.to_upper_surface(region.interface, ray.heading),
                state: ray.state,
            });
            return;
        }
        let Some(geometry) = self.geometry_of(region.interface) else {
            return;
        };
        if let Some(end) = begin(geometry, &mut ray.heading, region.half_space) {
            let departure = Departure {
                region,
                direction: ray.heading.world_direction(),
                state: ray.state,
            };
            self.end(end, &departure, &kind, batch);
        } else {
            let segment = PathSegment {
                traversal: Traversal::begin(&ray.heading),
                state: ray.state,
                kind,
                flight: f64::INFINITY,
            };
            let query = ray.heading.query(geometry, region.half_space);
            self.push(region.interface, segment, query, batch);
        }
    }

    /// Has a segment searched in the next round.
    #[inline]
    pub(super) fn push<R>(
        &self,
        interface: Interface,
        segment: PathSegment<G::Facet>,
        query: Query,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let is_last = matches!(segment.kind, RayKind::Path)
            && segment.state.events.order() >= self.settings.max_order;
        batch.continuing += usize::from(!is_last);
        let next = &mut batch.next[interface as usize];
        next.segments.push(segment);
        next.queries.push(query);
    }

    /// Continues a segment after the search in its current tile: with what it means that the ray has met a facet,
    /// or in the next tile.
    pub(super) fn advance<R: Rng>(
        &self,
        interface: Interface,
        mut segment: PathSegment<G::Facet>,
        query: &mut Query,
        hit: &Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let region = Region {
            interface,
            half_space: query.half_space,
        };
        if let Some(layer) = &self.layer
            && region == Region::inside(interface)
        {
            return self.advance_inside(layer, interface, segment, query, hit, batch);
        }
        let Some(geometry) = self.geometry_of(interface) else {
            return;
        };
        if let Some(hit) = hit {
            batch.work.segments += 1;
            let at = || Arrival {
                region,
                heading: segment.traversal.arrival(geometry, query, hit),
                facet: hit.facet,
            };
            self.meet(&segment, region, at, batch);
        } else if let Some(end) = segment.traversal.step(geometry, query) {
            let departure = Departure {
                region,
                direction: segment.traversal.world_direction(),
                state: segment.state,
            };
            self.end(end, &departure, &segment.kind, batch);
        } else {
            self.push(interface, segment, *query, batch);
        }
    }

    /// What follows from a facet that a segment has met, by the kind of its ray.
    #[inline(always)]
    fn meet<R: Rng>(
        &self,
        segment: &PathSegment<G::Facet>,
        region: Region,
        at: impl Fn() -> Arrival<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let state = &segment.state;
        match &segment.kind {
            RayKind::Path => {
                let departure = Departure {
                    region,
                    direction: segment.traversal.world_direction(),
                    state: *state,
                };
                self.tally_masked(&departure, batch);
                self.interact(at(), state, batch);
            }
            RayKind::Visibility(lit) => self.tally_shadowed(lit, state, batch),
            RayKind::BehindFirstFacet => {
                let at = at();
                if region.half_space == self.incident {
                    self.tally_shadowed(&at, state, batch);
                }
                let ray = PathRay {
                    region: region.behind(),
                    heading: at.heading,
                    state: *state,
                };
                self.trace(ray, RayKind::BehindFirstFacet, batch);
            }
        }
    }

    /// Ends a ray that does not meet the surface: a path escapes into the tally or is lost, and a visibility ray
    /// tells that its facet is lit.
    pub(super) fn end<R: Rng>(
        &self,
        end: TraversalEnd,
        departure: &Departure,
        kind: &RayKind<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        batch.work.count(end);
        let state = &departure.state;
        match (kind, end) {
            (RayKind::BehindFirstFacet, _) => {}
            (RayKind::Visibility(at), _) => self.end_visibility(end, state, at, batch),
            (RayKind::Path, TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_)) => {
                let exit = self.exit(departure);
                batch.tally.add_exit(&exit);
            }
            (RayKind::Path, TraversalEnd::LeftPatch) => {
                batch.tally.add_loss(Loss::LeftPatch, state.flux);
                self.tally_masked(departure, batch);
            }
            (RayKind::Path, TraversalEnd::Lost) => {
                batch.tally.add_loss(Loss::Lost, state.flux);
                self.tally_masked(departure, batch);
            }
        }
    }
}
