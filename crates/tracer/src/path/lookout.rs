//! Lookout: what flights inside the layer meet before they end.
//!
//! Most are known to meet nothing from the heights nearby; the others are searched together. Few go on beyond their
//! tile, and are followed one by one ([`Tracer::advance_inside`]) before they come back.

use asperity_tally::Loss;

use super::Tracer;
use super::arrivals::Take;
use super::batch::Batch;
use super::flights::{FindOutside, FindReach, Flights};
use super::state::{Arrival, RayKind, Region, SingleSegment};
use crate::geometry::{Geometry, Nearby};
use crate::interaction::layer::{Interface, TracedLayer};
use crate::periodic::{Heading, Traversal, TraversalEnd, approach, begin};
use crate::ray::{HalfSpace, Hit, RayBatch};

/// What flights may meet: an interface, as which of those ahead of them, and the numbers of the flights.
struct Lookout<'a> {
    interface: Interface,
    place: u32,
    which: &'a [u32],
}

/// What is known of a flight and one of the interfaces.
enum Ahead<F> {
    Clear,
    Met(Hit<F>),
    /// A search must tell.
    Unknown,
    Lost,
}

impl<G: Geometry> Tracer<'_, G> {
    /// Finds which flights meet an interface before they end, and has them interact there; those that meet none keep
    /// their flux.
    pub(super) fn look_ahead(
        &self,
        layer: &TracedLayer<'_, G>,
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        batch.instructions.run(FindReach { layer, flights });
        let mut which = std::mem::take(&mut batch.elsewhere);
        for place in 0..layer.interfaces() {
            for interface in [Interface::Top, Interface::Bottom] {
                let Some(geometry) = self.geometry_of(interface) else {
                    continue;
                };
                batch.instructions.run(FindOutside {
                    layer,
                    geometry,
                    interface,
                    flights,
                });
                flights.select(layer, (interface, place), &mut which);
                let lookout = Lookout {
                    interface,
                    place,
                    which: &which,
                };
                self.look_at(layer, &lookout, flights, batch);
                self.search_flights(layer, &lookout, flights, batch);
            }
        }
        batch.elsewhere = which;
    }

    /// Finds what flights meet nearby; `batch.searched_flights` then holds those that need a search.
    fn look_at(
        &self,
        layer: &TracedLayer<'_, G>,
        lookout: &Lookout<'_>,
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let Some(geometry) = self.geometry_of(lookout.interface) else {
            return;
        };
        let region = Region::inside(lookout.interface);
        batch.met.clear();
        batch.searched_flights.clear();
        for &number in lookout.which {
            let i = number as usize;
            let from = layer.to_interface(lookout.interface, flights.at.heading(i));
            let mut heading = from;
            let gone = approach(geometry, &mut heading, region.half_space, flights.reach[i]);
            flights.length[i] -= gone;
            flights.reach[i] -= gone;
            let ahead = ahead(geometry, region, &mut heading, flights.reach[i]);
            if heading != from {
                let heading = layer.to_upper_surface(lookout.interface, heading);
                flights.at.set_heading(i, &heading);
            }
            match ahead {
                Ahead::Clear => {}
                Ahead::Met(hit) => {
                    batch.work.segments_skipped += 1;
                    self.meet_ahead(layer, lookout, (number, hit), flights, batch);
                }
                Ahead::Unknown => batch.searched_flights.push(number),
                Ahead::Lost => {
                    batch.work.segments += 1;
                    let state = flights.at.state(i);
                    batch.add_loss(&state, Loss::Lost, state.flux);
                    flights.at.flux[i] = 0.0;
                }
            }
        }
        self.take_met(flights, batch);
    }

    /// Lets a flight end at what it meets; at the upper surface with all others, by [`Tracer::take_met`].
    fn meet_ahead(
        &self,
        layer: &TracedLayer<'_, G>,
        lookout: &Lookout<'_>,
        (number, hit): (u32, Hit<G::Facet>),
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        if lookout.interface == Interface::Top {
            batch.met.push(number);
            batch.arrivals.facets.push(hit.facet);
            batch.arrivals.ts.push(hit.t);
            return;
        }
        let Some(geometry) = self.geometry_of(Interface::Bottom) else {
            return;
        };
        let i = number as usize;
        let heading = layer.to_interface(Interface::Bottom, flights.at.heading(i));
        let region = Region::inside(Interface::Bottom);
        let query = heading.query(geometry, region.half_space);
        let at = Arrival {
            region,
            heading: Traversal::begin(&heading).arrival(geometry, &query, &hit),
            facet: hit.facet,
        };
        self.arrive(&at, &flights.at.state(i), batch);
        flights.at.flux[i] = 0.0;
    }

    /// Adds the flights whose numbers are in `batch.met` to the arrivals, whose facets are already there.
    fn take_met(&self, flights: &mut Flights, batch: &mut Batch<'_, G::Facet>) {
        batch.instructions.run(Take {
            segments: &flights.at,
            which: &batch.met,
            arrivals: &mut batch.arrivals,
        });
        for &i in &batch.met {
            flights.at.flux[i as usize] = 0.0;
        }
        batch.met.clear();
    }

    /// Searches the flights of which the heights nearby do not tell what they meet.
    fn search_flights(
        &self,
        layer: &TracedLayer<'_, G>,
        lookout: &Lookout<'_>,
        flights: &mut Flights,
        batch: &mut Batch<'_, G::Facet>,
    ) {
        if batch.searched_flights.is_empty() {
            return;
        }
        let Some((geometry, accelerator)) = self.surface(lookout.interface) else {
            return;
        };
        let searched = std::mem::take(&mut batch.searched_flights);
        let mut hits = std::mem::take(&mut batch.hits);
        if lookout.interface == Interface::Top {
            let rays = flights.at.rays(geometry.aspect());
            accelerator.closest_hits(geometry, rays, &searched, &mut hits);
        } else {
            let rays = &mut batch.single_search.rays;
            let all = collect_at_bottom(layer, geometry, flights, &searched, rays);
            accelerator.closest_hits(geometry, rays.columns(), &all, &mut hits);
        }
        for (&number, hit) in searched.iter().zip(&hits) {
            let i = number as usize;
            match *hit {
                Some(hit) if hit.t <= flights.reach[i] => {
                    batch.work.segments += 1;
                    self.meet_ahead(layer, lookout, (number, hit), flights, batch);
                }
                // It meets the interface only after its flight has ended.
                Some(_) => flights.clear_of[i] = lookout.place + 1,
                None if ends_in_tile(geometry, flights, i) => {
                    flights.clear_of[i] = lookout.place + 1;
                }
                None => self.leave_tile_inside(layer, lookout.interface, (flights, i), batch),
            }
        }
        self.take_met(flights, batch);
        batch.searched_flights = searched;
        batch.hits = hits;
    }

    /// Continues a flight in the tile after its first.
    #[inline(never)]
    fn leave_tile_inside(
        &self,
        layer: &TracedLayer<'_, G>,
        interface: Interface,
        (flights, i): (&mut Flights, usize),
        batch: &mut Batch<'_, G::Facet>,
    ) {
        let Some(geometry) = self.geometry_of(interface) else {
            return;
        };
        let heading = layer.to_interface(interface, flights.at.heading(i));
        let segment = SingleSegment {
            interface,
            query: heading.query(geometry, interface.inner_side()),
            traversal: Traversal::begin(&heading),
            state: flights.at.state(i),
            kind: RayKind::Path,
            flight: flights.length[i],
        };
        flights.at.flux[i] = 0.0;
        self.advance_inside(layer, segment, None, batch);
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
        let to_bottom = layer.to_flat_bottom(from.origin.z, from.direction.z);
        let reach = segment.flight.min(to_bottom);
        let end = match hit {
            Some(hit) if hit.t <= reach => {
                batch.work.segments += 1;
                let at = Arrival {
                    region: Region::inside(interface),
                    heading: segment.traversal.arrival(geometry, &segment.query, &hit),
                    facet: hit.facet,
                };
                self.arrive(&at, &segment.state, batch);
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
        let clear_of = 1 + layer.place_ahead(from.direction.z, interface);
        batch
            .flights
            .push(&from, &segment.state, segment.flight, clear_of);
    }
}

/// What is known of a flight up to `reach` and the interface of `region`, in the coordinates of which `heading` is; where a
/// search must tell, it begins at `heading`.
#[inline]
fn ahead<G: Geometry>(
    geometry: &G,
    region: Region,
    heading: &mut Heading,
    reach: f64,
) -> Ahead<G::Facet> {
    let query = heading.query(geometry, region.half_space);
    match geometry.nearby(&query.ray, query.half_space, reach) {
        Nearby::Clear => Ahead::Clear,
        Nearby::Met(hit) => Ahead::Met(hit),
        Nearby::Unknown => match begin(geometry, heading, region.half_space) {
            None => Ahead::Unknown,
            Some(TraversalEnd::Lost) => Ahead::Lost,
            Some(_) => Ahead::Clear,
        },
    }
}

/// Whether flight number `i` ends in the tile in which it was searched.
fn ends_in_tile<G: Geometry>(geometry: &G, flights: &Flights, i: usize) -> bool {
    let heading = flights.at.heading(i);
    let end = heading
        .query(geometry, HalfSpace::Below)
        .ray
        .at(flights.reach[i]);
    let [cx, cy] = geometry.extent();
    (0.0..cx).contains(&end.x) && (0.0..cy).contains(&end.y)
}

/// Collects the rays of flights in the coordinates of the bottom, and returns their numbers there.
fn collect_at_bottom<G: Geometry>(
    layer: &TracedLayer<'_, G>,
    geometry: &G,
    flights: &Flights,
    which: &[u32],
    rays: &mut RayBatch,
) -> Vec<u32> {
    rays.clear();
    for &i in which {
        let heading = layer.to_interface(Interface::Bottom, flights.at.heading(i as usize));
        rays.push(&heading.query(geometry, Interface::Bottom.inner_side()));
    }
    (0..which.len() as u32).collect()
}
