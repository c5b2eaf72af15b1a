//! The configuration of a convergence run: what `asperity converge` reads from a file.

use asperity_results::Header;
use asperity_simulate::{
    Case, Cells, Effort, Estimator, RandomSurfaces, Settings, SimulateError, SurfaceSource,
    check_memory, check_results, traced_bytes,
};
use asperity_synthesis::SurfaceRecipe;
use std::collections::BTreeSet;
use std::fmt::Display;

use asperity_tally::{HemisphereGrid, Sides, TallySpec};
use asperity_tracer::{AcceleratorKind, Branching, Sampling};
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::method::{ConvergeRun, Method};
use crate::config::cases::flat_accelerator;
use crate::config::error::ConfigError;
use crate::config::values::{Count, Number, OneOrMany, OrAuto, PerAxis};
use crate::config::{
    CompareConfig, LightConfig, MaterialConfig, OutputConfig, RunConfig, SurfaceConfig,
    VerifyConfig,
};
use crate::error::StudyError;
use crate::settings::number::MOST_COUNT;
use crate::settings::{Command, Document, defaults};

/// `[converge]`: the methods, and how much each of them does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ConvergenceConfig {
    /// Estimators.
    pub estimators: OneOrMany<Estimator>,
    /// Sampling of rays.
    pub samplings: OneOrMany<Sampling>,
    /// Branches that paths follow: both, or one picked at random.
    pub branchings: OneOrMany<Branching>,
    /// Rays per second of another ray tracer. The tables then have the seconds that it would need for plain random rays
    /// that pick a branch.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub peer_rate: Option<Number>,
    /// Accelerator that finds hits.
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
    /// Material.
    pub material: MaterialConfig,
    /// Directions towards the light.
    pub light: LightConfig,
    /// The methods and their effort.
    pub converge: ConvergenceConfig,
    /// Output.
    pub output: OutputConfig,
}

/// A configuration with its lists multiplied out, checked.
pub struct ConvergePlan {
    /// The cases, on surfaces of the spacing of the reference.
    pub cases: Vec<Case>,
    /// The methods; those of a peer come last.
    pub methods: Vec<Method>,
    /// Rays and surfaces of a run.
    pub efforts: Vec<Effort>,
    /// The runs in the order in which they are measured. Those of a case begin with its reference, which also warms the machine up.
    pub runs: Vec<ConvergeRun>,
    /// Errors for which run times are computed.
    pub errors: Vec<f64>,
    /// Tally spec of each run.
    pub spec: TallySpec,
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

    /// Surfaces of a recipe at a spacing.
    fn surfaces(
        &self,
        recipe: SurfaceRecipe,
        spacing: PerAxis<Number>,
    ) -> Result<RandomSurfaces, StudyError> {
        let shape = self.shape(spacing)?;
        let (spacing, insist) = (spacing.xy().map(|spacing| spacing.0), self.surface.insist);
        let surfaces = RandomSurfaces::new(Cells::Flat, recipe, shape, spacing, insist);
        Ok(surfaces.map_err(SimulateError::from)?)
    }

    /// Verification without models, of the same surfaces, material and light.
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

    /// The settings of all runs of a method, whose effort and seeds differ.
    pub(super) fn settings(&self, method: &Method) -> Result<Settings, ConfigError> {
        let run = RunConfig {
            branching: OrAuto::Named(method.branching),
            accelerator: method.accelerator,
            estimator: method.estimator,
            sampling: method.sampling,
            ..self.as_verification().run
        };
        Ok(Settings {
            mesh_quadrature: false,
            ..run.ray_settings()?
        })
    }

