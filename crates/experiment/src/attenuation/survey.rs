//! One surface surveyed: which of its points face, see and are seen, counted.

use std::ops::AddAssign;

use asperity_optics::{Incidence, reflect};
use asperity_surface::HeightField;
use asperity_tracer::{
    Accelerator, AcceleratorKind, Facet, Geometry, Horizon, Horizons, Look, Sight, Surface, look,
};
use rand::{Rng, RngExt};
use rayon::prelude::*;

use super::config::{Plan, Way};
use super::heights::{self, BINS};
use super::{AttenuationConfig, AttenuationError};
use crate::limits::{RunError, check_grazing};
use crate::progress::Progress;
use crate::stream::point_stream;

/// Facets whose points share a random stream and are surveyed together.
const CHUNK: usize = 1 << 13;

/// Points that face a direction, and those of them that see it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    pub(super) facing: u64,
    pub(super) free: u64,
}

impl AddAssign for Seen {
    fn add_assign(&mut self, other: Self) {
        self.facing += other.facing;
        self.free += other.free;
    }
}

/// Projected areas of points that face a direction, and of those that see it, over that of the mean plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Area {
    pub(super) facing: f64,
    pub(super) free: f64,
}

/// What was counted on a surface, or on a part of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Counts {
    pub(super) points: u64,
    /// One a light.
    pub(super) lights: Vec<Seen>,
    /// The same lights' projected areas, each point having one of the mean plane.
    pub(super) areas: Vec<Area>,
    /// One a view.
    pub(super) views: Vec<Seen>,
    /// Points that face both directions, and those of them that are lit and seen; views of one light after
    /// the other.
    pub(super) pairs: Vec<Seen>,
    /// Lit points whose mirrored ray gets away, one a light.
    pub(super) mirrored: Vec<u64>,
    /// Points that face a light and are lit, by their height; the bins of one light after the other.
    pub(super) heights: Vec<Seen>,
    /// Looks of which it cannot be told what they see.
    pub(super) lost: u64,
}

impl Counts {
    fn add(mut self, other: Self) -> Self {
        if self.points == 0 {
            return other;
        }
        let sum = |into: &mut Vec<Seen>, from: &[Seen]| {
            into.iter_mut().zip(from).for_each(|(a, b)| *a += *b);
        };
        self.points += other.points;
        sum(&mut self.lights, &other.lights);
        sum(&mut self.views, &other.views);
        sum(&mut self.pairs, &other.pairs);
        sum(&mut self.heights, &other.heights);
        for (a, b) in self.areas.iter_mut().zip(&other.areas) {
            a.facing += b.facing;
            a.free += b.free;
        }
        let mirrored = self.mirrored.iter_mut().zip(&other.mirrored);
        mirrored.for_each(|(a, b)| *a += b);
        self.lost += other.lost;
        self
    }
}

/// What was found on one realisation.
pub(super) struct Surveyed {
    /// One a sigma.
    pub(super) counts: Vec<Counts>,
    /// Horizons along the azimuth of the lights, on the surface of the first sigma, and the least rise that
    /// they tell apart.
    pub(super) horizons: Option<(Vec<Horizon>, f64)>,
}

/// Surveys the surfaces of realisation `index`, one a sigma; `None` if the run is to stop.
///
/// They are one surface at several scales of height, and so are their horizons: these are found once.
pub(super) fn survey(
    config: &AttenuationConfig,
    plan: &Plan,
    index: u64,
    progress: &dyn Progress,
) -> Result<Option<Surveyed>, AttenuationError> {
    let run = &config.run;
    let draw = |sigma: usize| -> Result<Surface, AttenuationError> {
        let field: HeightField = plan.recipes[sigma].draw(run.seed, index)?;
        Ok(Surface::new(field.with_border(plan.border)))
    };
    let first = draw(0)?;
    let least = least_rise(config, plan);
    let horizons = if plan.needs_horizons(run) {
        Some(find_horizons(config, plan, &first, index, least)?)
    } else {
        None
    };
    let mut counts = Vec::new();
    let mut drawn = Some(first);
    for sigma in 0..plan.sigmas.len() {
        if progress.stop().is_some() {
            return Ok(None);
        }
        let surface = match drawn.take() {
            Some(first) => first,
            None => draw(sigma)?,
        };
        for light in plan.lights.iter().chain(&plan.views) {
            check_grazing(&surface, *light)?;
        }
        let accelerator = surface
            .accelerator(AcceleratorKind::Auto)
            .map_err(RunError::from)?;
        let site = Site {
            config,
            plan,
            sigma: plan.sigmas[sigma],
            surface: &surface,
            accelerator: &*accelerator,
            horizons: horizons.as_deref().filter(|_| plan.way == Way::Horizons),
            steeper: plan.sigmas[sigma] / plan.sigmas[0],
            azimuths: plan.azimuths(),
            index,
        };
        counts.push(site.count());
        progress.advance(1);
    }
    Ok(Some(Surveyed {
        counts,
        horizons: horizons.map(|mut all| (all.swap_remove(0), least)),
    }))
}

