//! Flights: take light inside the layer from interaction to interaction, all of a round together.
//!
//! Each round takes all flights one on: to a facet (`flight_query.rs`), to a flat face (`bottom.rs`), or to where the
//! medium scatters them (`medium.rs`).

use asperity_optics::Bottom;
use asperity_surface::Border;
use asperity_tally::Loss;
use glam::DVec3;

use crate::geometry::Geometry;
use crate::interaction::stack::TracedLayer;
use crate::path::layer::flight_query::absorb_along;
use crate::path::state::batch::{Batch, LightInLayer};
use crate::path::state::flights::Flights;
use crate::path::state::path_state::{Departure, PathState, Region};
use crate::path::state::random_numbers::DrawNumbers;
use crate::path::state::segments::{Gather, gather_column, rows_of, rows_of_mut};
use crate::path::tracer::Tracer;
use crate::periodic::{Heading, wrap};
use crate::random::Use;
use crate::ray::HalfSpace;
use crate::vector::Stage;

/// Begins free flights by uniform random numbers.
pub(crate) struct BeginFlights<'a, 'g, G: Geometry> {
    pub(crate) layer: &'a TracedLayer<'g, G>,
    pub(crate) numbers: &'a [f64],
    pub(crate) length: &'a mut [f64],
}

impl<G: Geometry> Stage for BeginFlights<'_, '_, G> {
    #[inline(always)]
    fn run(self) {
        for (length, u) in self.length.iter_mut().zip(self.numbers) {
            *length = self.layer.free_flight(*u);
        }
    }
}

/// Moves flights that hit nothing to their ends.
struct FlyOn<'a> {
    from: &'a Flights,
    /// Their numbers.
    which: &'a [u32],
    aspect: f64,
    into: &'a mut Flights,
}

