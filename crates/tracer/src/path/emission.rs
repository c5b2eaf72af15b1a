//! Emission: where the paths of a batch start.

use std::f64::consts::TAU;

use asperity_surface::Border;
use asperity_tally::EventPath;
use glam::{DVec2, DVec3};

use super::Tracer;
use super::batch::{Batch, MAX_IN_FLIGHT};
use super::beam::{Beam, axes_turned};
use super::illumination::Starts;
use super::light_state::LightState;
use super::segments::Segments;
use super::state::{Arrival, PathRay, PathState, RayKind, Region};
use crate::geometry::Geometry;
use crate::sampling::{Places, Start};
use crate::vector::Stage;

/// Adds the parallel rays of a beam to the segments, moved into the tile.
struct Emit<'a> {
    beam: &'a Beam,
    /// Extent of the tile.
    extent: [f64; 2],
    /// Sign of the half space of the light.
    side: f64,
    starts: &'a [Start],
    into: &'a mut Segments,
    light: LightState,
}

impl Stage for Emit<'_> {
    #[inline(always)]
    fn run(self) {
        let rows = self.into.len..self.into.len + self.starts.len();
        self.into.len = rows.end;
        let [x, y, z] = self
            .into
            .origin
            .each_mut()
            .map(|column| &mut column[rows.clone()]);
        let in_tile = |place: f64, size: f64| place - (place / size).floor() * size;
        let [size_x, size_y] = self.extent;
        for (i, start) in self.starts.iter().enumerate() {
            let [u, v, _] = start.place;
            let origin = self.beam.origin([u, v], DVec2::X);
            x[i] = in_tile(origin.x, size_x);
            y[i] = in_tile(origin.y, size_y);
            z[i] = origin.z;
        }
        let direction = self.beam.direction(DVec2::X);
        for axis in 0..3 {
            self.into.direction[axis][rows.clone()].fill(direction[axis]);
        }
        self.into.side[rows.clone()].fill(self.side);
        self.into.flux[rows.clone()].fill(1.0);
        let light = self.light.0;
        for (column, number) in self.into.light.iter_mut().zip(light) {
            column[rows.clone()].fill(number);
        }
        for column in [
            &mut self.into.order,
            &mut self.into.events,
            &mut self.into.scatterings,
            &mut self.into.mirrored,
        ] {
            column[rows.clone()].fill(0);
        }
        for (ray, start) in self.into.ray[rows].iter_mut().zip(self.starts) {
            *ray = start.ray;
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Starts new paths while few are in flight.
    pub(super) fn start_paths(
        &self,
        beam: &Beam,
        starts: Starts,
        places: &mut Places,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let free = MAX_IN_FLIGHT.saturating_sub(self.count_continuing(batch));
        let mut drawn = std::mem::take(&mut batch.starts);
        places.draw_many(free, batch.instructions, &mut drawn);
        // Of parallel rays over a surface that repeats nothing has to be found out
        let are_parallel = starts == Starts::FromAbove
            && !batch.segments.kept.turn
            && self.geometry.border() == Border::Periodic;
        if are_parallel {
            self.emit_parallel(beam, &drawn, batch);
        } else {
            for start in &drawn {
                let [u, v, azimuth] = start.place;
                let turn = if batch.segments.kept.turn {
                    DVec2::from_angle(TAU * azimuth)
                } else {
                    DVec2::X
                };
                self.emit(beam, starts, (start.ray, [u, v]), turn, batch);
                batch.work.rays += 1;
            }
            self.begin_sightlines(batch);
        }
        batch.starts = drawn;
    }

    /// Starts paths at the highest point of a periodic surface, all in the same direction, in its tile.
    fn emit_parallel(&self, beam: &Beam, starts: &[Start], batch: &mut Batch<'_, G::Facet>) {
        let first = batch.segments.len;
        batch.work.rays += starts.len() as u64;
        batch.segments.make_room(first + starts.len());
        batch.instructions.run(Emit {
            beam,
            extent: self.geometry.extent(),
            side: self.incident.sign(),
            starts,
            into: &mut batch.segments,
            light: LightState::incident(self.settings.polarisation, batch.stokes),
        });
        batch
            .searched
            .extend(first as u32..batch.segments.len as u32);
    }

    /// How light from an azimuth turned by `turn` is polarised, in the axes of its ray. Those of vertical rays do not turn
    /// with the azimuth, so the light does.
    fn incident_light(&self, beam: &Beam, turn: DVec2, stokes: [f64; 3]) -> LightState {
        let polarisation = self.settings.polarisation;
        let light = LightState::incident(polarisation, stokes);
        if turn == DVec2::X || !beam.is_vertical() {
            return light;
        }
        light.turned(polarisation, axes_turned(DVec3::NEG_Z, turn).inverse())
    }

    /// How many of the segments in flight may be followed by another one.
    ///
    /// Segments that are the last of their paths do not count, so that when a path starts does not depend on whether
    /// they are traced; see [`Tracer::ends_unrecorded`].
    fn count_continuing(&self, batch: &Batch<'_, G::Facet>) -> usize {
        let max_order = self.settings.max_order;
        let order = &batch.segments.order;
        let continues = |i: &&u32| order[**i as usize] < max_order;
        let singles = batch.singles.iter().filter(|single| {
            !matches!(single.kind, RayKind::Path) || single.state.events.order() < max_order
        });
        let inside = batch.flights.at.len + batch.entering.len;
        batch.searched.iter().filter(continues).count()
            + singles.count()
            + batch.arrivals.len()
            + inside
    }

    /// Starts path number `ray` at `place` in the period, with the light turned by `turn` about the vertical.
    #[inline]
    fn emit(
        &self,
        beam: &Beam,
        starts: Starts,
        (ray, place): (u32, [f64; 2]),
        turn: DVec2,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let region = Region::top(self.incident);
        let state = |flux| PathState {
            flux,
            events: EventPath::default(),
            scatterings: 0,
            ray,
            turn: DVec2::new(turn.x, -turn.y),
            light: self.incident_light(beam, turn, batch.stokes),
        };
        match starts {
            Starts::FromAbove => {
                let ray = PathRay {
                    region,
                    heading: beam.ray(place, turn),
                    state: state(1.0),
                };
                self.trace(ray, RayKind::Path, batch);
            }
            Starts::OnSurface => {
                if let Some((heading, facet, flux)) = beam.point(self.geometry, place, turn) {
                    let at = Arrival {
                        region,
                        heading,
                        facet,
                    };
                    batch.sightlines.push(&at, &state(flux));
                }
            }
        }
    }
}