/// Horizons of all points along each azimuth.
fn find_horizons(
    config: &AttenuationConfig,
    plan: &Plan,
    surface: &Surface,
    index: u64,
    least: f64,
) -> Result<Vec<Vec<Horizon>>, AttenuationError> {
    plan.azimuths()
        .into_iter()
        .map(|azimuth| {
            let horizons = Horizons::new(surface, azimuth, least)?;
            let chunks = chunks(surface);
            let found: Vec<Vec<Horizon>> = chunks
                .into_par_iter()
                .map(|chunk| {
                    points(surface, config.run.seed, index, chunk)
                        .map(|point| horizons.of(point.facet, point.look.origin))
                        .collect()
                })
                .collect();
            Ok(found.concat())
        })
        .collect()
}

/// The least rise of interest on the surface of the first sigma; on others all rises are larger or smaller as
/// sigma is.
fn least_rise(config: &AttenuationConfig, plan: &Plan) -> f64 {
    let steepest = plan.sigmas.iter().copied().fold(0.0, f64::max);
    let mut least = f64::INFINITY;
    for direction in plan.lights.iter().chain(&plan.views) {
        least = least.min(cotangent(direction) * plan.sigmas[0] / steepest);
    }
    if config.run.demarcation {
        // More than half of all points are dark where rises are as small as this.
        least = least.min(0.1 * plan.slopes[0].xx().sqrt());
    }
    // Rounding must not lift it above a cotangent; vertical light alone has none.
    (least * (1.0 - 1e-9)).min(f64::MAX)
}

/// A point of the surface, looking at itself until it is told where to look.
struct Point {
    facet: Facet,
    look: Look,
}

/// Numbers of the chunks of a surface.
fn chunks(surface: &Surface) -> Vec<usize> {
    (0..surface.facet_count().div_ceil(CHUNK)).collect()
}

/// The points of a chunk: one on each facet, anywhere on it, so that all together are spread evenly over
/// the mean plane.
fn points(
    surface: &Surface,
    seed: u64,
    index: u64,
    chunk: usize,
) -> impl Iterator<Item = Point> + '_ {
    let mut rng = point_stream(seed, index, chunk as u64);
    let end = (CHUNK * (chunk + 1)).min(surface.facet_count());
    (CHUNK * chunk..end).map(move |number| {
        let facet = surface.facet(number);
        let [a, b, c] = surface.corners(facet);
        let [far, near] = sorted_pair(&mut rng);
        let place = a + far * (b - a) + near * (c - b);
        let look = Look {
            origin: surface.snap(facet, place),
            direction: surface.normal(facet),
        };
        Point { facet, look }
    })
}

/// Two uniform numbers, the larger one first: a uniform point of a triangle.
fn sorted_pair<R: Rng>(rng: &mut R) -> [f64; 2] {
    let (a, b): (f64, f64) = (rng.random(), rng.random());
    [a.max(b), a.min(b)]
}

/// `cot(theta)`.
fn cotangent(direction: &Incidence) -> f64 {
    direction.theta().tan().recip()
}

/// One surface, and what is asked of it.
struct Site<'a> {
    config: &'a AttenuationConfig,
    plan: &'a Plan,
    sigma: f64,
    surface: &'a Surface,
    accelerator: &'a dyn Accelerator<Surface>,
    /// Horizons of all points along each azimuth, where points see by them.
    horizons: Option<&'a [Vec<Horizon>]>,
    /// How many times steeper this surface is than that of the horizons.
    steeper: f64,
    azimuths: Vec<f64>,
    index: u64,
}

/// Which points of a chunk face a direction, and which see it.
struct Marks {
    facing: Vec<bool>,
    free: Vec<bool>,
}

impl Marks {
    fn count(&self) -> Seen {
        Seen {
            facing: ones(self.facing.iter().copied()),
            free: ones(self.free.iter().copied()),
        }
    }

    /// Points that face and see both directions.
    fn both(&self, other: &Self) -> Seen {
        let both = |a: &[bool], b: &[bool]| ones(a.iter().zip(b).map(|(a, b)| *a & *b));
        Seen {
            facing: both(&self.facing, &other.facing),
            free: both(&self.free, &other.free),
        }
    }
}

fn ones(marks: impl Iterator<Item = bool>) -> u64 {
    marks.map(u64::from).sum()
}

