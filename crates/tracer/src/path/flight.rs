//! Flights inside the layer below a surface: free flights and scattering.
//!
//! A flight is searched for facets only where the heights nearby cannot tell what it meets; most flights are not
//! searched, and are traced at once, one after the other. Where one ends at a facet and light is divided, what
//! stays inside waits in [`Batch::inside`], so that paths of any length need constant memory.

use asperity_optics::PhaseFunction;
use asperity_surface::Border;
use asperity_tally::Loss;
use rand::RngExt;

use super::Tracer;
use super::batch::Batch;
use super::roulette::Roulette;
use super::state::{Arrival, Departure, LayerRay, PathState, RayKind, Region, SingleSegment};
use crate::geometry::{Geometry, Nearby};
use crate::interaction::layer::{Interface, TracedLayer};
use crate::interaction::rayleigh::scatter_rayleigh;
use crate::periodic::{Heading, Traversal, TraversalEnd, approach, begin, wrap};
use crate::random::{Draws, Use};
use crate::ray::{HalfSpace, Hit};
use crate::settings::Polarisation;

/// Threshold of Russian roulette inside the layer, over the threshold elsewhere.
///
/// A scattered path continues for long with little flux. At an albedo of 0.9 over glass, 0.3 of an incident
/// ray's flux instead of 0.01 takes a third of the scatterings, and half the time for the same error of bins.
const ROULETTE_FACTOR: f64 = 30.0;

/// A straight flight through the layer, in the coordinates of the upper surface.
struct Flight {
    heading: Heading,
    state: PathState,
    /// How far it goes before it interacts with the medium.
    length: f64,
    /// How many of the interfaces ahead it is known not to meet.
    clear_of: usize,
}

/// What is known of a flight and one of the interfaces.
enum Ahead<F> {
    Clear,
    Met(Arrival<F>),
    /// A search must tell, which begins here.
    Unknown(Heading),
    Lost,
}

