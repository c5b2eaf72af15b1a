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
//! If the edge of a shadow falls across a facet, the side away from the light is lit, and there the sample is
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
//! # Visibility
//! For flat cells the horizon of a point, the steepest rise along an azimuth, answers for all its polar angles
//! ([`asperity_tracer::Horizons`]), and for all sigma, to which it is proportional. One visibility ray per point and direction
//! ([`asperity_tracer::trace_visibility`]) gives the same answers: tests compare them. Mirrored rays have no azimuth in common and are
//! always visibility rays.
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
mod skyline;
mod smooth_ground;
mod study;
mod survey;
mod tables;
#[cfg(test)]
mod tests;

use asperity_analysis::SlopeCovariance;
use asperity_numerics::elementary::exp_m1;
use asperity_optics::Incidence;
use asperity_results::Container;
use asperity_simulate::{Cells, SimulateError, StoppedBy, counted};
use asperity_tally::Estimate;
use serde::Serialize;

use crate::error::StudyError;
use crate::report::flux_basis::patches;

pub use config::{
    AttenuationConfig, AttenuationDirections, AttenuationOutput, AttenuationRun, AttenuationSurface,
};
pub use demarcation::Demarcation;
pub use given::ShadowShares;
pub use heights::VisibilityRow;
pub use plan::AttenuationStudy;
pub use survey::SurveyedSurface;

use counts::Counts;
use demarcation::Rises;
use estimate::ratio;

/// Fractions for one sigma, light and view.
#[derive(Clone, Debug)]
pub struct AttenuationRow {
    /// Root mean square height, length units.
    pub sigma: f64,
    /// Slopes of the continuous surface, by which theory expects the same.
    pub slopes: SlopeCovariance,
    /// Direction towards the light.
    pub light: Incidence,
    /// Direction towards the eye.
    pub view: Incidence,
    /// Fraction of all points that are lit.
    pub lit: Estimate,
    /// Fraction of the points facing the light that are lit.
    pub g1: Estimate,
    /// `g1` weighted by projected areas, `wi.m / m.z`, which Smith's G1 is exactly.
    pub g1_projected: Estimate,
    /// Projected area of all lit points over that of the mean plane: one, if none is lost or seen twice.
    pub lit_projected: Estimate,
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
    /// `1 - N_s / N` of the 2019 paper, over the samples of the grid: the fraction of those that are lit and
    /// seen.
    pub paper_g2: Estimate,
    /// Fraction of all points that are lit and whose mirrored ray escapes.
    pub mirror_g2: Option<Estimate>,
}

/// Work, and its time.
#[derive(Clone, Debug, Serialize)]
pub struct AttenuationWork {
    /// Surfaces of each sigma.
    pub realisations: u64,
    /// Points of a surface.
    pub points: u64,
    /// Samples of a surface over which `paper_g2` is.
    pub samples: u64,
    /// Visibility method: `rays` or `horizons`.
    pub method: &'static str,
    /// Visibility rays lost to numerical failure; they count as blocked.
    pub lost: u64,
    /// Seconds from beginning to end.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
}

/// Outcome of an attenuation run.
pub struct AttenuationOutcome<'a> {
    /// Study.
    pub study: &'a AttenuationStudy,
    /// Rows by sigma, light and view, the last changing fastest.
    pub rows: Vec<AttenuationRow>,
    /// Angles at which shadow begins, one per sigma; empty if not requested.
    pub demarcation: Vec<Demarcation>,
    /// Visibility by sigma, light and height; empty if that was not requested.
    pub visibility: Vec<VisibilityRow>,
    /// Work.
    pub work: AttenuationWork,
    /// Cause of an end before all surfaces were measured.
    pub stopped_by: Option<StoppedBy>,
}

impl AttenuationOutcome<'_> {
    /// Rows of the first view, on which what is lit does not depend.
    fn of_first_view(&self) -> impl Iterator<Item = &AttenuationRow> {
        self.rows.iter().step_by(self.study.views.len())
    }

    /// Independent points over all surfaces of a sigma: no more than there are patches of a correlation length, in which points see
    /// much the same.
    fn independent_points(&self) -> f64 {
        let drawn = &self.study.surfaces[0].drawn;
        let tau = self.study.config.surface.tau.0;
        let patches = patches(drawn.shape(), drawn.spacing(), [tau; 2]);
        patches.min(self.work.points as f64) * self.work.realisations as f64
    }

    /// Warnings for the reader.
    fn warnings(&self) -> Vec<String> {
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
                counted(self.study.config.run.realisations.0, "surface")
            )
        });
        lost.into_iter().chain(stopped).collect()
    }
}

