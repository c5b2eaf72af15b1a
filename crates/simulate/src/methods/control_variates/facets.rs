//! Facet control variate of one given surface: its own unshadowed single scattering, summed over its facets.
//!
//! A given surface belongs to no ensemble whose mean could be taken. The sum over all facets takes the place of
//! that mean. Only shadowing, masking and multiple scattering of this surface are left to sampling, and the
//! noise of rays is the only noise.

use asperity_analysis::{ModelError, SlopeCovariance, SlopeMixture, visible_fractions};
use asperity_optics::Material;
use asperity_surface::{Border, HeightField};
use asperity_tally::{ControlVariate, Sides, TallySpec, TallyValues};
use asperity_tracer::{
    Geometry, MAX_CONDUCTORS, Surface, sum_over_facets, sum_over_facets_of_conductors,
    unshadowed_fluxes,
};

use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::input::settings::Settings;
use crate::methods::method::{ControlVariateMean, Method, SPECULAR_FACETS, UNPOLARISED_LIGHT};

const ENDLESS_SURFACE: &str = "needs a surface that continues beyond its border; this one is an open patch, so take auto or plain, or a periodic or mirrored border";

impl Method {
    /// The method for light on one given surface of flat cells.
    ///
    /// If the choice is free, a control variate is taken if it promises to pay and the sum over all facets
    /// costs less than the rays do.
    ///
    /// # Errors
    /// [`SimulateError::NoControlVariate`] if a control variate is insisted on for an open patch: rays that come from
    /// outside it meet other facets than those that are summed over.
    pub(crate) fn of_surface(
        surface: &Surface,
        case: &Case,
        settings: &Settings,
        sums: &mut FacetSums<'_>,
    ) -> Result<Self, SimulateError> {
        if case.material.is_diffuse() {
            return Self::uncontrolled(settings, SPECULAR_FACETS);
        }
        // No control variate knows of a layer, and that of one surface is of light from one azimuth.
        let light = &case.light;
        if !case.layers.is_empty() || light.random_azimuth || light.spread.is_some() {
            return Ok(Self::plain(settings));
        }
        if case.light.is_polarised() {
            return Self::uncontrolled(settings, UNPOLARISED_LIGHT);
        }
        let estimator = settings.estimator;
        let open = surface.border() == Border::Open;
        let few_rays = (settings.effort.total_rays() as usize) < surface.facet_count();
        let pointless = open || few_rays || surface.is_flat();
        if estimator == Estimator::Plain || estimator == Estimator::Auto && pointless {
            return Ok(Self::plain(settings));
        }
        if open {
            return Self::uncontrolled(settings, ENDLESS_SURFACE);
        }
        let Some(slopes) = slopes(surface.field()) else {
            return Ok(Self::plain(settings));
        };
        // The side that is not recorded has its control variate too.
        let (tally, incidence) = (settings.spec_of(case), case.light.incidence);
        let both = tally.with_sides(Sides::Both);
        let slopes = SlopeMixture::from(slopes);
        let fractions = match visible_fractions(&slopes, case.material, incidence, &tally) {
            Ok(fractions) => fractions,
            Err(ModelError::MatchedIndices(_)) if estimator == Estimator::Auto => {
                return Ok(Self::plain(settings));
            }
            Err(error) => return Err(error.into()),
        };
        let sum = sums.of(surface, case, both);
        let control_variate = ControlVariate::new(tally, fractions, &unshadowed_fluxes(&sum));
        let mean = ControlVariateMean::FacetsOfSurface;
        Self::with_control_variate(settings, control_variate, mean, &slopes, incidence)
    }
}

/// Sums over the facets of one surface. Conductors in the same light are summed in one pass.
pub(crate) struct FacetSums<'a> {
    /// The cases on the surface.
    cases: Vec<&'a Case>,
    /// Finished sums of conductors, until their cases take them.
    made: Vec<(&'a Case, TallySpec, TallyValues)>,
}

impl<'a> FacetSums<'a> {
    pub(crate) fn new(cases: impl IntoIterator<Item = &'a Case>) -> Self {
        Self {
            cases: cases.into_iter().collect(),
            made: Vec::new(),
        }
    }

