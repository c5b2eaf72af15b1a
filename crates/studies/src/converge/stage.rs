//! One case of a convergence run: its runs by the clock, and what they are measured against.

use std::time::Instant;

use asperity_analysis::{
    Beckmann, Masking, SlopeCovariance, Smith, bin_fluxes, hemispherical_energy,
};
use asperity_optics::Material;
use asperity_simulate::{
    Case, Observer, PathChoice, Settings, SimulateError, Simulation, StoppedBy, SummaryWork, slopes,
};
use asperity_tally::{Component, Side, TallyResult, TallyStatistics};
use asperity_tracer::PathSettings;

use super::config::{Plan, PlannedReference};
use super::deviation::Target;
use super::method::{reference_seed, run_seed};
use super::{
    ConvergeConfig, ConvergeError, ConvergeWork, ConvergedCase, Measurement, Method, MethodOutcome,
    Reference, RunEffort,
};
use crate::config::error::ConfigError;

/// Smith's Lambda up to which nothing counts as hidden.
const NOTHING_HIDDEN: f64 = 1e-12;

/// What single scattering may miss of all light to count as all there is.
const NOTHING_MISSING: f64 = 1e-9;

/// One case, ready to be measured.
pub(super) struct Stage<'a> {
    plan: &'a Plan,
    case: Case,
    slopes: Option<SlopeCovariance>,
    /// By method; the reference is the last.
    prepared: Vec<Prepared>,
}

/// A method, ready to be run.
struct Prepared {
    method: Method,
    simulation: Simulation,
    /// Samples `[nx, ny]` of a surface.
    size: [usize; 2],
    /// Seconds that it took to prepare.
    seconds: f64,
}

/// What one run found and took.
pub(super) struct Run {
    pub(super) statistics: TallyStatistics,
    pub(super) rays_per_surface: u64,
    pub(super) work: SummaryWork,
}

/// What runs are measured against.
struct Targets {
    reference: Target,
    /// The exact fluxes, where they are known.
    exact: Option<Target>,
}

/// Passes on steps and the stop; what a run begins and ends is a part of the measurement.
struct Steps<'a>(&'a dyn Observer);

impl Observer for Steps<'_> {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, steps: u64) {
        self.0.advance(steps);
    }
    fn end(&self) {}
    fn stop(&self) -> Option<StoppedBy> {
        self.0.stop()
    }
}

/// The effort of a run as the engine takes it.
const fn engine_effort(effort: RunEffort) -> asperity_simulate::Effort {
    asperity_simulate::Effort::Rays {
        total: effort.rays * effort.surfaces,
        surfaces: effort.surfaces,
    }
}

impl<'a> Stage<'a> {
    pub(super) fn new(
        config: &ConvergeConfig,
        plan: &'a Plan,
        case: Case,
    ) -> Result<Self, ConvergeError> {
        let methods = plan.methods.iter().chain([&plan.reference.method]);
        let prepared = methods.map(|method| prepare(config, plan, &case, method));
        let recipe = case.surface.recipe();
        let slopes = recipe
            .map(slopes)
            .transpose()
            .map_err(SimulateError::from)?;
        Ok(Self {
            plan,
            slopes,
            prepared: prepared.collect::<Result<_, _>>()?,
            case,
        })
    }

    /// The method, ready to be run.
    fn prepared(&self, method: &Method) -> &Prepared {
        let found = self.prepared.iter().find(|one| one.method == *method);
        found.unwrap_or(&self.prepared[0])
    }

    /// Rays of all runs.
    pub(super) fn rays(&self) -> u64 {
        let plan = self.plan;
        let PlannedReference {
            method: reference,
            effort,
        } = &plan.reference;
        let of = |method, effort: &RunEffort| {
            let simulation = &self.prepared(method).simulation;
            simulation.repeated(engine_effort(*effort), 0).rays()
        };
        let one_of_each: u64 = plan
            .methods
            .iter()
            .flat_map(|method| plan.efforts.iter().map(move |effort| of(method, effort)))
            .sum();
        plan.repeats * one_of_each + of(reference, effort)
    }

