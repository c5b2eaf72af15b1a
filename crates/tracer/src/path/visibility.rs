//! Visibility: lines of sight from points of the surface towards the light, which tell where paths start that begin
//! on the surface.

use super::Tracer;
use super::batch::Batch;
use super::escape::{FindOutlooks, sort_by_outlook};
use super::search::FindEscapes;
use super::sightlines::TakeLit;
use super::state::{Arrival, PathState, RayKind, SingleSegment};
use crate::geometry::Geometry;
use crate::interaction::layer::Interface;
use crate::periodic::{Heading, Traversal};

impl<G: Geometry> Tracer<'_, G> {
    /// Starts the paths whose lines of sight need no search, and has the others searched.
    pub(super) fn begin_sightlines(&self, batch: &mut Batch<'_, G::Facet>) {
        let mut lines = std::mem::take(&mut batch.sightlines);
        batch.instructions.run(FindOutlooks {
            geometry: self.geometry,
            segments: &lines.from.at,
            outlooks: &mut lines.outlooks,
        });
        // Those that face away from the light carry no flux.
        sort_by_outlook(
            &lines.outlooks,
            &lines.from.at.flux,
            [&mut lines.searched, &mut lines.lit, &mut batch.elsewhere],
            &mut batch.work,
        );
        batch.instructions.run(TakeLit {
            lines: &lines,
            arrivals: &mut batch.arrivals,
        });
        for k in 0..batch.elsewhere.len() {
            let (at, state) = lines.arrival(batch.elsewhere[k] as usize);
            self.trace_visibility(at, state, batch);
        }
        if lines.need_no_search() {
            lines.clear();
        }
        batch.sightlines = lines;
    }

    /// Searches lines of sight in their first tile: what is shadowed is tallied, and the other paths start.
    pub(super) fn search_sightlines(&self, batch: &mut Batch<'_, G::Facet>) {
        let mut lines = std::mem::take(&mut batch.sightlines);
        let rays = lines.from.at.rays(self.geometry.aspect());
        self.accelerator
            .closest_hits(self.geometry, rays, &lines.searched, &mut batch.hits);
        batch.elsewhere.clear();
        for (k, &i) in lines.searched.iter().enumerate() {
            if batch.hits[k].is_some() {
                let (at, state) = lines.arrival(i as usize);
                batch.work.segments += 1;
                self.tally_shadowed(&at, &state, batch);
            } else {
                batch.elsewhere.push(i);
            }
        }
        batch.instructions.run(FindEscapes {
            geometry: self.geometry,
            segments: &lines.from.at,
            which: &batch.elsewhere,
            escape: &mut batch.escape,
        });
        lines.lit.clear();
        for k in 0..batch.elsewhere.len() {
            let i = batch.elsewhere[k];
            if batch.escape[k] {
                lines.lit.push(i);
            } else {
                let i = i as usize;
                let (at, state) = lines.arrival(i);
                self.follow_sightline(&lines.from.at.heading(i), at, state, batch);
            }
        }
        batch.work.segments += lines.lit.len() as u64;
        batch.instructions.run(TakeLit {
            lines: &lines,
            arrivals: &mut batch.arrivals,
        });
        lines.clear();
        batch.sightlines = lines;
    }

    /// Continues a line of sight in the tile after its first.
    fn follow_sightline(
        &self,
        towards_light: &Heading,
        at: Arrival<G::Facet>,
        state: PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let single = SingleSegment {
            interface: Interface::Top,
            query: towards_light.query(self.geometry, self.incident),
            traversal: Traversal::begin(towards_light),
            state,
            kind: RayKind::Visibility(Box::new(at)),
            flight: f64::INFINITY,
        };
        self.step(self.geometry, single, batch);
    }
}
