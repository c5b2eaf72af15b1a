//! Survey: counts which points and samples of a surface face, see and are seen.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use asperity_optics::{Incidence, reflect};
use asperity_results::Stored;
use asperity_simulate::{Observer, Shape, SimulateError, check_shape};
use asperity_surface::{Border, SplineSurface};
use asperity_tracer::{
    Accelerator, AcceleratorKind, Horizon, Visibility, VisibilityRay, trace_visibility,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::counts::Counts;
use super::demarcation::Rises;
use super::ground::{Ground, Point};
use super::heights::{self, BINS};
use super::plan::{AttenuationStudy, RoughSurfaces};
use super::points::{chunks, points, samples};
use super::skyline::{Skyline, cotangent, least_rise};
use crate::error::StudyError;

/// Counts of one realisation, whose surfaces are one at several scales of height.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurveyedSurface {
    /// One per sigma.
    pub(super) counts: Vec<Counts>,
    /// Rises at which shadow begins on the surface of the first sigma, if requested.
    pub(super) rises: Option<Rises>,
}

impl Stored for SurveyedSurface {}

impl SurveyedSurface {
    /// Surveys realisation `index`; `None` if the run is to stop.
    pub(super) fn of(
        study: &AttenuationStudy,
        index: u64,
        observer: &dyn Observer,
    ) -> Result<Option<Self>, StudyError> {
        let run = &study.config.run;
        let (mut counts, mut rises, mut skylines) = (Vec::new(), None, Vec::new());
        for (number, surfaces) in study.surfaces.iter().enumerate() {
            if observer.stop().is_some() {
                return Ok(None);
            }
            let shape = match surfaces.shape(study, index, observer) {
                Err(SimulateError::Interrupted) => return Ok(None),
                shape => shape?,
            };
            // Light too grazing would cross too many tiles: it is refused before horizons are computed.
            study
                .directions()
                .try_for_each(|direction| check_shape(&shape, *direction))?;
            // Horizons scale with height, so that those of the first surface serve all.
            if let (0, Shape::HeightField { top, .. }) = (number, &shape) {
                let least = least_rise(study);
                skylines = match Skyline::of_each_azimuth(study, top, index, least, observer) {
                    Err(error) if error.is_stopped() => return Ok(None),
                    skylines => skylines?,
                };
                rises = (run.demarcation).then(|| Rises::of(&skylines[0].points, least));
            }
            let survey = Survey::of(study, surfaces, index, &skylines);
            match survey.count(&shape, observer) {
                Err(SimulateError::Interrupted) => return Ok(None),
                counted => counts.push(counted?),
            }
            observer.advance(1);
        }
        Ok(Some(Self { counts, rises }))
    }
}

impl RoughSurfaces {
    /// The surface of realisation `index`.
    pub(super) fn shape(
        &self,
        study: &AttenuationStudy,
        index: u64,
        observer: &dyn Observer,
    ) -> Result<Shape, SimulateError> {
        let run = &study.config.run;
        let gives_up = || observer.gives_up();
        let shape = self
            .drawn
            .draw_into(run.seed, index, Vec::new(), &gives_up)?;
        Ok(with_border(shape, study.config.surface.border))
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

/// Survey: the counts that are requested of a surface; none by default.
#[derive(Clone, Copy, Default)]
pub(super) struct Survey<'a> {
    /// Seed of the points, and number of the surface that they are on.
    pub(super) seed: u64,
    pub(super) index: u64,
    pub(super) lights: &'a [Incidence],
    /// Without any, no samples are counted.
    pub(super) views: &'a [Incidence],
    /// `true` if mirrored rays are followed.
    pub(super) mirror: bool,
    /// Root mean square height, if points are counted by height.
    pub(super) sigma: Option<f64>,
    /// Azimuths of lights and views, radians.
    pub(super) azimuths: &'a [f64],
    /// Horizons along each azimuth; none where points see by rays.
    pub(super) skylines: &'a [Skyline],
    /// Steepness of this surface over that of the skylines.
    pub(super) steeper: f64,
}

impl<'a> Survey<'a> {
    /// The counts that a plan needs of a surface.
    pub(super) fn of(
        study: &'a AttenuationStudy,
        surfaces: &RoughSurfaces,
        index: u64,
        skylines: &'a [Skyline],
    ) -> Self {
        let run = &study.config.run;
        Self {
            seed: run.seed,
            index,
            lights: &study.lights,
            views: &study.views,
            mirror: run.mirror,
            sigma: run.heights.then_some(surfaces.sigma),
            azimuths: &study.azimuths,
            skylines,
            steeper: surfaces.sigma / study.surfaces[0].sigma,
        }
    }

