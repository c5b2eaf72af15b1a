//! A given surface against models with its own slopes: its regions take the place of random surfaces.

#[cfg(test)]
mod tests;

use asperity_analysis::{SlopeDistribution, SlopeTableError, SmithSlopes};
use asperity_numerics::elementary::hypot;
use asperity_simulate::{Case, Effort, Estimator, Observer, Outcome, Settings, Shape, short};
use asperity_surface::{Border, HeightField, RegionSlopes};
use asperity_tally::TallyResult;
use asperity_tracer::Polarisation;
use serde_json::{Value, json};

use super::region_plan::RegionPlan;
use crate::comparison::AVERAGED_LAYERS;
use crate::comparison::json::ComparisonJson;
use crate::comparison::judgement::Judgement;
use crate::comparison::models::{Compared, Testing, compare_models};
use crate::comparison::region_shifts::RegionShifts;
use crate::comparison::slope_tables::{SlopeSymmetry, SlopeTables};
use crate::config::case_model::{CaseModel, ModelledSurface};
use crate::config::error::ConfigError;
use crate::config::isotropy::Isotropy;
use crate::config::trace::TraceConfig;
use crate::config::{CompareConfig, RunConfig};
use crate::error::StudyError;
use crate::given::{ComparedSurfaceError, GivenSurfaces};

/// Mean slope, over the root mean square slope, above which a surface is called tilted.
const TILTED: f64 = 0.05;

/// Correlation of the slopes along x and y above which a mirrored tile is said to mix two surfaces.
const SLANTED: f64 = 0.1;

/// Flux that goes down past the rim of an open patch above which that is told.
const PAST_RIM: f64 = 1e-4;

/// A given surface against models.
pub struct TraceComparison<'a> {
    /// The regions of the surface, with a tally of each, against the models.
    pub judgement: Judgement<'a>,
    slopes: &'a Slopes,
}

/// The slopes that models are made for.
#[derive(Clone)]
pub(super) struct Slopes {
    pub(super) plan: RegionPlan,
    pub(super) shifts: RegionShifts,
    /// Slopes of any density, if a model is made of them.
    pub(super) tables: Option<SlopeTables>,
    isotropy: Isotropy,
}

impl Slopes {
    /// Surface that models of the case are made for.
    fn modelled(&self, case: &Case) -> ModelledSurface {
        ModelledSurface {
            slopes: Ok(self.distribution()),
            is_nearly_isotropic: self.isotropy.is_near,
            material: case.material,
            layers: case.layers.clone(),
        }
    }

    /// The `models` that are of isotropic surfaces and take the mean of the slope variances.
    ///
    /// # Errors
    /// [`ComparedSurfaceError::Anisotropic`] if the variances differ by more than they are known to; other refusals of models.
    fn isotropic_models<'a>(
        &self,
        models: &'a [String],
        case: &Case,
        surface: &str,
    ) -> Result<Vec<&'a str>, StudyError> {
        let modelled = self.modelled(case);
        let anisotropic = ModelledSurface {
            is_nearly_isotropic: false,
            ..modelled.clone()
        };
        let mut isotropic = Vec::new();
        for name in models {
            CaseModel::of(name, &modelled).map_err(|error| match error {
                ConfigError::RefusedModel { error, .. } if error.is_anisotropic() => {
                    StudyError::from(ComparedSurfaceError::Anisotropic {
                        name: surface.to_owned(),
                        variances: self.isotropy.variances,
                        error,
                    })
                }
                error => error.into(),
            })?;
            if CaseModel::of(name, &anisotropic).is_err() {
                isotropic.push(name.as_str());
            }
        }
        Ok(isotropic)
    }

    fn distribution(&self) -> SlopeDistribution {
        let covariance = self.shifts.covariance();
        match &self.tables {
            Some(tables) => tables.distribution(covariance),
            None => covariance.into(),
        }
    }
}

/// A comparison, checked and ready to be run after the surface is traced.
pub(super) struct PlannedComparison {
    config: CompareConfig,
    slopes: Slopes,
    settings: Settings,
    pub(super) warnings: Vec<String>,
}

impl PlannedComparison {
    /// Checks that the surface, of which there is one, can be compared with the models of the configuration; `None` without any.
    pub(super) fn new(
        config: &TraceConfig,
        surfaces: &GivenSurfaces,
        case: &Case,
        settings: &Settings,
    ) -> Result<Option<Self>, StudyError> {
        if config.compare.models.is_empty() {
            return Ok(None);
        }
        if !surfaces.others.is_empty() {
            let count = 1 + surfaces.others.len();
            return Err(ComparedSurfaceError::Several { count }.into());
        }
        let surface = &surfaces.first;
        let field = surface.height_map("--models")?;
        let plan = RegionPlan::of(field, &surface.name)?;
        let regions = [plan.regions.columns as usize, plan.regions.rows as usize];
        let found = match case.surface.shapes() {
            [Shape::Smooth { top, .. }] => top.spline().region_slopes(regions),
            _ => field.region_slopes(regions),
        };
        let mut warnings: Vec<String> = slope_warnings(field, &found).into_iter().collect();
        let of_layers =
            !case.layers.is_empty() && config.run.polarisation != Polarisation::Averaged;
        if of_layers {
            warnings.push(AVERAGED_LAYERS.to_owned());
        }
        let shifts = RegionShifts::new(&centred(field.border(), found), plan.widths())?;
        let tabulates = config.compare.models.iter().any(|m| m == SmithSlopes::NAME);
        let tables = tabulates.then(|| tables(field, case, regions));
        let tables = tables.transpose()?;
        let slopes = Slopes {
            isotropy: Isotropy::of(shifts.elements()),
            plan,
            shifts,
            tables,
        };
        let isotropic = slopes.isotropic_models(&config.compare.models, case, &surface.name)?;
        if !isotropic.is_empty() {
            warnings.push(slopes.isotropy.note(&isotropic));
        }
        let settings = Settings {
            regions: Some(slopes.plan.regions),
            estimator: Estimator::Plain,
            refine: false,
            ..*settings
        };
        Ok(Some(Self {
            config: config.compare.clone(),
            slopes,
            settings,
            warnings,
        }))
    }

