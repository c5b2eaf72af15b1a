//! Light inside the layer below a surface: free flights, scattering, and the bottom.
//!
//! A flight is searched for facets only where a look at the heights nearby cannot tell; most are not,
//! and are followed at once, one after the other. Where one ends at a facet and light is divided, what stays
//! inside waits in [`Batch::inside`] for its turn, so that paths go on without limit in constant memory.

use asperity_optics::{Bottom, Material, around, reflect};
use asperity_surface::Border;
use asperity_tally::{Event, Loss};
use glam::DVec3;
use rand::{Rng, RngExt};

use super::leg::{Arrival, Errand, Leg, Light, onward};
use super::{Batch, Tracer};
use crate::geometry::{Geometry, Nearby};
use crate::interaction::facet::{Branch, Scattered, scatter};
use crate::interaction::layer::{Face, TracedLayer};
use crate::periodic::{Heading, Traversal, TraversalEnd, approach, begin, wrap};
use crate::ray::{HalfSpace, Hit, Query};

/// Inside, roulette begins at so many times the flux at which it begins elsewhere.
///
/// A path that is scattered goes on for long with little flux. At an albedo of 0.9 over glass, 0.3 of an incident
/// ray's flux instead of 0.01 takes a third of the scatterings, and half the time for the same error of bins.
const EAGERNESS: f64 = 30.0;

/// Light that sets out inside the layer, in the coordinates of the upper surface.
pub(super) struct Inside {
    pub(super) heading: Heading,
    pub(super) light: Light,
}

/// What is known of a flight and one of the faces.
enum Ahead<F> {
    Clear,
    Met(Arrival<F>),
    /// A search must tell, which begins here.
    FlightSearch(Heading),
    Lost,
}

