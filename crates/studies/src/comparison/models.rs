//! Models against the explicit surfaces of a case.

use asperity_simulate::{Observer, Outcome};
use std::borrow::Cow;
use std::f64::consts::PI;

use asperity_analysis::{
    Comparison, Expectation, Expected, Grouping, SamplingEffort, Verdict, compare,
    compare_untested, sidak_level, verdicts,
};
use asperity_optics::Incidence;
use asperity_tally::{
    Azimuth, Component, Entry, Estimate, Mirror, Side, TallyResult, TallySpec, TallyValues,
};
use rayon::prelude::*;

use crate::comparison::model_rays;
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
    /// The components of the light that it is compared with: those that it claims, then all light, whether or not the model describes it.
    pub components: Vec<(Component, ComparedComponent)>,
}

impl ModelOutcome {
    /// A component of the light; `None` where it is not compared.
    #[must_use]
    pub fn compared(&self, component: Component) -> Option<&ComparedComponent> {
        let mut all = self.components.iter();
        let found = all.find(|(compared, _)| *compared == component);
        found.map(|(_, compared)| compared)
    }

    /// A component of the light, or all light where it is not compared.
    ///
    /// # Panics
    /// If no component is compared, which is never the case: all light is always the last.
    #[must_use]
    pub fn compared_or_all(&self, component: Component) -> &ComparedComponent {
        let found = self.compared(component);
        found.unwrap_or_else(|| &self.components[self.components.len() - 1].1)
    }

    /// The component by which the model is judged: all that it describes.
    #[must_use]
    pub fn judged_component(&self) -> Component {
        self.model.judged_component()
    }

    /// The comparison with all light that the model describes.
    #[must_use]
    pub fn judged(&self) -> &ComparedComponent {
        self.compared_or_all(self.judged_component())
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
}

/// Light that a model expects, and the tallies of surfaces that it is compared with.
struct ExpectedLight<'a> {
    model: CaseModel,
    expectation: Expectation,
    tallies: Cow<'a, [TallyValues]>,
}

impl ExpectedLight<'_> {
    /// The components that are compared: those that the model claims, and all light.
    fn components(&self) -> Vec<Component> {
        let mut components = self.model.claims();
        components.retain(|component| *component != ALL_LIGHT);
        components.push(ALL_LIGHT);
        components
    }

    fn claims(&self, component: Component) -> bool {
        self.model.claims().contains(&component)
    }

    /// Returns `true` if both models claim or do not claim the component, and expect exactly the same of it on the same tallies.
    fn equals(&self, other: &Self, component: Component) -> bool {
        let spec = self.expectation.spec();
        let bins = spec.recorded_entries(component);
        let sides: Vec<Entry> = spec
            .sides()
            .map(|side| spec.flux_entry(side, component))
            .collect();
        let is_same = |one: &TallyValues, two: &TallyValues| {
            one[bins] == two[bins] && sides.iter().all(|&entry| one[entry] == two[entry])
        };
        let [one, two] = [self, other].map(|light| light.expectation.statistics().means());
        let mut tallies = self.tallies.iter().zip(&*other.tallies);
        let samples = [self, other].map(|light| light.expectation.samples(component));
        self.claims(component) == other.claims(component)
            && samples == [false; 2]
            && is_same(one, two)
            && tallies.all(|(one, two)| is_same(one, two))
    }
}

/// Compares every model of the configuration with the surfaces of a case.
///
/// Each component that a model claims is a test, but models that expect exactly the same of it are one; the level is shared among all
/// tests of the case. Returns the models and the level of each test; no models if the run gives them up.
pub(crate) fn compare_models(
    compared: &Compared<'_>,
    observer: &dyn Observer,
) -> Result<(Vec<ModelOutcome>, f64), StudyError> {
    let config = compared.config;
    let models = config.models.par_iter().with_max_len(1);
    let models = models.map(|name| {
        let model = CaseModel::of(name, &compared.surface)?;
        compared.expect(model, observer)
    });
    let models = match models.collect::<Result<Vec<_>, StudyError>>() {
        Err(error) if error.is_stopped() => Vec::new(),
        models => models?,
    };

    // Compare equal light once
    let mut unique: Vec<(usize, Component)> = Vec::new();
    let mut place = |number: usize, component| {
        let equals = |&(other, of): &(usize, Component)| {
            of == component && models[other].equals(&models[number], component)
        };
        unique.iter().position(equals).unwrap_or_else(|| {
            unique.push((number, component));
            unique.len() - 1
        })
    };
    let places: Vec<Vec<(Component, usize)>> = (0..models.len())
        .map(|i| {
            let components = models[i].components().into_iter();
            components
                .map(|component| (component, place(i, component)))
                .collect()
        })
        .collect();
    let found = unique
        .par_iter()
        .map(|&(number, component)| compared.against(&models[number], component));
    let mut found = found.collect::<Result<Vec<_>, StudyError>>()?;

    // Share the level among the tests
    let tested = found.iter_mut().zip(&unique);
    let tested = tested.filter(|(_, (number, component))| {
        compared.testing == Testing::Tests && models[*number].claims(*component)
    });
    let mut tested: Vec<&mut ComparedComponent> = tested.map(|(found, _)| found).collect();
    let comparisons: Vec<&Comparison> = tested.iter().map(|one| &one.comparison).collect();
    let verdicts = verdicts(&comparisons, config.level);
    let level = sidak_level(config.level, verdicts.len().max(1));
    for (one, verdict) in tested.iter_mut().zip(verdicts) {
        one.verdict = Some(verdict);
    }
    let outcomes = models.into_iter().zip(places).map(|(light, places)| {
        let of = |(component, place): (Component, usize)| (component, found[place].clone());
        ModelOutcome {
            model: light.model,
            expectation: light.expectation,
            components: places.into_iter().map(of).collect(),
        }
    });
    Ok((outcomes.collect(), level))
}

