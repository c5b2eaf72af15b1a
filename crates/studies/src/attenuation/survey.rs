//! Survey: counts which points and samples of a surface face, see and are seen.

use std::sync::Arc;

use asperity_optics::{Incidence, reflect};
use asperity_results::Stored;
use asperity_simulate::{Observer, Shape, SimulateError, check_shape};
use asperity_surface::{Border, SplineSurface};
use asperity_tracer::{
    Accelerator, AcceleratorKind, Horizon, Visibility, VisibilityRay, trace_visibility,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::AttenuationError;
use super::config::VisibilityMethod;
use super::counts::Counts;
use super::demarcation::Rises;
use super::ground::{Ground, Point};
use super::heights::{self, BINS};
use super::plan::AttenuationPlan;
use super::points::{chunks, points, samples};
use super::skyline::{Skyline, cotangent, least_rise};

/// What was found on one realisation, whose surfaces are one at several scales of height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurveyedSurface {
    /// One per sigma.
    pub(super) counts: Vec<Counts>,
    /// Where shadow begins on the surface of the first sigma, if that was requested.
    pub(super) rises: Option<Rises>,
}

impl Stored for SurveyedSurface {}

impl SurveyedSurface {
    /// Surveys realisation `index`; `None` if the run is to stop.
    pub(super) fn of(
        plan: &AttenuationPlan,
        index: u64,
        observer: &dyn Observer,
    ) -> Result<Option<Self>, AttenuationError> {
        let run = &plan.config.run;
        let (mut counts, mut rises, mut skylines) = (Vec::new(), None, Vec::new());
        for (number, surfaces) in plan.surfaces.iter().enumerate() {
            if observer.stop().is_some() {
                return Ok(None);
            }
            let drawn = surfaces.drawn.draw_into(run.seed, index, Vec::new());
            let shape = drawn.map_err(SimulateError::from)?;
            let shape = with_border(shape, plan.config.surface.border);
            // Light too grazing would cross too many tiles: it is refused before horizons are computed.
            plan.directions()
                .try_for_each(|direction| check_shape(&shape, *direction))?;
            // Horizons scale with height, so that those of the first surface serve all.
            if let (0, true, Shape::HeightField { top, .. }) =
                (number, plan.needs_horizons(), &shape)
            {
                let least = least_rise(plan);
                skylines = Skyline::of_each_azimuth(plan, top, index, least)?;
                let rises_of = |skyline: &Skyline| Rises::of(&skyline.points.concat(), least);
                rises = run.demarcation.then(|| rises_of(&skylines[0]));
            }
            let survey = Survey {
                seed: run.seed,
                index,
                lights: &plan.lights,
                views: &plan.views,
                mirror: run.mirror,
                sigma: run.heights.then_some(surfaces.sigma),
                azimuths: &plan.azimuths,
                skylines: match plan.method {
                    VisibilityMethod::Horizons => &skylines,
                    _ => &[],
                },
                steeper: surfaces.sigma / plan.surfaces[0].sigma,
            };
            counts.push(survey.count(&shape)?);
            observer.advance(1);
        }
        Ok(Some(Self { counts, rises }))
    }
}

/// A periodic shape, or, for another border, the heights or the spline through the samples that have it.
fn with_border(shape: Shape, border: Border) -> Shape {
    match shape {
        Shape::HeightField { top, .. } if border != Border::Periodic => {
            let field = Arc::unwrap_or_clone(top).into_field();
            Shape::height_field(field.with_border(border))
        }
        Shape::Smooth { top, .. } if border != Border::Periodic => {
            let samples = top.spline().samples().with_border(border);
            Shape::smooth(SplineSurface::through(&samples))
        }
        periodic => periodic,
    }
}