    /// One run of the engine, by its clock.
    fn run(
        &self,
        method: &Method,
        effort: RunEffort,
        seed: u64,
        observer: &dyn Observer,
    ) -> Result<Run, ConvergeError> {
        let simulation = &self.prepared(method).simulation;
        let simulation = simulation.repeated(engine_effort(effort), seed);
        let outcomes = simulation.run(&Steps(observer));
        if observer.stop().is_some() {
            return Err(ConvergeError::Interrupted);
        }
        let outcome = outcomes?.into_iter().next();
        let outcome = outcome.ok_or(ConvergeError::Interrupted)?;
        let mut statistics = TallyStatistics::new(self.plan.spec);
        let surfaces = outcome.surfaces.iter();
        surfaces.for_each(|tally| statistics.push(tally));
        Ok(Run {
            statistics,
            rays_per_surface: outcome.work.rays / effort.surfaces,
            work: outcome.work,
        })
    }

    /// The reference first, which also warms the machine up, then all methods in turns.
    pub(super) fn measure(&self, progress: &dyn Observer) -> Result<ConvergedCase, ConvergeError> {
        let began = Instant::now();
        let mut work = ConvergeWork::default();
        let PlannedReference { method, effort } = self.plan.reference;
        let seed = reference_seed(self.plan.seed, &self.case);
        let run = self.run(&method, effort, seed, progress)?;
        work.add(&run, effort);
        let targets = Targets {
            reference: Target::new(self.fluxes(&run)).ok_or(ConvergeError::NoLight)?,
            exact: self.exact_fluxes()?.and_then(Target::new),
        };
        let reference = self.reference(&run, &targets);
        let samples = self.samples(&targets, &mut work, progress)?;
        let methods = self.outcomes(&samples, &reference);
        work.seconds = began.elapsed().as_secs_f64();
        Ok(ConvergedCase {
            case: self.case.clone(),
            reference,
            is_exact: targets.exact.is_some(),
            methods,
            work,
        })
    }

    /// What the run of the reference found.
    fn reference(&self, run: &Run, targets: &Targets) -> Reference {
        let PlannedReference { method, effort } = self.plan.reference;
        let bins = self.plan.spec.recorded_entries(Component::All);
        let standard_errors: Vec<f64> = bins
            .iter()
            .map(|bin| run.statistics.at(bin).se.unwrap_or(0.0))
            .collect();
        let exact = targets.exact.as_ref();
        Reference {
            method,
            size: self.prepared(&method).size,
            rays_per_surface: run.rays_per_surface,
            surfaces: effort.surfaces,
            error: targets.reference.own_error(&standard_errors),
            error_exact: exact.map(|exact| exact.relative_rms(&self.fluxes(run))),
            seconds: run.work.machine.seconds,
        }
    }

    /// The runs of every method and effort, by method, then by effort.
    fn samples(
        &self,
        targets: &Targets,
        work: &mut ConvergeWork,
        progress: &dyn Observer,
    ) -> Result<Vec<Vec<RunSample>>, ConvergeError> {
        let plan = self.plan;
        let mut samples: Vec<Vec<RunSample>> = Vec::new();
        samples.resize_with(plan.methods.len() * plan.efforts.len(), Vec::new);
        for repeat in 0..plan.repeats {
            for (e, &effort) in plan.efforts.iter().enumerate() {
                for turn in 0..plan.methods.len() {
                    // Another one begins each time, so that none always follows the same.
                    let m = (turn + repeat as usize) % plan.methods.len();
                    let method = &plan.methods[m];
                    let seed = run_seed(plan.seed, &self.case, method, effort, repeat);
                    let run = self.run(method, effort, seed, progress)?;
                    work.add(&run, effort);
                    samples[m * plan.efforts.len() + e].push(self.sample(&run, targets));
                }
            }
        }
        Ok(samples)
    }

    /// The measurements of every method, over their samples.
    fn outcomes(&self, samples: &[Vec<RunSample>], reference: &Reference) -> Vec<MethodOutcome> {
        let efforts = &self.plan.efforts;
        let methods = self.plan.methods.iter();
        let own = methods
            .zip(samples.chunks_exact(efforts.len()))
            .map(|(method, samples)| {
                let measurements = efforts.iter().zip(samples);
                let measurements = measurements
                    .map(|(effort, samples)| Measurement::over(*effort, samples, reference.error));
                let setup_seconds = self.prepared(method).seconds;
                MethodOutcome::new(*method, setup_seconds, measurements.collect())
            });
        let mut outcomes: Vec<MethodOutcome> = own.collect();
        if let Some(rate) = self.plan.peer_rate {
            let of_peers = outcomes.iter().filter(|own| own.method.is_of_peers());
            let peers: Vec<MethodOutcome> = of_peers.map(|own| own.of_peer(rate)).collect();
            outcomes.extend(peers);
        }
        outcomes
    }