/// Purpose of a comparison.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Testing {
    /// Distances and tests: p values and verdicts.
    Tests,
    /// Distances alone.
    Distances,
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
    pub(crate) testing: Testing,
    /// `true` if the run has a target error: models follow as many rays as the error of the result asks for.
    pub(crate) has_target: bool,
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

    /// Expectation of one model, with the tallies to compare it with, unless the run gives it up.
    fn expect(
        &self,
        model: CaseModel,
        observer: &dyn Observer,
    ) -> Result<ExpectedLight<'_>, StudyError> {
        let surfaces = self.outcome.surfaces.len() as u64;
        let effort = |rays| SamplingEffort {
            rays,
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
        let is_tabulated = model
            .density()
            .is_some_and(|density| density.tabulated().is_some());
        let expect = |model: &CaseModel, rays: u64| {
            let (incidence, spec) = (self.incidence(), self.spec());
            let found = model.expect(incidence, spec, azimuth, effort(rays), observer)?;
            Ok::<_, StudyError>(match self.mirror() {
                Some(mirror) if is_tabulated || !found.is_exact() => found.folded(&mirror),
                _ => found,
            })
        };
        let given = self.config.model_rays.map(|rays| rays.0);
        let expectation = match (given, self.has_target) {
            (None, true) => {
                let pilot = expect(&model, model_rays::PILOT)?;
                let planned = model_rays::planned(&pilot, self.outcome);
                match pilot.is_exact() || pilot.rays() >= planned {
                    true => pilot,
                    false => expect(&model, planned)?,
                }
            }
            (given, _) => expect(&model, given.unwrap_or(model_rays::DEFAULT))?,
        };
        let tallies = match (self.regions, &model) {
            _ if is_tabulated => Cow::Owned(self.less_tabulated()?),
            // Models of layers between flat faces know of no slopes.
            (Some(regions), CaseModel::Surface(_)) => {
                // Their noise is multiplied by the shifts of regions, which are small beside the steps.
                let rays = expectation.rays().div_ceil(10);
                let derivatives = regions.derivatives(|slopes| {
                    let surface = self.surface.with_slopes(slopes);
                    let model = CaseModel::of(model.name(), &surface)?;
                    let expectation = expect(&model, rays)?;
                    Ok::<_, StudyError>(expectation.statistics().means().clone())
                })?;
                Cow::Owned(regions.adjusted(&self.outcome.surfaces, &derivatives))
            }
            _ => Cow::Borrowed(self.outcome.surfaces.as_slice()),
        };
        Ok(ExpectedLight {
            model,
            expectation,
            tallies,
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

    /// One component of the light against what a model expects of it.
    fn against(
        &self,
        light: &ExpectedLight<'_>,
        component: Component,
    ) -> Result<ComparedComponent, StudyError> {
        let ExpectedLight {
            expectation,
            tallies,
            ..
        } = light;
        let spec = self.spec();
        let bins = spec.recorded_entries(component);
        let fluxes = |tally: &TallyValues| tally[bins].to_vec();
        let surfaces: Vec<Vec<f64>> = tallies.iter().map(fluxes).collect();
        let batches: Vec<&[f64]> = expectation.tallies().iter().map(|t| &t[bins]).collect();
        let expected = if batches.len() == surfaces.len() && expectation.samples(component) {
            Expected::Batches(&batches)
        } else {
            Expected::Exact(&expectation.statistics().means()[bins])
        };
        let comparison = if self.testing == Testing::Tests && light.claims(component) {
            let counts = RayCounts {
                outcome: self.outcome,
                expectation,
                component,
                free_azimuth: self.free_azimuth,
            };
            let groupings = rings_and_sides(spec, &counts);
            compare(
                &surfaces,
                expected,
                &counts.of_bins(),
                &groupings,
                self.seed,
            )?
        } else {
            compare_untested(&surfaces, expected, self.seed)?
        };
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