    /// Counts over all points of a height map, in the order of the chunks, whatever thread had which.
    ///
    /// # Errors
    /// [`SimulateError`] if no accelerator can be built, or `observer` gives the count up.
    ///
    /// # Panics
    /// On a triangle mesh, which has no points per cell.
    pub(super) fn count(
        &self,
        shape: &Shape,
        observer: &dyn Observer,
    ) -> Result<Counts, SimulateError> {
        match shape {
            Shape::HeightField { top, .. } => self.count_on(&**top, observer),
            Shape::Smooth { top, .. } => self.count_on(&**top, observer),
            Shape::TriangleMesh { .. } => unreachable!("only height maps are surveyed"),
        }
    }

    fn count_on<G: Ground>(
        &self,
        ground: &G,
        observer: &dyn Observer,
    ) -> Result<Counts, SimulateError> {
        let accelerator = ground.accelerator(AcceleratorKind::Auto)?;
        let site = Site {
            survey: *self,
            ground,
            accelerator: &*accelerator,
            lost: AtomicU64::new(0),
        };
        let chunks = chunks(ground).into_par_iter();
        let count = |chunk| (!observer.gives_up()).then(|| site.count_chunk(chunk));
        let counts: Option<Vec<Counts>> = chunks.map(count).collect();
        let mut sum = Counts::default();
        let counts = counts.ok_or(SimulateError::Interrupted)?;
        counts.into_iter().for_each(|one| sum += one);
        sum.lost = site.lost.into_inner();
        Ok(sum)
    }
}

/// One surface, and what is counted on it.
struct Site<'a, G: Ground> {
    survey: Survey<'a>,
    ground: &'a G,
    accelerator: &'a dyn Accelerator<G>,
    /// Visibility rays lost so far.
    lost: AtomicU64,
}

/// Visibility of a direction from a point.
#[derive(Clone, Copy)]
struct Mark {
    facing: bool,
    free: bool,
}

/// Numbers of points that face both of two directions, which may be one, and that see both.
fn count(a: &[Mark], b: &[Mark]) -> [u64; 2] {
    let both = a.iter().zip(b);
    both.fold([0; 2], |[facing, free], (a, b)| {
        [
            facing + u64::from(a.facing & b.facing),
            free + u64::from(a.free & b.free),
        ]
    })
}