impl Stage for FlyOn<'_> {
    #[inline(always)]
    fn run(self) {
        let into = self.into;
        let first = into.at.len;
        Gather {
            from: &self.from.at,
            which: self.which,
            into: &mut into.at,
        }
        .run();
        let rows = first..into.at.len;
        let n = rows.len();
        let reach = &mut into.reach[rows.clone()];
        gather_column(reach, &self.from.reach, self.which);
        gather_column(
            &mut into.ends_at_plane[rows.clone()],
            &self.from.ends_at_plane,
            self.which,
        );
        into.clear_of[rows.clone()].fill(0);
        let [x, y, z] = rows_of_mut(&mut into.at.origin, rows.clone());
        let [dx, dy, dz] = rows_of(&into.at.direction, rows.clone());
        for i in 0..n {
            x[i] += reach[i] * dx[i];
            y[i] += reach[i] * (dy[i] * self.aspect);
            z[i] += reach[i] * dz[i];
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Takes all flights inside the layers to their next interaction.
    pub(crate) fn trace_flights(&self, batch: &mut Batch<'_, G::Facet>) {
        for layer in self.stack.layers() {
            self.begin_flights(layer, batch);
            let mut flown = std::mem::take(&mut batch.flown);
            std::mem::swap(&mut batch.layers[layer.number()].flights, &mut flown);
            self.query_flights(layer, &mut flown, batch);
            self.fly(layer, &mut flown, batch);
            flown.at.len = 0;
            batch.flown = flown;
        }
        self.interact_at_bottoms(batch);
    }

    /// Begins the flights of light that has entered a layer.
    fn begin_flights(&self, layer: &TracedLayer<'_, G>, batch: &mut Batch<'_, G::Facet>) {
        let LightInLayer {
            flights, entering, ..
        } = &mut batch.layers[layer.number()];
        let rows = flights.at.len..flights.at.len + entering.len;
        flights.make_room(rows.end);
        batch.met.clear();
        batch.met.extend(0..entering.len as u32);
        batch.instructions.run(Gather {
            from: entering,
            which: &batch.met,
            into: &mut flights.at,
        });
        batch.instructions.run(DrawNumbers {
            stream: batch.stream,
            segments: &flights.at,
            rows: rows.clone(),
            pairs: 1,
            of: Use::Flight,
            into: &mut batch.numbers,
        });
        batch.instructions.run(BeginFlights {
            layer,
            numbers: &batch.numbers[0],
            length: &mut flights.length[rows.clone()],
        });
        flights.clear_of[rows].fill(0);
        entering.len = 0;
    }

    /// Moves flights that hit nothing to their ends, where they come to a flat face, are scattered or leave.
    fn fly(
        &self,
        layer: &TracedLayer<'_, G>,
        flown: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        // Leave a clear medium that has no end
        let mut which = std::mem::take(&mut batch.elsewhere);
        which.clear();
        for i in 0..flown.at.len {
            if flown.at.flux[i] == 0.0 {
                continue;
            }
            if flown.clear_of[i] == 0 {
                batch.work.segments_skipped += 1;
            } else {
                batch.work.segments += 1;
            }
            let reach = flown.reach[i];
            if !absorb_along(layer, (flown, i), reach, batch) {
                continue;
            }
            if reach.is_infinite() {
                self.leave_clear_medium(layer, &flown.at.heading(i), flown.at.state(i), batch);
            } else {
                which.push(i as u32);
            }
        }

        // Go to the ends
        let flights = &mut batch.layers[layer.number()].flights;
        let first = flights.at.len;
        flights.make_room(first + which.len());
        batch.instructions.run(FlyOn {
            from: flown,
            which: &which,
            aspect: self.geometry.aspect(),
            into: flights,
        });
        batch.elsewhere = which;
        self.wrap_flights(layer, first, batch);
        self.end_at_planes(layer, first, batch);
        self.scatter_in_medium(layer, first, batch);
    }

    /// Moves the flights from number `first` on into the tile.
    fn wrap_flights(
        &self,
        layer: &TracedLayer<'_, G>,
        first: usize,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let [cx, cy] = self.geometry.extent();
        let number = layer.number();
        for i in first..batch.layers[number].flights.at.len {
            let at = &mut batch.layers[number].flights.at;
            let (x, y) = (at.origin[0][i], at.origin[1][i]);
            if (0.0 <= x) & (x < cx) & (0.0 <= y) & (y < cy) {
                continue;
            }
            let mut heading = at.heading(i);
            if wrap(self.geometry, &mut heading) {
                at.set_heading(i, &heading);
            } else {
                let state = at.state(i);
                at.flux[i] = 0.0;
                batch.add_loss(&state, Loss::LeftPatch, state.flux);
            }
        }
    }

    /// Ends those of the flights from number `first` on that come to a flat face, where they interact or leave.
    fn end_at_planes(
        &self,
        layer: &TracedLayer<'_, G>,
        first: usize,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let number = layer.number();
        for i in first..batch.layers[number].flights.at.len {
            let Flights {
                at, ends_at_plane, ..
            } = &mut batch.layers[number].flights;
            if !ends_at_plane[i] || at.flux[i] == 0.0 {
                continue;
            }
            let (mut heading, state) = (at.heading(i), at.state(i));
            at.flux[i] = 0.0;
            let dz = heading.direction.z;
            layer.put_onto_plane(&mut heading.origin, dz);
            let (interface, half_space) = layer.interface_towards(dz);
            if self.stack.bottom(interface) == Some(Bottom::Open) {
                self.push_exit(&below(layer, &heading, state), batch);
            } else {
                let above = &mut batch.layers[interface.number() - 1];
                above.at_bottom.push(&heading, half_space, DVec3::Z, &state);
            }
        }
    }

    /// Tallies light without another interaction in a clear medium: it leaves downwards if the medium has no end, or leaves an open
    /// patch, below the surface or beside a bottom with a surface of its own.
    fn leave_clear_medium(
        &self,
        layer: &TracedLayer<'_, G>,
        heading: &Heading,
        state: PathState,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        if heading.direction.z < 0.0 && layer.bottom().is_none() {
            self.push_exit(&below(layer, heading, state), batch);
        } else {
            let loss = match self.geometry.border() {
                Border::Open => Loss::LeftPatch,
                Border::Periodic | Border::Mirrored => Loss::Lost,
            };
            batch.add_loss(&state, loss, state.flux);
        }
    }
}

/// A ray that leaves downwards below the bottom of the lowest layer.
fn below<G: Geometry>(
    layer: &TracedLayer<'_, G>,
    heading: &Heading,
    state: PathState,
) -> Departure {
    Departure {
        region: Region {
            interface: layer.lower(),
            half_space: HalfSpace::Below,
        },
        direction: heading.world_direction(),
        state,
    }
}
