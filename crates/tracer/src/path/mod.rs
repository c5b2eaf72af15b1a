//! Light paths: from interaction to interaction until all flux has left.

mod beam;
mod hidden;
mod illumination;
mod inside;
mod leg;
mod work;

use std::f64::consts::{PI, TAU};

use asperity_optics::Material;
use asperity_tally::{
    Azimuth, ControlVariate, EventPath, Exit, Loss, Side, Tally, TallySpec, TallyValues,
};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use crate::accelerators::Accelerator;
use crate::geometry::Geometry;
use crate::interaction::facet::{Branch, Scattered, scatter};
use crate::interaction::layer::{Face, TracedLayer};
use crate::path::beam::Beam;
use crate::periodic::{Heading, Traversal, TraversalEnd, begin};
use crate::ray::{HalfSpace, Hit, Query};
use crate::sampling::Places;
use crate::settings::{Branching, PathSettings};

pub use illumination::{Illumination, Starts};
pub use work::Work;

use inside::Inside;
use leg::{Arrival, Errand, InFlight, Leg, Light, onward};

/// Legs that are followed together: enough to fill wide searches, few enough for them and the surface
/// around them to stay in cache.
const TOGETHER: usize = 1024;

/// Follows light that falls on a surface.
pub struct Tracer<'a, G: Geometry> {
    geometry: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    incident: HalfSpace,
    settings: PathSettings,
    substrate: Option<TracedLayer<'a, G>>,
}

/// The state of one batch.
struct Batch<'r, F, R> {
    record: Tally<'r>,
    work: Work,
    rng: &'r mut R,
    /// Legs to be searched next, by the face that they may meet.
    next: [InFlight<F>; 2],
    /// Light that sets out inside the layer.
    inside: Vec<Inside>,
    /// How many of the next legs may have another one behind them.
    lasting: usize,
}

impl<'a, G: Geometry> Tracer<'a, G> {
    /// A tracer for light that comes from the `incident` half space.
    ///
    /// The indices of `material` are relative to the medium there, also where it lies below.
    #[must_use]
    pub const fn new(
        geometry: &'a G,
        accelerator: &'a dyn Accelerator<G>,
        material: Material,
        incident: HalfSpace,
        settings: PathSettings,
    ) -> Self {
        Self {
            geometry,
            accelerator,
            material,
            incident,
            settings,
            substrate: None,
        }
    }

    /// The same with a layer of medium below the surface.
    ///
    /// # Panics
    /// Unless the light comes from above onto a dielectric: there is no medium elsewhere.
    #[must_use]
    pub fn over(self, substrate: TracedLayer<'a, G>) -> Self {
        assert!(
            self.incident == HalfSpace::Above && self.material.transmitting_index().is_some(),
            "a half_space lies below a dielectric that is lit from above"
        );
        Self {
            substrate: Some(substrate),
            ..self
        }
    }

