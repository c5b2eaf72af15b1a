//! Paths followed one after another, depth first, and watched on their way.
//!
//! This is the plain reference of `Tracer::batch`, which follows many rays together.

use std::fmt::Debug;

use asperity_optics::{Incidence, Material, dielectric, reflect, refract};
use asperity_surface::Border;
use asperity_tally::{Event, EventPath};
use asperity_tracer::{Accelerator, Branching, Geometry, HalfSpace, PathStream, TileRay};
use asperity_tracer::{Heading, TraversalEnd, TraversalResult, traverse};
use glam::DVec3;

use crate::ground::Ground;
use crate::stressed::Stressed;

/// Columns and rows of a segment that are watched at either end of it.
const WATCHED: f64 = 2000.0;

/// A stretch of a path that is still to be followed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment<F> {
    pub(crate) heading: Heading,
    pub(crate) half_space: HalfSpace,
    /// The facet that it has just left.
    pub(crate) last: Option<F>,
    flux: f64,
    order: usize,
    transmissions: u32,
    path: EventPath,
}

/// Method by which segments are traced.
pub(crate) trait Scheme<G: Geometry>: Sync {
    /// Follows a segment to where it meets the surface or leaves it.
    fn follow(&self, surface: &G, segment: &Segment<G::Facet>) -> TraversalResult<G::Facet>;

    /// Start of light that continues from `origin` on a facet with the unit normal `away`, on the side that it goes to.
    fn depart(&self, origin: DVec3, _away: DVec3) -> DVec3 {
        origin
    }
}

/// Culling by side: the method of asperity.
pub(crate) struct BySide<'a, G>(pub(crate) &'a dyn Accelerator<G>);

impl<G: Geometry> Scheme<G> for BySide<'_, G> {
    fn follow(&self, surface: &G, segment: &Segment<G::Facet>) -> TraversalResult<G::Facet> {
        traverse(surface, self.0, segment.heading, segment.half_space)
    }
}

/// Material of the surface, and the limits that end a path.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Light {
    pub(crate) material: Material,
    pub(crate) incident: HalfSpace,
    pub(crate) branching: Branching,
    /// Split branches weaker than this end, booked as truncated; there is no roulette.
    pub(crate) weakest: f64,
    pub(crate) max_order: usize,
}

/// Fate of the light, and the errors that were seen.
#[derive(Clone, Debug, Default)]
pub(crate) struct Account {
    pub(crate) rays: u64,
    pub(crate) segments: u64,
    /// Flux that left, by side (reflected, transmitted) and order.
    pub(crate) by_order: [Vec<f64>; 2],
    pub(crate) absorbed: f64,
    pub(crate) truncated: f64,
    pub(crate) left_patch: f64,
    pub(crate) lost: f64,
    /// Segments that ended as lost.
    pub(crate) lost_segments: u64,
    /// Branches that ended for being weak: roulette would have been asked.
    pub(crate) weak: u64,
    /// Segments on the wrong side of the surface, hits from the wrong side, exits to the wrong side.
    pub(crate) wrong_sides: u64,
    /// The first fault, in words with which it can be replayed.
    pub(crate) first_fault: Option<String>,
}

impl Account {
    pub(crate) fn left(&self, side: usize) -> f64 {
        self.by_order[side].iter().sum()
    }

    /// Everything booked, in rays.
    pub(crate) fn total(&self) -> f64 {
        let ended = self.absorbed + self.truncated + self.left_patch + self.lost;
        self.left(0) + self.left(1) + ended
    }

    pub(crate) fn add(&mut self, other: &Self) {
        self.rays += other.rays;
        self.segments += other.segments;
        for (all, own) in self.by_order.iter_mut().zip(&other.by_order) {
            all.resize(all.len().max(own.len()), 0.0);
            all.iter_mut().zip(own).for_each(|(a, b)| *a += b);
        }
        self.absorbed += other.absorbed;
        self.truncated += other.truncated;
        self.left_patch += other.left_patch;
        self.lost += other.lost;
        self.lost_segments += other.lost_segments;
        self.weak += other.weak;
        self.wrong_sides += other.wrong_sides;
        if self.first_fault.is_none() {
            self.first_fault.clone_from(&other.first_fault);
        }
    }