    /// Header of the results: neither the errors nor the peer, which are computed from the runs.
    #[must_use]
    pub fn header(&self) -> Header {
        let mut settings = self.clone();
        settings.converge.errors = OneOrMany::Many(Vec::new());
        settings.converge.peer_rate = None;
        settings.light.forget_wavelength(&settings.material);
        settings.output.plots = true;
        Header::new("converge", self.converge.seed, json!(settings))
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
            Err(ConfigError::part_samples(spacing, extent))
        };
        let ([x, y], [dx, dy]) = (self.extent(), spacing.xy());
        Ok([samples(y, dy.0)?, samples(x, dx.0)?])
    }

    /// Returns the reason why no control variate is known, if none is.
    fn why_uncontrolled(&self) -> Option<ConfigError> {
        let needs = if matches!(self.material, MaterialConfig::Lambertian { .. }) {
            "does not support Lambertian facets; give --estimators plain"
        } else if self.surface.is_measured() {
            "needs the distribution of slopes, which is not known for these surfaces; give --estimators plain"
        } else {
            return None;
        };
        Some(ConfigError::no_control_variate(needs))
    }

    /// All methods, by spacing, accelerator, branching, estimator and sampling in that order of nesting, then those of peers.
    fn methods(&self, spacings: &[PerAxis<Number>]) -> Result<Vec<Method>, ConfigError> {
        let config = &self.converge;
        let branchings = once("branchings", config.branchings.values("branchings")?)?;
        let estimators = once("estimators", config.estimators.values("estimators")?)?;
        let samplings = once("samplings", config.samplings.values("samplings")?)?;
        let accelerators = once("accelerators", config.accelerators.values("accelerators")?)?;
        if accelerators.contains(&AcceleratorKind::Flat) {
            return Err(flat_accelerator());
        }
        let mut methods = Vec::new();
        for &spacing in spacings {
            for &accelerator in &accelerators {
                for &branching in &branchings {
                    for &estimator in &estimators {
                        methods.extend(samplings.iter().map(|&sampling| Method {
                            estimator,
                            sampling,
                            branching,
                            peer_rate: None,
                            accelerator,
                            spacing,
                        }));
                    }
                }
            }
        }
        if let Some(Number(rate)) = config.peer_rate {
            let of_peers = methods.iter().filter(|method| method.is_of_peers());
            let of_peers = of_peers.map(|method| Method {
                peer_rate: Some(rate),
                ..*method
            });
            let peers: Vec<Method> = of_peers.collect();
            if peers.is_empty() {
                let needed = "errors of plain random rays that pick a branch: add plain to estimators, random to samplings and pick to branchings";
                return Err(ConfigError::missing("peer_rate", needed));
            }
            methods.extend(peers);
        }
        Ok(methods)
    }

    /// Multiplies the lists out, and checks all that can be known before a ray is traced: values, grids, memory.
    ///
    /// # Errors
    /// [`StudyError`] if a value is out of range, two contradict each other, or surfaces cannot be drawn or traced in memory.
    pub fn plan(&self) -> Result<ConvergePlan, StudyError> {
        let config = &self.converge;
        let verification = self.as_verification();
        let spacings = match &config.spacings {
            Some(list) => {
                let list = list.values("spacings")?;
                once("spacings", list.iter().map(|spacing| spacing.0).collect())?;
                list.into_iter().map(PerAxis::Both).collect()
            }
            None => vec![PerAxis::Each(self.surface.spacing().map(Number))],
        };
        let methods = self.methods(&spacings)?;
        let efforts = efforts(config)?;
        let errors = config.errors.values("errors")?;
        // Without a list there is one; a list has one number for both axes.
        let finest = spacings
            .iter()
            .min_by(|a, b| a.xy()[0].0.total_cmp(&b.xy()[0].0));
        let spacing = config.reference_spacing.map(PerAxis::Both);
        let spacing = spacing.or(finest.copied()).unwrap_or(spacings[0]);
        let cases_at = |spacing| verification.cases(|_, recipe| self.surfaces(recipe, spacing));
        let uncontrolled = self.why_uncontrolled();
        let is_controlled = |method: &Method| method.estimator == Estimator::Controlled;
        // Refused before surfaces are drawn to be measured, which may take long
        if let Some(error) = &uncontrolled
            && methods.iter().any(is_controlled)
        {
            return Err(error.clone().into());
        }
        let cases = cases_at(spacing)?;
        let reference = Method {
            estimator: match uncontrolled {
                None => Estimator::Controlled,
                Some(_) => Estimator::Plain,
            },
            sampling: Sampling::QuasiRandom,
            branching: Branching::Split,
            peer_rate: None,
            accelerator: AcceleratorKind::Auto,
            spacing,
        };
        let reference_effort = effort(config.reference_rays.0, config.reference_surfaces.0)?;
        let spec = verification.run.ray_settings()?.tally;
        let all_efforts = efforts.iter().chain([&reference_effort]);
        let most_surfaces = all_efforts.map(|effort| effort.surfaces()).max();
        check_results(&spec, most_surfaces.unwrap_or(1), 1, false)?;
        // Methods of one spacing share their surfaces.
        let mut measured = vec![(reference, cases.clone())];
        for method in methods.iter().filter(|method| method.peer_rate.is_none()) {
            let mut known = measured.iter();
            let cases = match known.find(|(known, _)| known.spacing == method.spacing) {
                Some((_, cases)) => cases.clone(),
                None => cases_at(method.spacing)?,
            };
            measured.push((*method, cases));
        }
        for (method, cases) in &measured {
            let accelerator = method.accelerator.on_height_field(false);
            for case in cases {
                if let SurfaceSource::Random(surfaces) = &case.surface {
                    let traced = traced_bytes(surfaces.shape(), accelerator);
                    check_memory("tracing one surface", surfaces.peak_bytes().max(traced))?;
                }
            }
        }
        let runs = measured.len() * efforts.len() * cases.len();
        // Means, squares of deviations and least errors
        let bytes = (runs as f64) * config.repeats.0 as f64 * (3 * 8 * spec.len()) as f64;
        check_memory("storing the results of all runs", bytes as usize)?;
        Ok(ConvergePlan {
            runs: self.runs(&measured, &efforts, reference_effort),
            errors: errors.iter().map(|error| error.0).collect(),
            cases,
            methods,
            efforts,
            spec,
        })
    }

    /// The runs of methods, of which the first is that of the reference, on their cases.
    fn runs(
        &self,
        measured: &[(Method, Vec<Case>)],
        efforts: &[Effort],
        reference_effort: Effort,
    ) -> Vec<ConvergeRun> {
        let run = |case_number: usize, method: usize, effort, repeat| {
            let (method, cases) = &measured[method];
            let run = ConvergeRun {
                case_number,
                case: cases[case_number].clone(),
                method: *method,
                effort,
                repeat,
                seed: 0,
            };
            run.seeded(self.converge.seed)
        };
        let mut runs = Vec::new();
        for case in 0..measured[0].1.len() {
            runs.push(run(case, 0, reference_effort, None));
            for repeat in 0..self.converge.repeats.0 {
                for &effort in efforts {
                    let turns = measured.len() - 1;
                    // Another one begins each time, so that none always follows the same.
                    let methods = (0..turns).map(|turn| 1 + (turn + repeat as usize) % turns);
                    runs.extend(methods.map(|method| run(case, method, effort, Some(repeat))));
                }
            }
        }
        runs
    }
}

