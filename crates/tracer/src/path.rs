//! Light paths: from interaction to interaction until all flux has left.

use std::f64::consts::{PI, TAU};

use asperity_optics::{Fresnel, Incidence, Material, dielectric, reflect, refract};
use asperity_surface::Border;
use asperity_tally::{Azimuth, Event, EventPath, Exit, Layout, Loss, Record, Side};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};
use serde::{Deserialize, Serialize};

use crate::accelerator::Accelerator;
use crate::border::{Heading, Room, Travel, travel_together};
use crate::geometry::{Escape, Geometry};
use crate::morton::morton_square;
use crate::ray::Medium;

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

/// Incident rays that are followed together: enough to fill wide searches, few enough for their
/// paths and the surface around them to stay in cache.
const TOGETHER: usize = 2048;

/// Follows light that falls on a surface.
pub struct Tracer<'a, G: Geometry> {
    geometry: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    material: Material,
    incident: Medium,
    settings: PathSettings,
}

/// One stretch of a path that is still to be followed.
#[derive(Clone, Copy)]
struct Leg {
    heading: Heading,
    medium: Medium,
    flux: f64,
    path: EventPath,
    /// Cosine and sine of the angle by which what leaves is turned about the vertical.
    turn: DVec2,
}

/// The state of one batch.
struct Batch<'r, R> {
    record: Record,
    work: Work,
    rng: &'r mut R,
    /// What goes on from the legs that have just been followed.
    onward: Vec<Leg>,
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

    /// Traces one batch of `strata * strata` rays, one from each stratum of the mean plane.
    ///
    /// Light comes from `incidence`; with `any_azimuth` each ray comes from an azimuth of its own,
    /// uniformly drawn, and what leaves is turned back so that its azimuths are as if the light had
    /// come from that of `incidence`; of vertical light all azimuths are one, none is drawn, and what
    /// leaves is spread evenly over azimuth ([`Azimuth::Free`]). Returns flux fractions by `layout`, and the work done.
    ///
    /// Directions are those of the incident medium's frame: its side is +z, also when it is below
    /// the surface. Random numbers are drawn in an order that depends on the paths alone, so all
    /// accelerators give the same result.
    pub fn batch<R: Rng>(
        &self,
        incidence: Incidence,
        any_azimuth: bool,
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
        let turned = any_azimuth && !free;
        let mut batch = Batch {
            record: Record::new(layout, azimuth),
            work: Work::default(),
            rng,
            onward: Vec::new(),
        };
        let (mut legs, mut ends, mut room) = (Vec::new(), Vec::new(), Room::default());
        let mut places = morton_square(strata).peekable();
        while places.peek().is_some() {
            legs.clear();
            for place in places.by_ref().take(TOGETHER) {
                legs.push(self.incident_leg(place, strata, incidence, turned, batch.rng));
                batch.work.rays += 1;
            }
            while !legs.is_empty() {
                let rays = legs.iter().map(|leg: &Leg| (leg.heading, leg.medium));
                travel_together(self.geometry, self.accelerator, rays, &mut room, &mut ends);
                for (leg, end) in legs.drain(..).zip(&ends) {
                    self.arrive(leg, end, &mut batch);
                }
                std::mem::swap(&mut legs, &mut batch.onward);
            }
        }
        (batch.record.into_fractions(batch.work.rays), batch.work)
    }

    /// A ray from a random point of the stratum at `[column, row]` of `strata` by `strata`.
    fn incident_leg<R: Rng>(
        &self,
        [column, row]: [u32; 2],
        strata: u32,
        incidence: Incidence,
        turned: bool,
        rng: &mut R,
    ) -> Leg {
        let width = 1.0 / f64::from(strata);
        let u = (f64::from(column) + rng.random::<f64>()) * width;
        let v = (f64::from(row) + rng.random::<f64>()) * width;
        let (light, turn) = if turned {
            let phi = TAU * rng.random::<f64>();
            (incidence.at_azimuth(phi), incidence.phi() - phi)
        } else {
            (incidence, 0.0)
        };
        Leg {
            heading: self.start(light.wi(), u, v),
            medium: self.incident,
            flux: 1.0,
            path: EventPath::default(),
            turn: DVec2::from_angle(turn),
        }
    }

    /// The ray that would meet the mean plane at the fractions `(u, v)` of a period, started where
    /// it passes the highest point of the surface (the lowest, if it comes from below).
    fn start(&self, wi: DVec3, u: f64, v: f64) -> Heading {
        let surface = self.geometry;
        let wi = self.turned_upright(wi);
        // A mirrored tile and its images make a period of two tiles along each axis.
        let period = match surface.border() {
            Border::Mirrored => 2.0,
            Border::Periodic | Border::Open => 1.0,
        };
        let [cx, cy] = surface.extent().map(|e| e * period);
        let [low, high] = surface.z_range();
        let z = if self.incident == Medium::Above {
            high
        } else {
            low
        };
        let t = (z - surface.mean_plane()) / wi.z;
        let origin = DVec3::new(u * cx + t * wi.x, v * cy + t * wi.y * surface.aspect(), z);
        Heading {
            origin,
            direction: -wi,
            mirrored: [false; 2],
        }
    }

    /// Between the frame in which the incident medium is +z and that of the height field.
    fn turned_upright(&self, w: DVec3) -> DVec3 {
        DVec3::new(w.x, w.y, w.z * self.incident.sign())
    }

    /// Books what has left, and lets light that has met the surface go on from there.
    fn arrive<R: Rng>(&self, leg: Leg, end: &Travel<G::Facet>, batch: &mut Batch<'_, R>) {
        if let Travel::EscapedUnsearched(escape) = end {
            batch.work.segments_skipped += 1;
            let nearby = *escape == Escape::SteeperThanNear;
            batch.work.segments_skipped_nearby += u64::from(nearby);
        } else {
            batch.work.segments += 1;
        }
        match *end {
            Travel::Escaped | Travel::EscapedUnsearched(_) => {
                let wo = self.turned_upright(leg.heading.world_direction());
                let level = leg.turn.rotate(wo.truncate());
                batch.record.add_exit(&Exit {
                    side: self.side_of(leg.medium),
                    wo: level.extend(wo.z),
                    flux: leg.flux,
                    path: leg.path,
                });
            }
            Travel::LeftPatch => batch.record.add_loss(Loss::LeftPatch, leg.flux),
            Travel::Lost => batch.record.add_loss(Loss::Lost, leg.flux),
            Travel::Met(_, _) if leg.path.order() >= self.settings.max_order => {
                batch.record.add_loss(Loss::Truncated, leg.flux);
            }
            Travel::Met(hit, heading) => {
                let arrived = Leg { heading, ..leg };
                self.interact(&arrived, hit.facet, batch);
            }
        }
    }

    /// Reflects, transmits or absorbs light that has arrived at a facet.
    fn interact<R: Rng>(&self, leg: &Leg, facet: G::Facet, batch: &mut Batch<'_, R>) {
        let m = leg.medium.sign() * self.geometry.normal(facet);
        let wi = -leg.heading.direction;
        let cos_alpha = wi.dot(m).clamp(0.0, 1.0);
        let (fresnel, eta) = self.fresnel(leg.medium, cos_alpha);

        let onward = |event: Event, share: f64| {
            let (direction, medium) = match event {
                Event::Reflection => (reflect(wi, m), leg.medium),
                Event::Transmission => (refract(wi, m, eta, fresnel.cos_beta), leg.medium.other()),
            };
            Leg {
                heading: Heading {
                    direction,
                    ..leg.heading
                },
                medium,
                flux: leg.flux * share,
                path: leg.path.then(event),
                turn: leg.turn,
            }
        };
        let transmits = self.material.transmitting_index().is_some();
        if transmits && self.settings.branching == Branching::Pick {
            let event = if batch.rng.random::<f64>() < fresnel.reflected {
                Event::Reflection
            } else {
                Event::Transmission
            };
            self.push_if_asked(onward(event, 1.0), batch);
            return;
        }
        if transmits {
            if fresnel.transmitted > 0.0 {
                let leg = onward(Event::Transmission, fresnel.transmitted);
                self.push_or_end(leg, batch);
            }
        } else {
            batch
                .record
                .add_loss(Loss::Absorbed, leg.flux * fresnel.transmitted);
        }
        if fresnel.reflected > 0.0 {
            let leg = onward(Event::Reflection, fresnel.reflected);
            self.push_or_end(leg, batch);
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
    fn push_or_end<R: Rng>(&self, mut leg: Leg, batch: &mut Batch<'_, R>) {
        let threshold = self.settings.roulette_below;
        if leg.flux < threshold {
            let survives = batch.rng.random::<f64>() * threshold < leg.flux;
            let kept = if survives { threshold } else { 0.0 };
            batch.record.add_loss(Loss::Truncated, leg.flux - kept);
            if !survives {
                return;
            }
            leg.flux = kept;
        }
        self.push_if_asked(leg, batch);
    }

    /// Pushes a branch that goes on, unless it can end only where nobody asks.
    ///
    /// A branch that has reached the highest order has no interaction left: it escapes on the side
    /// of its medium, or is truncated. If that side is not asked for, its flux is booked as such at
    /// once. A branch of lower order is always followed, since it may come back. This is decided
    /// after all random numbers of a branch are drawn, and one of the highest order draws no more, so
    /// what is recorded of a side does not depend on whether the other is asked for.
    fn push_if_asked<R>(&self, leg: Leg, batch: &mut Batch<'_, R>) {
        let last = leg.path.order() >= self.settings.max_order;
        if last && !batch.record.asks(self.side_of(leg.medium)) {
            batch.record.add_loss(Loss::NotAsked, leg.flux);
            batch.work.branches_not_asked += 1;
        } else {
            batch.onward.push(leg);
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