impl Site<'_> {
    /// Counts over all points, in the order of the chunks, whatever thread had which.
    fn count(&self) -> Counts {
        let counts: Vec<Counts> = chunks(self.surface)
            .into_par_iter()
            .map(|chunk| self.count_chunk(chunk))
            .collect();
        counts.into_iter().fold(Counts::default(), Counts::add)
    }

    fn count_chunk(&self, chunk: usize) -> Counts {
        let points: Vec<Point> =
            points(self.surface, self.config.run.seed, self.index, chunk).collect();
        let mut counts = Counts {
            points: points.len() as u64,
            ..Counts::default()
        };
        let first = CHUNK * chunk;
        let plan = self.plan;
        let views: Vec<Marks> = plan
            .views
            .iter()
            .map(|view| self.mark(view, first, &points, &mut counts.lost))
            .collect();
        counts.views = views.iter().map(Marks::count).collect();
        let bins: Vec<Option<usize>> = if self.config.run.heights {
            points.iter().map(|point| self.bin(point)).collect()
        } else {
            Vec::new()
        };
        for light in &plan.lights {
            let lit = self.mark(light, first, &points, &mut counts.lost);
            counts.lights.push(lit.count());
            counts.areas.push(area(light, &points, &lit));
            counts.pairs.extend(views.iter().map(|seen| lit.both(seen)));
            if self.config.run.mirror {
                let mirrored = self.mirrored(light, &points, &lit.free, &mut counts.lost);
                counts.mirrored.push(mirrored);
            }
            if self.config.run.heights {
                counts.heights.extend(by_height(&bins, &lit));
            }
        }
        counts
    }

    /// Which points face a direction and see it.
    fn mark(&self, direction: &Incidence, first: usize, points: &[Point], lost: &mut u64) -> Marks {
        let w = direction.wi();
        let facing: Vec<bool> = points
            .iter()
            .map(|point| point.look.direction.dot(w) > 0.0)
            .collect();
        // From straight above, every point is seen.
        if direction.is_vertical() {
            let free = facing.clone();
            return Marks { facing, free };
        }
        let free = match self.horizons {
            Some(all) => {
                let azimuth = self.azimuths.iter().position(|&phi| phi == direction.phi());
                let horizons = &all[azimuth.unwrap_or(0)][first..first + points.len()];
                let cotangent = cotangent(direction);
                facing
                    .iter()
                    .zip(horizons)
                    .map(|(&facing, horizon)| facing && self.steeper * horizon.beyond <= cotangent)
                    .collect()
            }
            None => {
                let looks = points.iter().zip(&facing).map(|(point, &facing)| {
                    facing.then_some(Look {
                        direction: w,
                        ..point.look
                    })
                });
                self.free(looks, lost)
            }
        };
        Marks { facing, free }
    }

    /// How many of the lit points send the mirrored ray away.
    fn mirrored(&self, light: &Incidence, points: &[Point], lit: &[bool], lost: &mut u64) -> u64 {
        let wi = light.wi();
        let looks = points.iter().zip(lit).map(|(point, &lit)| {
            let wo = reflect(wi, point.look.direction);
            // What goes down meets the surface.
            (lit && wo.z > 0.0).then_some(Look {
                direction: wo,
                ..point.look
            })
        });
        ones(self.free(looks, lost).into_iter())
    }

    /// Which of the looks that are taken see the sky.
    fn free(&self, looks: impl Iterator<Item = Option<Look>>, lost: &mut u64) -> Vec<bool> {
        let all: Vec<Option<Look>> = looks.collect();
        let taken: Vec<Look> = all.iter().copied().flatten().collect();
        let mut seen = Vec::new();
        look(self.surface, self.accelerator, &taken, &mut seen);
        *lost += ones(seen.iter().map(|sight| *sight == Sight::Lost));
        let mut seen = seen.into_iter();
        all.iter()
            .map(|look| look.is_some() && seen.next() == Some(Sight::Free))
            .collect()
    }

    /// The bin of a point's height.
    fn bin(&self, point: &Point) -> Option<usize> {
        let [dx, _] = self.surface.field().spacing();
        let height = (point.look.origin.z - self.surface.mean_plane()) * dx;
        heights::bin(height / self.sigma)
    }
}

/// Projected areas of facing and lit points.
fn area(light: &Incidence, points: &[Point], lit: &Marks) -> Area {
    let wi = light.wi();
    let mut sum = Area::default();
    for ((point, &facing), &free) in points.iter().zip(&lit.facing).zip(&lit.free) {
        if facing {
            let m = point.look.direction;
            let area = wi.dot(m) / (m.z * wi.z);
            sum.facing += area;
            sum.free += if free { area } else { 0.0 };
        }
    }
    sum
}

/// Facing and lit points by their height.
fn by_height(bins: &[Option<usize>], lit: &Marks) -> Vec<Seen> {
    let mut counts = vec![Seen::default(); BINS];
    for ((bin, &facing), &free) in bins.iter().zip(&lit.facing).zip(&lit.free) {
        if let Some(bin) = *bin {
            counts[bin] += Seen {
                facing: u64::from(facing),
                free: u64::from(free),
            };
        }
    }
    counts
}
