//! Models against the explicit surfaces of a case.

use asperity_simulate::{Observer, Outcome};
use std::borrow::Cow;
use std::f64::consts::PI;

use asperity_analysis::{
    Comparison, Expectation, Expected, Grouping, SamplingEffort, Verdict, compare, sidak_level,
    verdicts,
};
use asperity_optics::Incidence;
use asperity_tally::{
    Azimuth, Component, Estimate, Mirror, Side, TallyResult, TallySpec, TallyValues,
};
use rayon::prelude::*;

use crate::comparison::ray_counts::RayCounts;
use crate::comparison::region_shifts::RegionShifts;
use crate::comparison::side_difference::{SideDifference, side_differences};
use crate::comparison::slope_tables::SlopeTables;
use crate::config::CompareConfig;
use crate::config::case_model::{CaseModel, ModelledSurface};
use crate::config::error::ConfigError;
use crate::error::StudyError;

/// Batches of a sampled model that is compared with a single surface.
pub(crate) const BATCHES_WITHOUT_SURFACES: u64 = 16;

/// Light that every model is compared with, whatever it describes.
const ALL_LIGHT: Component = Component::All;

/// A component of the light against a model.
#[derive(Clone, Debug)]
pub struct ComparedComponent {
    /// Over the bins of the recorded sides.
    pub comparison: Comparison,
    /// Its verdict; `None` where the model makes no claim.
    pub verdict: Option<Verdict>,
    /// Energies and peaks of the recorded sides; none of multiple scattering alone.
    pub sides: Vec<SideDifference>,
}

/// One model against the explicit surfaces of a case.
pub struct ModelOutcome {
    /// The model.
    pub model: CaseModel,
    /// Its expectation.
    pub expectation: Expectation,
    /// The components of the light that it is compared with, without all light.
    pub components: Vec<(Component, ComparedComponent)>,
    /// All light, whether or not the model describes it.
    pub total: ComparedComponent,
}

impl ModelOutcome {
    /// A component of the light; `None` where it is not compared.
    #[must_use]
    pub fn compared(&self, component: Component) -> Option<&ComparedComponent> {
        if component == ALL_LIGHT {
            return Some(&self.total);
        }
        let found = self
            .components
            .iter()
            .find(|(compared, _)| *compared == component);
        found.map(|(_, compared)| compared)
    }

    /// The component by which the model is judged: all that it describes.
    #[must_use]
    pub fn judged_component(&self) -> Component {
        self.model.judged_component()
    }

    /// The comparison with all light that the model describes.
    #[must_use]
    pub fn judged(&self) -> &ComparedComponent {
        self.compared(self.judged_component())
            .unwrap_or(&self.total)
    }

    /// Returns `true` if the model describes a component of the light.
    #[must_use]
    pub fn describes(&self, component: Component) -> bool {
        if component.is_of_medium() {
            self.compared(component).is_some()
        } else {
            self.expectation.describes(component)
        }
    }

    /// The flux that the model expects on `side`, if it describes that component.
    #[must_use]
    pub fn energy(&self, component: Component, side: Side) -> Option<Estimate> {
        self.describes(component)
            .then(|| self.expectation.statistics().flux(side, component))
    }

    fn claimed(&mut self) -> impl Iterator<Item = &mut ComparedComponent> {
        let claims = self.model.claims();
        let claimed = move |component: &Component| claims.contains(component);
        self.components
            .iter_mut()
            .map(|(component, compared)| (*component, compared))
            .chain([(ALL_LIGHT, &mut self.total)])
            .filter(move |(component, _)| claimed(component))
            .map(|(_, compared)| compared)
    }
}

/// Compares every model of the configuration with the surfaces of a case.
///
/// Each component that a model claims is a test of its own; the level is shared among all tests of the
/// case. Returns the models and the level of each test; no models if the run gives them up.
pub(crate) fn compare_models(
    compared: &Compared<'_>,
    observer: &dyn Observer,
) -> Result<(Vec<ModelOutcome>, f64), StudyError> {
    let config = compared.config;
    let models = config.models.par_iter().with_max_len(1);
    let models = models.map(|name| {
        let model = CaseModel::of(name, &compared.surface)?;
        compared.with(model, observer)
    });
    let mut models = match models.collect::<Result<Vec<_>, StudyError>>() {
        Err(error) if error.is_stopped() => Vec::new(),
        models => models?,
    };
    let mut claims: Vec<&mut ComparedComponent> =
        models.iter_mut().flat_map(ModelOutcome::claimed).collect();
    let comparisons: Vec<&Comparison> = claims.iter().map(|claim| &claim.comparison).collect();
    let found = verdicts(&comparisons, config.level);
    let level = sidak_level(config.level, found.len().max(1));
    for (claim, verdict) in claims.iter_mut().zip(found) {
        claim.verdict = Some(verdict);
    }
    Ok((models, level))
}

/// Light that models are compared with.
pub(crate) struct Compared<'a> {
    pub(crate) config: &'a CompareConfig,
    /// Seed of sampled models and of sign flips.
    pub(crate) seed: u64,
    /// `true` if the light that leaves is spread evenly over azimuth.
    pub(crate) free_azimuth: bool,
    /// Surface that models are made for.
    pub(crate) surface: ModelledSurface,
    pub(crate) outcome: &'a Outcome,
    /// Slopes of the regions of a given surface, which take the place of surfaces.
    pub(crate) regions: Option<&'a RegionShifts>,
    /// Slopes of surfaces or regions, where models are made for a table of them.
    pub(crate) tables: Option<&'a SlopeTables>,
}