    /// Settings for `rays` on all regions together.
    pub(super) const fn settings(&self, rays: u64) -> Settings {
        Settings {
            effort: Effort::rays(rays),
            ..self.settings
        }
    }

    /// Comparison of the regions of the surface with the models.
    pub(super) fn judge<'a>(
        &'a self,
        case: &Case,
        outcome: &'a Outcome,
        run: &RunConfig,
        observer: &dyn Observer,
    ) -> Result<TraceComparison<'a>, StudyError> {
        observer.begin("comparing", self.config.models.len() as u64);
        let compared = Compared {
            config: &self.config,
            seed: run.seed,
            free_azimuth: false,
            surface: self.slopes.modelled(case),
            outcome,
            testing: Testing::Tests,
            has_target: run.target_error.is_some(),
            regions: Some(&self.slopes.shifts),
            tables: self.slopes.tables.as_ref(),
        };
        let (models, level) = compare_models(&compared, observer)?;
        observer.end();
        let judgement = Judgement {
            outcome,
            models,
            level,
            free_azimuth: false,
        };
        Ok(TraceComparison {
            judgement,
            slopes: &self.slopes,
        })
    }
}

/// Warnings on slopes of these regions as those of a Gaussian surface with a level mean plane.
fn slope_warnings(field: &HeightField, regions: &[RegionSlopes]) -> Vec<String> {
    let RegionSlopes { mean, second } = RegionSlopes::mean_of(regions);
    let [xx, xy, yy] = second;
    let mut warnings = Vec::new();
    let tilt = hypot(mean[0], mean[1]) / (xx + yy).sqrt();
    if tilt > TILTED {
        warnings.push(format!(
            "the surface is tilted: its mean slope is {tilt:.2} of its root mean square slope, but models have a level mean plane; --remove plane levels it"
        ));
    }
    let correlation = xy / (xx * yy).sqrt();
    if field.border() == Border::Mirrored && correlation.abs() > SLANTED {
        warnings.push(format!(
            "slopes along x and y are correlated ({correlation:.2}), and images of a mirrored tile have both signs of that: models are made for the mean of both, without correlation"
        ));
    }
    warnings
}

/// The slopes of the regions of a surface, as light meets it.
fn tables(
    field: &HeightField,
    case: &Case,
    regions: [usize; 2],
) -> Result<SlopeTables, SlopeTableError> {
    let samples = match case.surface.shapes() {
        [Shape::Smooth { top, .. }] => top.spline().slope_samples(regions),
        _ => field.slope_samples(regions),
    };
    let symmetry = match field.border() {
        Border::Mirrored => SlopeSymmetry::Mirrored,
        Border::Periodic | Border::Open => SlopeSymmetry::None,
    };
    let one = |number: usize| Ok(samples[number].clone());
    SlopeTables::new(samples.len(), one, symmetry, case.light.from)
}

/// The regions with second moments about the mean slope of the surface. Images of a mirrored tile have slopes of both signs: their
/// means and the products of both are zero.
fn centred(border: Border, mut regions: Vec<RegionSlopes>) -> Vec<RegionSlopes> {
    let [mx, my] = RegionSlopes::mean_of(&regions).mean;
    for RegionSlopes { mean, second } in &mut regions {
        if border == Border::Mirrored {
            *mean = [0.0; 2];
            second[1] = 0.0;
        } else {
            let [x, y] = *mean;
            second[0] += mx * mx - 2.0 * mx * x;
            second[1] += mx * my - mx * y - my * x;
            second[2] += my * my - 2.0 * my * y;
        }
    }
    regions
}

impl TraceComparison<'_> {
    pub(super) const fn slopes(&self) -> &Slopes {
        self.slopes
    }

    /// Flux that an open patch loses past its rim, which no model describes.
    pub(super) fn rim_warning(&self) -> Option<String> {
        let lost = self.judgement.outcome.statistics.budget().left_patch.mean;
        (lost > PAST_RIM).then(|| {
            format!(
                "{} of the light goes down past the rim of the open patch: that counts against every model, and regions at the rim have no shadows from beyond; --border mirrored has neither",
                short(lost)
            )
        })
    }

    /// Form of summary.json.
    pub(super) fn to_json(&self) -> Value {
        let mut value = json!(ComparisonJson::of(&self.judgement));
        let Slopes {
            plan,
            shifts,
            tables,
            ..
        } = self.slopes;
        let [xx, xy, yy] = shifts.elements();
        value["slopes"] = json!({
            "variance_x": xx,
            "covariance": xy,
            "variance_y": yy,
        });
        if let Some(tables) = tables {
            value["slopes"]["table_cells"] = json!(tables.size());
        }
        value["regions"] = json!({
            "columns": plan.regions.columns,
            "rows": plan.regions.rows,
            "extent": plan.extent,
            "correlation_length": plan.correlation,
            "scatter_factor": shifts.stretch(),
            "rays": self.judgement.outcome.work.rays,
        });
        value
    }
}