/// What is counted on a surface.
#[derive(Clone, Copy)]
pub(super) struct Survey<'a> {
    /// Seed of the points, and number of the surface that they are on.
    pub(super) seed: u64,
    pub(super) index: u64,
    pub(super) lights: &'a [Incidence],
    /// Without any, no samples are counted.
    pub(super) views: &'a [Incidence],
    /// Whether mirrored rays are followed.
    pub(super) mirror: bool,
    /// Root mean square height, if points are counted by height.
    pub(super) sigma: Option<f64>,
    /// Those of lights and views, radians.
    pub(super) azimuths: &'a [f64],
    /// Horizons along each azimuth; none where points see by rays.
    pub(super) skylines: &'a [Skyline],
    /// How many times steeper this surface is than that of the skylines.
    pub(super) steeper: f64,
}

impl Survey<'_> {
    /// Counts over all points of a height map, in the order of the chunks, whatever thread had which.
    ///
    /// # Panics
    /// On a triangle mesh, which has no points per cell.
    pub(super) fn count(&self, shape: &Shape) -> Result<Counts, SimulateError> {
        match shape {
            Shape::HeightField { top, .. } => self.count_on(&**top),
            Shape::Smooth { top, .. } => self.count_on(&**top),
            Shape::TriangleMesh { .. } => unreachable!("only height maps are surveyed"),
        }
    }

    fn count_on<G: Ground>(&self, ground: &G) -> Result<Counts, SimulateError> {
        let accelerator = ground.accelerator(AcceleratorKind::Auto)?;
        let site = Site {
            survey: *self,
            ground,
            accelerator: &*accelerator,
        };
        let chunks = chunks(ground).into_par_iter();
        let counts: Vec<Counts> = chunks.map(|chunk| site.count_chunk(chunk)).collect();
        let mut sum = Counts::default();
        counts.into_iter().for_each(|one| sum += one);
        Ok(sum)
    }
}

/// One surface, and what is counted on it.
struct Site<'a, G: Ground> {
    survey: Survey<'a>,
    ground: &'a G,
    accelerator: &'a dyn Accelerator<G>,
}

/// Which points of a chunk face a direction, and which see it.
struct Marks {
    facing: Vec<bool>,
    free: Vec<bool>,
}

impl Marks {
    fn count(&self) -> [u64; 2] {
        [&self.facing, &self.free].map(|marks| ones(marks.iter().copied()))
    }

    /// Points that face and see both directions.
    fn both(&self, other: &Self) -> [u64; 2] {
        let both = |a: &[bool], b: &[bool]| ones(a.iter().zip(b).map(|(a, b)| *a & *b));
        [
            both(&self.facing, &other.facing),
            both(&self.free, &other.free),
        ]
    }
}

fn ones(marks: impl Iterator<Item = bool>) -> u64 {
    marks.map(u64::from).sum()
}

impl<'a, G: Ground> Site<'a, G> {
    fn count_chunk(&self, chunk: usize) -> Counts {
        let survey = &self.survey;
        let points: Vec<Point<G::Facet>> =
            points(self.ground, survey.seed, survey.index, chunk).collect();
        let mut counts = Counts {
            points: points.len() as u64,
            ..Counts::default()
        };
        let places = |direction: &Incidence| {
            let skyline = survey.skylines.get(self.azimuth(direction));
            (&*points, skyline.map(|all| &*all.points[chunk]))
        };
        let lights = self.marks(survey.lights, places, &mut counts.lost);
        let views = self.marks(survey.views, places, &mut counts.lost);
        views
            .iter()
            .for_each(|seen| counts.views.push(seen.count()));
        let bins = survey.sigma.map(|sigma| {
            let bins = points.iter().map(|point| self.bin(point, sigma));
            bins.collect::<Vec<_>>()
        });
        for (light, lit) in survey.lights.iter().zip(&lights) {
            counts.lights.push(lit.count());
            counts.areas.push(areas(light, &points, lit));
            for seen in &views {
                counts.pairs.push(lit.both(seen));
            }
            if survey.mirror {
                let mirrored = self.mirrored(light, &points, &lit.free, &mut counts.lost);
                counts.mirrored.push(mirrored);
            }
            for of_bin in bins.iter().flat_map(|bins| by_height(bins, lit)) {
                counts.heights.push(of_bin);
            }
        }
        if !views.is_empty() {
            self.count_samples(chunk, &mut counts);
        }
        counts
    }

