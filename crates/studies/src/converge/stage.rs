//! One case of a convergence run: its runs by the clock, and what they are measured against.

use asperity_simulate::{Case, Estimator, Group, Observer, RaySettings, Seconds};
use std::time::Instant;

use asperity_analysis::{
    Beckmann, Masking, SlopeCovariance, Smith, bin_fluxes, hemispherical_energy,
};
use asperity_optics::Material;
use asperity_surface::Synthesis;
use asperity_tally::{Component, Side, TallyResult, TallyStatistics};
use asperity_tracer::{PathSettings, Work};

use super::config::Plan;
use super::deviation::Target;
use super::method::{reference_seed, run_seed};
use super::{
    ConvergeConfig, ConvergeError, ConvergeWork, ConvergedCase, Effort, Measurement, Method,
    MethodOutcome, Reference,
};
use crate::values::{Number, PerAxis};
use crate::verify::VerifyError;
use asperity_simulate as estimate;
use asperity_simulate::{BottomSurface, slopes};

/// Smith's Lambda up to which nothing counts as hidden.
const NOTHING_HIDDEN: f64 = 1e-12;

/// What single scattering may miss of all light to count as all there is.
const NOTHING_MISSING: f64 = 1e-9;

/// One case, ready to be measured.
pub(super) struct Stage<'a> {
    plan: &'a Plan,
    case: Case,
    slopes: SlopeCovariance,
    /// How surfaces are drawn at each spacing.
    recipes: Vec<(PerAxis<Number>, Synthesis)>,
    /// What each estimator does, and the seconds that it took to know.
    estimators: Vec<(Estimator, estimate::Method, f64)>,
}

/// What one run found and took.
pub(super) struct Run {
    pub(super) statistics: TallyStatistics,
    pub(super) rays_a_surface: u64,
    pub(super) work: Work,
    pub(super) spent: Seconds,
    pub(super) seconds: f64,
}

impl<'a> Stage<'a> {
    pub(super) fn new(
        config: &ConvergeConfig,
        plan: &'a Plan,
        case: Case,
    ) -> Result<Self, ConvergeError> {
        let mut recipes: Vec<(PerAxis<Number>, Synthesis)> = Vec::new();
        for method in plan.methods.iter().chain([&plan.reference.0]) {
            if recipes
                .iter()
                .all(|(spacing, _)| *spacing != method.spacing)
            {
                recipes.push((method.spacing, config.recipe(&case, method)?));
            }
        }
        let slopes = slopes(&case.psd).map_err(VerifyError::from)?;
        let mut estimators: Vec<(Estimator, estimate::Method, f64)> = Vec::new();
        for method in plan.methods.iter().chain([&plan.reference.0]) {
            let estimator = method.estimator;
            if estimators.iter().all(|(known, ..)| *known != estimator) {
                let clock = Instant::now();
                let (material, incidence) = (case.material, case.incidence);
                let method = estimate::Method::of_ensemble(
                    estimator, &slopes, material, incidence, &plan.spec,
                )?;
                estimators.push((estimator, method, clock.elapsed().as_secs_f64()));
            }
        }
        Ok(Self {
            plan,
            case,
            slopes,
            recipes,
            estimators,
        })
    }

    /// What an estimator does, and the seconds that it took to know.
    fn estimator(&self, method: &Method) -> &(Estimator, estimate::Method, f64) {
        let known = self
            .estimators
            .iter()
            .find(|(e, ..)| *e == method.estimator);
        known.unwrap_or(&self.estimators[0])
    }

    /// Rays of all runs.
    pub(super) fn rays(&self) -> u64 {
        let plan = self.plan;
        let (reference, effort) = &plan.reference;
        let of = |method, effort: &Effort| {
            let rays = |group: &Group<'_>| group.blocks().rays() * effort.surfaces;
            self.with_group(method, *effort, 0, rays)
        };
        let one_of_each: u64 = plan
            .methods
            .iter()
            .flat_map(|method| plan.efforts.iter().map(move |effort| of(method, effort)))
            .sum();
        plan.repeats * one_of_each + of(reference, effort)
    }