impl<G: Ground> Site<'_, G> {
    fn count_chunk(&self, chunk: usize) -> Counts {
        let survey = &self.survey;
        let points: Vec<Point<G::Facet>> =
            points(self.ground, survey.seed, survey.index, chunk).collect();
        let mut counts = Counts {
            points: points.len() as u64,
            ..Counts::default()
        };
        let mark = |direction: &Incidence| {
            let skyline = survey.skylines.get(self.azimuth(direction));
            self.mark(direction, &points, skyline.map(|all| &*all.points[chunk]))
        };
        let views: Vec<Vec<Mark>> = survey.views.iter().map(mark).collect();
        for seen in &views {
            counts.views.push(count(seen, seen));
        }
        for light in survey.lights {
            let lit = &mark(light);
            counts.lights.push(count(lit, lit));
            counts.areas.push(areas(light, &points, lit));
            for seen in &views {
                counts.pairs.push(count(lit, seen));
            }
            if survey.mirror {
                counts.mirrored.push(self.mirrored(light, &points, lit));
            }
            if let Some(sigma) = survey.sigma {
                for of_bin in self.by_height(&points, sigma, lit) {
                    counts.heights.push(of_bin);
                }
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
        let mark = |direction: &Incidence| {
            let azimuth = self.azimuth(direction);
            let skyline = survey.skylines.get(azimuth);
            let horizons = skyline.map(|all| &*all.samples[chunk]);
            self.mark(direction, &samples[azimuth], horizons)
        };
        let views: Vec<Vec<Mark>> = survey.views.iter().map(mark).collect();
        for lit in survey.lights.iter().map(mark) {
            let both = views.iter().map(|seen| count(&lit, seen)[1]);
            counts.paper.extend(both);
        }
    }

    /// The number of a direction's azimuth; a vertical one may have any.
    fn azimuth(&self, direction: &Incidence) -> usize {
        let mut azimuths = self.survey.azimuths.iter();
        let number = azimuths.position(|&phi| phi == direction.phi());
        number.unwrap_or(0)
    }

    /// Points that face and see a direction, by their horizons or by rays.
    fn mark(
        &self,
        direction: &Incidence,
        points: &[Point<G::Facet>],
        horizons: Option<&[Horizon]>,
    ) -> Vec<Mark> {
        let w = direction.wi();
        let faces = |point: &Point<G::Facet>| point.ray.direction.dot(w) > 0.0;
        let free: Vec<bool> = match horizons {
            // From straight above, every point is seen.
            _ if direction.is_vertical() => points.iter().map(faces).collect(),
            Some(horizons) => {
                let cotangent = cotangent(direction);
                let sees = |horizon: &Horizon| self.survey.steeper * horizon.beyond <= cotangent;
                let points = points.iter().zip(horizons);
                points
                    .map(|(point, horizon)| faces(point) && sees(horizon))
                    .collect()
            }
            None => {
                let ray = |point| faces(point).then(|| self.ground.ray_along(point, direction));
                self.free(points.iter().map(ray))
            }
        };
        let marks = points.iter().map(faces).zip(free);
        marks.map(|(facing, free)| Mark { facing, free }).collect()
    }

    /// Number of lit points whose mirrored ray escapes.
    fn mirrored(&self, light: &Incidence, points: &[Point<G::Facet>], lit: &[Mark]) -> u64 {
        let wi = light.wi();
        let rays = points.iter().zip(lit).map(|(point, lit)| {
            let wo = reflect(wi, point.ray.direction);
            // What goes down meets the surface.
            (lit.free && wo.z > 0.0).then_some(VisibilityRay {
                direction: wo,
                ..point.ray
            })
        });
        self.free(rays).into_iter().map(u64::from).sum()
    }

    /// For each ray, whether it escapes; false where there is none.
    fn free(&self, rays: impl Iterator<Item = Option<VisibilityRay>>) -> Vec<bool> {
        let all: Vec<Option<VisibilityRay>> = rays.collect();
        let taken: Vec<VisibilityRay> = all.iter().copied().flatten().collect();
        let mut seen = Vec::new();
        trace_visibility(self.ground, self.accelerator, &taken, &mut seen);
        let is_lost = |one: &&Visibility| **one == Visibility::Lost;
        let lost = seen.iter().filter(is_lost).count() as u64;
        self.lost.fetch_add(lost, Ordering::Relaxed);
        let mut seen = seen.into_iter();
        all.iter()
            .map(|ray| ray.is_some() && seen.next() == Some(Visibility::Visible))
            .collect()
    }

    /// Facing and lit points by their height.
    fn by_height(&self, points: &[Point<G::Facet>], sigma: f64, lit: &[Mark]) -> [[u64; 2]; BINS] {
        let mut counts = [[0; 2]; BINS];
        for (point, mark) in points.iter().zip(lit) {
            let height = (point.ray.origin.z - self.ground.mean_plane()) * self.ground.unit();
            if let Some(bin) = heights::bin(height / sigma) {
                counts[bin][0] += u64::from(mark.facing);
                counts[bin][1] += u64::from(mark.free);
            }
        }
        counts
    }
}

/// Projected areas of facing and lit points.
fn areas<F>(light: &Incidence, points: &[Point<F>], lit: &[Mark]) -> [f64; 2] {
    let wi = light.wi();
    let mut sum = [0.0; 2];
    for (point, mark) in points.iter().zip(lit).filter(|(_, mark)| mark.facing) {
        let m = point.ray.direction;
        let area = wi.dot(m) / (m.z * wi.z);
        sum[0] += area;
        sum[1] += if mark.free { area } else { 0.0 };
    }
    sum
}
