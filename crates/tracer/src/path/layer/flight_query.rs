//! Flight query: the facets that flights inside the layer hit before they end.
//!
//! The heights nearby tell for most flights that they hit nothing; the others are searched together, in lanes, which is faster than
//! looking at the cells below each. Few flights go on beyond their
//! tile. They are traced one by one ([`Tracer::advance_inside`]).

use asperity_tally::Loss;
use glam::DVec3;

use crate::accelerators::SearchedSurface;
use crate::geometry::{Geometry, is_outside};
use crate::interaction::stack::{Interface, TracedLayer};
use crate::path::state::batch::Batch;
use crate::path::state::flights::Flights;
use crate::path::state::path_state::{Arrival, RayKind, Region, SingleSegment};
use crate::path::state::segments::{Gather, rows_of};
use crate::path::tracer::Tracer;
use crate::periodic::{Heading, Traversal, TraversalEnd, approach, begin};
use crate::ray::{HalfSpace, Hit, RayBatch, TileRay};
use crate::vector::Stage;

/// Flights to test against one interface, with its rank among those ahead of them.
struct FlightQuery<'a, 'g, G: Geometry> {
    layer: &'a TracedLayer<'g, G>,
    interface: Interface,
    surface: SearchedSurface<'a, G>,
    rank: u32,
    /// Numbers of the flights.
    which: &'a [u32],
}

/// Result for a flight and one of the interfaces, by the heights nearby.
enum Ahead {
    Clear,
    /// A search must tell.
    Unknown,
    Lost,
}

/// Finds how far flights go at the most.
struct FindReach<'a, 'g, G: Geometry> {
    layer: &'a TracedLayer<'g, G>,
    flights: &'a mut Flights,
}

impl<G: Geometry> Stage for FindReach<'_, '_, G> {
    #[inline(always)]
    fn run(self) {
        let n = self.flights.at.len;
        let [_, _, z] = rows_of(&self.flights.at.origin, 0..n);
        let [_, _, dz] = rows_of(&self.flights.at.direction, 0..n);
        let length = &self.flights.length[..n];
        let reach = &mut self.flights.reach[..n];
        let ends_at_plane = &mut self.flights.ends_at_plane[..n];
        for i in 0..n {
            let to_plane = self.layer.to_plane(z[i], dz[i]);
            ends_at_plane[i] = to_plane <= length[i];
            reach[i] = if to_plane < length[i] {
                to_plane
            } else {
                length[i]
            };
        }
    }
}

/// Finds which flights lie beyond all heights of an interface.
struct FindOutside<'a, 'g, G: Geometry> {
    layer: &'a TracedLayer<'g, G>,
    geometry: &'a G,
    interface: Interface,
    flights: &'a mut Flights,
}

impl<G: Geometry> Stage for FindOutside<'_, '_, G> {
    #[inline(always)]
    fn run(self) {
        let n = self.flights.at.len;
        let [_, _, z] = rows_of(&self.flights.at.origin, 0..n);
        let [_, _, dz] = rows_of(&self.flights.at.direction, 0..n);
        let reach = &self.flights.reach[..n];
        let outside = &mut self.flights.is_outside[..n];
        let range = self.geometry.z_range();
        let half_space = self.layer.side_of(self.interface);
        let shift = self.layer.shift_to(self.interface);
        for i in 0..n {
            let ray = TileRay {
                origin: DVec3::Z * (z[i] + shift),
                direction: DVec3::Z * dz[i],
            };
            outside[i] = is_outside(range, &ray, half_space, reach[i]);
        }
    }
}