impl Compared<'_> {
    const fn spec(&self) -> &TallySpec {
        self.outcome.statistics.spec()
    }

    const fn incidence(&self) -> Incidence {
        self.outcome.case.light.incidence
    }

    /// The plane of incidence, if bins were averaged over it. Level facets send light into exactly that plane, where bins may meet: a table has it on
    /// one side, as rays do, and averaged bins on both.
    fn mirror(&self) -> Option<Mirror> {
        let mirror = || Mirror::about(self.incidence().phi(), &self.spec().grid());
        self.outcome.work.folded.then(mirror).flatten()
    }

    /// The comparison with one model, unless the run gives it up.
    fn with(&self, model: CaseModel, observer: &dyn Observer) -> Result<ModelOutcome, StudyError> {
        let surfaces = self.outcome.surfaces.len() as u64;
        let effort = SamplingEffort {
            rays: self.config.model_rays.0,
            batches: match surfaces {
                0 | 1 => BATCHES_WITHOUT_SURFACES,
                _ => surfaces,
            },
            seed: self.seed,
        };
        let azimuth = if self.free_azimuth {
            Azimuth::Free
        } else {
            Azimuth::From(self.incidence().phi() + PI)
        };
        let expect = |model: &CaseModel, effort: SamplingEffort| {
            let (incidence, spec) = (self.incidence(), self.spec());
            model.expect(incidence, spec, azimuth, effort, observer)
        };
        let is_tabulated = model
            .density()
            .is_some_and(|density| density.tabulated().is_some());
        let expectation = expect(&model, effort)?;
        let expectation = match self.mirror() {
            Some(mirror) if is_tabulated || !expectation.is_exact() => expectation.folded(&mirror),
            _ => expectation,
        };
        let tallies = match (self.regions, &model) {
            _ if is_tabulated => Cow::Owned(self.less_tabulated()?),
            // Models of layers between flat faces know of no slopes.
            (Some(regions), CaseModel::Surface(_)) => {
                // Their noise is multiplied by the shifts of regions, which are small beside the steps.
                let effort = SamplingEffort {
                    rays: effort.rays.div_ceil(10),
                    ..effort
                };
                let derivatives = regions.derivatives(|slopes| {
                    let surface = self.surface.with_slopes(slopes);
                    let model = CaseModel::of(model.name(), &surface)?;
                    let expectation = expect(&model, effort)?;
                    Ok::<_, StudyError>(expectation.statistics().means().clone())
                })?;
                Cow::Owned(regions.adjusted(&self.outcome.surfaces, &derivatives))
            }
            _ => Cow::Borrowed(self.outcome.surfaces.as_slice()),
        };
        let claims = model.claims();
        let apart = claims
            .into_par_iter()
            .filter(|&component| component != ALL_LIGHT);
        let against = |component| self.against(&tallies, &expectation, component);
        let (total, components) = rayon::join(
            || against(ALL_LIGHT),
            || {
                let components = apart.map(|component| Ok((component, against(component)?)));
                components.collect::<Result<_, StudyError>>()
            },
        );
        Ok(ModelOutcome {
            components: components?,
            total: total?,
            expectation,
            model,
        })
    }

    /// The tallies of surfaces or regions less what their own tables of slopes explain.
    fn less_tabulated(&self) -> Result<Vec<TallyValues>, StudyError> {
        let tallies = &self.outcome.surfaces;
        let Some(tables) = self.tables else {
            return Ok(tallies.clone());
        };
        let adjusted = tables.adjusted(
            tallies,
            self.surface.material,
            self.incidence(),
            self.mirror(),
        );
        let adjusted = adjusted.map_err(ConfigError::from)?;
        Ok(match self.regions {
            Some(regions) => regions.stretched(adjusted),
            None => adjusted,
        })
    }

    /// One component of the light, in one tally per surface, against what the model expects of it.
    fn against(
        &self,
        tallies: &[TallyValues],
        expectation: &Expectation,
        component: Component,
    ) -> Result<ComparedComponent, StudyError> {
        let spec = self.spec();
        let bins = spec.recorded_entries(component);
        let fluxes = |tally: &TallyValues| tally[bins].to_vec();
        let surfaces: Vec<Vec<f64>> = tallies.iter().map(fluxes).collect();
        let of_model = expectation.statistics().means();
        let mean = &of_model[bins];
        let batches: Vec<&[f64]> = expectation.tallies().iter().map(|t| &t[bins]).collect();
        let expected = if batches.len() == surfaces.len() && !expectation.is_exact() {
            Expected::Batches(&batches)
        } else {
            Expected::Exact(mean)
        };
        let counts = RayCounts {
            outcome: self.outcome,
            expectation,
            component,
            free_azimuth: self.free_azimuth,
        };
        let comparison = compare(
            &surfaces,
            expected,
            &counts.of_bins(),
            &rings_and_sides(spec, &counts),
            self.seed,
        )?;
        let sides = match component {
            Component::Multiple => Vec::new(),
            _ => side_differences(spec, component, tallies, expectation, self.free_azimuth),
        };
        Ok(ComparedComponent {
            comparison,
            verdict: None,
            sides,
        })
    }
}

/// Sums of bins in which a deviation is tested in addition to the bins: rings of equal polar angle, and whole
/// sides, which are the energies. Bins count from the first that is requested.
fn rings_and_sides(spec: &TallySpec, counts: &RayCounts<'_>) -> [Grouping; 2] {
    let grid = spec.grid();
    let grouping = |name, of_each: usize| {
        let firsts = (0..spec.recorded_bins().len()).step_by(of_each);
        let groups: Vec<Vec<usize>> = firsts.map(|i| (i..i + of_each).collect()).collect();
        Grouping {
            name,
            rays: counts.of_groups(&groups),
            groups,
        }
    };
    [
        grouping("rings", grid.n_phi()),
        grouping("sides", grid.bins_per_side()),
    ]
}
