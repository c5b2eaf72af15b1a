//! The configuration of a convergence run: what `asperity converge` reads from a file.

use asperity_simulate::{
    Case, Cells, Estimator, RandomSurfaces, SimulateError, SurfaceSource, check_memory,
    check_results, short, traced_bytes,
};
use asperity_surface::SurfaceRecipe;
use std::collections::BTreeSet;
use std::fmt::Display;

use asperity_tally::{HemisphereGrid, Sides, TallySpec};
use asperity_tracer::{AcceleratorKind, Branching, Sampling};
use serde::{Deserialize, Serialize};

use super::ConvergeError;
use super::method::{Method, RunEffort};
use crate::config::error::ConfigError;
use crate::config::values::{Count, Number, OneOrMany, OrAuto, PerAxis};
use crate::config::{
    CompareConfig, LightConfig, MaterialConfig, OutputConfig, RunConfig, SurfaceConfig,
    VerifyConfig,
};
use crate::settings::number::MOST_COUNT;
use crate::settings::{Command, Document, defaults};

/// `[converge]`: the methods, and how much each of them does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceConfig {
    /// Estimators.
    pub estimators: OneOrMany<Estimator>,
    /// How rays are spread.
    pub samplings: OneOrMany<Sampling>,
    /// Whether paths follow both branches, or one picked at random.
    pub branchings: OneOrMany<Branching>,
    /// Rays per second of another ray tracer. The tables then have the seconds that it would need for plain random rays
    /// that pick a branch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer_rate: Option<Number>,
    /// How hits are found.
    pub accelerators: OneOrMany<AcceleratorKind>,
    /// Length units per sample, along both axes; that of the surface unless given. The extent of the
    /// surface stays, and its samples follow.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spacings: Option<OneOrMany<Number>>,
    /// Rays per surface. Goes with `surfaces` value by value; one value holds for all of the other.
    pub rays: OneOrMany<Count>,
    /// Surfaces that a run draws.
    pub surfaces: OneOrMany<Count>,
    /// Runs of each method and effort, each with surfaces and rays of its own.
    pub repeats: Count,
    /// Rays per surface of the reference.
    pub reference_rays: Count,
    /// Surfaces of the reference.
    pub reference_surfaces: Count,
    /// Spacing of the reference; the finest of `spacings` unless given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_spacing: Option<Number>,
    /// Seed of which those of all runs derive.
    pub seed: u64,
    /// Bins of a hemisphere, `THETAxPHI`.
    pub bins: HemisphereGrid,
    /// The sides over whose bins errors are taken.
    pub side: Sides,
    /// Errors for which run times are computed.
    pub errors: OneOrMany<Number>,
}

/// Run time against error: surfaces, material, light and methods. Every key has a default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergeConfig {
    /// The random surfaces; `size` times `spacing` is their extent at every spacing.
    pub surface: SurfaceConfig,
    /// What they are made of.
    pub material: MaterialConfig,
    /// Where the light comes from.
    pub light: LightConfig,
    /// The methods and their effort.
    pub converge: ConvergenceConfig,
    /// What is written.
    pub output: OutputConfig,
}

/// What runs are measured against.
#[derive(Clone, Copy)]
pub(super) struct PlannedReference {
    pub(super) method: Method,
    pub(super) effort: RunEffort,
}

/// A configuration with its lists multiplied out, checked.
pub(super) struct Plan {
    pub(super) cases: Vec<Case>,
    pub(super) methods: Vec<Method>,
    pub(super) efforts: Vec<RunEffort>,
    pub(super) repeats: u64,
    pub(super) reference: PlannedReference,
    pub(super) errors: Vec<f64>,
    /// Rays per second of a peer.
    pub(super) peer_rate: Option<f64>,
    pub(super) spec: TallySpec,
    pub(super) seed: u64,
}

impl Default for ConvergeConfig {
    fn default() -> Self {
        defaults(Command::Converge)
    }
}

impl ConvergeConfig {
    /// Reads a configuration from the text of a TOML file.
    ///
    /// # Errors
    /// [`ConfigError::Setting`] with line and key if the text is invalid.
    pub fn from_toml(text: &str) -> Result<Self, ConfigError> {
        Ok(Document::of_text(Command::Converge, text)?.read()?)
    }