    /// Traces one batch of `strata * strata` rays.
    ///
    /// Returns flux fractions, and the work done; under a `control`, the fractions that it
    /// leaves, which [`ControlVariate::complete`] turns into flux fractions.
    ///
    /// Directions are those of the incident medium's frame: its side is +z, also when it is below
    /// the surface. Random numbers are drawn in an order that depends on the paths alone, so all
    /// accelerators give the same result.
    ///
    /// # Panics
    /// If there is both a layer and a control, or the sampling is quasi-random and `strata` is not a [`crate::Sampling::quasi_random_strata`].
    pub fn batch<R: Rng>(
        &self,
        illumination: &Illumination,
        strata: u32,
        spec: TallySpec,
        control: Option<&ControlVariate>,
        rng: &mut R,
    ) -> (TallyValues, Work) {
        assert!(
            self.substrate.is_none() || control.is_none(),
            "no control knows of a layer"
        );
        let incidence = illumination.incidence;
        // Vertical light has no azimuth to draw.
        let free = illumination.any_azimuth && incidence.is_vertical();
        let azimuth = if free {
            Azimuth::Free
        } else {
            Azimuth::From(incidence.phi() + PI)
        };
        let turned = illumination.any_azimuth && !free;
        let mut places = Places::new(illumination.sampling, strata, turned, rng);
        let mut batch = Batch {
            record: Tally::new(spec, azimuth).with_control_variate(control),
            work: Work::default(),
            rng,
            next: [InFlight::new(), InFlight::new()],
            inside: Vec::new(),
            lasting: 0,
        };
        let beam = Beam::new(self.geometry, self.incident, incidence);
        let mut now = [InFlight::new(), InFlight::new()];
        let mut hits = Vec::new();
        loop {
            // Legs that end in any case do not count, so that when a ray starts, and which random
            // numbers it draws, does not depend on whether they are followed; see `set_out_if_asked`.
            while batch.lasting < TOGETHER
                && let Some([u, v, azimuth]) = places.draw(batch.rng)
            {
                let turn = DVec2::from_angle(TAU * azimuth);
                self.start(&beam, illumination.starts, [u, v], turn, &mut batch);
                self.fly_on(&mut batch);
                batch.work.rays += 1;
            }
            std::mem::swap(&mut now, &mut batch.next);
            batch.lasting = 0;
            if now.iter().all(|now| now.legs.is_empty()) {
                break;
            }
            for (face, now) in [Face::Top, Face::Bottom].into_iter().zip(&mut now) {
                let Some((geometry, accelerator)) = self.face(face) else {
                    continue;
                };
                accelerator.closest_hits(geometry, &now.queries, &mut hits);
                for ((leg, query), hit) in now.legs.drain(..).zip(&mut now.queries).zip(&hits) {
                    self.arrive(face, leg, query, hit, &mut batch);
                    self.fly_on(&mut batch);
                }
                now.queries.clear();
            }
        }
        (batch.record.into_fractions(batch.work.rays), batch.work)
    }

    /// Lets one path of a batch start at `[u, v]` of the period, with the light turned by `turn`.
    #[inline]
    fn start<R: Rng>(
        &self,
        beam: &Beam,
        starts: Starts,
        place: [f64; 2],
        turn: DVec2,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let light = |flux| Light {
            flux,
            path: EventPath::default(),
            scatterings: 0,
            turn: DVec2::new(turn.x, -turn.y),
        };
        match starts {
            Starts::FromAbove => {
                let heading = beam.ray(place, turn);
                let (light, errand) = (light(1.0), Errand::Light);
                self.set_out(Face::Top, heading, self.incident, light, errand, batch);
            }
            Starts::OnSurface => {
                let Some((heading, facet, flux)) = beam.point(self.geometry, place, turn) else {
                    return;
                };
                let towards_light = Heading {
                    direction: -heading.direction,
                    ..heading
                };
                self.look(
                    towards_light,
                    light(flux),
                    Arrival { heading, facet },
                    batch,
                );
            }
        }
    }