    fn leave(&mut self, side: usize, order: usize, flux: f64) {
        let orders = &mut self.by_order[side];
        orders.resize(orders.len().max(order + 1), 0.0);
        orders[order] += flux;
    }

    fn fault<F: Debug>(&mut self, segment: &Segment<F>, what: &str) {
        self.wrong_sides += 1;
        self.first_fault
            .get_or_insert_with(|| format!("{what}: {segment:?}"));
    }
}

/// The ray that would meet the mean plane at the fractions `(u, v)` of a period (of two tiles along
/// each axis, if they are mirrored), started at the height of the highest point, or the lowest.
pub(crate) fn start<G: Geometry>(
    surface: &G,
    light: &Light,
    incidence: Incidence,
    u: f64,
    v: f64,
) -> Heading {
    let tiles = match surface.border() {
        Border::Mirrored => 2.0,
        Border::Periodic | Border::Open => 1.0,
    };
    let [cx, cy] = surface.extent();
    let target = DVec3::new(u * tiles * cx, v * tiles * cy, surface.mean_plane());
    start_towards(surface, light, incidence, target)
}

/// The ray that would meet `target`, started at the height of the highest point, or the lowest.
pub(crate) fn start_towards<G: Geometry>(
    surface: &G,
    light: &Light,
    incidence: Incidence,
    target: DVec3,
) -> Heading {
    let q = light.incident.sign();
    let wi = incidence.wi() * DVec3::new(1.0, 1.0, q);
    let z = q * surface.z_range()[1];
    let t = (z - target.z) / wi.z;
    Heading {
        origin: DVec3::new(
            target.x + t * wi.x,
            target.y + t * wi.y * surface.aspect(),
            z,
        ),
        direction: -wi,
        mirrored: [false; 2],
    }
}

/// The random numbers of a path.
#[derive(Clone, Copy)]
pub(crate) struct Numbers {
    pub(crate) stream: PathStream,
    pub(crate) ray: u32,
}

impl Numbers {
    /// The number that picks a branch at the end of a segment.
    fn pick<F>(self, segment: &Segment<F>) -> f64 {
        let [pick, _] = self.stream.of_interaction(self.ray, segment.path, 0);
        pick
    }
}

/// Follows one incident ray and all that comes of it.
pub(crate) fn walk<G: Stressed>(
    surface: &G,
    scheme: &dyn Scheme<G>,
    light: &Light,
    heading: Heading,
    numbers: Numbers,
) -> Account {
    let mut account = Account {
        rays: 1,
        ..Account::default()
    };
    let ground = Ground::across_tiles(surface);
    let mut segments = vec![Segment {
        heading,
        half_space: light.incident,
        last: None,
        flux: 1.0,
        order: 0,
        transmissions: 0,
        path: EventPath::default(),
    }];
    while let Some(segment) = segments.pop() {
        account.segments += 1;
        let end = scheme.follow(surface, &segment);
        watch(surface, &ground, light, &segment, &end, &mut account);
        match end {
            TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_)) => {
                let side = usize::from(segment.half_space != light.incident);
                account.leave(side, segment.order, segment.flux);
            }
            TraversalResult::Ended(TraversalEnd::LeftPatch) => account.left_patch += segment.flux,
            TraversalResult::Ended(TraversalEnd::Lost) => {
                account.lost += segment.flux;
                account.lost_segments += 1;
                account
                    .first_fault
                    .get_or_insert_with(|| format!("lost: {segment:?}"));
            }
            TraversalResult::Hit(..) if segment.order >= light.max_order => {
                account.truncated += segment.flux
            }
            TraversalResult::Hit(hit, met) => {
                let arrived = Segment {
                    heading: met,
                    last: Some(hit.facet),
                    ..segment
                };
                interact(
                    surface,
                    scheme,
                    light,
                    &arrived,
                    numbers,
                    &mut segments,
                    &mut account,
                );
            }
        }
    }
    account
}

