//! Geometric attenuation: the fraction of the points of explicit surfaces that is lit and visible.
//!
//! # Definitions
//! One point on each facet, anywhere on it, both triangles of every cell: points are spread evenly over the
//! *mean plane*, each with the normal of its facet, which is exact for the mesh. Fractions are of points, not
//! of projected areas.
//! - A point is in *local shadow* if its facet faces away, `wi.m <= 0`; in *distant shadow* if the facet
//!   faces the light but another one hides it. (Light towards a facet that faces away would have to come
//!   out of the ground; a point is counted once.) *Local* and *distant masking* are the same of `wo`.
//! - *lit*: fraction of all points in no shadow. `g1`: fraction of those that face the light. `g1_view`: the same
//!   of the view. `g2`: fraction of the points that face both directions that are lit and visible.
//! - `paper_g2`: `1 - N_s / N` over the *samples* of the grid, `N_s` those in one of the four: the counting
//!   of the 2019 paper (Sec. 2.2), for which each element of the matrix of heights is a microfacet. A sample
//!   has six facets around it, and belongs to the one into which the direction to the light or the eye points:
//!   along a row, only the samples that follow decide. Of an open patch the samples of the border
//!   are left out, around which facets are missing. The paper's view is vertical, and from above
//!   all of a height field is visible; then it is the fraction of samples that are lit.
//! - `mirror_g2`: fraction of all points that are lit and whose *mirrored* ray escapes, as the paper's Sec.
//!   3.2.4 describes masking. It is not one at normal incidence.
//! - `g1_projected`, `lit_projected`: weighted by projected areas. The projected area of the lit points is
//!   that of the mean plane, so the second is one, and therefore the mean of the first is Smith's `1 / (1 +
//!   Lambda)` for Gaussian slopes, whatever the surface. `g1` is smaller: points that hardly face the light are shadowed
//!   more often.
//! - The *visibility* of a height is the fraction of the points there that face the light and are lit.
//!
//! # Points and samples
//! Where the edge of a shadow falls across a facet, the side away from the light is lit, and there the sample is
//! that stands for it. So a lit point has a lit sample behind it, and each shadow is shorter
//! by half a spacing in the mean if samples are counted; its other end is a ridge, a corner of the mesh in
//! both. Therefore `paper_g2` under a vertical view is above `lit`, by a difference of first
//! order in the spacing, while `lit` itself, being that of a mesh, is off by the second order.
//!
//! # Errors
//! Fractions are ratios of sums over surfaces. Points of one surface are correlated; errors are from the scatter
//! between surfaces. Surfaces of different sigma are the same ones, higher or lower: errors at
//! different sigma, as at different angles, are not independent. No surface is rescaled to its sigma.
//!
//! # Given surfaces
//! [`ShadowShares`] counts lit, averted and hidden points of one height map, for `inspect --theta`.
//!
//! # Two methods
//! Rays: one visibility ray per point and direction ([`asperity_tracer::trace_visibility`]). Horizons: the
//! steepest rise along an azimuth answers for all its polar angles ([`asperity_tracer::Horizons`]), and for all
//! sigma, to which it is proportional. The mirrored rays have no azimuth in common and are always rays.
//!
//! # Smooth cells
//! Points are at the same places of the mean plane, two in each cell, with the height and normal of the smooth surface there, and so
//! are samples. Visibility is found by rays: horizons walk along the edges of facets.

mod config;
mod counts;
mod demarcation;
mod estimate;
mod figures;
mod files;
mod flat_ground;
mod given;
mod ground;
mod heights;
mod plan;
mod points;
mod rough_surface;
mod skyline;
mod smooth_ground;
mod survey;
mod tables;
#[cfg(test)]
mod tests;

use asperity_simulate::{Cells, Observer, SimulateError, StoppedBy, counted};
use std::time::Instant;

use asperity_analysis::{
    Beckmann, smith_correlated_g2, smith_lit, smith_lit_as_printed, smith_separable_g2,
    v_cavity_lit, v_cavity_mean_g1, v_cavity_mean_g2,
};
use asperity_surface::SynthesisError;
use asperity_tally::Estimate;
use serde::Serialize;

use crate::config::error::ConfigError;