    /// Between the frame in which the incident medium is +z and that of the height field.
    fn turned_upright(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.x, w.y, w.z * self.incident.sign())
    }

    /// A surface that rays meet, and how hits on it are found.
    #[inline]
    fn face(&self, face: Face) -> Option<(&'a G, &'a dyn Accelerator<G>)> {
        match face {
            Face::Top => Some((self.geometry, self.accelerator)),
            Face::Bottom => self.substrate.as_ref().and_then(TracedLayer::surface),
        }
    }

    /// The surface alone.
    #[inline]
    fn geometry_of(&self, face: Face) -> Option<&'a G> {
        self.face(face).map(|(geometry, _)| geometry)
    }

    /// Light that leaves in the `direction` given, or would, from one of the faces.
    fn exit(&self, direction: DVec3, face: Face, half_space: HalfSpace, light: &Light) -> Exit {
        let wo = self.turned_upright(direction);
        let level = light.turn.rotate(wo.truncate());
        Exit {
            side: self.side_of(face, half_space),
            wo: level.extend(wo.z),
            flux: light.flux,
            path: light.path,
            scatterings: light.scatterings,
        }
    }

    /// Lets a leg begin, or ends it at once if it meets nothing.
    fn set_out<R: Rng>(
        &self,
        face: Face,
        mut heading: Heading,
        half_space: HalfSpace,
        light: Light,
        errand: Errand<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if let Some(substrate) = &self.substrate
            && half_space == face.inside()
        {
            let heading = substrate.back_from(face, heading);
            batch.inside.push(Inside { heading, light });
            return;
        }
        let Some(geometry) = self.geometry_of(face) else {
            return;
        };
        if let Some(end) = begin(geometry, &mut heading, half_space) {
            let direction = heading.world_direction();
            self.end(end, direction, (face, half_space), &light, &errand, batch);
        } else {
            let leg = Leg {
                way: Traversal::begin(&heading),
                light,
                errand,
                flight: f64::INFINITY,
            };
            self.push(face, leg, heading.query(geometry, half_space), batch);
        }
    }

    /// Has a leg searched next.
    #[inline]
    fn push<R>(
        &self,
        face: Face,
        leg: Leg<G::Facet>,
        query: Query,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let last = matches!(leg.errand, Errand::Light)
            && leg.light.path.order() >= self.settings.max_order;
        batch.lasting += usize::from(!last);
        let next = &mut batch.next[face as usize];
        next.legs.push(leg);
        next.queries.push(query);
    }

    /// Goes on from what a leg has met in the current tile, be it nothing.
    fn arrive<R: Rng>(
        &self,
        face: Face,
        mut leg: Leg<G::Facet>,
        query: &mut Query,
        hit: &Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if let Some(substrate) = &self.substrate
            && query.half_space == face.inside()
        {
            return self.arrive_inside(substrate, face, leg, query, hit, batch);
        }
        let Some(geometry) = self.geometry_of(face) else {
            return;
        };
        let Some(hit) = hit else {
            match leg.way.step(geometry, query) {
                Some(end) => {
                    let direction = leg.way.world_direction();
                    let place = (face, query.half_space);
                    self.end(end, direction, place, &leg.light, &leg.errand, batch);
                }
                None => self.push(face, leg, *query, batch),
            }
            return;
        };
        batch.work.segments += 1;
        let light = &leg.light;
        let arrival = || Arrival {
            heading: leg.way.arrival(geometry, query, hit),
            facet: hit.facet,
        };
        match &leg.errand {
            Errand::Sight(at) => self.unlit(at, light, batch),
            Errand::Shadow => {
                let at = arrival();
                if query.half_space == self.incident {
                    self.unlit(&at, light, batch);
                }
                let behind = query.half_space.other();
                let errand = Errand::Shadow;
                self.set_out(face, at.heading, behind, *light, errand, batch);
            }
            Errand::Light => {
                self.unseen(leg.way.world_direction(), query.half_space, light, batch);
                self.meet(face, arrival(), query.half_space, light, batch);
            }
        }
    }

    /// What becomes of light that has come to a facet through `half_space`.
    #[inline]
    fn meet<R: Rng>(
        &self,
        face: Face,
        at: Arrival<G::Facet>,
        half_space: HalfSpace,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if light.path.order() >= self.settings.max_order {
            batch.record.add_loss(Loss::Truncated, light.flux);
            return;
        }
        match face {
            Face::Top => self.interact(&at, half_space, light, batch),
            Face::Bottom => self.interact_at_bottom(&at, half_space, light, batch),
        }
        if batch.record.control_variate().is_some() {
            self.look_into_shadow(at, half_space.other(), light, batch);
        }
    }

    /// Books a leg whose way, in the `direction` given, has ended without meeting the surface.
    fn end<R: Rng>(
        &self,
        end: TraversalEnd,
        direction: DVec3,
        (face, half_space): (Face, HalfSpace),
        light: &Light,
        errand: &Errand<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        batch.work.count(end);
        match errand {
            Errand::Light => {}
            Errand::Shadow => return,
            Errand::Sight(at) => return self.looked(end, light, at, batch),
        }
        match end {
            TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_) => {
                let exit = self.exit(direction, face, half_space, light);
                batch.record.add_exit(&exit);
                return;
            }
            TraversalEnd::LeftPatch => batch.record.add_loss(Loss::LeftPatch, light.flux),
            TraversalEnd::Lost => batch.record.add_loss(Loss::Lost, light.flux),
        }
        self.unseen(direction, half_space, light, batch);
    }

    /// What becomes of light that arrives at a facet through `half_space`.
    #[inline(always)]
    fn scattered(&self, at: &Arrival<G::Facet>, half_space: HalfSpace) -> Scattered {
        let m = half_space.sign() * self.geometry.normal(at.facet);
        let wi = -at.heading.direction;
        scatter(self.material, half_space == self.incident, wi, m)
    }

    /// Reflects, transmits or absorbs light that has arrived at a facet.
    #[inline]
    fn interact<R: Rng>(
        &self,
        at: &Arrival<G::Facet>,
        half_space: HalfSpace,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let scattered = self.scattered(at, half_space);
        let absorbed = light.flux * scattered.absorbed;
        if light.path.order() == 0 {
            batch.record.add_first_absorbed(absorbed);
        } else {
            batch.record.add_loss(Loss::Absorbed, absorbed);
        }
        let divides = self.material.transmitting_index().is_some();
        for (branch, share) in self.followed(&scattered, divides, batch.rng) {
            let (heading, half_space, mut light) = onward(at, half_space, light, &branch, share);
            if self.survives(&mut light, batch) {
                self.set_out_if_asked(heading, half_space, light, batch);
            }
        }
    }

    /// The branches that are followed, each with the share of the flux that it takes, of what `divides`
    /// light, or only reflects it.
    #[inline(always)]
    fn followed<R: Rng>(
        &self,
        scattered: &Scattered,
        divides: bool,
        rng: &mut R,
    ) -> impl Iterator<Item = (Branch, f64)> + use<'_, 'a, R, G> {
        let [transmitted, reflected] = scattered.branches;
        let shares = if divides && self.settings.branching == Branching::Pick {
            if rng.random::<f64>() < reflected.share {
                [0.0, 1.0]
            } else {
                [1.0, 0.0]
            }
        } else {
            [transmitted.share, reflected.share]
        };
        [transmitted, reflected]
            .into_iter()
            .zip(shares)
            .filter(|(_, share)| *share > 0.0)
    }

    /// Russian roulette: weak light goes on with a probability proportional to its flux, and then
    /// carries the threshold; false if it ends. What that removes or adds is booked as truncated, zero on average.
    ///
    /// Under a control the first branches are all followed: what cancels must not be left to chance.
    #[inline(always)]
    fn survives<R: Rng>(&self, light: &mut Light, batch: &mut Batch<'_, G::Facet, R>) -> bool {
        self.survives_below(self.settings.roulette_below, light, batch)
    }

    /// The same with another threshold.
    #[inline(always)]
    fn survives_below<R: Rng>(
        &self,
        threshold: f64,
        light: &mut Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) -> bool {
        let cancels = light.path.order() == 1 && batch.record.control_variate().is_some();
        if light.flux < threshold && !cancels {
            let survives = batch.rng.random::<f64>() * threshold < light.flux;
            let kept = if survives { threshold } else { 0.0 };
            batch.record.add_loss(Loss::Truncated, light.flux - kept);
            light.flux = kept;
        }
        light.flux > 0.0
    }

    /// Lets a branch set out, unless it can end only where nobody asks.
    ///
    /// A branch that has reached the highest order has no interaction left: it escapes on the side
    /// of its medium, or is truncated. If that side is not asked for, its flux is booked as such at
    /// once. A branch of lower order is always followed, since it may come back. This is decided
    /// after all random numbers of a branch are drawn, and one of the highest order draws no more, so
    /// what is recorded of a side does not depend on whether the other is asked for.
    #[inline(always)]
    fn set_out_if_asked<R: Rng>(
        &self,
        heading: Heading,
        half_space: HalfSpace,
        light: Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        // Inside a layer it may yet be absorbed, or come out elsewhere.
        let inside = self.substrate.is_some() && half_space == HalfSpace::Below;
        let last = light.path.order() >= self.settings.max_order && !inside;
        if last && !batch.record.records(self.side_of(Face::Top, half_space)) {
            batch.record.add_loss(Loss::NotRecorded, light.flux);
            self.unseen(heading.world_direction(), half_space, &light, batch);
            batch.work.branches_not_recorded += 1;
        } else {
            self.set_out(Face::Top, heading, half_space, light, Errand::Light, batch);
        }
    }

    /// The side on which light leaves that escapes from a face through `half_space`.
    fn side_of(&self, face: Face, half_space: HalfSpace) -> Side {
        if face == Face::Top && half_space == self.incident {
            Side::Reflected
        } else {
            Side::Transmitted
        }
    }
}