    /// Checks everything that can be known before a ray is traced: values, grids, memory. Returns the names of all files that are written.
    ///
    /// # Errors
    /// [`ConvergeError`] as from [`crate::converge`].
    pub fn check(&self) -> Result<Vec<String>, ConvergeError> {
        let plan = self.plan()?;
        let efforts = plan.efforts.iter().chain([&plan.reference.effort]);
        let surfaces = efforts.map(|effort| effort.surfaces).max().unwrap_or(1);
        check_results(&plan.spec, surfaces, 1, false)?;
        for method in plan.methods.iter().chain([&plan.reference.method]) {
            for case in &plan.cases {
                let case = self.spaced(case, method.spacing)?;
                let SurfaceSource::Random(surfaces) = &case.surface else {
                    continue;
                };
                let accelerator = method.accelerator.on_height_field(false);
                let [ny, nx] = surfaces.shape();
                let bytes = surfaces
                    .peak_bytes()
                    .max(traced_bytes([ny, nx], accelerator));
                check_memory("tracing one surface", bytes)?;
            }
        }
        Ok(self.files(&plan.cases))
    }

    /// Surfaces of a recipe at a spacing.
    fn surfaces(
        &self,
        recipe: SurfaceRecipe,
        spacing: PerAxis<Number>,
    ) -> Result<RandomSurfaces, ConvergeError> {
        let shape = self.shape(spacing)?;
        let (spacing, insist) = (spacing.xy().map(|spacing| spacing.0), self.surface.insist);
        let surfaces = RandomSurfaces::new(Cells::Flat, recipe, shape, spacing, insist);
        Ok(surfaces.map_err(SimulateError::from)?)
    }

    /// The same case on surfaces of another spacing.
    pub(super) fn spaced(
        &self,
        case: &Case,
        spacing: PerAxis<Number>,
    ) -> Result<Case, ConvergeError> {
        let surface = match case.surface.recipe() {
            Some(recipe) => SurfaceSource::random(self.surfaces(recipe.clone(), spacing)?),
            None => case.surface.clone(),
        };
        Ok(Case {
            surface,
            ..case.clone()
        })
    }

    /// The same surfaces, material and light as a verification without models.
    fn as_verification(&self) -> VerifyConfig {
        VerifyConfig {
            surface: self.surface.clone(),
            material: self.material.clone(),
            medium: None,
            light: self.light.clone(),
            run: RunConfig {
                seed: self.converge.seed,
                bins: OrAuto::Named(self.converge.bins),
                side: self.converge.side,
                ..RunConfig::default()
            },
            compare: CompareConfig::none(),
            output: self.output.clone(),
        }
    }

    /// Extent of the surfaces along x and y, length units.
    pub(super) fn extent(&self) -> [f64; 2] {
        let ([nx, ny], [dx, dy]) = (self.surface.size(), self.surface.spacing());
        [nx as f64 * dx, ny as f64 * dy]
    }

    /// Samples `[ny, nx]` over the extent of the surfaces.
    pub(super) fn shape(&self, spacing: PerAxis<Number>) -> Result<[usize; 2], ConfigError> {
        let samples = |extent: f64, spacing: f64| {
            let samples = extent / spacing;
            let whole = samples.round();
            if spacing > 0.0 && whole >= 1.0 && (samples - whole).abs() <= 1e-9 * whole {
                return Ok(whole as usize);
            }
            Err(ConfigError::Contradiction(format!(
                "spacing {} does not divide the extent {} of the surfaces, size times spacing, into whole samples",
                short(spacing),
                short(extent),
            )))
        };
        let ([x, y], [dx, dy]) = (self.extent(), spacing.xy());
        Ok([samples(y, dy.0)?, samples(x, dx.0)?])
    }

    /// The spacing of the surfaces, where methods have none of their own.
    fn own_spacing(&self) -> PerAxis<Number> {
        PerAxis::Each(self.surface.spacing().map(Number))
    }

    /// The spacings of the methods.
    fn spacings(&self) -> Result<Vec<PerAxis<Number>>, ConfigError> {
        Ok(match &self.converge.spacings {
            Some(list) => {
                let list = list.values("spacings")?;
                once("spacings", list.iter().map(|spacing| spacing.0))?;
                list.into_iter().map(PerAxis::Both).collect()
            }
            None => vec![self.own_spacing()],
        })
    }

