//! Light paths: from interaction to interaction until all flux has left.

use std::f64::consts::PI;

use asperity_optics::{Fresnel, Incidence, Material, dielectric, reflect, refract};
use asperity_tally::{Azimuth, Event, EventPath, Exit, Layout, Loss, Record, Side};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use crate::accelerator::{Accelerator, Query};
use crate::beam::Beam;
use crate::border::{End, Heading, Way, set_out};
use crate::geometry::{Escape, Geometry};
use crate::ray::{Hit, Medium};
use crate::sampling::{Sampling, Starts};

/// What happens where light is partly reflected and partly transmitted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Branching {
    /// Both branches are followed, each with its share of the flux.
    #[default]
    Split,
    /// One branch is picked at random, with the probability of its share, and carries all flux.
    Pick,
}

/// How paths are followed and ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSettings {
    branching: Branching,
    roulette_below: f64,
    max_order: u32,
}

/// Why path settings are refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PathSettingsError {
    /// The roulette threshold is out of range.
    #[error(
        "the roulette threshold is {0}; it must be from 1e-6 to 1, since split paths never end without roulette"
    )]
    BadRoulette(f64),
    /// No interaction is allowed.
    #[error("the highest order is 0; light must be allowed one interaction at least")]
    NoInteraction,
}

impl PathSettings {
    /// Roulette decides below 1 % of the incident flux.
    pub const DEFAULT_ROULETTE: f64 = 0.01;

    /// Interactions after which a path is truncated; light on a surface of s = 0.25 rarely has 100.
    pub const DEFAULT_MAX_ORDER: u32 = 1000;

    /// Settings for tracing.
    ///
    /// `roulette_below`: flux, as a fraction of the incident ray's, below which Russian roulette
    /// decides whether a branch goes on, from `1e-6` to `1`. `max_order`: interactions
    /// after which a path is ended and counted as truncated.
    ///
    /// # Errors
    /// [`PathSettingsError`] if the threshold is outside `[1e-6, 1]` or the order is zero.
    pub fn new(
        branching: Branching,
        roulette_below: f64,
        max_order: u32,
    ) -> Result<Self, PathSettingsError> {
        if !(1e-6..=1.0).contains(&roulette_below) {
            return Err(PathSettingsError::BadRoulette(roulette_below));
        }
        if max_order == 0 {
            return Err(PathSettingsError::NoInteraction);
        }
        Ok(Self {
            branching,
            roulette_below,
            max_order,
        })
    }
}

impl Default for PathSettings {
    /// Both branches, with the default roulette and bounce limit.
    fn default() -> Self {
        Self {
            branching: Branching::Split,
            roulette_below: Self::DEFAULT_ROULETTE,
            max_order: Self::DEFAULT_MAX_ORDER,
        }
    }
}

/// What was done, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Work {
    /// Incident rays.
    pub rays: u64,
    /// Segments searched for a hit.
    pub segments: u64,
    /// Segments that needed no search.
    pub segments_skipped: u64,
    /// Those of them that the slopes nearby excused, not those of the whole surface.
    pub segments_skipped_nearby: u64,
    /// Branches not followed, since they could end only on a side that is not asked for.
    pub branches_not_asked: u64,
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.segments += other.segments;
        self.segments_skipped += other.segments_skipped;
        self.segments_skipped_nearby += other.segments_skipped_nearby;
        self.branches_not_asked += other.branches_not_asked;
    }
}

/// Legs that are followed together: enough to fill wide searches, few enough for them and the surface
/// around them to stay in cache.
const TOGETHER: usize = 1024;

/// Follows light that falls on a surface.
pub struct Tracer<'a, G: Geometry> {
    geometry: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    incident: Medium,
    settings: PathSettings,
}

/// What light carries along its path.
#[derive(Clone, Copy)]
struct Light {
    flux: f64,
    path: EventPath,
    /// Cosine and sine of the angle by which what leaves is turned about the vertical.
    turn: DVec2,
}

/// One stretch of a path that is being followed.
struct Leg {
    way: Way,
    light: Light,
}

/// Legs that are next to be searched, and what to ask about each.
#[derive(Default)]
struct InFlight {
    queries: Vec<Query>,
    legs: Vec<Leg>,
}

/// The state of one batch.
struct Batch<'r, R> {
    record: Record,
    work: Work,
    rng: &'r mut R,
    next: InFlight,
    /// How many of the next legs may have another one behind them.
    lasting: usize,
}

impl<'a, G: Geometry> Tracer<'a, G> {
    /// A tracer for light that comes from the `incident` medium.
    ///
    /// The indices of `material` are relative to that medium, also where it lies below.
    #[must_use]
    pub const fn new(
        geometry: &'a G,
        accelerator: &'a dyn Accelerator<G>,
        material: Material,
        incident: Medium,
        settings: PathSettings,
    ) -> Self {
        Self {
            geometry,
            accelerator,
            material,
            incident,
            settings,
        }
    }