    /// The sum of a case.
    fn of(&mut self, surface: &Surface, case: &Case, spec: TallySpec) -> TallyValues {
        let facets = 0..surface.facet_count();
        let (incidence, from) = (case.light.incidence, case.light.from);
        let is_made = |(one, of, _): &(&Case, TallySpec, TallyValues)| {
            one.material == case.material && one.light == case.light && *of == spec
        };
        if let Some(made) = self.made.iter().position(is_made) {
            return self.made.swap_remove(made).2;
        }
        let alike = self.cases.iter().filter_map(|one| {
            let Material::Conductor { eta, kappa } = one.material else {
                return None;
            };
            let is_alike = one.light == case.light && one.bins == case.bins;
            is_alike.then_some((*one, [eta, kappa]))
        });
        let (cases, indices): (Vec<&Case>, Vec<[f64; 2]>) = alike.take(MAX_CONDUCTORS).unzip();
        if !cases.iter().any(|one| one.material == case.material) {
            return sum_over_facets(surface, case.material, incidence, from, spec, facets);
        }
        self.cases
            .retain(|one| !cases.iter().any(|made| std::ptr::eq(*made, *one)));
        let sums = sum_over_facets_of_conductors(surface, &indices, incidence, from, spec, facets);
        let made = cases.into_iter().zip(sums);
        self.made.extend(made.map(|(case, sum)| (case, spec, sum)));
        self.of(surface, case, spec)
    }
}

/// Mean squares and products of the facets' slopes, from which visible fractions are estimated; the same along all
/// directions where they are not those of a surface, as of grooves; `None` without any.
fn slopes(field: &HeightField) -> Option<SlopeCovariance> {
    let [xx, xy, yy] = field.slope_moments().second;
    SlopeCovariance::new(xx, yy, xy)
        .or_else(|_| SlopeCovariance::new(0.5 * (xx + yy), 0.5 * (xx + yy), 0.0))
        .ok()
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Incidence, Material};
    use asperity_synthesis::{Psd, Synthesis};

    use asperity_tally::{TallyResult, TallySpec};
    use asperity_tracer::HalfSpace;

    use super::*;

    /// A black surface absorbs the weights of all facets that face the light: of each half of
    /// a cell `max(0, wi . m) / (cos theta_m cos theta_i) = max(0, 1 - slope . wi / cos theta_i)`, over the
    /// number of facets. In a mirrored tile each stands for its four images. No scale of the sum shows
    /// in results, since the budget of each tally is closed.
    #[test]
    fn the_sum_over_all_facets_is_that_of_their_weights() {
        let black = Material::conductor(1.0, 0.0).unwrap();
        let incidence = Incidence::from_degrees(65.0, 25.0).unwrap();
        let wi = incidence.wi() / incidence.wi().z;
        let spec = TallySpec::default();
        let psd = Psd::gaussian(4.0, 4.0).unwrap();
        let synthesis = Synthesis::new(psd, [34, 36], [1.0, 1.0], false).unwrap();
        for border in [Border::Periodic, Border::Mirrored] {
            let field = synthesis.draw(3, 0).unwrap().with_border(border);
            let images: &[[f64; 2]] = match border {
                Border::Mirrored => &[[1.0, 1.0], [-1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]],
                _ => &[[1.0, 1.0]],
            };
            let [cx, cy] = field.cells();
            let (mut sum, mut lost) = (0.0, 0);
            for (ix, iy) in (0..cx).flat_map(|ix| (0..cy).map(move |iy| (ix, iy))) {
                for [x, y] in field.facet_slopes(ix, iy) {
                    for [flip_x, flip_y] in images {
                        let weight = 1.0 - flip_x * x * wi.x - flip_y * y * wi.y;
                        sum += weight.max(0.0) / (2 * cx * cy * images.len()) as f64;
                        lost += usize::from(weight < 0.0);
                    }
                }
            }
            let surface = Surface::new(field);
            let facets = surface.facet_count();
            assert!(lost > facets / 10, "{facets} {lost}");
            let above = HalfSpace::Above;
            let tally = sum_over_facets(&surface, black, incidence, above, spec, 0..facets);
            println!("{border:?}: {} against {sum}", tally.budget().absorbed);
            // Some 1e4 weights, each with a few roundings.
            assert!((tally.budget().absorbed / sum - 1.0).abs() < 1e-12);
        }
    }
}