pub use config::{
    AttenuationConfig, AttenuationLight, AttenuationOutput, AttenuationRun, AttenuationSurface,
    AttenuationView, VisibilityMethod,
};
pub use demarcation::Demarcation;
pub use files::{attenuation_report, attenuation_summary};
pub use given::ShadowShares;
pub use heights::VisibilityRow;
pub use tables::attenuation_table;

use counts::{Area, Counts};
use demarcation::Rises;
use estimate::ratio;
use plan::Plan;
use rough_surface::RoughSurface;
use survey::survey;

/// Why an attenuation run fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AttenuationError {
    /// An interrupt came before the first surface was finished.
    #[error("interrupted before a surface was finished: there is nothing to write")]
    Interrupted,
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The surfaces cannot be drawn.
    #[error(transparent)]
    Synthesis(SynthesisError),
    /// The surfaces do not fit into memory, or the light cannot be followed.
    #[error(transparent)]
    Run(#[from] SimulateError),
}

/// What was measured for one sigma, light and view, with what theory expects.
///
/// Polar angles and azimuths are in degrees; theory is that of the continuous surface.
#[derive(Clone, Debug)]
pub struct AttenuationRow {
    /// Root mean square height, length units.
    pub sigma: f64,
    /// Of the direction towards the light.
    pub theta: f64,
    /// Of the direction towards the light.
    pub phi: f64,
    /// Of the direction towards the eye.
    pub view_theta: f64,
    /// Of the direction towards the eye.
    pub view_phi: f64,
    /// Fraction of all points that are lit.
    pub lit: Estimate,
    /// Fraction of the points facing the light that are lit.
    pub g1: Estimate,
    /// The same weighted by projected areas, `wi.m / m.z`: what Smith's G1 stands for exactly.
    pub g1_projected: Estimate,
    /// Projected area of all lit points over that of the mean plane: one, if none is lost or seen twice.
    pub lit_projected: Estimate,
    /// Smith's lit fraction.
    pub smith_lit: f64,
    /// Smith's `1 / (1 + Lambda)`.
    pub smith_g1: f64,
    /// The lit fraction by Smith's formula as the 2019 paper prints it.
    pub smith_lit_as_printed: f64,
    /// The lit fraction of V-cavities.
    pub v_cavity_lit: f64,
    /// The same of the points that face the light.
    pub v_cavity_g1: f64,
    /// Fraction of all points that face away from the light.
    pub local_shadow: Estimate,
    /// Fraction of all points that face the light and are shadowed.
    pub distant_shadow: Estimate,
    /// Fraction of all points that face away from the eye.
    pub local_mask: Estimate,
    /// Fraction of all points that face the eye and are masked.
    pub distant_mask: Estimate,
    /// Fraction of the points facing the eye that are visible.
    pub g1_view: Estimate,
    /// Fraction of the points that face both directions that are lit and visible.
    pub g2: Estimate,
    /// Smith's `G1(wi) G1(wo)`.
    pub smith_separable_g2: f64,
    /// Smith's `1 / (1 + Lambda(wi) + Lambda(wo))`.
    pub smith_correlated_g2: f64,
    /// `g2` of V-cavities.
    pub v_cavity_g2: f64,
    /// `1 - N_s / N` of the 2019 paper, over the samples of the grid: the fraction of those that are lit and
    /// seen.
    pub paper_g2: Estimate,
    /// Fraction of all points that are lit and whose mirrored ray escapes.
    pub mirror_g2: Option<Estimate>,
}

/// What was done, and how long it took.
#[derive(Clone, Debug, Serialize)]
pub struct AttenuationWork {
    /// Surfaces of each sigma.
    pub realisations: u64,
    /// Points of a surface.
    pub points: u64,
    /// Samples of a surface over which `paper_g2` is.
    pub samples: u64,
    /// Rays or horizons.
    pub method: VisibilityMethod,
    /// Visibility rays lost to numerical failure; they count as blocked.
    pub lost: u64,
    /// Seconds from beginning to end.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
}