    /// Traces one batch of `strata * strata` rays, which `sampling` spreads over the mean plane and,
    /// where it is free, over azimuth.
    ///
    /// Light comes from `incidence`; with `any_azimuth` each ray comes from an azimuth of its own,
    /// uniform over all, and what leaves is turned back so that its azimuths are as if the light had
    /// come from that of `incidence`; of vertical light all azimuths are one, none is drawn, and what
    /// leaves is spread evenly over azimuth ([`Azimuth::Free`]). Returns flux fractions by `layout`, and the work done.
    ///
    /// Directions are those of the incident medium's frame: its side is +z, also when it is below
    /// the surface. Random numbers are drawn in an order that depends on the paths alone, so all
    /// accelerators give the same result.
    ///
    /// # Panics
    /// If `sampling` is quasi-random and `strata` is not a [`Sampling::quasi_random_strata`].
    pub fn batch<R: Rng>(
        &self,
        incidence: Incidence,
        any_azimuth: bool,
        sampling: Sampling,
        strata: u32,
        layout: Layout,
        rng: &mut R,
    ) -> (Vec<f64>, Work) {
        // Vertical light has no azimuth to draw.
        let free = any_azimuth && incidence.is_vertical();
        let azimuth = if free {
            Azimuth::Free
        } else {
            Azimuth::From(incidence.phi() + PI)
        };
        let mut starts = Starts::new(sampling, strata, any_azimuth && !free, rng);
        let mut batch = Batch {
            record: Record::new(layout, azimuth),
            work: Work::default(),
            rng,
            next: InFlight::default(),
            lasting: 0,
        };
        let beam = Beam::new(self.geometry, self.incident, incidence);
        let (mut now, mut hits) = (InFlight::default(), Vec::new());
        loop {
            // Legs that end in any case do not count, so that when a ray starts, and which random
            // numbers it draws, does not depend on whether they are followed; see `set_out_if_asked`.
            while batch.lasting < TOGETHER
                && let Some(start) = starts.draw(batch.rng)
            {
                let (heading, turn) = beam.ray(start);
                let light = Light {
                    flux: 1.0,
                    path: EventPath::default(),
                    turn,
                };
                self.set_out(heading, self.incident, light, &mut batch);
                batch.work.rays += 1;
            }
            std::mem::swap(&mut now, &mut batch.next);
            batch.lasting = 0;
            if now.legs.is_empty() {
                break;
            }
            self.accelerator
                .closest_hits(self.geometry, &now.queries, &mut hits);
            for ((leg, query), hit) in now.legs.iter_mut().zip(&mut now.queries).zip(&hits) {
                self.arrive(leg, query, hit, &mut batch);
            }
            now.legs.clear();
            now.queries.clear();
        }
        (batch.record.into_fractions(batch.work.rays), batch.work)
    }

