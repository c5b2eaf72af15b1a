//! Search: finds the facets that the segments in flight hit, and continues the segments that hit none.

use crate::accelerators::SearchedSurface;
use crate::geometry::Geometry;
use crate::interaction::stack::Interface;
use crate::path::state::batch::{Batch, SingleSearch};
use crate::path::state::path_state::{Arrival, Departure, RayKind, Region, SingleSegment};
use crate::path::state::segments::{Gather, Segments};
use crate::path::state::work::Work;
use crate::path::tracer::Tracer;
use crate::periodic::{Traversal, leaves_heights_in_tile};
use crate::ray::Hit;
use crate::vector::Stage;

/// Finds which of the segments that meet nothing in their tile escape: see [`leaves_heights_in_tile`].
pub(crate) struct FindEscapes<'a, G: Geometry> {
    pub(crate) geometry: &'a G,
    pub(crate) segments: &'a Segments,
    pub(crate) which: &'a [u32],
    pub(crate) escape: &'a mut Vec<bool>,
}

impl<G: Geometry> Stage for FindEscapes<'_, G> {
    #[inline(always)]
    fn run(self) {
        self.escape.resize(self.which.len(), false);
        let rays = self.segments.rays(self.geometry.aspect());
        for (escape, &i) in self.escape.iter_mut().zip(self.which) {
            *escape = leaves_heights_in_tile(self.geometry, &rays.query(i as usize));
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Searches all segments in flight, and continues each: at the facet that it meets, in the next tile, or into
    /// the tally.
    pub(crate) fn search(&self, batch: &mut Batch<'_, G::Facet>) {
        self.search_segments(batch);
        if !batch.visibility_rays.need_no_search() {
            self.search_visibility_rays(batch);
        }
        if !batch.singles.is_empty() {
            self.search_singles(batch);
        }
    }

    /// Searches the paths in their first tile.
    fn search_segments(&self, batch: &mut Batch<'_, G::Facet>) {
        let rays = batch.segments.rays(self.geometry.aspect());
        let (searched, hits) = (&batch.searched, &mut batch.hits);
        self.accelerator
            .closest_hits(self.geometry, rays, searched, hits);
        let cancels = batch.tallies.control_variate().is_some();
        let searched = std::mem::take(&mut batch.searched);
        batch.met.clear();
        batch.elsewhere.clear();
        for (&i, hit) in searched.iter().zip(&batch.hits) {
            match *hit {
                Some(Hit { t, facet }) => {
                    batch.met.push(i);
                    batch.arrivals.facets.push(facet);
                    batch.arrivals.ts.push(t);
                }
                None => batch.elsewhere.push(i),
            }
        }
        batch.work.segments += batch.met.len() as u64;
        if cancels {
            for k in 0..batch.met.len() {
                let i = batch.met[k] as usize;
                if batch.segments.order[i] == 1 {
                    self.tally_masked(&self.departure(batch, i), batch);
                }
            }
        }
        batch.instructions.run(Gather {
            from: &batch.segments,
            which: &batch.met,
            into: &mut batch.arrivals.at,
        });
        batch.searched = searched;
        batch.searched.clear();
        self.leave_first_tile(batch);
    }

    /// A segment of the columns, as it would leave its region.
    pub(crate) fn departure(&self, batch: &Batch<'_, G::Facet>, i: usize) -> Departure {
        Departure {
            region: Region::top(batch.segments.half_space(i)),
            direction: batch.segments.heading(i).world_direction(),
            state: batch.segments.state(i),
        }
    }

    /// Continues the segments that have met nothing in their first tile.
    fn leave_first_tile(&self, batch: &mut Batch<'_, G::Facet>) {
        batch.instructions.run(FindEscapes {
            geometry: self.geometry,
            segments: &batch.segments,
            which: &batch.elsewhere,
            escape: &mut batch.escape,
        });
        let gone = std::mem::take(&mut batch.elsewhere);
        for (k, &i) in gone.iter().enumerate() {
            if batch.escape[k] {
                batch.escaped.push(i);
            } else {
                self.enter_next_tile(i as usize, batch);
            }
        }
        batch.elsewhere = gone;
        batch.work.segments += batch.escaped.len() as u64;
        self.leave(batch, |_| Work::SEARCHED);
    }

    /// Continues a segment in the tile after its first.
    #[inline(never)]
    fn enter_next_tile(&self, i: usize, batch: &mut Batch<'_, G::Facet>) {
        let heading = batch.segments.heading(i);
        let half_space = batch.segments.half_space(i);
        let single = SingleSegment {
            interface: Interface::TOP,
            query: heading.query(self.geometry, half_space),
            traversal: Traversal::begin(&heading),
            state: batch.segments.state(i),
            kind: RayKind::Path,
            flight: f64::INFINITY,
        };
        self.step(self.geometry, single, batch);
    }

    /// Continues a single segment that has met nothing in its current tile.
    pub(crate) fn step(
        &self,
        geometry: &G,
        mut single: SingleSegment<G::Facet>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        match single.traversal.step(geometry, &mut single.query) {
            None => batch.singles.push(single),
            Some(end) => {
                let departure = Departure {
                    region: single.region(),
                    direction: single.traversal.world_direction(),
                    state: single.state,
                };
                self.end(end, &departure, &single.kind, batch);
            }
        }
    }

    /// Searches the segments that are kept one by one, at either interface.
    fn search_singles(&self, batch: &mut Batch<'_, G::Facet>) {
        let SingleSearch {
            mut singles,
            mut rays,
            mut which,
            mut hits,
        } = std::mem::take(&mut batch.single_search);
        std::mem::swap(&mut singles, &mut batch.singles);
        hits.resize(singles.len(), None);
        for interface in std::iter::once(Interface::TOP).chain(self.stack.interfaces()) {
            let Some(SearchedSurface {
                geometry,
                accelerator,
            }) = self.surface(interface)
            else {
                continue;
            };
            rays.clear();
            which.clear();
            for (k, single) in (0..).zip(&singles) {
                // Rows of the other interface stay, not searched, so that numbers are those of the singles.
                rays.push(&single.query);
                if single.interface == interface {
                    which.push(k);
                }
            }
            if which.is_empty() {
                continue;
            }
            accelerator.closest_hits(geometry, rays.columns(), &which, &mut batch.hits);
            for (&k, hit) in which.iter().zip(&batch.hits) {
                hits[k as usize] = *hit;
            }
        }
        for (single, hit) in singles.drain(..).zip(hits.drain(..)) {
            self.advance(single, hit, batch);
        }
        batch.single_search = SingleSearch {
            singles,
            rays,
            which,
            hits,
        };
    }

    /// Continues a single segment after the search in its current tile.
    fn advance(
        &self,
        single: SingleSegment<G::Facet>,
        hit: Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let region = single.region();
        let Some(SearchedSurface { geometry, .. }) = self.surface(region.interface) else {
            return;
        };
        if let Some(layer) = self.stack.layer_at(region.interface, region.half_space) {
            return self.advance_inside(layer, geometry, single, hit, batch);
        }
        match hit {
            None => self.step(geometry, single, batch),
            Some(hit) => {
                batch.work.segments += 1;
                let at = Arrival {
                    region,
                    heading: single.traversal.arrival(geometry, &single.query, &hit),
                    facet: hit.facet,
                };
                self.meet(&single, at, batch);
            }
        }
    }
}
