//! Mesh error: what the spacing of a mesh does to results, by quadrature or by meshes of several spacings.

use asperity_analysis::{ModelError, SlopeCovariance, control_variate, unshadowed_fluxes};
use asperity_surface::Border;
use asperity_synthesis::Synthesis;
use asperity_tally::{ByEntry, ControlVariate, TallySpec, TallyValues, UnshadowedFluxes};
use asperity_tracer::Shape;
use serde::{Deserialize, Serialize};

use super::refinement::Refinement;
use crate::input::case::Case;
use crate::input::settings::Settings;
use crate::methods::method::Method;
use crate::slopes::slopes;

/// Said of a mesh error that was not requested.
const NOT_REQUESTED: &str = "not estimated: --refine traces a finer mesh";

/// Reasons why the mesh error of a surface is unknown.
const OPEN: &str = "not estimated: a surface with an open border cannot be refined";
const TRIANGLES: &str = "none: the triangles given are the surface";
const SMOOTH: &str = "none: the spline through the heights given is the surface";

/// Said of random surfaces of smooth cells that are not refined; the figures are those of docs/how_it_works/smooth_cells.md.
const RANDOM_SMOOTH: &str = "not estimated: --refine traces a finer mesh; of 4 smooth cells per correlation length it was below 3e-4 in every flux tried, s = 0.5 to 3";

/// Said of random surfaces whose slopes are not Gaussian and that are not refined.
const NOT_GAUSSIAN: &str =
    "not estimated: it is computed for Gaussian slopes alone; --refine traces a finer mesh";

/// Said of structures, by whether facets are the structure itself.
const EXACT: &str = "0: the facets are the structure itself";
const CUT: &str = "not estimated: facets cut across edges or curves of the structure; --refine traces a finer mesh";

/// Said of what a control variate removes where the slopes of cells are not Gaussian.
const UNKNOWN_SLOPES_OF_CELLS: &str = "not estimated: the control variate has the slopes of the continuous surface, and those of the cells are not known in closed form";

/// Said of what a control variate removes where cells are smooth.
const SAME_SLOPES: &str = "none: smooth cells have the slopes of the continuous surface";

/// Said of a mesh error, wherever it comes from.
const SIGN: &str = "what the mesh adds to the result, so less it is that of the continuous surface";

/// Slope variance below which the plain estimate is not made to wait for a quadrature: lobes narrower than
/// a thousandth of a milliradian take it minutes, and lie in one bin.
const LEAST_SLOPE_VARIANCE: f64 = 1e-12;

/// The error of a mesh, by the entries of a tally.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeshErrors {
    /// Shift by the mesh, where it is known.
    pub(crate) remaining: ByEntry<Option<f64>>,
    /// Shift by the mesh without the control variate.
    pub(crate) removed: Option<TallyValues>,
    /// Explanation of both.
    pub(crate) explanation: MeshExplanation,
    pub(crate) refinement: Option<Refinement>,
    /// `true` if facets cut across edges of a structure, and how much that changes is not known.
    #[serde(default)]
    pub(crate) cuts_edges: bool,
}

/// Explanation of the estimates of mesh errors, or why there are none: a sentence each.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct MeshExplanation {
    pub(crate) remaining: String,
    pub(crate) removed: String,
}

impl MeshExplanation {
    fn of_remaining(remaining: &str) -> Self {
        Self {
            remaining: remaining.to_owned(),
            removed: NOTHING_REMOVED.to_owned(),
        }
    }
}

/// Said where no analytic result is subtracted.
const NOTHING_REMOVED: &str = "none: no result of the continuous surface is subtracted";

impl MeshErrors {
    /// Not known of any entry, and why.
    pub(crate) fn unknown(spec: TallySpec, why: &str) -> Self {
        Self {
            remaining: ByEntry::filled(spec, None),
            removed: None,
            explanation: MeshExplanation::of_remaining(why),
            refinement: None,
            cuts_edges: false,
        }
    }

    /// Mesh error of given surfaces, and what their refinement showed, if they were refined.
    pub(crate) fn of_given(
        shapes: &[Shape],
        spec: TallySpec,
        refinement: Option<Refinement>,
    ) -> Self {
        if let Some(refinement) = refinement {
            return Self::of_refined(refinement);
        }
        let with_relief = shapes.iter().find(|shape| !shape.is_level());
        match with_relief.unwrap_or(&shapes[0]) {
            Shape::TriangleMesh { .. } => Self::unknown(spec, TRIANGLES),
            Shape::Smooth { .. } => Self::unknown(spec, SMOOTH),
            Shape::HeightField { top, .. } if top.is_flat() => Self {
                remaining: ByEntry::filled(spec, Some(0.0)),
                ..Self::unknown(spec, "0: any mesh shows a flat surface as it is")
            },
            Shape::HeightField { top, .. } if top.field().border() == Border::Open => {
                Self::unknown(spec, OPEN)
            }
            Shape::HeightField { .. } => Self::unknown(spec, NOT_REQUESTED),
        }
    }

