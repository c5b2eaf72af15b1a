//! Cases that share surfaces: how much of them is traced, and when that ends.

use std::time::Instant;

use asperity_surface::Synthesis;
use asperity_tracer::Medium;
use rayon::prelude::*;

use crate::blocks::RaySettings;
use crate::case::Case;
use crate::config::VerifyConfig;
use crate::ensemble::{Ensemble, Group, surface_bytes};
use crate::estimator::Estimator;
use crate::known::Known;
use crate::limits::{check_memory, most_realisations};
use crate::method::{Method, with_least_errors};
use crate::pilot::{self, Figures};
use crate::progress::Progress;
use crate::stopping::{StoppedBy, Stopping};
use crate::tables::error_in_short;
use crate::verify::{VerifyError, slopes};

/// Times that surfaces are added to those planned, at most.
const MOST_ROUNDS: u32 = 4;

/// What the mesh may add to an error at its target: a third of it, squared.
const MESH_ALLOWANCE: f64 = 1.055;

/// Surfaces added are so many times more than the error found asks for.
const ROUND_MARGIN: f64 = 1.1;

/// The cases of one recipe, and the effort that they take.
pub(crate) struct Sharing {
    synthesis: Synthesis,
    cases: Vec<Case>,
    /// What needs no tracing, by case.
    known: Vec<Option<Known>>,
    /// The others, and how they are estimated.
    traced: Vec<Case>,
    methods: Vec<Method>,
    settings: RaySettings,
    incident: Medium,
    any_azimuth: bool,
    /// Surfaces planned.
    pub(crate) realisations: u64,
    /// Of the pilot run, by traced case.
    figures: Vec<Figures>,
    mesh_error: Option<f64>,
    warnings: Vec<String>,
    /// Whether it matters when the run ends.
    limited: bool,
}

/// What was found for one case.
pub(crate) struct Traced {
    pub(crate) case: Case,
    pub(crate) method: Method,
    pub(crate) ensemble: Ensemble,
    pub(crate) seconds: f64,
    pub(crate) stopping: Option<Stopping>,
    pub(crate) deviation_bound: Option<f64>,
    pub(crate) size: [usize; 2],
    pub(crate) spacing: [f64; 2],
}