/// Rays and surfaces, value by value; one value holds for all of the other.
fn efforts(config: &ConvergenceConfig) -> Result<Vec<Effort>, ConfigError> {
    let rays = config.rays.values("rays")?;
    let surfaces = config.surfaces.values("surfaces")?;
    let count = rays.len().max(surfaces.len());
    if ![rays.len(), surfaces.len()]
        .iter()
        .all(|len| [1, count].contains(len))
    {
        let (rays, surfaces) = (rays.len(), surfaces.len());
        return Err(ConfigError::unsuitable(
            format!("{rays} values of rays and {surfaces} of surfaces"),
            "they go together value by value, so give as many of both, or one of either",
        ));
    }
    let pairs = (0..count).map(|i| (rays[i % rays.len()].0, surfaces[i % surfaces.len()].0));
    let names = pairs
        .clone()
        .map(|(rays, surfaces)| format!("{rays} x {surfaces}"));
    once("rays and surfaces", names.collect())?;
    pairs
        .map(|(rays, surfaces)| effort(rays, surfaces))
        .collect()
}

fn effort(rays: u64, surfaces: u64) -> Result<Effort, ConfigError> {
    match rays.checked_mul(surfaces) {
        Some(total) if total as f64 <= MOST_COUNT => Ok(Effort::Rays { total, surfaces }),
        _ => Err(ConfigError::unsuitable(
            format!("{rays} rays on each of {surfaces} surfaces"),
            format!("must be at most {MOST_COUNT:e} in all"),
        )),
    }
}

