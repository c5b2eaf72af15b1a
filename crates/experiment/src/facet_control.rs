//! The control of one given surface: its own unshadowed single scattering, summed over its facets.
//!
//! Of a measured surface there is no ensemble whose mean could be taken. The sum over all facets takes
//! its place, so that what is left to sampling is shadow, masking and multiple scattering of this
//! surface; noise of rays goes, and there is no other.

use asperity_analysis::{ModelError, SlopeCovariance, visible_shares};
use asperity_optics::{Incidence, Material};
use asperity_surface::{Border, HeightField};
use asperity_tally::{Control, Layout, Sides};
use asperity_tracer::{Geometry, Medium, Surface, sum_over_facets, unshadowed_fluxes};
use rayon::prelude::*;

use crate::blocks::{RECORD_BUDGET, RaySettings};
use crate::estimator::Estimator;
use crate::limits::RunError;
use crate::method::{ControlMean, Method};

/// Parts that the sum over facets is divided into, whatever the number of threads.
const PARTS: usize = 64;

impl Method {
    /// The method for light on one given surface.
    ///
    /// Where the choice is free, a control is taken if it promises to pay and the sum over all facets
    /// costs less than the rays do.
    ///
    /// # Errors
    /// [`RunError::OpenControl`] where a control is insisted on for an open patch: rays that come from
    /// beside it meet other facets than those that are summed over.
    pub(crate) fn of_surface(
        surface: &Surface,
        material: Material,
        incidence: Incidence,
        incident: Medium,
        settings: &RaySettings,
    ) -> Result<Self, RunError> {
        let estimator = settings.estimator;
        let open = surface.border() == Border::Open;
        let few_rays = (settings.rays as usize) < surface.facet_count();
        let pointless = open || few_rays || surface.is_flat();
        if estimator == Estimator::Plain || estimator == Estimator::Auto && pointless {
            return Ok(Self::PLAIN);
        }
        if open {
            return Err(RunError::OpenControl);
        }
        let Some(slopes) = slopes(surface.field()) else {
            return Ok(Self::PLAIN);
        };
        // The side that is not asked for has its control too.
        let layout = settings.layout;
        let both = layout.with_sides(Sides::Both);
        let shares = match visible_shares(&slopes, material, incidence, &layout) {
            Ok(shares) => shares,
            Err(ModelError::MatchedIndices(_)) if estimator == Estimator::Auto => {
                return Ok(Self::PLAIN);
            }
            Err(error) => return Err(error.into()),
        };
        let record = sum_over_all_facets(surface, material, incidence, incident, both);
        let control = Control::new(layout, shares, &unshadowed_fluxes(&both, &record));
        let mean = ControlMean::FacetsOfSurface;
        Ok(Self::with_control(
            estimator, control, mean, &slopes, incidence,
        ))
    }
}

/// The sum over all facets, part by part.
fn sum_over_all_facets(
    surface: &Surface,
    material: Material,
    incidence: Incidence,
    incident: Medium,
    layout: Layout,
) -> Vec<f64> {
    let facets = surface.facet_count();
    // Records of all parts are held until they are added in their order.
    let parts = (RECORD_BUDGET / (layout.len() * size_of::<f64>())).clamp(1, PARTS);
    let bound = |part: usize| (facets as u128 * part as u128 / parts as u128) as usize;
    let records: Vec<Vec<f64>> = (0..parts)
        .into_par_iter()
        .with_max_len(1)
        .map(|part| {
            let range = bound(part)..bound(part + 1);
            sum_over_facets(surface, material, incidence, incident, layout, range)
        })
        .collect();
    let mut sum = vec![0.0; layout.len()];
    for record in records {
        for (sum, value) in sum.iter_mut().zip(record) {
            *sum += value;
        }
    }
    sum
}

/// Mean squares and products of the facets' slopes, from which shares are guessed; the same along all
/// directions where they are not those of a surface, as of grooves; `None` without any.
fn slopes(field: &HeightField) -> Option<SlopeCovariance> {
    let [cx, cy] = field.cells();
    let facets = 2.0 * (cx * cy) as f64;
    let sums: Vec<[f64; 3]> = (0..cy)
        .into_par_iter()
        .map(|iy| {
            let mut sum = [0.0; 3];
            for ix in 0..cx {
                for [x, y] in field.facet_slopes(ix, iy) {
                    sum = [sum[0] + x * x, sum[1] + x * y, sum[2] + y * y];
                }
            }
            sum
        })
        .collect();
    let [xx, xy, yy] = [0, 1, 2].map(|i| sums.iter().map(|row| row[i]).sum::<f64>() / facets);
    SlopeCovariance::new(xx, yy, xy)
        .or_else(|_| SlopeCovariance::new(0.5 * (xx + yy), 0.5 * (xx + yy), 0.0))
        .ok()
}