impl<G: Geometry> Tracer<'_, G> {
    /// Finds which flights hit an interface before they end, and has them interact there. The others keep their flux.
    pub(crate) fn query_flights(
        &self,
        layer: &TracedLayer<'_, G>,
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        batch.instructions.run(FindReach { layer, flights });
        let mut which = std::mem::take(&mut batch.elsewhere);
        for rank in 0..layer.interfaces() {
            for interface in [layer.upper(), layer.lower()] {
                let Some(surface) = self.surface(interface) else {
                    continue;
                };
                batch.instructions.run(FindOutside {
                    layer,
                    geometry: surface.geometry,
                    interface,
                    flights,
                });
                flights.select(layer, (interface, rank), &mut which);
                let query = FlightQuery {
                    layer,
                    interface,
                    surface,
                    rank,
                    which: &which,
                };
                self.find_searched(&query, flights, batch);
                if !batch.searched_flights.is_empty() {
                    self.search_flights(&query, flights, batch);
                }
            }
        }
        batch.elsewhere = which;
    }

    /// Collects in `batch.searched_flights` the flights that the height bounds cannot clear.
    fn find_searched(
        &self,
        query: &FlightQuery<'_, '_, G>,
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let &FlightQuery {
            layer,
            interface,
            surface: SearchedSurface { geometry, .. },
            ..
        } = query;
        let half_space = layer.side_of(interface);
        batch.searched_flights.clear();
        for &number in query.which {
            let i = number as usize;
            let from = self.stack.to_interface(interface, flights.at.heading(i));
            let mut heading = from;
            let gone = approach(geometry, &mut heading, half_space, flights.reach[i]);
            flights.length[i] -= gone;
            flights.reach[i] -= gone;
            if !absorb_along(layer, (flights, i), gone, batch) {
                continue;
            }
            let ahead = ahead(geometry, half_space, &mut heading, flights.reach[i]);
            if heading != from {
                let heading = self.stack.to_uppermost(interface, heading);
                flights.at.set_heading(i, &heading);
            }
            match ahead {
                Ahead::Clear => {}
                Ahead::Unknown => batch.searched_flights.push(number),
                Ahead::Lost => {
                    batch.work.segments += 1;
                    let state = flights.at.state(i);
                    batch.add_loss(&state, Loss::Lost, state.flux);
                    flights.at.flux[i] = 0.0;
                }
            }
        }
    }

    /// Ends a flight at the facet that it hits; at the upper surface with all others, by [`take_met`].
    fn end_at_interface(
        &self,
        query: &FlightQuery<'_, '_, G>,
        (number, hit): (u32, Hit<G::Facet>),
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let i = number as usize;
        if !absorb_along(query.layer, (flights, i), hit.t, batch) {
            return;
        }
        if query.interface == Interface::TOP {
            batch.met.push(number);
            batch.arrivals.facets.push(hit.facet);
            batch.arrivals.ts.push(hit.t);
            return;
        }
        let interface = query.interface;
        let heading = self.stack.to_interface(interface, flights.at.heading(i));
        let region = Region {
            interface,
            half_space: query.layer.side_of(interface),
        };
        let ray = heading.query(query.surface.geometry, region.half_space);
        let at = Arrival {
            region,
            heading: Traversal::begin(&heading).arrival(query.surface.geometry, &ray, &hit),
            facet: hit.facet,
        };
        self.arrive(&at, &flights.at.state(i), batch);
        flights.at.flux[i] = 0.0;
    }

    /// Searches these flights.
    fn search_flights(
        &self,
        query: &FlightQuery<'_, '_, G>,
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let geometry = query.surface.geometry;
        batch.met.clear();
        let searched = std::mem::take(&mut batch.searched_flights);
        let mut hits = std::mem::take(&mut batch.hits);
        if query.interface == Interface::TOP {
            let rays = flights.at.rays(geometry.aspect());
            query
                .surface
                .accelerator
                .closest_hits(geometry, rays, &searched, &mut hits);
        } else {
            let rays = &mut batch.single_search.rays;
            let all = self.collect_rays(query, flights, &searched, rays);
            query
                .surface
                .accelerator
                .closest_hits(geometry, rays.columns(), &all, &mut hits);
        }
        for (&number, hit) in searched.iter().zip(&hits) {
            let i = number as usize;
            match *hit {
                Some(hit) if hit.t <= flights.reach[i] => {
                    batch.work.segments += 1;
                    self.end_at_interface(query, (number, hit), flights, batch);
                }
                // It hits the interface only after its flight has ended.
                Some(_) => flights.clear_of[i] = query.rank + 1,
                None if ends_in_tile(geometry, flights, i) => {
                    flights.clear_of[i] = query.rank + 1;
                }
                None => self.leave_tile_inside(query, (flights, i), batch),
            }
        }
        take_met(flights, batch);
        batch.searched_flights = searched;
        batch.hits = hits;
    }

    /// Continues a flight in the tile after its first.
    #[inline(never)]
    fn leave_tile_inside(
        &self,
        query: &FlightQuery<'_, '_, G>,
        (flights, i): (&mut Flights, usize),
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let interface = query.interface;
        let heading = self.stack.to_interface(interface, flights.at.heading(i));
        let segment = SingleSegment {
            interface,
            query: heading.query(query.surface.geometry, query.layer.side_of(interface)),
            traversal: Traversal::begin(&heading),
            state: flights.at.state(i),
            kind: RayKind::Path,
            flight: flights.length[i],
        };
        flights.at.flux[i] = 0.0;
        self.advance_inside(query.layer, query.surface.geometry, segment, None, batch);
    }

    /// Continues a segment inside the layer after the search in its current tile.
    pub(crate) fn advance_inside(
        &self,
        layer: &TracedLayer<'_, G>,
        geometry: &G,
        mut segment: SingleSegment<G::Facet>,
        hit: Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let interface = segment.interface;
        let beginning = segment.traversal.beginning(&segment.query);
        let from = self.stack.to_uppermost(interface, beginning);
        let to_plane = layer.to_plane(from.origin.z, from.direction.z);
        let reach = segment.flight.min(to_plane);
        let end = match hit {
            Some(hit) if hit.t <= reach => {
                batch.work.segments += 1;
                if let Some(left) = layer.transmittance(hit.t) {
                    let flux = segment.state.flux;
                    segment.state.flux = flux * left;
                    batch.add_loss(&segment.state, Loss::Absorbed, flux - segment.state.flux);
                }
                let at = Arrival {
                    region: segment.region(),
                    heading: segment.traversal.arrival(geometry, &segment.query, &hit),
                    facet: hit.facet,
                };
                self.arrive(&at, &segment.state, batch);
                return;
            }
            // It hits the interface only after its flight has ended.
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
        let clear_of = 1 + layer.rank_ahead(from.direction.z, interface);
        let flights = &mut batch.layers[layer.number()].flights;
        flights.push(&from, &segment.state, segment.flight, clear_of);
    }

    /// Collects the rays of flights in the coordinates of an interface below the uppermost surface, and returns their numbers there.
    fn collect_rays(
        &self,
        query: &FlightQuery<'_, '_, G>,
        flights: &Flights,
        which: &[u32],
        rays: &mut RayBatch,
    ) -> Vec<u32> {
        let (interface, half_space) = (query.interface, query.layer.side_of(query.interface));
        rays.clear();
        for &i in which {
            let heading = self
                .stack
                .to_interface(interface, flights.at.heading(i as usize));
            rays.push(&heading.query(query.surface.geometry, half_space));
        }
        (0..which.len() as u32).collect()
    }
}