/// Reflects, transmits or absorbs light that has arrived at the facet `segment.last`.
fn interact<G: Stressed>(
    surface: &G,
    scheme: &dyn Scheme<G>,
    light: &Light,
    segment: &Segment<G::Facet>,
    numbers: Numbers,
    segments: &mut Vec<Segment<G::Facet>>,
    account: &mut Account,
) {
    let Some(facet) = segment.last else { return };
    let wi = -segment.heading.direction;
    let mut m = segment.half_space.sign() * surface.normal_at(facet, segment.heading.origin);
    if wi.dot(m) < -surface.grazing(0.0) {
        account.fault(segment, "hit from the wrong side");
        m = -m;
    }
    let cos_theta_i = wi.dot(m).clamp(0.0, 1.0);
    let index = light.material.transmitting_index().map(|eta| {
        if segment.half_space == light.incident {
            eta
        } else {
            1.0 / eta
        }
    });
    let fresnel = match index {
        Some(eta) => dielectric(cos_theta_i, eta),
        None => light.material.fresnel(cos_theta_i),
    };

    let mut push = |direction: DVec3, half_space, share: f64, event| {
        let flux = segment.flux * share;
        if flux < light.weakest && light.branching == Branching::Split {
            account.truncated += flux;
            account.weak += u64::from(flux > 0.0);
            return;
        }
        let away = m * direction.dot(m).signum();
        segments.push(Segment {
            heading: Heading {
                origin: scheme.depart(segment.heading.origin, away),
                direction,
                mirrored: segment.heading.mirrored,
            },
            half_space,
            flux,
            order: segment.order + 1,
            transmissions: segment.transmissions + u32::from(event == Event::Transmission),
            path: segment.path.then(event),
            ..*segment
        });
    };
    let [reflected, transmitted] = match (index, light.branching) {
        (Some(_), Branching::Pick) if numbers.pick(segment) < fresnel.reflected => [1.0, 0.0],
        (Some(_), Branching::Pick) => [0.0, 1.0],
        _ => [fresnel.reflected, fresnel.transmitted],
    };
    match index {
        Some(eta) if transmitted > 0.0 => {
            let direction = refract(wi, m, eta, fresnel.cos_theta_t);
            push(
                direction,
                segment.half_space.other(),
                transmitted,
                Event::Transmission,
            );
        }
        _ => {}
    }
    if reflected > 0.0 {
        push(
            reflect(wi, m),
            segment.half_space,
            reflected,
            Event::Reflection,
        );
    }
    if index.is_none() {
        account.absorbed += segment.flux * transmitted;
    }
}

/// Notes where a segment is not in the half space that it claims.
fn watch<G: Stressed>(
    surface: &G,
    ground: &Ground<'_, G>,
    light: &Light,
    segment: &Segment<G::Facet>,
    end: &TraversalResult<G::Facet>,
    account: &mut Account,
) {
    let d = segment.heading.direction;
    let ray = TileRay {
        origin: segment.heading.origin,
        direction: DVec3::new(d.x, d.y * surface.aspect(), d.z),
    };
    let q = segment.half_space.sign();
    let to = match end {
        TraversalResult::Hit(hit, met) => {
            if let Some(depth) = ground.off_surface(&ray, hit.t) {
                account.fault(
                    segment,
                    &format!("hit {depth:e} off the surface at {met:?}"),
                );
            }
            hit.t
        }
        TraversalResult::Ended(TraversalEnd::Escaped | TraversalEnd::EscapedUnsearched(_)) => {
            let up = segment.heading.world_direction().z * light.incident.sign() > 0.0;
            if up != segment.transmissions.is_multiple_of(2) || q * d.z <= 0.0 {
                account.fault(segment, "exit to the wrong side");
                return;
            }
            ((q * surface.z_range()[1] - ray.origin.z) / d.z).max(0.0)
        }
        TraversalResult::Ended(TraversalEnd::LeftPatch | TraversalEnd::Lost) => return,
    };
    // All of a short segment, both ends of a long one.
    let speed = ray.direction.x.abs() + ray.direction.y.abs();
    let watched = WATCHED / speed;
    let stretches = if to <= 2.0 * watched {
        vec![[0.0, to]]
    } else {
        vec![[0.0, watched], [to - watched, to]]
    };
    for stretch in stretches {
        if let Some(breach) = ground.breach(&ray, segment.half_space, stretch) {
            account.fault(segment, &format!("{breach:?} on the way to {end:?}"));
            return;
        }
    }
}
