//! Horizons of all points of a surface, and of its samples.

use asperity_optics::Incidence;
use asperity_tracer::{Facet, Horizon, Horizons, Surface};
use rayon::prelude::*;

use super::config::VisibilityMethod;
use super::ground::{Point, Skyline};
use super::plan::Plan;
use super::points::{chunks, points, samples};
use super::{AttenuationConfig, AttenuationError};

/// The skylines of a surface, one per azimuth.
pub(super) fn find_skylines(
    config: &AttenuationConfig,
    plan: &Plan,
    surface: &Surface,
    index: u64,
    least: f64,
) -> Result<Vec<Skyline>, AttenuationError> {
    plan.azimuths()
        .into_iter()
        .map(|azimuth| {
            let horizons = Horizons::new(surface, azimuth, least)?;
            let of = |point: Point<Facet>| horizons.of(point.facet, point.ray.origin);
            let found: Vec<(Vec<Horizon>, Vec<Horizon>)> = chunks(surface)
                .into_par_iter()
                .map(|chunk| {
                    let points = points(surface, config.run.seed, index, chunk).map(of);
                    let samples = if plan.method == VisibilityMethod::Horizons {
                        samples(surface, azimuth, chunk).map(of).collect()
                    } else {
                        Vec::new()
                    };
                    (points.collect(), samples)
                })
                .collect();
            let (points, samples): (Vec<_>, Vec<_>) = found.into_iter().unzip();
            Ok(Skyline {
                points: points.concat(),
                samples,
            })
        })
        .collect()
}

/// The least rise of interest on the surface of the first sigma; on others all rises are larger or smaller as
/// sigma is.
pub(super) fn least_rise(config: &AttenuationConfig, plan: &Plan) -> f64 {
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

/// `cot(theta)`.
pub(super) fn cotangent(direction: &Incidence) -> f64 {
    direction.theta().tan().recip()
}
