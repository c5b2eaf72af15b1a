//! Emission: starts the paths of a batch.

use std::ops::Range;

use asperity_surface::Border;
use asperity_tally::EventPath;
use glam::{DVec2, DVec3};
use rand::RngExt;

use crate::geometry::Geometry;
use crate::path::beam::Beam;
use crate::path::illumination::{Illumination, Starts};
use crate::path::start::surface_starts::StartOnSurface;
use crate::path::state::batch::{Batch, MAX_IN_FLIGHT};
use crate::path::state::light_state::LightState;
use crate::path::state::path_state::{PathRay, PathState, RayKind, Region, axes_turned};
use crate::path::state::segments::{IncidentState, Segments, rows_of, rows_of_mut};
use crate::path::tracer::Tracer;
use crate::random::{Step, Use};
use crate::sampling::{Positions, Start};
use crate::vector::Stage;

/// Adds the rays of a beam to the segments, moved into the tile of a periodic surface.
struct Emit<'a> {
    beam: &'a Beam,
    /// Extent of the tile.
    extent: [f64; 2],
    starts: &'a [Start],
    light: &'a IncidentState,
    into: &'a mut Segments,
}

impl Stage for Emit<'_> {
    #[inline(always)]
    fn run(self) {
        let rows = self.into.add_starts(self.starts, self.light);
        let [x, y, z] = rows_of_mut(&mut self.into.origin, rows.clone());
        let [dx, dy, _] = rows_of(&self.into.direction, rows.clone());
        let in_tile = |position: f64, size: f64| position - (position / size).floor() * size;
        let [size_x, size_y] = self.extent;
        for (i, start) in self.starts.iter().enumerate() {
            let [u, v, _] = start.position;
            let origin = self.beam.origin([u, v], [dx[i], dy[i]]);
            x[i] = in_tile(origin.x, size_x);
            y[i] = in_tile(origin.y, size_y);
            z[i] = origin.z;
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Starts new paths while few are in flight.
    pub(crate) fn start_paths(
        &self,
        beam: &Beam,
        illumination: &Illumination,
        positions: &mut Positions,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let free = MAX_IN_FLIGHT.saturating_sub(batch.in_flight());
        let mut drawn = std::mem::take(&mut batch.starts);
        positions.draw_many(free, batch.instructions, &mut drawn);
        batch.work.rays += drawn.len() as u64;
        match (illumination.starts, illumination.spread) {
            (_, Some(spread)) => {
                for start in &drawn {
                    let draws = &mut batch.stream.draws(start.ray, Step::START, Use::Direction);
                    let wi = spread.sample(illumination.incidence, || draws.random());
                    self.emit(&beam.towards(wi), start, batch);
                }
            }
            (Starts::OnSurface, None) => self.start_on_surface(beam, &drawn, batch),
            // Over a surface that repeats nothing has to be found out
            (Starts::FromAbove, None) if self.geometry.border() == Border::Periodic => {
                self.emit_all(beam, &drawn, batch);
            }
            (Starts::FromAbove, None) => {
                drawn.iter().for_each(|start| self.emit(beam, start, batch))
            }
        }
        batch.starts = drawn;
    }

    /// Starts paths at the highest point of a periodic surface, in its tile.
    fn emit_all(&self, beam: &Beam, starts: &[Start], batch: &mut Batch<'_, G::Facet>) {
        let first = batch.segments.len;
        batch.instructions.run(Emit {
            beam,
            extent: self.geometry.extent(),
            starts,
            light: &self.incident_state(-beam.wi(), batch),
            into: &mut batch.segments,
        });
        let rows = first..batch.segments.len;
        batch.searched.extend(rows.start as u32..rows.end as u32);
        self.turn_polarisation(beam, batch.stokes, rows, &mut batch.segments);
    }

    /// Starts paths at points of the surface that the light reaches.
    fn start_on_surface(&self, beam: &Beam, starts: &[Start], batch: &mut Batch<'_, G::Facet>) {
        batch.instructions.run(StartOnSurface {
            geometry: self.geometry,
            beam,
            starts,
            light: &self.incident_state(beam.wi(), batch),
            into: &mut batch.visibility_rays.from,
        });
        let rays = &mut batch.visibility_rays.from.at;
        self.turn_polarisation(beam, batch.stokes, 0..rays.len, rays);
        self.begin_visibility_rays(batch);
    }

    /// State of the rays that start with `direction`.
    fn incident_state(&self, direction: DVec3, batch: &Batch<'_, G::Facet>) -> IncidentState {
        IncidentState {
            direction,
            half_space: self.incident,
            state: LightState::incident(self.settings.polarisation, batch.stokes),
        }
    }

    /// Polarisation of light from an azimuth turned by `turn`, in the axes of its ray. Those of vertical rays do not
    /// turn with the azimuth, so the light does.
    fn incident_light(&self, beam: &Beam, turn: DVec2, stokes: [f64; 3]) -> LightState {
        let polarisation = self.settings.polarisation;
        let light = LightState::incident(polarisation, stokes);
        if turn == DVec2::X || !beam.is_vertical() {
            return light;
        }
        light.turned(polarisation, axes_turned(DVec3::NEG_Z, turn).inverse())
    }

    /// Sets the polarisation of each of the segments in `rows` by [`Tracer::incident_light`]; they carry that of azimuth zero.
    fn turn_polarisation(
        &self,
        beam: &Beam,
        stokes: [f64; 3],
        rows: Range<usize>,
        segments: &mut Segments,
    ) {
        if !segments.kept.turn || !beam.is_vertical() {
            return;
        }
        for i in rows {
            let turn = DVec2::new(segments.turn[0][i], -segments.turn[1][i]);
            let light = self.incident_light(beam, turn, stokes);
            segments.set_light_state(i, &light);
        }
    }

    /// Starts a path at the highest point of any surface.
    fn emit(&self, beam: &Beam, start: &Start, batch: &mut Batch<'_, G::Facet>) {
        let [u, v, _] = start.position;
        let turn = start.turn();
        let ray = PathRay {
            region: Region::top(self.incident),
            heading: beam.ray([u, v], turn),
            state: PathState {
                flux: 1.0,
                events: EventPath::default(),
                scatterings: 0,
                ray: start.ray,
                slot: 0,
                turn: DVec2::new(turn.x, -turn.y),
                light: self.incident_light(beam, turn, batch.stokes),
            },
        };
        self.trace(ray, RayKind::Path, batch);
    }
}

#[cfg(test)]
mod tests {
    use asperity_optics::Incidence;
    use asperity_surface::HeightField;

    use super::*;
    use crate::geometry::height_field::Surface;
    use crate::path::illumination::Window;
    use crate::path::state::segments::Kept;
    use crate::periodic::begin;
    use crate::ray::HalfSpace;
    use crate::vector::Instructions;

    #[test]
    fn many_rays_begin_where_one_does() {
        let heights = (0..63).map(|i| f64::from(i * i % 11)).collect();
        let field = HeightField::new(heights, [7, 9], [1.0, 1.5]).unwrap();
        let surface = Surface::new(field);
        let incidence = Incidence::from_degrees(75.0, 20.0).unwrap();
        for (half_space, turn) in [
            (HalfSpace::Above, false),
            (HalfSpace::Above, true),
            (HalfSpace::Below, true),
        ] {
            let beam = Beam::new(&surface, half_space, incidence, Window::WHOLE);
            let start = |ray: u32| {
                let part = |step: f64| (f64::from(ray) * step).fract();
                let azimuth = if turn { part(0.618_034) } else { 0.0 };
                Start {
                    position: [part(0.569_840), part(0.754_878), azimuth],
                    ray,
                }
            };
            let starts: Vec<Start> = (0..200).map(start).collect();
            let mut segments = Segments::new(Kept {
                turn,
                ..Kept::NOTHING
            });
            Instructions::best().run(Emit {
                beam: &beam,
                extent: surface.extent(),
                starts: &starts,
                light: &IncidentState {
                    direction: -beam.wi(),
                    half_space,
                    state: LightState::NONE,
                },
                into: &mut segments,
            });
            for (i, start) in starts.iter().enumerate() {
                let ([u, v, _], turn) = (start.position, start.turn());
                let mut heading = beam.ray([u, v], turn);
                assert_eq!(begin(&surface, &mut heading, half_space), None);
                assert_eq!(segments.heading(i), heading, "{i}");
                let state = segments.state(i);
                assert_eq!((state.flux, state.ray), (1.0, start.ray));
                assert_eq!(state.turn, DVec2::new(turn.x, -turn.y));
                assert_eq!(segments.half_space(i), half_space);
            }
        }
    }
}