    /// All methods, by spacing, accelerator, branching, estimator and sampling in that order of nesting.
    fn methods(&self, spacings: &[PerAxis<Number>]) -> Result<Vec<Method>, ConfigError> {
        let config = &self.converge;
        let estimators = config.estimators.values("estimators")?;
        let samplings = config.samplings.values("samplings")?;
        let accelerators = config.accelerators.values("accelerators")?;
        let branchings = config.branchings.values("branchings")?;
        once("branchings", &branchings)?;
        once("estimators", &estimators)?;
        once("samplings", &samplings)?;
        once("accelerators", &accelerators)?;
        let mut methods = Vec::new();
        for &spacing in spacings {
            self.shape(spacing)?;
            for &accelerator in &accelerators {
                check_accelerator(accelerator)?;
                for &branching in &branchings {
                    for &estimator in &estimators {
                        methods.extend(samplings.iter().map(|&sampling| Method {
                            estimator,
                            sampling,
                            branching,
                            accelerator,
                            spacing,
                        }));
                    }
                }
            }
        }
        if config.peer_rate.is_some() && !methods.iter().any(Method::is_of_peers) {
            return Err(ConfigError::Contradiction(
                "peer_rate takes errors of plain random rays that pick a branch: add plain to estimators, random to samplings and pick to branchings"
                    .to_owned(),
            ));
        }
        Ok(methods)
    }

    /// Multiplies the lists out and checks them.
    pub(super) fn plan(&self) -> Result<Plan, ConvergeError> {
        let config = &self.converge;
        let verification = self.as_verification();
        let spacings = self.spacings()?;
        let methods = self.methods(&spacings)?;
        let errors: Vec<f64> = config
            .errors
            .values("errors")?
            .iter()
            .map(|e| e.0)
            .collect();
        let reference = RunEffort {
            rays: config.reference_rays.0,
            surfaces: config.reference_surfaces.0,
        };
        check_effort(reference)?;
        let finest = spacings
            .iter()
            .copied()
            .reduce(|a, b| if coarsest(b) < coarsest(a) { b } else { a });
        let spacing = config.reference_spacing.map(PerAxis::Both).or(finest);
        let spacing = spacing.unwrap_or(self.own_spacing());
        self.shape(spacing)?;
        let cases = verification.cases(|_, recipe| self.surfaces(recipe, spacing))?;
        let uncontrolled = cases.iter().find_map(why_uncontrolled);
        let is_controlled = |method: &Method| method.estimator == Estimator::Controlled;
        if let Some(error) = &uncontrolled
            && methods.iter().any(is_controlled)
        {
            return Err(error.clone().into());
        }
        Ok(Plan {
            cases,
            methods,
            efforts: efforts(config)?,
            repeats: config.repeats.0,
            reference: PlannedReference {
                method: Method {
                    estimator: match uncontrolled {
                        None => Estimator::Controlled,
                        Some(_) => Estimator::Plain,
                    },
                    sampling: Sampling::QuasiRandom,
                    branching: Branching::Split,
                    accelerator: AcceleratorKind::Auto,
                    spacing,
                },
                effort: reference,
            },
            errors,
            peer_rate: config.peer_rate.map(|rate| rate.0),
            spec: verification.run.ray_settings()?.tally,
            seed: config.seed,
        })
    }
}

/// Why no control variate is known for a case, if none is.
fn why_uncontrolled(case: &Case) -> Option<ConfigError> {
    if case.material.is_diffuse() {
        return Some(ConfigError::DiffuseControl);
    }
    let recipe = case.surface.recipe()?;
    recipe.structured().map(|_| ConfigError::NoControl)
}

fn coarsest(spacing: PerAxis<Number>) -> f64 {
    let [dx, dy] = spacing.xy();
    dx.0.max(dy.0)
}

/// Rays and surfaces, value by value; one value holds for all of the other.
fn efforts(config: &ConvergenceConfig) -> Result<Vec<RunEffort>, ConfigError> {
    let rays = config.rays.values("rays")?;
    let surfaces = config.surfaces.values("surfaces")?;
    let count = rays.len().max(surfaces.len());
    if [rays.len(), surfaces.len()]
        .iter()
        .any(|&len| len != 1 && len != count)
    {
        return Err(ConfigError::Contradiction(format!(
            "rays has {} values and surfaces {}; they go together value by value, so give as many of both, or one of either",
            rays.len(),
            surfaces.len(),
        )));
    }
    let efforts: Vec<RunEffort> = (0..count)
        .map(|i| RunEffort {
            rays: rays[i % rays.len()].0,
            surfaces: surfaces[i % surfaces.len()].0,
        })
        .collect();
    efforts.iter().copied().try_for_each(check_effort)?;
    once(
        "rays and surfaces",
        efforts
            .iter()
            .map(|e| format!("{} x {}", e.rays, e.surfaces)),
    )?;
    Ok(efforts)
}

