//! One surface surveyed: which of its points and samples face, see and are seen, counted.

use asperity_optics::{Incidence, reflect};
use asperity_simulate::{Observer, SimulateError, check_grazing};
use asperity_surface::{Border, SplineSurface};
use asperity_tracer::{
    Accelerator, AcceleratorKind, Horizon, SmoothSurface, Surface, Visibility, VisibilityRay,
    trace_visibility,
};
use rayon::prelude::*;

use super::config::VisibilityMethod;
use super::counts::{Area, Counts, Seen};
use super::ground::{Ground, Point, Skyline};
use super::heights::{self, BINS};
use super::plan::{Plan, Recipes};
use super::points::{CHUNK, chunks, points, samples};
use super::skyline::{cotangent, least_rise};
use super::{AttenuationConfig, AttenuationError};

/// What was found on one realisation.
pub(super) struct Surveyed {
    /// One per sigma.
    pub(super) counts: Vec<Counts>,
    /// Horizons of the points along the azimuth of the lights, on the surface of the first sigma, and the least rise that
    /// they tell apart.
    pub(super) horizons: Option<(Vec<Horizon>, f64)>,
}

/// Surveys the surfaces of realisation `index`, one per sigma; `None` if the run is to stop.
pub(super) fn survey(
    config: &AttenuationConfig,
    plan: &Plan,
    index: u64,
    progress: &dyn Observer,
) -> Result<Option<Surveyed>, AttenuationError> {
    let seed = config.run.seed;
    match &plan.recipes {
        Recipes::Flat(recipes) => {
            let draw = |sigma: usize| -> Result<Surface, AttenuationError> {
                let field = recipes[sigma].draw(seed, index)?;
                Ok(Surface::new(field.with_border(plan.border)))
            };
            survey_of(draw, config, plan, index, progress)
        }
        Recipes::Smooth(recipes) => {
            let draw = |sigma: usize| -> Result<SmoothSurface, AttenuationError> {
                let spline = recipes[sigma].draw(seed, index)?;
                Ok(SmoothSurface::new(with_border(spline, plan.border)))
            };
            survey_of(draw, config, plan, index, progress)
        }
    }
}

/// A periodic spline, or, for another border, the spline through its samples that has it.
fn with_border(spline: SplineSurface, border: Border) -> SplineSurface {
    match border {
        Border::Periodic => spline,
        _ => SplineSurface::through(&spline.samples().with_border(border)),
    }
}

/// Surveys surfaces that `draw` makes by the number of their sigma.
///
/// They are one surface at several scales of height, and so are their horizons: these are found once.
fn survey_of<G: Ground>(
    draw: impl Fn(usize) -> Result<G, AttenuationError>,
    config: &AttenuationConfig,
    plan: &Plan,
    index: u64,
    progress: &dyn Observer,
) -> Result<Option<Surveyed>, AttenuationError> {
    let grazing = |ground: &G| -> Result<(), AttenuationError> {
        let mut directions = plan.lights.iter().chain(&plan.views);
        Ok(directions.try_for_each(|direction| check_grazing(ground, *direction))?)
    };
    let first = draw(0)?;
    // Light this grazing would have to cross too many tiles: refuse it before horizons are computed.
    grazing(&first)?;
    let least = least_rise(config, plan);
    let skylines = if plan.needs_horizons(&config.run) {
        first.skylines(config, plan, index, least)?
    } else {
        None
    };
    let mut counts = Vec::new();
    let mut drawn = Some(first);
    for sigma in 0..plan.sigmas.len() {
        if progress.stop().is_some() {
            return Ok(None);
        }
        let ground = match drawn.take() {
            Some(first) => first,
            None => draw(sigma)?,
        };
        grazing(&ground)?;
        let accelerator = ground
            .accelerator(AcceleratorKind::Auto)
            .map_err(SimulateError::from)?;
        let site = Site {
            config,
            plan,
            sigma: plan.sigmas[sigma],
            ground: &ground,
            accelerator: &*accelerator,
            skylines: skylines
                .as_deref()
                .filter(|_| plan.method == VisibilityMethod::Horizons),
            steeper: plan.sigmas[sigma] / plan.sigmas[0],
            azimuths: plan.azimuths(),
            index,
        };
        counts.push(site.count());
        progress.advance(1);
    }
    Ok(Some(Surveyed {
        counts,
        horizons: skylines.map(|mut all| (all.swap_remove(0).points, least)),
    }))
}

/// One surface, and what is measured on it.
struct Site<'a, G: Ground> {
    config: &'a AttenuationConfig,
    plan: &'a Plan,
    sigma: f64,
    ground: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    /// Horizons along each azimuth, where points see by them.
    skylines: Option<&'a [Skyline]>,
    /// How many times steeper this surface is than that of the skylines.
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

