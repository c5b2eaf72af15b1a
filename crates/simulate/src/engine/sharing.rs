//! Cases that share surfaces: how much of them is traced, and when that ends.

use std::time::Instant;

use asperity_surface::Synthesis;
use asperity_tracer::HalfSpace;
use rayon::prelude::*;

use crate::engine::blocks::RaySettings;
use crate::engine::ensemble::{Ensemble, Group, surface_bytes};
use crate::engine::pilot::{self, Figures};
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::input::limits::{check_memory, most_realisations};
use crate::methods::known::Known;
use crate::methods::method::{Method, with_least_errors};
use crate::observer::Observer;
use crate::observer::StoppedBy;
use crate::output::stopping::Stopping;
use crate::slopes::slopes;
use crate::text::error_in_short;

/// Times that surfaces are added to those planned, at most.
const MOST_ROUNDS: u32 = 4;

/// What the mesh may add to an error at its target: a third of it, squared.
pub const MESH_ALLOWANCE: f64 = 1.055;

/// Surfaces added are so many times more than the error found asks for.
const ROUND_MARGIN: f64 = 1.1;

/// How many surfaces are drawn, and how light falls on them.
#[derive(Clone, Copy, Debug)]
pub struct RunPlan {
    /// Surfaces.
    pub realisations: u64,
    /// The side that the light comes from.
    pub incident: HalfSpace,
    /// Whether each ray comes from an azimuth of its own.
    pub any_azimuth: bool,
    /// Whether the run may end by time.
    pub limited: bool,
}

/// The cases of one recipe, and the effort that they take.
pub struct Sharing {
    synthesis: Synthesis,
    cases: Vec<Case>,
    /// What needs no tracing, by case.
    known: Vec<Option<Known>>,
    /// The others, and how they are estimated.
    traced: Vec<Case>,
    methods: Vec<Method>,
    pub settings: RaySettings,
    incident: HalfSpace,
    any_azimuth: bool,
    /// Surfaces planned.
    pub realisations: u64,
    /// Of the pilot run, by traced case.
    figures: Vec<Figures>,
    /// What the mesh adds to each error, as far as the pilot run could tell, by traced case.
    mesh_errors: Vec<Option<f64>>,
    warnings: Vec<String>,
    /// Whether it matters when the run ends.
    limited: bool,
}

/// What was found for one case.
pub struct Traced {
    pub case: Case,
    pub method: Method,
    pub ensemble: Ensemble,
    pub seconds: f64,
    pub stopping: Option<Stopping>,
    pub deviation_bound: Option<f64>,
    pub size: [usize; 2],
    pub spacing: [f64; 2],
}

impl Sharing {
    /// With the effort of `plan`, which a plan may replace.
    pub fn new(
        plan: &RunPlan,
        settings: RaySettings,
        synthesis: Synthesis,
        cases: Vec<Case>,
    ) -> Result<Self, SimulateError> {
        let known = cases
            .par_iter()
            .map(|case| Ok(Known::of(&settings, &slopes(&case.psd)?, case)?))
            .collect::<Result<Vec<_>, SimulateError>>()?;
        let traced: Vec<Case> = cases
            .iter()
            .zip(&known)
            .filter(|(_, known)| known.is_none())
            .map(|(case, _)| *case)
            .collect();
        // What one surface does is asked for as it is, without the mean of others.
        let of_one = plan.realisations == 1 && settings.target.is_none();
        let estimator = match settings.estimator {
            Estimator::Auto if of_one => Estimator::Plain,
            chosen => chosen,
        };
        let methods = traced
            .par_iter()
            .map(|case| {
                // No control knows of a medium.
                let estimator = match case.layer {
                    Some(_) => Estimator::Plain,
                    None => estimator,
                };
                Ok(Method::of_ensemble(
                    estimator,
                    &slopes(&case.psd)?,
                    case.material,
                    case.incidence,
                    &settings.spec,
                )?)
            })
            .collect::<Result<Vec<_>, SimulateError>>()?;
        Ok(Self {
            synthesis,
            cases,
            known,
            traced,
            methods,
            settings,
            incident: plan.incident,
            any_azimuth: plan.any_azimuth,
            realisations: plan.realisations,
            figures: Vec::new(),
            mesh_errors: Vec::new(),
            warnings: Vec::new(),
            limited: settings.target.is_some() || plan.limited,
        })
    }

    fn group<'a>(&'a self, settings: &'a RaySettings, realisations: u64) -> Group<'a> {
        Group {
            synthesis: &self.synthesis,
            cases: &self.traced,
            methods: &self.methods,
            realisations,
            settings,
            incident: self.incident,
            any_azimuth: self.any_azimuth,
            coarsened: false,
        }
    }

