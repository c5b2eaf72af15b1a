//! Skyline: the horizons of all points of a surface, and of its samples.

use asperity_numerics::elementary::tan;
use asperity_optics::Incidence;
use asperity_simulate::{Observer, SimulateError};
use asperity_tracer::{Facet, Horizon, Horizons, Surface};
use rayon::prelude::*;

use super::ground::Point;
use super::plan::AttenuationStudy;
use super::points::{chunks, points, samples};
use crate::config::error::ConfigError;
use crate::error::StudyError;

/// Horizons along one azimuth, in one list per chunk.
pub(super) struct Skyline {
    /// One per point.
    pub(super) points: Vec<Vec<Horizon>>,
    /// One per sample.
    pub(super) samples: Vec<Vec<Horizon>>,
}

impl Skyline {
    /// The skylines of a surface, one per azimuth, which tell rises of `least` and more apart.
    pub(super) fn of_each_azimuth(
        study: &AttenuationStudy,
        surface: &Surface,
        index: u64,
        least: f64,
        observer: &dyn Observer,
    ) -> Result<Vec<Self>, StudyError> {
        let along = |&azimuth: &f64| {
            let horizons = Horizons::new(surface, azimuth, least).map_err(ConfigError::from)?;
            let of = |point: Point<Facet>| horizons.of(point.facet, point.ray.origin);
            let found = chunks(surface).into_par_iter().map(|chunk| {
                if observer.gives_up() {
                    return None;
                }
                let points = points(surface, study.config.run.seed, index, chunk).map(of);
                let samples = samples(surface, azimuth, chunk).map(of);
                Some((points.collect(), samples.collect()))
            });
            let found: Option<Vec<_>> = found.collect();
            let found = found.ok_or(SimulateError::Interrupted)?;
            let (points, samples) = found.into_iter().unzip();
            Ok(Self { points, samples })
        };
        study.azimuths.iter().map(along).collect()
    }
}

/// The least rise of interest on the surface of the first sigma; on others all rises are larger or smaller as
/// sigma is.
pub(super) fn least_rise(study: &AttenuationStudy) -> f64 {
    let first = &study.surfaces[0];
    let sigmas = study.surfaces.iter().map(|surfaces| surfaces.sigma);
    let steepest = sigmas.fold(0.0, f64::max);
    let cotangents = study.directions().map(cotangent);
    let mut least = cotangents.fold(f64::INFINITY, |least, c| {
        least.min(c * first.sigma / steepest)
    });
    if study.config.run.demarcation {
        // More than half of all points are dark where rises are as small as this.
        least = least.min(0.1 * first.slopes.xx().sqrt());
    }
    // Rounding must not lift it above a cotangent; vertical light alone has none.
    (least * (1.0 - 1e-9)).min(f64::MAX)
}

/// `cot(theta)`.
pub(super) fn cotangent(direction: &Incidence) -> f64 {
    tan(direction.theta()).recip()
}