/// Refuses a list that names a value twice.
fn once<T: Display>(list: &'static str, values: Vec<T>) -> Result<Vec<T>, ConfigError> {
    let mut seen = BTreeSet::new();
    match values
        .iter()
        .map(T::to_string)
        .find(|value| !seen.insert(value.clone()))
    {
        Some(value) => Err(ConfigError::GivenTwice { list, value }),
        None => Ok(values),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        let error = match ConvergeConfig::from_toml(text) {
            Ok(config) => config.plan().err().unwrap().to_string(),
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
        assert!(plan.efforts.iter().all(|effort| effort.surfaces() == 4));
        let shapes: Vec<_> = plan
            .methods
            .iter()
            .map(|m| config.shape(m.spacing).unwrap())
            .collect();
        assert_eq!(shapes[0], [128, 256]);
        assert_eq!(shapes[17], [512, 1024]);
        // The reference is as fine as the finest.
        assert_eq!(plan.runs[0].method.spacing, PerAxis::Both(Number(0.5)));
    }

    #[test]
    fn defaults_are_understood() {
        let plan = ConvergeConfig::default().plan().unwrap();
        assert_eq!((plan.cases.len(), plan.methods.len()), (1, 6));
        assert_eq!(plan.runs.len(), 1 + 6 * 3 * 8);
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
            ("[converge]\nspacings = [3]", "divide the extent 512"),
            ("[converge]\nspacings = [0]", "above 0"),
            ("[converge]\nspacings = [-1]", "above 0"),
            ("[converge]\nspacings = [8]", "correlation length"),
            ("[converge]\nreference_spacing = 5", "divide the extent"),
            (
                "[converge]\nrays = [10, 100]\nsurfaces = [1, 2, 3]",
                "2 values of rays and 3 of surfaces",
            ),
            (
                "[converge]\nrays = [10, 10]\nsurfaces = 1",
                "10 x 1 is given twice",
            ),
            ("[converge]\nrays = 0", "1 or more"),
            ("[converge]\nrays = 1e14", "at most 1e15"),
            ("[converge]\nsurfaces = 1e7", "GiB"),
            ("[converge]\nrepeats = 0", "1 or more"),
            (
                "[converge]\nrepeats = 1e15",
                "storing the results of all runs",
            ),
            ("[converge]\nreference_surfaces = 1", "2 or more"),
            ("[converge]\nerrors = [0.01, 0]", "above 0"),
            ("[converge]\nbins = \"0x5\"", "bins"),
            (
                "[converge]\nside = \"transmitted\"\n[material]\nkind = \"mirror\"",
                "nothing is transmitted",
            ),
            ("[surface]\nsmoothness = [3, 3.0000001]", "same folder"),
            ("[run]\nrays = 5", "unknown section `run`"),
            ("[light]\ntheta = 90", "below 90"),
        ] {
            let error = refusal(text);
            assert!(error.contains(expected), "{text}: {error}");
        }
    }
}