impl AttenuationStudy {
    /// Outcome of the surfaces that were found.
    ///
    /// # Errors
    /// [`SimulateError::Interrupted`] if there are none.
    pub(crate) fn outcome(
        &self,
        found: &Container<'_, SurveyedSurface>,
    ) -> Result<AttenuationOutcome<'_>, StudyError> {
        let found_surfaces = || found.cases().map(|(_, surface)| surface);
        let first = found_surfaces().next();
        let first = &first.ok_or(SimulateError::Interrupted)?.counts[0];
        let rises: Vec<Rises> = found_surfaces().filter_map(|found| found.rises).collect();
        let tau = self.config.surface.tau.0;
        let (mut rows, mut demarcation, mut visibility) = (Vec::new(), Vec::new(), Vec::new());
        for (number, surfaces) in self.surfaces.iter().enumerate() {
            let counts: Vec<&Counts> = found_surfaces().map(|one| &one.counts[number]).collect();
            for light in 0..self.lights.len() {
                let views = 0..self.views.len();
                rows.extend(views.map(|view| self.row([number, light, view], &counts)));
            }
            if !rises.is_empty() {
                let factor = surfaces.sigma / self.surfaces[0].sigma;
                demarcation.push(Demarcation::new(surfaces, tau, &rises, factor));
            }
            if self.config.run.heights {
                let lights = self.lights.iter().enumerate();
                visibility
                    .extend(lights.flat_map(|light| heights::rows(surfaces, tau, light, &counts)));
            }
        }
        let lost = found_surfaces().flat_map(|one| &one.counts);
        Ok(AttenuationOutcome {
            study: self,
            rows,
            demarcation,
            visibility,
            work: AttenuationWork {
                realisations: found_surfaces().count() as u64,
                points: first.points,
                samples: first.samples,
                method: self.method(),
                lost: lost.map(|counts| counts.lost).sum(),
                seconds: found.seconds(),
                threads: rayon::current_num_threads(),
            },
            stopped_by: found.stopped_by(),
        })
    }

    /// The row of the sigma, light and view of these numbers, of the `counts` of all realisations.
    fn row(&self, [sigma, i, o]: [usize; 3], counts: &[&Counts]) -> AttenuationRow {
        // Ratios of what is measured on each surface.
        let areas = |of: &dyn Fn(&Counts) -> [f64; 2]| ratio(counts.iter().map(|one| of(one)));
        let fraction =
            |of: &dyn Fn(&Counts) -> [u64; 2]| areas(&|one| of(one).map(|count| count as f64));
        let of_all = |of: &dyn Fn(&Counts) -> u64| fraction(&|one| [of(one), one.points]);
        let pair = i * self.views.len() + o;
        let surfaces = &self.surfaces[sigma];
        AttenuationRow {
            sigma: surfaces.sigma,
            slopes: surfaces.slopes,
            light: self.lights[i],
            view: self.views[o],
            lit: of_all(&|one| one.lights.free[i]),
            g1: fraction(&|one| [one.lights.free[i], one.lights.facing[i]]),
            g1_projected: areas(&|one| [one.areas.free[i], one.areas.facing[i]]),
            lit_projected: areas(&|one| [one.areas.free[i], one.points as f64]),
            local_shadow: of_all(&|one| one.points - one.lights.facing[i]),
            distant_shadow: of_all(&|one| one.lights.facing[i] - one.lights.free[i]),
            local_mask: of_all(&|one| one.points - one.views.facing[o]),
            distant_mask: of_all(&|one| one.views.facing[o] - one.views.free[o]),
            g1_view: fraction(&|one| [one.views.free[o], one.views.facing[o]]),
            g2: fraction(&|one| [one.pairs.free[pair], one.pairs.facing[pair]]),
            paper_g2: fraction(&|one| [one.paper[pair], one.samples]),
            mirror_g2: (self.config.run.mirror).then(|| of_all(&|one| one.mirrored[i])),
        }
    }

    /// Deficit of the slope variance of the mesh below that of the continuous surface, as a fraction: the worse of the two
    /// axes. 0 for smooth cells.
    fn mesh_slope_deficit(&self) -> f64 {
        let drawn = &self.surfaces[0].drawn;
        if drawn.cells() == Cells::Smooth {
            return 0.0;
        }
        let [dx, dy] = drawn.spacing();
        let square = (dx.max(dy) / self.config.surface.tau.0).powi(2);
        1.0 + exp_m1(-square) / square
    }
}