fn check_effort(effort: RunEffort) -> Result<(), ConfigError> {
    match effort.rays.checked_mul(effort.surfaces) {
        Some(all) if all as f64 <= MOST_COUNT => Ok(()),
        _ => Err(ConfigError::Contradiction(format!(
            "{} rays on each of {} surfaces are more than {MOST_COUNT:e} in all",
            effort.rays, effort.surfaces
        ))),
    }
}

fn check_accelerator(accelerator: AcceleratorKind) -> Result<(), ConfigError> {
    match accelerator {
        AcceleratorKind::Flat => Err(ConfigError::FlatAccelerator),
        _ => Ok(()),
    }
}

/// Refuses a list that names a value twice.
fn once<T: Display>(list: &str, values: impl IntoIterator<Item = T>) -> Result<(), ConfigError> {
    let mut seen = BTreeSet::new();
    for value in values {
        let value = value.to_string();
        if seen.contains(&value) {
            return Err(ConfigError::Contradiction(format!(
                "{list}: {value} is given twice"
            )));
        }
        seen.insert(value);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        let error = match ConvergeConfig::from_toml(text) {
            Ok(config) => config.check().unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(!error.contains('\n'), "{error}");
        error
    }

    #[test]
    fn lists_multiply_and_the_extent_stays() {
        let text = "
            [surface]
            size = [512, 256]
            [converge]
            estimators = \"plain\"
            accelerators = [\"mesh\", \"pyramid\"]
            spacings = [2, 1, 0.5]
            rays = [100, 1000]
            surfaces = 4
        ";
        let config = ConvergeConfig::from_toml(text).unwrap();
        let plan = config.plan().unwrap();
        assert_eq!(plan.methods.len(), 2 * 3 * 3);
        assert_eq!(plan.efforts.len(), 2);
        assert!(plan.efforts.iter().all(|effort| effort.surfaces == 4));
        let shapes: Vec<_> = plan
            .methods
            .iter()
            .map(|m| config.shape(m.spacing).unwrap())
            .collect();
        assert_eq!(shapes[0], [128, 256]);
        assert_eq!(shapes[17], [512, 1024]);
        // The reference is as fine as the finest.
        assert_eq!(plan.reference.method.spacing, PerAxis::Both(Number(0.5)));
    }

    #[test]
    fn defaults_are_understood() {
        let config = ConvergeConfig::from_toml("").unwrap();
        config.check().unwrap();
        let plan = config.plan().unwrap();
        assert_eq!((plan.cases.len(), plan.methods.len()), (1, 6));
    }

    #[test]
    fn bad_values_get_a_sentence() {
        for (text, expected) in [
            (
                "[converge]\nestimator = \"plain\"",
                "line 2: unknown key `estimator`",
            ),
            ("[converge]\nestimators = \"best\"", "plain or controlled"),
            ("[converge]\nestimators = []", "one or several"),
            ("[converge]\nestimators = 3", "plain or controlled"),
            (
                "[converge]\nsamplings = [\"random\", \"random\"]",
                "random is given twice",
            ),
            ("[converge]\naccelerators = [\"flat\"]", "take auto"),
            ("[converge]\nspacings = [1, 1]", "1 is given twice"),
            (
                "[converge]\nspacings = [3]",
                "does not divide the extent 512",
            ),
            ("[converge]\nspacings = [0]", "above 0"),
            ("[converge]\nspacings = [-1]", "above 0"),
            ("[converge]\nspacings = [8]", "correlation length"),
            ("[converge]\nreference_spacing = 5", "does not divide"),
            (
                "[converge]\nrays = [10, 100]\nsurfaces = [1, 2, 3]",
                "rays has 2 values and surfaces 3",
            ),
            (
                "[converge]\nrays = [10, 10]\nsurfaces = 1",
                "10 x 1 is given twice",
            ),
            ("[converge]\nrays = 0", "1 or more"),
            ("[converge]\nrays = 1e14", "more than 1e15"),
            ("[converge]\nsurfaces = 1e7", "GiB"),
            ("[converge]\nrepeats = 0", "1 or more"),
            ("[converge]\nreference_surfaces = 1", "2 or more"),
            ("[converge]\nerrors = [0.01, 0]", "above 0"),
            ("[converge]\nbins = \"0x5\"", "bins"),
            (
                "[converge]\nside = \"transmitted\"\n[material]\nkind = \"mirror\"",
                "nothing is transmitted",
            ),
            ("[surface]\nsmoothness = [3, 3]", "same folder"),
            ("[run]\nrays = 5", "unknown section `run`"),
            ("[light]\ntheta = 90", "below 90"),
        ] {
            let error = refusal(text);
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