impl Sharing {
    /// With the effort that `config` asks for, which a plan may replace.
    pub(crate) fn new(
        config: &VerifyConfig,
        settings: RaySettings,
        synthesis: Synthesis,
        cases: Vec<Case>,
    ) -> Result<Self, VerifyError> {
        let known = cases
            .par_iter()
            .map(|case| Ok(Known::of(&settings, &slopes(&case.psd)?, case)?))
            .collect::<Result<Vec<_>, VerifyError>>()?;
        let traced: Vec<Case> = cases
            .iter()
            .zip(&known)
            .filter(|(_, known)| known.is_none())
            .map(|(case, _)| *case)
            .collect();
        // What one surface does is asked for as it is, without the mean of others.
        let of_one = config.run.realisations.0 == 1 && settings.target.is_none();
        let estimator = match settings.estimator {
            Estimator::Auto if of_one => Estimator::Plain,
            chosen => chosen,
        };
        let methods = traced
            .par_iter()
            .map(|case| {
                Ok(Method::of_ensemble(
                    estimator,
                    &slopes(&case.psd)?,
                    case.material,
                    case.incidence,
                    &settings.layout,
                )?)
            })
            .collect::<Result<Vec<_>, VerifyError>>()?;
        Ok(Self {
            synthesis,
            cases,
            known,
            traced,
            methods,
            settings,
            incident: Medium::from(config.light.from),
            any_azimuth: config.any_azimuth(),
            realisations: config.run.realisations.0,
            figures: Vec::new(),
            mesh_error: None,
            warnings: Vec::new(),
            limited: settings.target.is_some() || config.run.max_time.is_some(),
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
    pub(crate) fn rays(&self) -> u64 {
        let group = self.group(&self.settings, self.realisations);
        let of_case = group.blocks().rays().saturating_mul(self.realisations);
        of_case.saturating_mul(self.traced.len() as u64)
    }

    /// Rays of its pilot run.
    pub(crate) fn pilot_rays(&self) -> u64 {
        let runs = if self.halves() { 2 } else { 1 };
        runs * pilot::RAYS * self.traced.len() as u64
    }

    /// Whether every second sample makes a surface.
    fn halves(&self) -> bool {
        self.synthesis.shape().iter().all(|n| n % 2 == 0 && *n >= 4)
    }

    /// Plans surfaces, rays and spacing by a pilot run. If that is stopped, all stays as it is.
    pub(crate) fn plan(
        &mut self,
        all_cases: usize,
        progress: &dyn Progress,
    ) -> Result<(), VerifyError> {
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
            first.is_some_and(|e| e.records.len() as u64 == pilot::SURFACES)
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
        let layout = &self.settings.layout;
        let cells = self.synthesis.shape().iter().product();
        self.figures = fine
            .iter()
            .zip(&self.methods)
            .enumerate()
            .map(|(i, (fine, method))| {
                let control = method.control();
                let counted = pilot::entries_with_least_error(target.of(), layout, control);
                let coarse = coarse.as_ref().map(|coarse| &coarse[i]);
                Figures::new(target, layout, fine, coarse, (cells, counted))
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
        self.mesh_error = mesh_error;
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
        let most = most_realisations(layout, all_cases);
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
        let statistics = with_least_errors(
            &self.methods[i],
            &self.settings.layout,
            statistics,
            ensemble.work.rays,
        );
        let aim = self.settings.target?.of();
        aim.error(&self.settings.layout, &statistics)
    }

    /// Traces all cases: as planned, and more until the error is reached. Also returns the cases that an
    /// interrupt came before.
    pub(crate) fn run(
        self,
        all_cases: usize,
        progress: &dyn Progress,
    ) -> Result<(Vec<Traced>, Vec<Case>), VerifyError> {
        let clock = Instant::now();
        let group = self.group(&self.settings, self.realisations);
        let rays = group.blocks().rays();
        let mut ensembles: Vec<Ensemble> = Vec::new();
        let mut ended = StoppedBy::Plan;
        let mut rounds = 0;
        let most = most_realisations(&self.settings.layout, all_cases);
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
                    let mesh = self.mesh_error.unwrap_or(0.0);
                    let target = self.settings.target.map_or(0.0, |target| target.error());
                    ended = if (worst * target).hypot(mesh) <= target * MESH_ALLOWANCE {
                        StoppedBy::Target
                    } else {
                        StoppedBy::Mesh
                    };
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
        let errors: Vec<Option<f64>> = (0..ensembles.len())
            .map(|i| self.error(i, &ensembles[i]))
            .collect();
        let stopped = matches!(ended, StoppedBy::Time | StoppedBy::Interrupt);
        let [ny, nx] = self.synthesis.shape();
        let (size, spacing) = ([nx, ny], self.synthesis.spacing());
        let target = self.settings.target;
        let common = Stopping {
            target_error: target.map(|target| target.error()),
            of: target.map(|target| target.of()),
            error: None,
            mesh_error: self.mesh_error,
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
                    mesh_error: None,
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
            let reached = matches!((errors[i], target), (Some(e), Some(t)) if e <= t.error());
            let stopping = Stopping {
                error: errors[i],
                pilot: self.figures.get(i).map(|figures| figures.figures),
                stopped_by: if reached && !stopped {
                    StoppedBy::Target
                } else {
                    ended
                },
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

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use asperity_tally::{Layout, Side};

    use super::*;
    use crate::progress::Silent;
    use crate::verify::verify;

    fn config(text: &str) -> VerifyConfig {
        let fixed = "[surface]\ntau = 8\nsize = 128\nsmoothness = 2\n[compare]\nmodels = []\n";
        VerifyConfig::from_toml(&format!("{fixed}{text}")).unwrap()
    }

    /// Interrupts a run after so many rays.
    struct After(AtomicU64, u64);

    impl Progress for After {
        fn begin(&self, _stage: &str, _total: u64) {}
        fn advance(&self, steps: u64) {
            self.0.fetch_add(steps, Ordering::Relaxed);
        }
        fn end(&self) {}
        fn stop(&self) -> Option<StoppedBy> {
            let over = self.0.load(Ordering::Relaxed) >= self.1;
            over.then_some(StoppedBy::Interrupt)
        }
    }

    #[test]
    fn errors_reach_their_targets() {
        for run in [
            "target_error = 0.01",
            "target_error = 3e-3\nof = \"rings\"\nestimator = \"plain\"",
            "target_error = 2e-3\nof = \"in-plane\"",
            "target_error = 1e-3\nof = \"transmitted\"\nestimator = \"plain\"",
        ] {
            let config = config(&format!("[run]\n{run}"));
            let outcome = verify(&config, &Silent).unwrap();
            let case = &outcome.cases[0];
            let stopping = case.stopping.as_ref().unwrap();
            let target = config.run.ray_settings().unwrap().target.unwrap();
            let error = target
                .of()
                .error(&outcome.layout, &case.statistics)
                .unwrap();
            println!("{run:?}: {error} {stopping:?}");
            assert_eq!(stopping.stopped_by, StoppedBy::Target);
            assert_eq!(stopping.error, Some(error));
            assert!(error <= target.error());
            // Not by far more than was needed: least surfaces and rays are the exception.
            assert!(error > 0.2 * target.error() || case.work.realisations == 8);
        }
    }

    /// Many results with one target scatter about what a much longer run finds by no more than their
    /// errors say.
    #[test]
    fn errors_reached_are_those_that_results_have() {
        let reflected = |run: &str| {
            let outcome = verify(&config(run), &Silent).unwrap();
            let estimate = outcome.cases[0].statistics.estimate(Layout::REFLECTED);
            (estimate.mean, estimate.se.unwrap())
        };
        let fixed = "estimator = \"plain\"\n";
        let (truth, truth_se) = reflected(&format!("[run]\n{fixed}realisations = 400\nrays = 4e5"));
        let n = 24;
        let squares: f64 = (0..n)
            .map(|seed| {
                let run = format!(
                    "[run]\n{fixed}target_error = 4e-4\nof = \"reflected\"\nseed = {}",
                    seed + 100
                );
                let (mean, se) = reflected(&run);
                (mean - truth).powi(2) / (se * se + truth_se * truth_se)
            })
            .sum();
        // A mean of 24 squared t values of seven degrees or more: 1.4 at most on average, with a scatter
        // of 0.55. Ending where the error looks small may add a little.
        let mean = squares / f64::from(n);
        println!("mean squared t: {mean}");
        assert!(mean < 3.0, "{mean}");
    }

    #[test]
    fn pilot_and_result_share_no_surface_and_no_thread_count() {
        let text = "[run]\ntarget_error = 0.02\nseed = 5";
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let outcome = pool
                .build()
                .unwrap()
                .install(|| verify(&config(text), &Silent));
            outcome.unwrap().cases.remove(0)
        };
        let [one, two] = [on(1), on(2)];
        assert_eq!(one.stopping, two.stopping);
        assert_eq!(one.statistics.means(), two.statistics.means());
        // The same surfaces and rays without a target give the same fluxes.
        let stopping = one.stopping.unwrap();
        let [nx, ny] = one.size;
        let same = format!(
            "[surface]\ntau = 8\nsmoothness = 2\nsize = [{nx}, {ny}]\nspacing = {}\n[compare]\nmodels = []\n[run]\nseed = 5\nrealisations = {}\nrays = {}",
            one.spacing[0], one.work.realisations, one.work.rays
        );
        let again = verify(&VerifyConfig::from_toml(&same).unwrap(), &Silent).unwrap();
        assert_eq!(again.cases[0].work.rays, one.work.rays, "{stopping:?}");
        assert_eq!(again.cases[0].statistics.means(), one.statistics.means());
        assert!(again.cases[0].stopping.is_none());
    }

    #[test]
    fn an_interrupt_leaves_the_surfaces_so_far() {
        let text = "[run]\nrealisations = 64\nrays = 64000";
        let outcome = verify(&config(text), &After(AtomicU64::new(0), 10_000)).unwrap();
        let case = &outcome.cases[0];
        let surfaces = case.work.realisations;
        assert!((10..40).contains(&surfaces), "{surfaces}");
        assert_eq!(case.statistics.batches(), surfaces);
        assert_eq!(case.work.rays % surfaces, 0, "all surfaces are whole");
        let stopping = case.stopping.as_ref().unwrap();
        assert_eq!(stopping.stopped_by, StoppedBy::Interrupt);
        assert!(stopping.warnings[0].contains("interrupted"));

        let error = verify(&config(text), &After(AtomicU64::new(0), 0));
        assert!(matches!(error, Err(VerifyError::Interrupted)));
        let pilot = "[run]\ntarget_error = 0.01";
        let error = verify(&config(pilot), &After(AtomicU64::new(0), 1));
        assert!(matches!(error, Err(VerifyError::Interrupted)));
    }

    #[test]
    fn without_time_one_surface_is_traced() {
        for run in ["realisations = 9\nrays = 9000", "target_error = 1e-3"] {
            let text = format!("[run]\n{run}\nmax_time = 1e-9");
            let outcome = verify(&config(&text), &Silent).unwrap();
            let case = &outcome.cases[0];
            assert_eq!(case.work.realisations, 1);
            assert_eq!(case.errors_from, "ray blocks");
            let stopping = case.stopping.as_ref().unwrap();
            assert_eq!(stopping.stopped_by, StoppedBy::Time);
            assert!(stopping.warnings[0].contains("speed of the machine"));
        }
        let enough = config("[run]\nrealisations = 9\nrays = 9000\nmax_time = \"1h\"");
        let outcome = verify(&enough, &Silent).unwrap();
        let stopping = outcome.cases[0].stopping.as_ref().unwrap();
        assert_eq!(stopping.stopped_by, StoppedBy::Plan);
    }

    #[test]
    fn nothing_is_traced_where_nothing_can_change() {
        let text = "
            [surface]
            smoothness = 100
            [light]
            theta = [0, 30]
            [run]
            target_error = 1e-4
            [compare]
            models = []
        ";
        let outcome = verify(&VerifyConfig::from_toml(text).unwrap(), &Silent).unwrap();
        for case in &outcome.cases {
            assert_eq!([case.work.rays, case.work.realisations], [0, 0]);
            let stopping = case.stopping.as_ref().unwrap();
            assert_eq!(stopping.stopped_by, StoppedBy::Bound);
            assert!(stopping.error.unwrap() < 1e-8);
            let budget: f64 = case.statistics.means()[..5].iter().sum();
            assert!((budget - 1.0).abs() < 1e-12);
        }
    }

    /// What surfaces do lies within the bound about what is known without them, in all totals.
    #[test]
    fn no_traced_total_deviates_by_more_than_the_bound() {
        let mut closest = 0.0_f64;
        for material in [
            "kind = \"mirror\"",
            "eta = 1.5",
            "eta = \"1/1.5\"",
            "kind = \"conductor\"\neta = 0.2\nkappa = 3.9",
        ] {
            let fixed = format!(
                "[surface]\ntau = 8\nsize = 128\nsmoothness = [2, 4, 8]\n[light]\ntheta = [0, 45, 70]\n[material]\n{material}\n[compare]\nmodels = []\n[run]\n"
            );
            let with = |run: &str| {
                let config = VerifyConfig::from_toml(&format!("{fixed}{run}")).unwrap();
                verify(&config, &Silent).unwrap()
            };
            // So large an error that nothing is ever traced.
            let known = with("target_error = 30\nof = \"reflected\"");
            let traced = with("realisations = 12\nrays = 24000");
            for (known, traced) in known.cases.iter().zip(&traced.cases) {
                let bound = known.deviation_bound.unwrap();
                assert_eq!(known.work.rays, 0);
                let layout = &known_layout();
                let totals = Side::BOTH
                    .into_iter()
                    .flat_map(|side| [side.index(), layout.order(side, 1), layout.multiple(side)]);
                for i in totals.chain([Layout::ABSORBED]) {
                    let traced = traced.statistics.estimate(i);
                    let deviation = (traced.mean - known.statistics.means()[i]).abs();
                    let noise = 4.0 * traced.se.unwrap() + 1e-3;
                    assert!(
                        deviation <= bound + noise,
                        "{i} {deviation} {bound} {}",
                        known.case
                    );
                    closest = closest.max((deviation - noise) / bound);
                }
            }
        }
        // It is a bound that is not idle.
        println!("nearest to the bound: {closest}");
        assert!(closest > 0.3);
    }

    fn known_layout() -> Layout {
        config("").run.ray_settings().unwrap().layout
    }
}