/// What an attenuation run found.
#[derive(Clone, Debug)]
pub struct AttenuationOutcome {
    /// The configuration that was run.
    pub config: AttenuationConfig,
    /// Rows by sigma, light and view, the last changing fastest.
    pub rows: Vec<AttenuationRow>,
    /// Where shadow begins, one per sigma; empty if that was not requested.
    pub demarcation: Vec<Demarcation>,
    /// Visibility by sigma, light and height; empty if that was not requested.
    pub visibility: Vec<VisibilityRow>,
    /// What was done.
    pub work: AttenuationWork,
    /// How far the slope variance of the mesh lies below that of the continuous surface, as a fraction; 0 for smooth cells.
    pub mesh_slope_deficit: f64,
    /// Independent points over all surfaces of a sigma: points within a correlation length see much the same.
    pub(crate) independent_points: f64,
    models_at: Vec<f64>,
    over_sigma_at: Vec<f64>,
    /// What ended the run before all surfaces were measured.
    pub stopped_by: Option<StoppedBy>,
}

impl AttenuationOutcome {
    /// What a reader should not miss.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let work = &self.work;
        let lost = (work.lost > 0).then(|| {
            format!(
                "{} visibility rays were lost to numerical failure; they count as blocked",
                work.lost
            )
        });
        let stopped = self.stopped_by.map(|_| {
            format!(
                "interrupted: these are the results of {} of {}",
                work.realisations,
                counted(self.config.run.realisations.0, "surface")
            )
        });
        lost.into_iter().chain(stopped).collect()
    }
}

/// Measures geometric attenuation.
///
/// # Errors
/// [`AttenuationError`] if the configuration makes no sense, does not fit into memory, or the run is
/// interrupted before its first surface is finished.
pub fn attenuation(
    config: &AttenuationConfig,
    progress: &dyn Observer,
) -> Result<AttenuationOutcome, AttenuationError> {
    let began = Instant::now();
    let plan = config.plan()?;
    let realisations = config.run.realisations.0;
    progress.begin("measuring", realisations * plan.sigmas.len() as u64);
    let mut counts: Vec<Vec<Counts>> = vec![Vec::new(); plan.sigmas.len()];
    let mut rises = Vec::new();
    let mut stopped_by = None;
    for index in 0..realisations {
        let Some(surveyed) = survey(config, &plan, index, progress)? else {
            stopped_by = progress.stop();
            break;
        };
        for (all, one) in counts.iter_mut().zip(surveyed.counts) {
            all.push(one);
        }
        if config.run.demarcation
            && let Some((horizons, least)) = surveyed.horizons
        {
            rises.push(Rises::of(&horizons, least));
        }
    }
    progress.end();
    let Some(first) = counts[0].first() else {
        return Err(AttenuationError::Interrupted);
    };
    Ok(AttenuationOutcome {
        config: config.clone(),
        rows: rows(&plan, &counts),
        demarcation: demarcation(&plan, &rises),
        visibility: if config.run.heights {
            visibility(&plan, &counts)
        } else {
            Vec::new()
        },
        work: AttenuationWork {
            realisations: counts[0].len() as u64,
            points: first.points,
            samples: first.samples,
            method: plan.method,
            lost: counts.iter().flatten().map(|counts| counts.lost).sum(),
            seconds: began.elapsed().as_secs_f64(),
            threads: rayon::current_num_threads(),
        },
        mesh_slope_deficit: mesh_slope_deficit(&plan),
        independent_points: plan.independent_points(first.points) * counts[0].len() as f64,
        models_at: plan.models_at,
        over_sigma_at: plan.over_sigma_at,
        stopped_by,
    })
}

/// The rows of all sigma, lights and views.
fn rows(plan: &Plan, counts: &[Vec<Counts>]) -> Vec<AttenuationRow> {
    let mut rows = Vec::new();
    for (sigma, counts) in counts.iter().enumerate() {
        for light in 0..plan.lights.len() {
            rows.extend((0..plan.views.len()).map(|view| row(plan, [sigma, light, view], counts)));
        }
    }
    rows
}