impl<G: Geometry> Tracer<'_, G> {
    /// Follows everything that waits inside, until each has left, ended or needs a search.
    pub(super) fn fly_on<R: Rng>(&self, batch: &mut Batch<'_, G::Facet, R>) {
        let Some(substrate) = &self.substrate else {
            return;
        };
        while let Some(Inside { heading, light }) = batch.inside.pop() {
            let flight = substrate.free_flight(batch.rng);
            self.fly(substrate, heading, light, flight, 0, batch);
        }
    }

    /// Follows light from flight to flight, the first of which is known to pass clear of so many of the
    /// faces ahead.
    fn fly<R: Rng>(
        &self,
        substrate: &TracedLayer<'_, G>,
        mut heading: Heading,
        mut light: Light,
        mut flight: f64,
        mut clear_of: usize,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        loop {
            let to_bottom = substrate.to_flat_bottom(&heading);
            let mut reach = flight.min(to_bottom);
            let faces = TracedLayer::<G>::faces_ahead(heading.direction);
            for face in &faces[clear_of..] {
                let Some(geometry) = self.geometry_of(*face) else {
                    continue;
                };
                let mut to_face = substrate.to_face(*face, heading);
                let gone = approach(geometry, &mut to_face, face.inside(), reach);
                if gone > 0.0 {
                    heading = substrate.back_from(*face, to_face);
                    (flight, reach) = (flight - gone, reach - gone);
                }
                match ahead(geometry, *face, to_face, reach) {
                    Ahead::Clear => {}
                    Ahead::Met(at) => {
                        batch.work.segments_skipped += 1;
                        self.meet(*face, at, face.inside(), &light, batch);
                        return;
                    }
                    Ahead::FlightSearch(heading) => {
                        let way = Traversal::begin(&heading);
                        let query = heading.query(geometry, face.inside());
                        let leg = Leg {
                            way,
                            light,
                            errand: Errand::Light,
                            flight,
                        };
                        self.push(*face, leg, query, batch);
                        return;
                    }
                    Ahead::Lost => {
                        batch.work.segments += 1;
                        batch.record.add_loss(Loss::Lost, light.flux);
                        return;
                    }
                }
            }
            if clear_of == 0 {
                batch.work.segments_skipped += 1;
            } else {
                batch.work.segments += 1;
                clear_of = 0;
            }
            if reach.is_infinite() {
                return self.leave_clear(substrate, &heading, &light, batch);
            }
            heading.origin += reach * heading.query(self.geometry, HalfSpace::Below).ray.direction;
            if !wrap(self.geometry, &mut heading) {
                batch.record.add_loss(Loss::LeftPatch, light.flux);
                return;
            }
            if to_bottom <= flight {
                substrate.put_onto_bottom(&mut heading.origin);
                self.meet_flat_bottom(heading, &light, batch);
                return;
            }
            if !self.collide(substrate, &mut light, batch) {
                return;
            }
            heading.direction = substrate.scattered(heading.direction, batch.rng);
            flight = substrate.free_flight(batch.rng);
        }
    }

    /// Books light that meets nothing more in a clear medium: it goes down for ever where that has no end,
    /// or leaves an open patch, below the surface or beside a bottom of its own.
    fn leave_clear<R>(
        &self,
        substrate: &TracedLayer<'_, G>,
        heading: &Heading,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if heading.direction.z < 0.0 && substrate.bottom().is_none() {
            let direction = heading.world_direction();
            let exit = self.exit(direction, Face::Bottom, HalfSpace::Below, light);
            batch.record.add_exit(&exit);
        } else {
            let loss = match self.geometry.border() {
                Border::Open => Loss::LeftPatch,
                Border::Periodic | Border::Mirrored => Loss::Lost,
            };
            batch.record.add_loss(loss, light.flux);
        }
    }

    /// Absorbs the share of an interaction that does not scatter; false if nothing goes on.
    #[inline]
    fn collide<R: Rng>(
        &self,
        substrate: &TracedLayer<'_, G>,
        light: &mut Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) -> bool {
        let kept = light.flux * substrate.albedo();
        batch.record.add_loss(Loss::Absorbed, light.flux - kept);
        if kept == 0.0 {
            return false;
        }
        if light.scatterings == substrate.max_scatterings() {
            batch.record.add_loss(Loss::Truncated, kept);
            return false;
        }
        light.flux = kept;
        light.scatterings += 1;
        batch.work.scatterings += 1;
        batch.work.max_scatterings = batch.work.max_scatterings.max(light.scatterings);
        let threshold = (EAGERNESS * self.settings.roulette_below).min(1.0);
        self.survives_below(threshold, light, batch)
    }

    /// Goes on with a leg inside that has been searched for in one tile.
    pub(super) fn arrive_inside<R: Rng>(
        &self,
        substrate: &TracedLayer<'_, G>,
        face: Face,
        mut leg: Leg<G::Facet>,
        query: &mut Query,
        hit: &Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let Some(geometry) = self.geometry_of(face) else {
            return;
        };
        let beginning = leg.way.beginning(query);
        let from = substrate.back_from(face, beginning);
        let reach = leg.flight.min(substrate.to_flat_bottom(&from));
        let end = match hit {
            Some(hit) if hit.t <= reach => {
                batch.work.segments += 1;
                let at = Arrival {
                    heading: leg.way.arrival(geometry, query, hit),
                    facet: hit.facet,
                };
                self.meet(face, at, face.inside(), &leg.light, batch);
                return;
            }
            // It meets the face only after its flight has ended.
            Some(_) => None,
            None => match leg.way.step(geometry, query) {
                Some(end) => Some(end),
                None if leg.way.entered() <= reach => return self.push(face, leg, *query, batch),
                None => None,
            },
        };
        if end == Some(TraversalEnd::Lost) && leg.way.entered() <= reach {
            batch.work.segments += 1;
            batch.record.add_loss(Loss::Lost, leg.light.flux);
            return;
        }
        let ahead = TracedLayer::<G>::faces_ahead(from.direction);
        let clear_of = 1 + ahead.iter().position(|f| *f == face).unwrap_or(0);
        self.fly(substrate, from, leg.light, leg.flight, clear_of, batch);
    }

    /// What light does that has come to a flat bottom.
    fn meet_flat_bottom<R: Rng>(
        &self,
        mut heading: Heading,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let Some(bottom) = self.substrate.as_ref().and_then(TracedLayer::bottom) else {
            return;
        };
        if bottom == Bottom::Open {
            let exit = self.exit(
                heading.world_direction(),
                Face::Bottom,
                HalfSpace::Below,
                light,
            );
            batch.record.add_exit(&exit);
            return;
        }
        if light.path.order() >= self.settings.max_order {
            batch.record.add_loss(Loss::Truncated, light.flux);
            return;
        }
        let scattered = scatter_at_bottom(
            bottom,
            HalfSpace::Above,
            -heading.direction,
            DVec3::Z,
            batch.rng,
        );
        batch
            .record
            .add_loss(Loss::Absorbed, light.flux * scattered.absorbed);
        let divides = matches!(bottom, Bottom::Interface { .. });
        for (branch, share) in self.followed(&scattered, divides, batch.rng) {
            let mut light = light.onward(&branch, share);
            if !self.survives(&mut light, batch) {
                continue;
            }
            heading.direction = branch.direction;
            match branch.event {
                Event::Reflection => batch.inside.push(Inside { heading, light }),
                Event::Transmission => {
                    let direction = heading.world_direction();
                    let exit = self.exit(direction, Face::Bottom, HalfSpace::Below, &light);
                    batch.record.add_exit(&exit);
                }
            }
        }
    }

    /// Reflects, transmits or absorbs light that has arrived at a facet of the bottom through `half_space`.
    pub(super) fn interact_at_bottom<R: Rng>(
        &self,
        at: &Arrival<G::Facet>,
        half_space: HalfSpace,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let (Some(bottom), Some(geometry)) = (
            self.substrate.as_ref().and_then(TracedLayer::bottom),
            self.geometry_of(Face::Bottom),
        ) else {
            return;
        };
        let m = half_space.sign() * geometry.normal(at.facet);
        let wi = -at.heading.direction;
        let scattered = scatter_at_bottom(bottom, half_space, wi, m, batch.rng);
        batch
            .record
            .add_loss(Loss::Absorbed, light.flux * scattered.absorbed);
        let divides = matches!(bottom, Bottom::Interface { .. });
        for (branch, share) in self.followed(&scattered, divides, batch.rng) {
            let (heading, half_space, mut light) = onward(at, half_space, light, &branch, share);
            if self.survives(&mut light, batch) {
                self.set_out(
                    Face::Bottom,
                    heading,
                    half_space,
                    light,
                    Errand::Light,
                    batch,
                );
            }
        }
    }
}