    /// Between the frame in which the incident medium is +z and that of the height field.
    fn turned_upright(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.x, w.y, w.z * self.incident.sign())
    }

    /// Lets light go its way, or books it at once if it meets nothing.
    fn set_out<R: Rng>(
        &self,
        mut heading: Heading,
        medium: Medium,
        light: Light,
        batch: &mut Batch<'_, R>,
    ) {
        if let Some(end) = set_out(self.geometry, &mut heading, medium) {
            self.book(end, heading.world_direction(), medium, &light, batch);
        } else {
            let way = Way::new(&heading);
            let query = heading.query(self.geometry, medium);
            self.push(Leg { way, light }, query, batch);
        }
    }

    /// Has a leg searched next.
    fn push<R>(&self, leg: Leg, query: Query, batch: &mut Batch<'_, R>) {
        batch.lasting += usize::from(leg.light.path.order() < self.settings.max_order);
        batch.next.legs.push(leg);
        batch.next.queries.push(query);
    }

    /// Lets light go on from what it has met in the current tile, be it nothing.
    fn arrive<R: Rng>(
        &self,
        leg: &mut Leg,
        query: &mut Query,
        hit: &Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, R>,
    ) {
        let Leg { way, light } = leg;
        match hit {
            Some(_) if light.path.order() >= self.settings.max_order => {
                batch.work.segments += 1;
                batch.record.add_loss(Loss::Truncated, light.flux);
            }
            Some(hit) => {
                batch.work.segments += 1;
                let heading = way.arrival(self.geometry, query, hit);
                self.interact(&heading, query.medium, light, hit.facet, batch);
            }
            None => match way.go_on(self.geometry, query) {
                Some(end) => {
                    self.book(end, way.world_direction(), query.medium, light, batch);
                }
                None => {
                    let leg = Leg {
                        way: way.take(),
                        light: *light,
                    };
                    self.push(leg, *query, batch);
                }
            },
        }
    }

    /// Books light whose way, in the `direction` given, has ended without meeting the surface.
    fn book<R>(
        &self,
        end: End,
        direction: DVec3,
        medium: Medium,
        light: &Light,
        batch: &mut Batch<'_, R>,
    ) {
        if let End::EscapedUnsearched(escape) = end {
            batch.work.segments_skipped += 1;
            let nearby = escape == Escape::SteeperThanNear;
            batch.work.segments_skipped_nearby += u64::from(nearby);
        } else {
            batch.work.segments += 1;
        }
        match end {
            End::Escaped | End::EscapedUnsearched(_) => {
                let wo = self.turned_upright(direction);
                let level = light.turn.rotate(wo.truncate());
                batch.record.add_exit(&Exit {
                    side: self.side_of(medium),
                    wo: level.extend(wo.z),
                    flux: light.flux,
                    path: light.path,
                });
            }
            End::LeftPatch => batch.record.add_loss(Loss::LeftPatch, light.flux),
            End::Lost => batch.record.add_loss(Loss::Lost, light.flux),
        }
    }

    /// Reflects, transmits or absorbs light that has arrived at a facet.
    fn interact<R: Rng>(
        &self,
        arrived: &Heading,
        medium: Medium,
        light: &Light,
        facet: G::Facet,
        batch: &mut Batch<'_, R>,
    ) {
        let m = medium.sign() * self.geometry.normal(facet);
        let wi = -arrived.direction;
        let cos_alpha = wi.dot(m).clamp(0.0, 1.0);
        let (fresnel, eta) = self.fresnel(medium, cos_alpha);

        let onward = |event: Event, share: f64| {
            let (direction, medium) = match event {
                Event::Reflection => (reflect(wi, m), medium),
                Event::Transmission => (refract(wi, m, eta, fresnel.cos_beta), medium.other()),
            };
            let heading = Heading {
                direction,
                ..*arrived
            };
            let light = Light {
                flux: light.flux * share,
                path: light.path.then(event),
                turn: light.turn,
            };
            (heading, medium, light)
        };
        let transmits = self.material.transmitting_index().is_some();
        if transmits && self.settings.branching == Branching::Pick {
            let event = if batch.rng.random::<f64>() < fresnel.reflected {
                Event::Reflection
            } else {
                Event::Transmission
            };
            let (heading, medium, light) = onward(event, 1.0);
            self.set_out_if_asked(heading, medium, light, batch);
            return;
        }
        if transmits {
            if fresnel.transmitted > 0.0 {
                let (heading, medium, light) = onward(Event::Transmission, fresnel.transmitted);
                self.set_out_or_end(heading, medium, light, batch);
            }
        } else {
            batch
                .record
                .add_loss(Loss::Absorbed, light.flux * fresnel.transmitted);
        }
        if fresnel.reflected > 0.0 {
            let (heading, medium, light) = onward(Event::Reflection, fresnel.reflected);
            self.set_out_or_end(heading, medium, light, batch);
        }
    }

    /// Fresnel terms for light that arrives in `medium`, and the relative index behind the facet.
    fn fresnel(&self, medium: Medium, cos_alpha: f64) -> (Fresnel, f64) {
        match self.material.transmitting_index() {
            Some(eta) if medium != self.incident => {
                let eta = 1.0 / eta;
                (dielectric(cos_alpha, eta), eta)
            }
            Some(eta) => (dielectric(cos_alpha, eta), eta),
            None => (self.material.fresnel(cos_alpha), 1.0),
        }
    }

    /// Russian roulette: a weak branch goes on with a probability proportional to its flux, and then
    /// carries the threshold. What that removes or adds is booked as truncated, zero on average.
    fn set_out_or_end<R: Rng>(
        &self,
        heading: Heading,
        medium: Medium,
        mut light: Light,
        batch: &mut Batch<'_, R>,
    ) {
        let threshold = self.settings.roulette_below;
        if light.flux < threshold {
            let survives = batch.rng.random::<f64>() * threshold < light.flux;
            let kept = if survives { threshold } else { 0.0 };
            batch.record.add_loss(Loss::Truncated, light.flux - kept);
            if !survives {
                return;
            }
            light.flux = kept;
        }
        self.set_out_if_asked(heading, medium, light, batch);
    }

    /// Lets a branch set out, unless it can end only where nobody asks.
    ///
    /// A branch that has reached the highest order has no interaction left: it escapes on the side
    /// of its medium, or is truncated. If that side is not asked for, its flux is booked as such at
    /// once. A branch of lower order is always followed, since it may come back. This is decided
    /// after all random numbers of a branch are drawn, and one of the highest order draws no more, so
    /// what is recorded of a side does not depend on whether the other is asked for.
    fn set_out_if_asked<R: Rng>(
        &self,
        heading: Heading,
        medium: Medium,
        light: Light,
        batch: &mut Batch<'_, R>,
    ) {
        let last = light.path.order() >= self.settings.max_order;
        if last && !batch.record.asks(self.side_of(medium)) {
            batch.record.add_loss(Loss::NotAsked, light.flux);
            batch.work.branches_not_asked += 1;
        } else {
            self.set_out(heading, medium, light, batch);
        }
    }

    /// The side on which light leaves that escapes through `medium`.
    fn side_of(&self, medium: Medium) -> Side {
        if medium == self.incident {
            Side::Reflected
        } else {
            Side::Transmitted
        }
    }
}