impl<G: Geometry> Tracer<'_, G> {
    /// Traces all rays that wait inside the layer, until each has left, ended or needs a search.
    pub(super) fn trace_flights(&self, batch: &mut Batch<'_, G::Facet>) {
        let Some(layer) = &self.layer else {
            return;
        };
        while let Some(LayerRay { heading, state }) = batch.inside.pop() {
            let mut draws = batch.stream.draws(state.ray, state.step(), Use::Flight);
            let flight = Flight {
                heading,
                state,
                length: layer.free_flight(&mut draws),
                clear_of: 0,
            };
            self.fly(layer, flight, batch);
        }
    }

    /// Follows a path from flight to flight.
    fn fly(&self, layer: &TracedLayer<'_, G>, mut flight: Flight, batch: &mut Batch<'_, G::Facet>) {
        loop {
            // Look for the interfaces ahead, up to the end of the flight
            let to_bottom = layer.to_flat_bottom(&flight.heading);
            let mut reach = flight.length.min(to_bottom);
            if self.meets_interface(layer, &mut flight, &mut reach, batch) {
                return;
            }
            if flight.clear_of == 0 {
                batch.work.segments_skipped += 1;
            } else {
                batch.work.segments += 1;
                flight.clear_of = 0;
            }

            // Go to the end of the flight, or leave a clear medium that has none
            if reach.is_infinite() {
                return self.leave_clear_medium(layer, &flight, batch);
            }
            let ray = flight.heading.query(self.geometry, HalfSpace::Below).ray;
            flight.heading.origin += reach * ray.direction;
            if !wrap(self.geometry, &mut flight.heading) {
                batch.add_loss(&flight.state, Loss::LeftPatch, flight.state.flux);
                return;
            }
            if to_bottom <= flight.length {
                layer.put_onto_bottom(&mut flight.heading.origin);
                return self.interact_at_flat_bottom(flight.heading, &flight.state, batch);
            }

            // Scatter in the medium
            let mut draws = batch
                .stream
                .draws(flight.state.ray, flight.state.step(), Use::Medium);
            if !self.collide(layer, &mut flight.state, &mut draws, batch) {
                return;
            }
            self.scatter_in_medium(layer, &mut flight, &mut draws);
            flight.length = layer.free_flight(&mut draws);
        }
    }

    /// Whether a flight ends at one of the interfaces ahead before `reach`, or has to be searched: then another one
    /// follows it. Both the flight and its reach begin anew where it comes between the heights of an interface.
    #[inline]
    fn meets_interface(
        &self,
        layer: &TracedLayer<'_, G>,
        flight: &mut Flight,
        reach: &mut f64,
        batch: &mut Batch<'_, G::Facet>,
    ) -> bool {
        let interfaces = TracedLayer::<G>::interfaces_ahead(flight.heading.direction);
        for &interface in &interfaces[flight.clear_of..] {
            let Some(geometry) = self.geometry_of(interface) else {
                continue;
            };
            let region = Region::inside(interface);
            let mut heading = layer.to_interface(interface, flight.heading);
            let gone = approach(geometry, &mut heading, region.half_space, *reach);
            if gone > 0.0 {
                flight.heading = layer.to_upper_surface(interface, heading);
                flight.length -= gone;
                *reach -= gone;
            }
            match ahead(geometry, region, heading, *reach) {
                Ahead::Clear => {}
                Ahead::Met(at) => {
                    batch.work.segments_skipped += 1;
                    self.interact(&at, &flight.state, batch);
                    return true;
                }
                Ahead::Unknown(heading) => {
                    batch.singles.push(SingleSegment {
                        interface,
                        query: heading.query(geometry, region.half_space),
                        traversal: Traversal::begin(&heading),
                        state: flight.state,
                        kind: RayKind::Path,
                        flight: flight.length,
                    });
                    return true;
                }
                Ahead::Lost => {
                    batch.work.segments += 1;
                    batch.add_loss(&flight.state, Loss::Lost, flight.state.flux);
                    return true;
                }
            }
        }
        false
    }

    /// Tallies light that meets nothing more in a clear medium: it goes down for ever where that has no end,
    /// or leaves an open patch, below the surface or beside a bottom with a surface of its own.
    fn leave_clear_medium(
        &self,
        layer: &TracedLayer<'_, G>,
        flight: &Flight,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        if flight.heading.direction.z < 0.0 && layer.bottom().is_none() {
            let departure = below_the_bottom(&flight.heading, flight.state);
            self.push_exit(&departure, batch);
        } else {
            let loss = match self.geometry.border() {
                Border::Open => Loss::LeftPatch,
                Border::Periodic | Border::Mirrored => Loss::Lost,
            };
            batch.add_loss(&flight.state, loss, flight.state.flux);
        }
    }

    /// Absorbs the fraction of an interaction with the medium that does not scatter; false if the path ends.
    #[inline]
    fn collide(
        &self,
        layer: &TracedLayer<'_, G>,
        state: &mut PathState,
        draws: &mut Draws,
        batch: &mut Batch<'_, G::Facet>,
    ) -> bool {
        let kept = state.flux * layer.albedo();
        batch.add_loss(state, Loss::Absorbed, state.flux - kept);
        if kept == 0.0 {
            return false;
        }
        if state.scatterings == layer.max_scatterings() {
            batch.add_loss(state, Loss::Truncated, kept);
            return false;
        }
        state.flux = kept;
        state.scatterings += 1;
        batch.work.scatterings += 1;
        batch.work.max_scatterings = batch.work.max_scatterings.max(state.scatterings);
        let threshold = (ROULETTE_FACTOR * self.settings.roulette_below).min(1.0);
        let u = draws.random();
        state.flux = Roulette::below(threshold).play(state.flux, u, batch.tally_of(state.ray));
        state.flux > 0.0
    }

    /// Turns a flight into the direction in which the medium scatters it. All but Rayleigh scattering depolarises.
    #[inline]
    fn scatter_in_medium(
        &self,
        layer: &TracedLayer<'_, G>,
        flight: &mut Flight,
        draws: &mut Draws,
    ) {
        let polarisation = self.settings.polarisation;
        let (k, light) = (flight.heading.direction, flight.state.light);
        let is_rayleigh = layer.phase() == PhaseFunction::Rayleigh;
        if polarisation == Polarisation::Averaged || !is_rayleigh {
            flight.heading.direction = layer.scattered(k, draws);
            flight.state.light = light.depolarised(polarisation);
            return;
        }
        let numbers = [draws.random(), draws.random(), draws.random()];
        let handedness = self.handedness(&flight.heading);
        let scattered = scatter_rayleigh(k, light.stokes(), handedness, numbers);
        flight.heading.direction = scattered.direction;
        // The direction was chosen by the flux that goes there.
        (flight.state.light, _) = light.after(polarisation, &scattered.passage);
    }

    /// Continues a segment inside the layer after the search in its current tile.
    pub(super) fn advance_inside(
        &self,
        layer: &TracedLayer<'_, G>,
        mut segment: SingleSegment<G::Facet>,
        hit: Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let interface = segment.interface;
        let Some(geometry) = self.geometry_of(interface) else {
            return;
        };
        let beginning = segment.traversal.beginning(&segment.query);
        let from = layer.to_upper_surface(interface, beginning);
        let reach = segment.flight.min(layer.to_flat_bottom(&from));
        let end = match hit {
            Some(hit) if hit.t <= reach => {
                batch.work.segments += 1;
                let at = Arrival {
                    region: Region::inside(interface),
                    heading: segment.traversal.arrival(geometry, &segment.query, &hit),
                    facet: hit.facet,
                };
                self.interact(&at, &segment.state, batch);
                return;
            }
            // It meets the interface only after its flight has ended.
            Some(_) => None,
            None => match segment.traversal.step(geometry, &mut segment.query) {
                Some(end) => Some(end),
                None if segment.traversal.entered() <= reach => {
                    batch.singles.push(segment);
                    return;
                }
                None => None,
            },
        };
        if end == Some(TraversalEnd::Lost) && segment.traversal.entered() <= reach {
            batch.work.segments += 1;
            batch.add_loss(&segment.state, Loss::Lost, segment.state.flux);
            return;
        }
        let ahead = TracedLayer::<G>::interfaces_ahead(from.direction);
        let place = ahead.iter().position(|other| *other == interface);
        let flight = Flight {
            heading: from,
            state: segment.state,
            length: segment.flight,
            clear_of: 1 + place.unwrap_or(0),
        };
        self.fly(layer, flight, batch);
    }
}

/// A ray that goes down below the bottom of the layer for ever.
pub(super) fn below_the_bottom(heading: &Heading, state: PathState) -> Departure {
    Departure {
        region: Region::inside(Interface::Bottom).behind(),
        direction: heading.world_direction(),
        state,
    }
}

/// What is known of a flight up to `reach` and the interface of `region`, in the coordinates of which `heading` is.
#[inline]
fn ahead<G: Geometry>(
    geometry: &G,
    region: Region,
    mut heading: Heading,
    reach: f64,
) -> Ahead<G::Facet> {
    let query = heading.query(geometry, region.half_space);
    match geometry.nearby(&query.ray, query.half_space, reach) {
        Nearby::Clear => Ahead::Clear,
        Nearby::Met(hit) => Ahead::Met(Arrival {
            region,
            heading: Traversal::begin(&heading).arrival(geometry, &query, &hit),
            facet: hit.facet,
        }),
        Nearby::Unknown => match begin(geometry, &mut heading, region.half_space) {
            None => Ahead::Unknown(heading),
            Some(TraversalEnd::Lost) => Ahead::Lost,
            Some(_) => Ahead::Clear,
        },
    }
}