    /// Mean fluxes of the bins that are compared.
    fn fluxes(&self, run: &Run) -> Vec<f64> {
        let bins = self.plan.spec.recorded_entries(Component::All);
        run.statistics.means()[bins].to_vec()
    }

    fn sample(&self, run: &Run, targets: &Targets) -> RunSample {
        let fluxes = self.fluxes(run);
        let means = run.statistics.means();
        let left = means.budget().reflected + means.budget().transmitted;
        let exact = targets.exact.as_ref();
        RunSample {
            seconds: run.work.machine.seconds,
            rays_per_surface: run.rays_per_surface,
            error: targets.reference.relative_rms(&fluxes),
            error_exact: exact.map(|exact| exact.relative_rms(&fluxes)),
            energy_error: self.returns_all_light().then_some(left - 1.0),
        }
    }

    /// Whether all light must be found on the sides that are recorded.
    fn returns_all_light(&self) -> bool {
        let records = |side| self.plan.spec.records(side);
        match self.case.material {
            Material::Mirror => records(Side::Reflected),
            Material::Dielectric { .. } => records(Side::Reflected) && records(Side::Transmitted),
            _ => false,
        }
    }

    /// What each bin holds exactly, where every facet is lit and seen and light meets only one.
    pub(super) fn exact_fluxes(&self) -> Result<Option<Vec<f64>>, ConvergeError> {
        let Case {
            material,
            light,
            surface,
            ..
        } = &self.case;
        let Some(slopes) = self.slopes else {
            return Ok(None);
        };
        let wi = light.incidence.wi();
        let is_gaussian = surface
            .recipe()
            .is_some_and(|recipe| recipe.gaussian().is_some() && recipe.is_isotropic());
        if !is_gaussian
            || material.is_diffuse()
            || Beckmann::new(slopes).lambda(wi) >= NOTHING_HIDDEN
        {
            return Ok(None);
        }
        let of = |material| Smith::new(slopes, material, Masking::HeightCorrelated);
        let model = of(*material)?;
        // What a conductor absorbs is none of the light that facets hide; a mirror in its place tells.
        let lossless = match material {
            Material::Conductor { .. } => of(Material::Mirror)?,
            _ => model,
        };
        let energy = hemispherical_energy(&lossless, wi);
        if (energy.reflected + energy.transmitted - 1.0).abs() > NOTHING_MISSING {
            return Ok(None);
        }
        let grid = self.plan.spec.grid();
        let expected = bin_fluxes(&model, wi, &grid);
        Ok(Some(expected[self.plan.spec.recorded_bins()].to_vec()))
    }
}

/// What one run gives to a measurement.
pub(super) struct RunSample {
    pub(super) seconds: f64,
    pub(super) rays_per_surface: u64,
    pub(super) error: f64,
    pub(super) error_exact: Option<f64>,
    pub(super) energy_error: Option<f64>,
}

/// A case by a method, ready to be run.
fn prepare(
    config: &ConvergeConfig,
    plan: &Plan,
    case: &Case,
    method: &Method,
) -> Result<Prepared, ConvergeError> {
    let case = config.spaced(case, method.spacing)?;
    let settings = Settings {
        tally: plan.spec,
        accelerator: method.accelerator,
        estimator: method.estimator,
        sampling: method.sampling,
        paths: PathChoice::new(
            Some(method.branching),
            None,
            PathSettings::DEFAULT_MAX_ORDER,
        )
        .map_err(ConfigError::from)?,
        effort: engine_effort(plan.reference.effort),
        mesh_quadrature: false,
        ..Settings::default()
    };
    let clock = Instant::now();
    Ok(Prepared {
        method: *method,
        size: case.surface.size().unwrap_or_default(),
        simulation: Simulation::new(&[case], &settings)?,
        seconds: clock.elapsed().as_secs_f64(),
    })
}
