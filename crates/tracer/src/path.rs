//! Light paths: from interaction to interaction until all flux has left.

mod hidden;
mod illumination;
mod leg;
mod work;

use std::f64::consts::{PI, TAU};

use asperity_optics::Material;
use asperity_tally::{Azimuth, Control, EventPath, Exit, History, Layout, Loss, Record, Side};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};

use crate::accelerator::{Accelerator, Query};
use crate::beam::Beam;
use crate::border::{End, Heading, Way, set_out};
use crate::geometry::Geometry;
use crate::path_settings::{Branching, PathSettings};
use crate::ray::{Hit, Medium};
use crate::sampling::Places;
use crate::scatter::{Scattered, scatter};

pub use illumination::{Illumination, Starts};
pub use work::Work;

use leg::{Arrival, Errand, InFlight, Leg, Light, onward};

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

/// The state of one batch.
struct Batch<'r, F, R> {
    record: Record<'r>,
    work: Work,
    rng: &'r mut R,
    next: InFlight<F>,
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

    /// Traces one batch of `strata * strata` rays.
    ///
    /// Returns flux fractions by `layout`, and the work done; under a `control`, the fractions that it
    /// leaves, which [`Control::complete`] turns into flux fractions.
    ///
    /// Directions are those of the incident medium's frame: its side is +z, also when it is below
    /// the surface. Random numbers are drawn in an order that depends on the paths alone, so all
    /// accelerators give the same result.
    ///
    /// # Panics
    /// If the sampling is quasi-random and `strata` is not a [`crate::Sampling::quasi_random_strata`].
    pub fn batch<R: Rng>(
        &self,
        illumination: &Illumination,
        strata: u32,
        layout: Layout,
        control: Option<&Control>,
        rng: &mut R,
    ) -> (Vec<f64>, Work) {
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
            record: Record::new(layout, azimuth).under(control),
            work: Work::default(),
            rng,
            next: InFlight::new(),
            lasting: 0,
        };
        let beam = Beam::new(self.geometry, self.incident, incidence);
        let (mut now, mut hits) = (InFlight::new(), Vec::new());
        loop {
            // Legs that end in any case do not count, so that when a ray starts, and which random
            // numbers it draws, does not depend on whether they are followed; see `set_out_if_asked`.
            while batch.lasting < TOGETHER
                && let Some([u, v, azimuth]) = places.draw(batch.rng)
            {
                let turn = DVec2::from_angle(TAU * azimuth);
                self.start(&beam, illumination.starts, [u, v], turn, &mut batch);
                batch.work.rays += 1;
            }
            std::mem::swap(&mut now, &mut batch.next);
            batch.lasting = 0;
            if now.legs.is_empty() {
                break;
            }
            self.accelerator
                .closest_hits(self.geometry, &now.queries, &mut hits);
            for ((leg, query), hit) in now.legs.drain(..).zip(&mut now.queries).zip(&hits) {
                self.arrive(leg, query, hit, &mut batch);
            }
            now.queries.clear();
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
                self.set_out(heading, self.incident, light(1.0), Errand::Light, batch);
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

    /// Light that leaves in the `direction` given, or would.
    fn exit(&self, direction: DVec3, medium: Medium, light: &Light) -> Exit {
        let wo = self.turned_upright(direction);
        let level = light.turn.rotate(wo.truncate());
        Exit {
            side: self.side_of(medium),
            wo: level.extend(wo.z),
            flux: light.flux,
            path: light.path,
            history: History::of(light.scatterings),
        }
    }

    /// Lets a leg begin, or ends it at once if it meets nothing.
    fn set_out<R: Rng>(
        &self,
        mut heading: Heading,
        medium: Medium,
        light: Light,
        errand: Errand<G::Facet>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        if let Some(end) = set_out(self.geometry, &mut heading, medium) {
            self.end(
                end,
                heading.world_direction(),
                medium,
                &light,
                &errand,
                batch,
            );
        } else {
            let way = Way::new(&heading);
            let query = heading.query(self.geometry, medium);
            self.push(Leg { way, light, errand }, query, batch);
        }
    }

    /// Has a leg searched next.
    #[inline]
    fn push<R>(&self, leg: Leg<G::Facet>, query: Query, batch: &mut Batch<'_, G::Facet, R>) {
        let last = matches!(leg.errand, Errand::Light)
            && leg.light.path.order() >= self.settings.max_order;
        batch.lasting += usize::from(!last);
        batch.next.legs.push(leg);
        batch.next.queries.push(query);
    }

    /// Goes on from what a leg has met in the current tile, be it nothing.
    fn arrive<R: Rng>(
        &self,
        mut leg: Leg<G::Facet>,
        query: &mut Query,
        hit: &Option<Hit<G::Facet>>,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let Some(hit) = hit else {
            match leg.way.go_on(self.geometry, query) {
                Some(end) => {
                    let direction = leg.way.world_direction();
                    self.end(end, direction, query.medium, &leg.light, &leg.errand, batch);
                }
                None => self.push(leg, *query, batch),
            }
            return;
        };
        batch.work.segments += 1;
        let light = &leg.light;
        let arrival = || Arrival {
            heading: leg.way.arrival(self.geometry, query, hit),
            facet: hit.facet,
        };
        match &leg.errand {
            Errand::Sight(at) => self.unlit(at, light, batch),
            Errand::Shadow => {
                let at = arrival();
                if query.medium == self.incident {
                    self.unlit(&at, light, batch);
                }
                let behind = query.medium.other();
                self.set_out(at.heading, behind, *light, Errand::Shadow, batch);
            }
            Errand::Light => {
                self.unseen(leg.way.world_direction(), query.medium, light, batch);
                if light.path.order() >= self.settings.max_order {
                    batch.record.add_loss(Loss::Truncated, light.flux);
                    return;
                }
                let at = arrival();
                self.interact(&at, query.medium, light, batch);
                if batch.record.control().is_some() {
                    self.look_into_shadow(at, query.medium.other(), light, batch);
                }
            }
        }
    }

    /// Books a leg whose way, in the `direction` given, has ended without meeting the surface.
    fn end<R: Rng>(
        &self,
        end: End,
        direction: DVec3,
        medium: Medium,
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
            End::Escaped | End::EscapedUnsearched(_) => {
                batch.record.add_exit(&self.exit(direction, medium, light));
                return;
            }
            End::LeftPatch => batch.record.add_loss(Loss::LeftPatch, light.flux),
            End::Lost => batch.record.add_loss(Loss::Lost, light.flux),
        }
        self.unseen(direction, medium, light, batch);
    }

    /// What becomes of light that arrives at a facet through `medium`.
    #[inline(always)]
    fn scattered(&self, at: &Arrival<G::Facet>, medium: Medium) -> Scattered {
        let m = medium.sign() * self.geometry.normal(at.facet);
        let wi = -at.heading.direction;
        scatter(self.material, medium == self.incident, wi, m)
    }

    /// Reflects, transmits or absorbs light that has arrived at a facet.
    #[inline]
    fn interact<R: Rng>(
        &self,
        at: &Arrival<G::Facet>,
        medium: Medium,
        light: &Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let scattered = self.scattered(at, medium);
        let transmits = self.material.transmitting_index().is_some();
        if transmits && self.settings.branching == Branching::Pick {
            let [transmitted, reflected] = &scattered.branches;
            let picked = if batch.rng.random::<f64>() < reflected.share {
                reflected
            } else {
                transmitted
            };
            let (heading, medium, light) = onward(at, medium, light, picked, 1.0);
            self.set_out_if_asked(heading, medium, light, batch);
            return;
        }
        let absorbed = light.flux * scattered.absorbed;
        if light.path.order() == 0 {
            batch.record.add_first_absorbed(absorbed);
        } else {
            batch.record.add_loss(Loss::Absorbed, absorbed);
        }
        for branch in &scattered.branches {
            if branch.share > 0.0 {
                let (heading, medium, light) = onward(at, medium, light, branch, branch.share);
                self.set_out_or_end(heading, medium, light, batch);
            }
        }
    }

    /// Russian roulette: a weak branch goes on with a probability proportional to its flux, and then
    /// carries the threshold. What that removes or adds is booked as truncated, zero on average.
    ///
    /// Under a control the first branches are all followed: what cancels must not be left to chance.
    #[inline(always)]
    fn set_out_or_end<R: Rng>(
        &self,
        heading: Heading,
        medium: Medium,
        mut light: Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let threshold = self.settings.roulette_below;
        let cancels = light.path.order() == 1 && batch.record.control().is_some();
        if light.flux < threshold && !cancels {
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
    #[inline(always)]
    fn set_out_if_asked<R: Rng>(
        &self,
        heading: Heading,
        medium: Medium,
        light: Light,
        batch: &mut Batch<'_, G::Facet, R>,
    ) {
        let last = light.path.order() >= self.settings.max_order;
        if last && !batch.record.asks(self.side_of(medium)) {
            batch.record.add_loss(Loss::NotAsked, light.flux);
            self.unseen(heading.world_direction(), medium, &light, batch);
            batch.work.branches_not_asked += 1;
        } else {
            self.set_out(heading, medium, light, Errand::Light, batch);
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