    /// Hands over what the engine runs: the only place that knows how to ask it.
    fn with_group<T>(
        &self,
        method: &Method,
        effort: Effort,
        seed: u64,
        then: impl FnOnce(&Group<'_>) -> T,
    ) -> T {
        let recipe = self
            .recipes
            .iter()
            .find(|(spacing, _)| *spacing == method.spacing);
        let (_, synthesis) = recipe.unwrap_or(&self.recipes[0]);
        then(&Group {
            synthesis,
            cases: &[self.case],
            methods: std::slice::from_ref(&self.estimator(method).1),
            realisations: effort.surfaces,
            settings: &RaySettings {
                rays: effort.rays * effort.surfaces,
                seed,
                spec: self.plan.spec,
                paths: PathSettings::default(),
                accelerator: method.accelerator,
                estimator: method.estimator,
                sampling: method.sampling,
                refine: false,
                target: None,
                bottom: BottomSurface::Flat,
                most_scatterings: 0,
            },
            incident: self.plan.incident,
            any_azimuth: self.plan.any_azimuth,
            coarsened: false,
        })
    }

    /// One run of the engine, by the clock.
    fn run(
        &self,
        method: &Method,
        effort: Effort,
        seed: u64,
        progress: &dyn Observer,
    ) -> Result<Run, ConvergeError> {
        let clock = Instant::now();
        let ensembles = self
            .with_group(method, effort, seed, |group| {
                group.run(0..effort.surfaces, progress)
            })
            .map_err(VerifyError::from)?;
        let seconds = clock.elapsed().as_secs_f64();
        if progress.stop().is_some() {
            return Err(ConvergeError::Interrupted);
        }
        let mut statistics = TallyStatistics::new(self.plan.spec);
        let mut run = Run {
            statistics: statistics.clone(),
            rays_a_surface: 0,
            work: Work::default(),
            spent: Seconds::default(),
            seconds,
        };
        for ensemble in ensembles {
            ensemble
                .tallies
                .iter()
                .for_each(|tally| statistics.push(tally));
            run.rays_a_surface = ensemble.work.rays / effort.surfaces;
            run.work = ensemble.work;
            run.spent = ensemble.seconds;
        }
        run.statistics = statistics;
        Ok(run)
    }

    /// The reference first, which also warms the machine up, then all methods in turns.
    pub(super) fn measure(&self, progress: &dyn Observer) -> Result<ConvergedCase, ConvergeError> {
        let began = Instant::now();
        let plan = self.plan;
        let (method, effort) = plan.reference;
        let run = self.run(
            &method,
            effort,
            reference_seed(plan.seed, &self.case),
            progress,
        )?;
        let target = Target::new(self.fluxes(&run)).ok_or(ConvergeError::NoLight)?;
        let exact = self.exact_fluxes()?.and_then(Target::new);
        let bins = self.plan.spec.recorded_entries(Component::All);
        let standard_errors: Vec<f64> = bins
            .iter()
            .map(|bin| run.statistics.at(bin).se.unwrap_or(0.0))
            .collect();
        let reference = Reference {
            method,
            size: self.size(&method),
            rays_a_surface: run.rays_a_surface,
            surfaces: effort.surfaces,
            error: target.own_error(&standard_errors),
            error_exact: exact
                .as_ref()
                .map(|exact| exact.relative_rms(&self.fluxes(&run))),
            seconds: run.seconds,
        };
        let mut work = ConvergeWork::default();
        work.add(&run, effort);

        let cells = plan.methods.len() * plan.efforts.len();
        let mut samples: Vec<Vec<RunSample>> = Vec::new();
        samples.resize_with(cells, Vec::new);
        for repeat in 0..plan.repeats {
            for (e, &effort) in plan.efforts.iter().enumerate() {
                for turn in 0..plan.methods.len() {
                    // Another one begins each time, so that none always follows the same.
                    let m = (turn + repeat as usize) % plan.methods.len();
                    let method = &plan.methods[m];
                    let seed = run_seed(plan.seed, &self.case, method, effort, repeat);
                    let run = self.run(method, effort, seed, progress)?;
                    work.add(&run, effort);
                    samples[m * plan.efforts.len() + e].push(self.sample(
                        &run,
                        &target,
                        exact.as_ref(),
                    ));
                }
            }
        }
        let methods = plan
            .methods
            .iter()
            .zip(samples.chunks_exact(plan.efforts.len()))
            .map(|(method, samples)| {
                let measurements = plan.efforts.iter().zip(samples);
                let measurements = measurements
                    .map(|(effort, samples)| Measurement::over(*effort, samples, reference.error));
                let setup_seconds = self.estimator(method).2;
                MethodOutcome::new(*method, setup_seconds, measurements.collect())
            })
            .collect();
        work.seconds = began.elapsed().as_secs_f64();
        Ok(ConvergedCase {
            case: self.case,
            reference,
            is_exact: exact.is_some(),
            methods,
            work,
        })
    }

    /// Samples `[nx, ny]` of a method's surfaces.
    fn size(&self, method: &Method) -> [usize; 2] {
        let run_nothing = Effort {
            rays: 1,
            surfaces: 1,
        };
        let [ny, nx] = self.with_group(method, run_nothing, 0, |group| group.synthesis.shape());
        [nx, ny]
    }

    /// Mean fluxes of the bins that are compared.
    fn fluxes(&self, run: &Run) -> Vec<f64> {
        let bins = self.plan.spec.recorded_entries(Component::All);
        run.statistics.means()[bins].to_vec()
    }

    fn sample(&self, run: &Run, target: &Target, exact: Option<&Target>) -> RunSample {
        let fluxes = self.fluxes(run);
        let means = run.statistics.means();
        let left = means.budget().reflected + means.budget().transmitted;
        RunSample {
            seconds: run.seconds,
            rays_a_surface: run.rays_a_surface,
            error: target.relative_rms(&fluxes),
            error_exact: exact.map(|exact| exact.relative_rms(&fluxes)),
            energy_error: self.returns_all_light().then_some(left - 1.0),
        }
    }

    /// Whether all light must be found on the sides that are asked for.
    fn returns_all_light(&self) -> bool {
        let asks = |side| self.plan.spec.records(side);
        match self.case.material {
            Material::Mirror => asks(Side::Reflected),
            Material::Dielectric { .. } => asks(Side::Reflected) && asks(Side::Transmitted),
            _ => false,
        }
    }

    /// What each bin holds exactly, where every facet is lit and seen and light meets only one.
    pub(super) fn exact_fluxes(&self) -> Result<Option<Vec<f64>>, ConvergeError> {
        let Case {
            material,
            incidence,
            psd,
            ..
        } = &self.case;
        let wi = incidence.wi();
        if !psd.is_isotropic() || Beckmann::new(self.slopes).lambda(wi) >= NOTHING_HIDDEN {
            return Ok(None);
        }
        let of = |material| Smith::new(self.slopes, material, Masking::HeightCorrelated);
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
    pub(super) rays_a_surface: u64,
    pub(super) error: f64,
    pub(super) error_exact: Option<f64>,
    pub(super) energy_error: Option<f64>,
}