    /// Samples that are lit and seen, for each light and view.
    fn count_samples(&self, chunk: usize, counts: &mut Counts) {
        let survey = &self.survey;
        let of_azimuth = |&azimuth: &f64| samples(self.ground, azimuth, chunk).collect();
        let samples: Vec<Vec<Point<G::Facet>>> = survey.azimuths.iter().map(of_azimuth).collect();
        counts.samples = samples[0].len() as u64;
        let places = |direction: &Incidence| {
            let azimuth = self.azimuth(direction);
            let skyline = survey.skylines.get(azimuth);
            (&*samples[azimuth], skyline.map(|all| &*all.samples[chunk]))
        };
        let lights = self.marks(survey.lights, places, &mut counts.lost);
        let views = self.marks(survey.views, places, &mut counts.lost);
        for lit in lights {
            let both = views.iter().map(|seen| lit.both(seen)[1]);
            counts.paper.extend(both);
        }
    }

    /// The number of a direction's azimuth; a vertical one may have any.
    fn azimuth(&self, direction: &Incidence) -> usize {
        let mut azimuths = self.survey.azimuths.iter();
        let number = azimuths.position(|&phi| phi == direction.phi());
        number.unwrap_or(0)
    }

    /// Which points face and see each direction. `places`: the points of a direction, and their horizons where they see by them.
    fn marks<'p>(
        &self,
        directions: &[Incidence],
        places: impl Fn(&Incidence) -> (&'p [Point<G::Facet>], Option<&'p [Horizon]>),
        lost: &mut u64,
    ) -> Vec<Marks>
    where
        G::Facet: 'p,
    {
        let mark = |direction: &Incidence| {
            let (points, horizons) = places(direction);
            self.mark(direction, points, horizons, lost)
        };
        directions.iter().map(mark).collect()
    }

    fn mark(
        &self,
        direction: &Incidence,
        points: &[Point<G::Facet>],
        horizons: Option<&[Horizon]>,
        lost: &mut u64,
    ) -> Marks {
        let w = direction.wi();
        let facing = points.iter().map(|point| point.ray.direction.dot(w) > 0.0);
        let facing: Vec<bool> = facing.collect();
        let free = match horizons {
            // From straight above, every point is seen.
            _ if direction.is_vertical() => facing.clone(),
            Some(horizons) => {
                let cotangent = cotangent(direction);
                let sees = |horizon: &Horizon| self.survey.steeper * horizon.beyond <= cotangent;
                let horizons = facing.iter().zip(horizons);
                horizons
                    .map(|(&facing, horizon)| facing && sees(horizon))
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
        *lost += ones(seen.iter().map(|one| *one == Visibility::Lost));
        let mut seen = seen.into_iter();
        all.iter()
            .map(|ray| ray.is_some() && seen.next() == Some(Visibility::Visible))
            .collect()
    }

    /// The bin of a point's height.
    fn bin(&self, point: &Point<G::Facet>, sigma: f64) -> Option<usize> {
        let height = (point.ray.origin.z - self.ground.mean_plane()) * self.ground.unit();
        heights::bin(height / sigma)
    }
}

/// Projected areas of facing and lit points.
fn areas<F>(light: &Incidence, points: &[Point<F>], lit: &Marks) -> [f64; 2] {
    let wi = light.wi();
    let mut sum = [0.0; 2];
    for ((point, &facing), &free) in points.iter().zip(&lit.facing).zip(&lit.free) {
        if facing {
            let m = point.ray.direction;
            let area = wi.dot(m) / (m.z * wi.z);
            sum[0] += area;
            sum[1] += if free { area } else { 0.0 };
        }
    }
    sum
}

/// Facing and lit points by their height.
fn by_height(bins: &[Option<usize>], lit: &Marks) -> [[u64; 2]; BINS] {
    let mut counts = [[0; 2]; BINS];
    for ((bin, &facing), &free) in bins.iter().zip(&lit.facing).zip(&lit.free) {
        if let Some(bin) = *bin {
            counts[bin][0] += u64::from(facing);
            counts[bin][1] += u64::from(free);
        }
    }
    counts
}