impl<G: Ground> Site<'_, G> {
    /// Counts over all points, in the order of the chunks, whatever thread had which.
    fn count(&self) -> Counts {
        let counts: Vec<Counts> = chunks(self.ground)
            .into_par_iter()
            .map(|chunk| self.count_chunk(chunk))
            .collect();
        counts.into_iter().fold(Counts::default(), Counts::add)
    }

    fn count_chunk(&self, chunk: usize) -> Counts {
        let points: Vec<Point<G::Facet>> =
            points(self.ground, self.config.run.seed, self.index, chunk).collect();
        let mut counts = Counts {
            points: points.len() as u64,
            ..Counts::default()
        };
        let plan = self.plan;
        let first = CHUNK * chunk;
        let mark = |direction: &Incidence, lost: &mut u64| {
            let skyline = self.skyline(direction);
            let horizons = skyline.map(|all| &all.points[first..first + points.len()]);
            self.mark(direction, &points, horizons, lost)
        };
        let views: Vec<Marks> = plan
            .views
            .iter()
            .map(|view| mark(view, &mut counts.lost))
            .collect();
        counts.views = views.iter().map(Marks::count).collect();
        let bins: Vec<Option<usize>> = if self.config.run.heights {
            points.iter().map(|point| self.bin(point)).collect()
        } else {
            Vec::new()
        };
        for light in &plan.lights {
            let lit = mark(light, &mut counts.lost);
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
        self.count_samples(chunk, &mut counts);
        counts
    }

    /// Samples that are lit and seen, for each light and view.
    fn count_samples(&self, chunk: usize, counts: &mut Counts) {
        let samples: Vec<Vec<Point<G::Facet>>> = self
            .azimuths
            .iter()
            .map(|&azimuth| samples(self.ground, azimuth, chunk).collect())
            .collect();
        counts.samples = samples[0].len() as u64;
        let mark = |direction: &Incidence, lost: &mut u64| {
            let skyline = self.skyline(direction);
            let horizons = skyline.map(|all| all.samples[chunk].as_slice());
            self.mark(direction, &samples[self.azimuth(direction)], horizons, lost)
        };
        let plan = self.plan;
        let views: Vec<Marks> = plan
            .views
            .iter()
            .map(|view| mark(view, &mut counts.lost))
            .collect();
        for light in &plan.lights {
            let lit = mark(light, &mut counts.lost);
            let both = views.iter().map(|seen| lit.both(seen).free);
            counts.paper.extend(both);
        }
    }

    /// The number of a direction's azimuth; a vertical one may have any.
    fn azimuth(&self, direction: &Incidence) -> usize {
        let number = self.azimuths.iter().position(|&phi| phi == direction.phi());
        number.unwrap_or(0)
    }

    /// Horizons along the azimuth of a direction, where points see by them.
    fn skyline(&self, direction: &Incidence) -> Option<&Skyline> {
        self.skylines.map(|all| &all[self.azimuth(direction)])
    }

    /// Which points face a direction and see it.
    fn mark(
        &self,
        direction: &Incidence,
        points: &[Point<G::Facet>],
        horizons: Option<&[Horizon]>,
        lost: &mut u64,
    ) -> Marks {
        let w = direction.wi();
        let facing: Vec<bool> = points
            .iter()
            .map(|point| point.ray.direction.dot(w) > 0.0)
            .collect();
        // From straight above, every point is seen.
        if direction.is_vertical() {
            let free = facing.clone();
            return Marks { facing, free };
        }
        let free = match horizons {
            Some(horizons) => {
                let cotangent = cotangent(direction);
                facing
                    .iter()
                    .zip(horizons)
                    .map(|(&facing, horizon)| facing && self.steeper * horizon.beyond <= cotangent)
                    .collect()
            }
            None => {
                let rays = points.iter().zip(&facing).map(|(point, &facing)| {
                    facing.then(|| self.ground.ray_along(point, direction))
                });
                self.free(rays, lost)
            }
        };
        Marks { facing, free }
    }

    /// How many of the lit points send the mirrored ray away.
    fn mirrored(
        &self,
        light: &Incidence,
        points: &[Point<G::Facet>],
        lit: &[bool],
        lost: &mut u64,
    ) -> u64 {
        let wi = light.wi();
        let rays = points.iter().zip(lit).map(|(point, &lit)| {
            let wo = reflect(wi, point.ray.direction);
            // What goes down meets the surface.
            (lit && wo.z > 0.0).then_some(VisibilityRay {
                direction: wo,
                ..point.ray
            })
        });
        ones(self.free(rays, lost).into_iter())
    }

    /// For each ray, whether it escapes; false where there is none.
    fn free(&self, rays: impl Iterator<Item = Option<VisibilityRay>>, lost: &mut u64) -> Vec<bool> {
        let all: Vec<Option<VisibilityRay>> = rays.collect();
        let taken: Vec<VisibilityRay> = all.iter().copied().flatten().collect();
        let mut seen = Vec::new();
        trace_visibility(self.ground, self.accelerator, &taken, &mut seen);
        *lost += ones(
            seen.iter()
                .map(|visibility| *visibility == Visibility::Lost),
        );
        let mut seen = seen.into_iter();
        all.iter()
            .map(|ray| ray.is_some() && seen.next() == Some(Visibility::Visible))
            .collect()
    }

    /// The bin of a point's height.
    fn bin(&self, point: &Point<G::Facet>) -> Option<usize> {
        let height = (point.ray.origin.z - self.ground.mean_plane()) * self.ground.unit();
        heights::bin(height / self.sigma)
    }
}

/// Projected areas of facing and lit points.
fn area<F>(light: &Incidence, points: &[Point<F>], lit: &Marks) -> Area {
    let wi = light.wi();
    let mut sum = Area::default();
    for ((point, &facing), &free) in points.iter().zip(&lit.facing).zip(&lit.free) {
        if facing {
            let m = point.ray.direction;
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