/// Absorbs the light of flight number `i` along a distance in a medium that only absorbs; returns `false` if none is left.
pub(super) fn absorb_along<G: Geometry>(
    layer: &TracedLayer<'_, G>,
    (flights, i): (&mut Flights, usize),
    distance: f64,
    batch: &mut Batch<'_, G::Facet>,
) -> bool {
    if let Some(left) = layer.transmittance(distance) {
        let state = flights.at.state(i);
        let kept = state.flux * left;
        flights.at.flux[i] = kept;
        batch.add_loss(&state, Loss::Absorbed, state.flux - kept);
    }
    flights.at.flux[i] > 0.0
}

/// Adds the flights whose numbers are in `batch.met` to the arrivals, whose facets are already there.
fn take_met<F: Copy>(flights: &mut Flights, batch: &mut Batch<'_, F>) {
    batch.instructions.run(Gather {
        from: &flights.at,
        which: &batch.met,
        into: &mut batch.arrivals.at,
    });
    for &i in &batch.met {
        flights.at.flux[i as usize] = 0.0;
    }
    batch.met.clear();
}

/// Result of the heights nearby for a flight up to `reach`, with `heading` in the coordinates of the interface; a search, where it
/// is needed, begins at `heading`.
#[inline]
fn ahead<G: Geometry>(
    geometry: &G,
    half_space: HalfSpace,
    heading: &mut Heading,
    reach: f64,
) -> Ahead {
    let query = heading.query(geometry, half_space);
    if geometry.is_clear_nearby(&query.ray, half_space, reach) {
        return Ahead::Clear;
    }
    match begin(geometry, heading, half_space) {
        None => Ahead::Unknown,
        Some(TraversalEnd::Lost) => Ahead::Lost,
        Some(_) => Ahead::Clear,
    }
}

/// Returns `true` if flight number `i` ends in the tile in which it was searched.
fn ends_in_tile<G: Geometry>(geometry: &G, flights: &Flights, i: usize) -> bool {
    let heading = flights.at.heading(i);
    let end = heading
        .query(geometry, HalfSpace::Below)
        .ray
        .at(flights.reach[i]);
    let [cx, cy] = geometry.extent();
    (0.0..cx).contains(&end.x) && (0.0..cy).contains(&end.y)
}