    /// Mesh error of random surfaces of smooth cells, estimated by `method`: what their refinement showed, if they were refined, or
    /// else what the pilot run found, if there was one, in words.
    pub(crate) fn of_random_smooth(
        method: &Method,
        spec: TallySpec,
        refinement: Option<Refinement>,
        by_pilot_run: Option<&str>,
    ) -> Self {
        let mut errors = match refinement {
            Some(refinement) => Self::of_refined(refinement),
            None => Self::unknown(spec, by_pilot_run.unwrap_or(RANDOM_SMOOTH)),
        };
        if method.control_variate().is_some() {
            errors.explanation.removed = SAME_SLOPES.to_owned();
        }
        errors
    }

    /// Mesh error of random surfaces whose slopes are not Gaussian: what their refinement showed, if they were refined, or else what
    /// the pilot run found, if there was one, in words. `is_exact`: whether facets are the structure itself, of structures.
    pub(crate) fn of_random_fields(
        is_exact: Option<bool>,
        method: &Method,
        spec: TallySpec,
        refinement: Option<Refinement>,
        by_pilot_run: Option<&str>,
    ) -> Self {
        let mut errors = match refinement {
            Some(refinement) => Self::of_refined(refinement),
            None if is_exact == Some(true) => Self {
                remaining: ByEntry::filled(spec, Some(0.0)),
                ..Self::unknown(spec, EXACT)
            },
            None if is_exact == Some(false) => Self {
                cuts_edges: by_pilot_run.is_none(),
                ..Self::unknown(spec, by_pilot_run.unwrap_or(CUT))
            },
            None => Self::unknown(spec, by_pilot_run.unwrap_or(NOT_GAUSSIAN)),
        };
        if method.control_variate().is_some() {
            errors.explanation.removed = UNKNOWN_SLOPES_OF_CELLS.to_owned();
        }
        errors
    }

    /// Mesh error of one surface that was refined.
    fn of_refined(refinement: Refinement) -> Self {
        Self {
            remaining: measured(&refinement),
            removed: None,
            explanation: MeshExplanation::of_remaining(&by_refinement(&refinement)),
            refinement: Some(refinement),
            cuts_edges: false,
        }
    }

    /// Mesh error of a case whose surfaces `synthesis` draws, of flat cells; what the pilot run found, if there was one, in words.
    pub(crate) fn of_random(
        case: &Case,
        synthesis: &Synthesis,
        method: &Method,
        settings: &Settings,
        refinement: Option<Refinement>,
        by_pilot_run: Option<&str>,
    ) -> Self {
        let first_order = FirstOrder {
            case,
            synthesis,
            spec: settings.spec_of(case),
        };
        let unknown = by_pilot_run.unwrap_or(NOT_REQUESTED);
        let mut errors = Self::unknown(first_order.spec, unknown);
        match method.control_variate() {
            _ if !settings.mesh_quadrature => {}
            Some(control_variate) => {
                first_order.removed_from(&mut errors, refinement.is_some(), control_variate)
            }
            None if !case.layers.is_empty() => {
                let said = &mut errors.explanation.remaining;
                said.push_str("; it is not computed for surfaces over a medium");
            }
            None if case.light.spread.is_some() => {
                let said = &mut errors.explanation.remaining;
                said.push_str("; it is not computed for light of several directions");
            }
            None if refinement.is_none() => first_order.remaining_in(&mut errors),
            None => {}
        }
        if let Some(refinement) = refinement {
            errors.remaining = measured(&refinement);
            errors.explanation.remaining = by_refinement(&refinement);
            errors.refinement = Some(refinement);
        }
        errors
    }
}

/// The part of what halving the spacing changed that is left.
fn measured(refinement: &Refinement) -> ByEntry<Option<f64>> {
    ByEntry::from_fn(*refinement.spec(), |entry| {
        Some(refinement.remaining(entry).mean)
    })
}

/// Explanation of a measured mesh error.
fn by_refinement(refinement: &Refinement) -> String {
    format!("{SIGN}; {}", refinement.convergence().words())
}

/// First-order shift of single scattering by the slopes of facets.
struct FirstOrder<'a> {
    case: &'a Case,
    synthesis: &'a Synthesis,
    spec: TallySpec,
}