fn row(plan: &Plan, [sigma, i, o]: [usize; 3], counts: &[Counts]) -> AttenuationRow {
    let (light, view, slopes) = (plan.lights[i], plan.views[o], &plan.slopes[sigma]);
    let (wi, wo) = (light.wi(), view.wi());
    let sigma = plan.sigmas[sigma];
    // Ratios of what is counted on each surface.
    let fraction = |over: &dyn Fn(&Counts) -> u64, under: &dyn Fn(&Counts) -> u64| {
        let pair = |counts: &Counts| [over(counts), under(counts)].map(|count| count as f64);
        ratio(counts.iter().map(pair))
    };
    let of_all = |over: &dyn Fn(&Counts) -> u64| fraction(over, &|counts| counts.points);
    let areas = |of: fn(Area, f64) -> [f64; 2]| {
        let pair = |counts: &Counts| of(counts.areas[i], counts.points as f64);
        ratio(counts.iter().map(pair))
    };
    let pair = i * plan.views.len() + o;
    AttenuationRow {
        sigma,
        theta: light.theta_deg(),
        phi: light.phi_deg(),
        view_theta: view.theta_deg(),
        view_phi: view.phi_deg(),
        lit: of_all(&|counts| counts.lights[i].free),
        g1: fraction(&|counts| counts.lights[i].free, &|counts| {
            counts.lights[i].facing
        }),
        g1_projected: areas(|area, _| [area.free, area.facing]),
        lit_projected: areas(|area, points| [area.free, points]),
        smith_lit: smith_lit(slopes, wi),
        smith_g1: Beckmann::new(*slopes).g1(wi),
        smith_lit_as_printed: smith_lit_as_printed(sigma, wi),
        v_cavity_lit: v_cavity_lit(slopes, wi),
        v_cavity_g1: v_cavity_mean_g1(slopes, wi),
        local_shadow: of_all(&|counts| counts.points - counts.lights[i].facing),
        distant_shadow: of_all(&|counts| counts.lights[i].facing - counts.lights[i].free),
        local_mask: of_all(&|counts| counts.points - counts.views[o].facing),
        distant_mask: of_all(&|counts| counts.views[o].facing - counts.views[o].free),
        g1_view: fraction(&|counts| counts.views[o].free, &|counts| {
            counts.views[o].facing
        }),
        g2: fraction(&|counts| counts.pairs[pair].free, &|counts| {
            counts.pairs[pair].facing
        }),
        smith_separable_g2: smith_separable_g2(slopes, wi, wo),
        smith_correlated_g2: smith_correlated_g2(slopes, wi, wo),
        v_cavity_g2: v_cavity_mean_g2(slopes, wi, wo),
        paper_g2: fraction(&|counts| counts.paper[pair], &|counts| counts.samples),
        mirror_g2: (!counts[0].mirrored.is_empty()).then(|| of_all(&|counts| counts.mirrored[i])),
    }
}

fn demarcation(plan: &Plan, rises: &[Rises]) -> Vec<Demarcation> {
    if rises.is_empty() {
        return Vec::new();
    }
    rough_surfaces(plan)
        .map(|surface| Demarcation::new(&surface, rises, surface.sigma / plan.sigmas[0]))
        .collect()
}

fn visibility(plan: &Plan, counts: &[Vec<Counts>]) -> Vec<VisibilityRow> {
    let mut rows = Vec::new();
    for (surface, counts) in rough_surfaces(plan).zip(counts) {
        let counts: Vec<&Counts> = counts.iter().collect();
        for (light, incidence) in plan.lights.iter().enumerate() {
            rows.extend(heights::rows(&surface, light, incidence, &counts));
        }
    }
    rows
}

/// The surfaces of each sigma.
fn rough_surfaces(plan: &Plan) -> impl Iterator<Item = RoughSurface<'_>> {
    let sigmas = plan.sigmas.iter().zip(&plan.slopes);
    sigmas.map(|(&sigma, slopes)| RoughSurface {
        sigma,
        tau: plan.tau,
        slopes,
    })
}

/// How far the slope variance of the mesh lies below that of the continuous surface: the worse of the two
/// axes.
fn mesh_slope_deficit(plan: &Plan) -> f64 {
    if plan.recipes.cells() == Cells::Smooth {
        return 0.0;
    }
    let deficit = |step: f64| {
        let square = (step / plan.tau).powi(2);
        1.0 + (-square).exp_m1() / square
    };
    let [dx, dy] = plan.spacing;
    deficit(dx).max(deficit(dy))
}