    /// Rays of all cases, as planned.
    pub fn rays(&self) -> u64 {
        let group = self.group(&self.settings, self.realisations);
        let of_case = group.blocks().rays().saturating_mul(self.realisations);
        of_case.saturating_mul(self.traced.len() as u64)
    }

    /// Rays of its pilot run.
    pub fn pilot_rays(&self) -> u64 {
        let runs = if self.halves() { 2 } else { 1 };
        runs * pilot::RAYS * self.traced.len() as u64
    }

    /// Whether every second sample makes a surface.
    fn halves(&self) -> bool {
        self.synthesis.shape().iter().all(|n| n % 2 == 0 && *n >= 4)
    }

    /// Plans surfaces, rays and spacing by a pilot run. If that is stopped, all stays as it is.
    pub fn plan(&mut self, all_cases: usize, progress: &dyn Observer) -> Result<(), SimulateError> {
        let Some(target) = self.settings.target else {
            return Ok(());
        };
        if self.traced.is_empty() {
            return Ok(());
        }
        let settings = RaySettings {
            rays: pilot::RAYS,
            target: None,
            refine: false,
            ..self.settings
        };
        let surfaces = pilot::FIRST..pilot::FIRST + pilot::SURFACES;
        let complete = |ensembles: &[Ensemble]| {
            let first = ensembles.first();
            first.is_some_and(|e| e.tallies.len() as u64 == pilot::SURFACES)
        };
        let pilot = self.group(&settings, pilot::SURFACES);
        let fine = pilot.run(surfaces.clone(), progress)?;
        if !complete(&fine) {
            return Ok(());
        }
        let coarse = if self.halves() {
            let coarsened = Group {
                coarsened: true,
                ..pilot
            };
            coarsened.run(surfaces, progress)?
        } else {
            Vec::new()
        };
        let coarse = complete(&coarse).then_some(coarse);
        let spec = &self.settings.spec;
        let cells = self.synthesis.shape().iter().product();
        self.figures = fine
            .iter()
            .zip(&self.methods)
            .enumerate()
            .map(|(i, (fine, method))| {
                let control = method.control();
                let counted = pilot::entries_with_least_error(target.of(), spec, control);
                let coarse = coarse.as_ref().map(|coarse| &coarse[i]);
                Figures::new(target, spec, fine, coarse, (cells, counted))
            })
            .collect();

        let mut recipes = Vec::new();
        for scale in [2.0, 0.5] {
            if let Some(synthesis) = pilot::respaced(&self.synthesis, scale)
                && check_memory("", surface_bytes(&synthesis, &self.settings)).is_ok()
            {
                recipes.push((scale, synthesis));
            }
        }
        let mut scales: Vec<f64> = recipes.iter().map(|(scale, _)| *scale).collect();
        scales.push(1.0);
        scales.sort_by(|a, b| b.total_cmp(a));
        let (scale, mesh_error, fine_enough) = pilot::spacing(&self.figures, target, &scales);
        self.mesh_errors = self.figures.iter().map(|f| f.mesh_error(scale)).collect();
        if let Some((_, synthesis)) = recipes.into_iter().find(|(s, _)| *s == scale) {
            self.synthesis = synthesis;
        }
        if let (Some(error), false) = (mesh_error, fine_enough) {
            let spacing = self.synthesis.spacing()[0];
            self.warnings.push(format!(
                "at the spacing {spacing} the mesh adds an error of up to {}, above a third of the target: give a finer spacing",
                error_in_short(error)
            ));
        }
        let most = most_realisations(spec, all_cases);
        if let Some(effort) = pilot::plan(&self.figures, target.error(), scale, most) {
            if effort.expected > target.error() {
                self.warnings.push(format!(
                    "the target {} takes more than {} surfaces, the most that results are held of: expect {}",
                    error_in_short(target.error()),
                    effort.realisations,
                    error_in_short(effort.expected)
                ));
            }
            self.realisations = effort.realisations;
            self.settings.rays = effort.realisations.saturating_mul(effort.rays_of_surface);
        }
        Ok(())
    }

    /// The largest error of a case over its target; none without a target.
    fn worst(&self, ensembles: &[Ensemble]) -> Option<f64> {
        let target = self.settings.target?;
        let errors: Option<Vec<f64>> = (0..ensembles.len())
            .map(|i| self.error(i, &ensembles[i]))
            .collect();
        let worst = errors?.into_iter().fold(0.0, f64::max);
        Some(worst / target.error())
    }

    /// The error of traced case `i`.
    fn error(&self, i: usize, ensemble: &Ensemble) -> Option<f64> {
        let statistics = ensemble.statistics();
        let statistics = with_least_errors(&self.methods[i], statistics, ensemble.work.rays);
        let aim = self.settings.target?.of();
        aim.error(&statistics)
    }

