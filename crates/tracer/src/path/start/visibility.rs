//! Visibility: rays from points of the surface towards the light, which decide whether paths start there.

use asperity_tally::Loss;

use crate::geometry::Geometry;
use crate::interaction::stack::Interface;
use crate::path::leave::escape::{FindCullingClasses, sort_by_culling_class};
use crate::path::state::arrivals::Arrivals;
use crate::path::state::batch::Batch;
use crate::path::state::path_state::{Arrival, PathState, RayKind, SingleSegment};
use crate::path::state::segments::Gather;
use crate::path::state::visibility_rays::{VisibilityRays, reversed};
use crate::path::tracer::Tracer;
use crate::path::travel::search::FindEscapes;
use crate::periodic::{Heading, Traversal, TraversalEnd, begin};
use crate::vector::Stage;

/// Starts the paths whose visibility rays are not blocked.
struct StartVisible<'a, F> {
    rays: &'a VisibilityRays<F>,
    arrivals: &'a mut Arrivals<F>,
}

impl<F: Copy> Stage for StartVisible<'_, F> {
    #[inline(always)]
    fn run(self) {
        let VisibilityRays { from, visible, .. } = self.rays;
        let first = self.arrivals.len();
        Gather {
            from: &from.at,
            which: visible,
            into: &mut self.arrivals.at,
        }
        .run();
        let Arrivals { at, facets, ts, .. } = self.arrivals;
        facets.extend(visible.iter().map(|&i| from.facets[i as usize]));
        ts.resize(facets.len(), 0.0);
        // The light comes the other way
        for column in &mut at.direction {
            for d in &mut column[first..at.len] {
                *d = -*d;
            }
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Starts the paths whose visibility rays need no search, and has the others searched.
    pub(crate) fn begin_visibility_rays(&self, batch: &mut Batch<'_, G::Facet>) {
        let mut rays = std::mem::take(&mut batch.visibility_rays);
        batch.instructions.run(FindCullingClasses {
            geometry: self.geometry,
            segments: &rays.from.at,
            classes: &mut rays.classes,
        });
        // Those from facets that face away from the light carry no flux.
        sort_by_culling_class(
            &rays.classes,
            &rays.from.at.flux,
            [&mut rays.searched, &mut rays.visible, &mut batch.elsewhere],
            &mut batch.work,
        );
        batch.instructions.run(StartVisible {
            rays: &rays,
            arrivals: &mut batch.arrivals,
        });
        for k in 0..batch.elsewhere.len() {
            let (at, state) = rays.arrival(batch.elsewhere[k] as usize);
            self.trace_visibility(at, state, batch);
        }
        if rays.need_no_search() {
            rays.clear();
        }
        batch.visibility_rays = rays;
    }

    /// Searches visibility rays in their first tile: shadowed facets are tallied, and the other paths start.
    pub(crate) fn search_visibility_rays(&self, batch: &mut Batch<'_, G::Facet>) {
        let mut rays = std::mem::take(&mut batch.visibility_rays);
        let columns = rays.from.at.rays(self.geometry.aspect());
        self.accelerator
            .closest_hits(self.geometry, columns, &rays.searched, &mut batch.hits);
        batch.elsewhere.clear();
        for (k, &i) in rays.searched.iter().enumerate() {
            if batch.hits[k].is_some() {
                let (at, state) = rays.arrival(i as usize);
                batch.work.segments += 1;
                self.tally_shadowed(&at, &state, batch);
            } else {
                batch.elsewhere.push(i);
            }
        }
        batch.instructions.run(FindEscapes {
            geometry: self.geometry,
            segments: &rays.from.at,
            which: &batch.elsewhere,
            escape: &mut batch.escape,
        });
        rays.visible.clear();
        for k in 0..batch.elsewhere.len() {
            let i = batch.elsewhere[k];
            if batch.escape[k] {
                rays.visible.push(i);
            } else {
                // Continue in the next tile
                let (at, state) = rays.arrival(i as usize);
                let ray = self.visibility_ray(&rays.from.at.heading(i as usize), at, state);
                self.step(self.geometry, ray, batch);
            }
        }
        batch.work.segments += rays.visible.len() as u64;
        batch.instructions.run(StartVisible {
            rays: &rays,
            arrivals: &mut batch.arrivals,
        });
        rays.clear();
        batch.visibility_rays = rays;
    }

    /// Traces a visibility ray from a facet towards the light.
    #[inline(never)]
    fn trace_visibility(
        &self,
        at: Arrival<G::Facet>,
        state: PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let mut towards_light = reversed(&at.heading);
        match begin(self.geometry, &mut towards_light, self.incident) {
            Some(end) => {
                batch.work.count(end);
                self.end_visibility(end, &state, &at, batch);
            }
            None => {
                let ray = self.visibility_ray(&towards_light, at, state);
                batch.singles.push(ray);
            }
        }
    }

    fn visibility_ray(
        &self,
        towards_light: &Heading,
        at: Arrival<G::Facet>,
        state: PathState,
    ) -> SingleSegment<G::Facet> {
        SingleSegment {
            interface: Interface::TOP,
            query: towards_light.query(self.geometry, self.incident),
            traversal: Traversal::begin(towards_light),
            state,
            kind: RayKind::Visibility(Box::new(at)),
            flight: f64::INFINITY,
        }
    }

    /// Lets a path start at a facet from which the visibility ray is not blocked.
    pub(crate) fn end_visibility(
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
}