/// What is known of a flight up to `reach` and a face, in the coordinates of which `heading` is.
#[inline]
fn ahead<G: Geometry>(
    geometry: &G,
    face: Face,
    mut heading: Heading,
    reach: f64,
) -> Ahead<G::Facet> {
    let query = heading.query(geometry, face.inside());
    match geometry.nearby(&query.ray, query.half_space, reach) {
        Nearby::Clear => Ahead::Clear,
        Nearby::Met(hit) => Ahead::Met(Arrival {
            heading: Traversal::begin(&heading).arrival(geometry, &query, &hit),
            facet: hit.facet,
        }),
        Nearby::Unknown => match begin(geometry, &mut heading, face.inside()) {
            None => Ahead::FlightSearch(heading),
            Some(TraversalEnd::Lost) => Ahead::Lost,
            Some(
                TraversalEnd::Escaped
                | TraversalEnd::EscapedUnsearched(_)
                | TraversalEnd::LeftPatch,
            ) => Ahead::Clear,
        },
    }
}

/// What a bottom does with light that comes through `half_space` from `wi` to a place of normal `m`, on the
/// side of `wi`.
fn scatter_at_bottom<R: Rng>(
    bottom: Bottom,
    half_space: HalfSpace,
    wi: DVec3,
    m: DVec3,
    rng: &mut R,
) -> Scattered {
    let reflected = |share, direction| {
        let branch = |event, share| Branch {
            event,
            direction,
            share,
        };
        Scattered {
            branches: [
                branch(Event::Transmission, 0.0),
                branch(Event::Reflection, share),
            ],
            absorbed: 1.0 - share,
        }
    };
    match bottom {
        Bottom::Interface { eta } => {
            let material = Material::Dielectric { eta };
            scatter(material, half_space == HalfSpace::Above, wi, m)
        }
        Bottom::Mirror => reflected(1.0, reflect(wi, m)),
        Bottom::Lambertian { reflectance } => {
            // Lambert: the squared sine of the angle to the normal is evenly distributed.
            let [u, v] = [rng.random::<f64>(), rng.random::<f64>()];
            reflected(reflectance, around(m, (1.0 - u).sqrt(), v))
        }
        _ => reflected(0.0, DVec3::ZERO),
    }
}