    /// What ends a case whose `error` lies within the target: that, unless the mesh adds too much to it.
    fn reached(&self, error: f64, mesh_error: Option<f64>) -> Option<StoppedBy> {
        let target = self.settings.target?.error();
        let mesh = mesh_error.unwrap_or(0.0);
        (error <= target).then(|| {
            if error.hypot(mesh) <= target * MESH_ALLOWANCE {
                StoppedBy::Target
            } else {
                StoppedBy::Mesh
            }
        })
    }

    /// Traces all cases: as planned, and more until the error is reached. Also returns the cases that an
    /// interrupt came before.
    pub fn run(
        self,
        all_cases: usize,
        progress: &dyn Observer,
    ) -> Result<(Vec<Traced>, Vec<Case>), SimulateError> {
        let clock = Instant::now();
        let group = self.group(&self.settings, self.realisations);
        let rays = group.blocks().rays();
        let mut ensembles: Vec<Ensemble> = Vec::new();
        let mut ended = StoppedBy::Plan;
        let mut rounds = 0;
        let most = most_realisations(&self.settings.spec, all_cases);
        if !self.traced.is_empty() {
            let mut planned = self.realisations;
            ensembles = group.run(0..planned, progress)?;
            loop {
                let done = ensembles.first().map_or(0, |e| e.work.rays);
                if done < planned * rays {
                    ended = progress.stop().unwrap_or(StoppedBy::Interrupt);
                    break;
                }
                let Some(worst) = self.worst(&ensembles) else {
                    break;
                };
                if worst <= 1.0 {
                    break;
                }
                let needed = (planned as f64 * worst * worst * ROUND_MARGIN).ceil() as u64;
                let all = needed.max(planned + 2).min(most);
                if rounds == MOST_ROUNDS || all <= planned {
                    break;
                }
                rounds += 1;
                progress.begin("adding", (all - planned) * rays * self.traced.len() as u64);
                let more = group.run(planned..all, progress)?;
                for (ensemble, more) in ensembles.iter_mut().zip(more) {
                    ensemble.append(more);
                }
                planned = all;
            }
        }
        let seconds = clock.elapsed().as_secs_f64() / self.traced.len().max(1) as f64;
        // The error of each, what the mesh adds to it, and whether that is what was asked for.
        let ends: Vec<_> = ensembles
            .iter()
            .enumerate()
            .map(|(i, ensemble)| {
                let error = self.error(i, ensemble);
                let mesh_error = self.mesh_errors.get(i).copied().flatten();
                let reached = error.and_then(|error| self.reached(error, mesh_error));
                (error, mesh_error, reached)
            })
            .collect();
        let stopped = matches!(ended, StoppedBy::Time | StoppedBy::Interrupt);
        let [ny, nx] = self.synthesis.shape();
        let (size, spacing) = ([nx, ny], self.synthesis.spacing());
        let target = self.settings.target;
        let common = Stopping {
            target_error: target.map(|target| target.error()),
            of: target.map(|target| target.of()),
            error: None,
            mesh_error: None,
            pilot: None,
            realisations: self.realisations,
            rays_per_surface: rays,
            size: Some(size),
            spacing: Some(spacing),
            rounds,
            stopped_by: ended,
            warnings: self.warnings,
        };

        let mut out = Vec::new();
        let mut left_out = Vec::new();
        let mut traced = ensembles.into_iter().zip(self.methods).enumerate();
        for (case, known) in self.cases.into_iter().zip(self.known) {
            if let Some(known) = known {
                let stopping = Stopping {
                    error: Some(known.error),
                    realisations: 0,
                    rays_per_surface: 0,
                    rounds: 0,
                    stopped_by: StoppedBy::Bound,
                    warnings: Vec::new(),
                    ..common.clone()
                };
                out.push(Traced {
                    case,
                    method: known.method,
                    ensemble: Ensemble::known(known.statistics),
                    seconds: 0.0,
                    stopping: Some(stopping),
                    deviation_bound: Some(known.bound),
                    size,
                    spacing,
                });
                continue;
            }
            let Some((i, (ensemble, method))) = traced.next() else {
                left_out.push(case);
                continue;
            };
            let (error, mesh_error, reached) = ends[i];
            let stopping = Stopping {
                error,
                mesh_error,
                pilot: self.figures.get(i).map(|figures| figures.figures),
                stopped_by: reached.filter(|_| !stopped).unwrap_or(ended),
                ..common.clone()
            };
            out.push(Traced {
                case,
                method,
                ensemble,
                seconds,
                stopping: (self.limited || stopped).then(|| stopping.with_warning()),
                deviation_bound: None,
                size,
                spacing,
            });
        }
        Ok((out, left_out))
    }
}