impl FirstOrder<'_> {
    /// Puts what the control variate has removed into `errors`.
    fn removed_from(
        &self,
        errors: &mut MeshErrors,
        refined: bool,
        control_variate: &ControlVariate,
    ) {
        let said = &mut errors.explanation;
        match self.removed(refined, control_variate) {
            Ok(values) => {
                said.remaining
                    .push_str("; the part that is removed is not included");
                said.removed = format!(
                    "exact, by quadrature: unshadowed single scattering by the slopes of the facets, less that by those of the continuous surface, in the fractions that the control variate subtracts{}",
                    self.over_azimuth()
                );
                errors.removed = Some(values);
            }
            Err(error) => said.removed = format!("not estimated: {error}"),
        }
    }

    /// Puts what the mesh adds to the plain estimate into `errors`.
    fn remaining_in(&self, errors: &mut MeshErrors) {
        let said = &mut errors.explanation.remaining;
        match self.shift() {
            Ok(values) => {
                *said = format!(
                    "{SIGN}; estimated by quadrature: unshadowed single scattering by the slopes of the facets, less that by those of the continuous surface, in the fractions that Smith's masking leaves{}; what it gains or loses in all is taken off the energies in proportion; null for light scattered more than once: --refine traces a finer mesh",
                    self.over_azimuth()
                );
                errors.remaining = values;
            }
            Err(error) => *said = format!("not estimated: {error}; --refine traces a finer mesh"),
        }
    }

    /// Shift removed by completing the tallies of a control variate.
    fn removed(
        &self,
        refined: bool,
        control_variate: &ControlVariate,
    ) -> Result<TallyValues, String> {
        let slopes = if refined {
            let finer = finer(self.synthesis).ok_or("the finer mesh has too many samples")?;
            self.slopes(&finer)
        } else {
            self.slopes(self.synthesis)
        };
        let fluxes = slopes.and_then(|slopes| self.fluxes(&slopes));
        let fluxes = fluxes.map_err(|error| error.to_string())?;
        Ok(control_variate.removed(&fluxes))
    }

    /// Shift of the plain estimate by the mesh, where light of the first order reaches.
    fn shift(&self) -> Result<ByEntry<Option<f64>>, String> {
        let variance = self.synthesis.psd().slope_variance();
        if variance.into_iter().fold(0.0, f64::max) < LEAST_SLOPE_VARIANCE {
            return Err("the surface is so smooth that its lobe is hard to integrate".into());
        }
        self.shift_of_rough().map_err(|error| error.to_string())
    }

    fn shift_of_rough(&self) -> Result<ByEntry<Option<f64>>, ModelError> {
        let (material, incidence) = (self.case.material, self.case.light.incidence);
        let of_surface = slopes(self.synthesis.recipe())?;
        let control_variate = control_variate(&of_surface.into(), material, incidence, &self.spec)?;
        let fluxes = self.fluxes(&self.slopes(self.synthesis)?)?;
        let of_mesh = ControlVariate::new(self.spec, control_variate.fractions().clone(), &fluxes);
        let mut shift = of_mesh
            .expected()
            .zip_map(control_variate.expected(), |mesh, surface| {
                (mesh != surface).then_some(mesh - surface)
            });
        // What single scattering gains, light scattered more often loses, and the energies hold both.
        let closed = control_variate.removed(&fluxes);
        for total in [
            TallySpec::BUDGET.reflected,
            TallySpec::BUDGET.transmitted,
            TallySpec::BUDGET.absorbed,
        ] {
            shift[total] = Some(closed[total]);
        }
        Ok(shift)
    }

    fn fluxes(&self, slopes: &SlopeCovariance) -> Result<UnshadowedFluxes, ModelError> {
        let incidence = self.case.light.incidence;
        unshadowed_fluxes(slopes, self.case.material, incidence, &self.spec)
    }

    /// Slopes of the facets; their mean over azimuth where the light may come from any.
    fn slopes(&self, synthesis: &Synthesis) -> Result<SlopeCovariance, ModelError> {
        let [xx, xy, yy] = synthesis.facet_slope_covariance();
        if self.case.light.random_azimuth {
            let mean = 0.5 * (xx + yy);
            return Ok(SlopeCovariance::new(mean, mean, 0.0)?);
        }
        Ok(SlopeCovariance::new(xx, yy, xy)?)
    }

    /// Addition to the explanation for light of any azimuth.
    const fn over_azimuth(&self) -> &'static str {
        if self.case.light.random_azimuth {
            ", whose variance is averaged over azimuth: that facets correlate slopes along x and y is of second order then"
        } else {
            ""
        }
    }
}

/// The surfaces at half the spacing; `None` if that has too many samples.
fn finer(synthesis: &Synthesis) -> Option<Synthesis> {
    let shape = synthesis.shape().map(|n| 2 * n);
    let spacing = synthesis.spacing().map(|d| d / 2.0);
    Synthesis::new(synthesis.psd().clone(), shape, spacing, true).ok()
}
