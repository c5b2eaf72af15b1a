//! Converged case: errors and seconds of each method, by the runs of one case.

use asperity_numerics::elementary::{exp, ln};
use asperity_optics::Material;
use asperity_results::CaseResult;
use asperity_simulate::{Case, MachineWork, Outcome, SummaryWork};
use asperity_tally::{Component, Side, TallyResult};
use asperity_tracer::Branching;
use serde::Serialize;

use super::config::ConvergePlan;
use super::deviation::{RepeatedError, Target};
use super::exact::exact_fluxes;
use super::fit::Fit;
use super::method::{ConvergeRun, Method};
use crate::error::StudyError;

/// An error below this multiple of the reference's own error says more about the reference than about the run.
const AT_THE_REFERENCE: f64 = 2.0;

/// Key of the seconds that a method was prepared in, among what the findings of a run say of the machine.
pub(super) const SETUP_SECONDS: &str = "setup_seconds";

/// Outcome of one case.
pub struct ConvergedCase<'a> {
    /// The case.
    pub case: &'a Case,
    /// Reference of the errors.
    pub reference: Reference,
    /// `true` if exact fluxes are known.
    pub is_exact: bool,
    /// The methods.
    pub methods: Vec<MethodOutcome>,
    /// Work of the engine, including the reference.
    pub work: ConvergeWork,
}

/// Reference of the errors.
#[derive(Clone, Debug, Serialize)]
pub struct Reference {
    /// Method of computation.
    #[serde(flatten)]
    pub method: Method,
    /// Samples `[nx, ny]` of a surface.
    pub size: [usize; 2],
    /// Rays on each surface.
    pub rays_per_surface: u64,
    /// Surfaces.
    pub surfaces: u64,
    /// Addition to every error expected of its own standard errors.
    pub error: f64,
    /// Its error against the exact fluxes, where there are such.
    pub error_exact: Option<f64>,
    /// Seconds that it took.
    pub seconds: f64,
}

/// Outcome of one method.
#[derive(Clone, Debug, Serialize)]
pub struct MethodOutcome {
    /// Its name among the methods of the plan.
    pub name: String,
    /// The method.
    #[serde(flatten)]
    pub method: Method,
    /// Seconds spent once, before its runs and not counted in theirs: on the mean of its control variate.
    pub setup_seconds: f64,
    /// Its runs, in the order of the efforts.
    pub measurements: Vec<Measurement>,
    /// The line through those that are usable.
    #[serde(flatten)]
    pub fit: Fit,
    /// Seconds to each of the errors of the plan.
    pub seconds_to: Vec<SecondsTo>,
    /// Time of plain random rays to the same error over that of this method, at equal effort.
    pub efficiency: Option<Efficiency>,
}

/// Runs of one method and effort.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// Rays on each surface.
    pub rays_per_surface: u64,
    /// Surfaces of a run.
    pub surfaces: u64,
    /// Runs.
    pub repeats: u64,
    /// Median seconds of a run.
    pub seconds: f64,
    /// Seconds of the fastest run.
    pub seconds_min: f64,
    /// Seconds of the slowest run.
    pub seconds_max: f64,
    /// Relative error against the reference.
    pub error: RepeatedError,
    /// Errors against the exact fluxes, where there are such.
    pub error_exact: Option<RepeatedError>,
    /// Difference from one of the light of a surface that absorbs nothing; `None` for others, and where
    /// a side is not requested.
    pub energy_error: Option<f64>,
    /// `true` if the error is well above that of the reference.
    pub usable: bool,
}

/// Seconds to an error, by the fitted line.
#[derive(Clone, Debug, Serialize)]
pub struct SecondsTo {
    /// The error.
    pub error: f64,
    /// Seconds; `None` where the line leads to none.
    pub seconds: Option<f64>,
    /// `true` if the error lies beyond those measured.
    pub extrapolated: Option<bool>,
    /// Time of plain random rays over that of this method.
    pub plain_random_over_this: Option<f64>,
}

/// Speed-up: time of plain random rays to the same error, over that of a method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Efficiency {
    /// So many times.
    pub ratio: f64,
    /// Standard error by those of the errors; `None` for single runs, and for plain random
    /// rays in addition to the rays themselves.
    pub se: Option<f64>,
}

/// Work, and its time.
#[derive(Clone, Debug, Serialize)]
pub struct ConvergeWork {
    /// Runs.
    pub runs: usize,
    /// Surfaces drawn.
    pub surfaces: u64,
    /// Incident rays.
    pub rays: u64,
    /// Segments searched for a hit.
    pub segments: u64,
    /// Segments that needed no search.
    pub segments_skipped: u64,
    /// Seconds spent on drawing surfaces, summed over surfaces.
    pub generate_seconds: f64,
    /// Seconds spent on building accelerators, summed over surfaces.
    pub build_seconds: f64,
    /// Seconds spent on tracing, summed over surfaces.
    pub trace_seconds: f64,
    /// Seconds of all runs.
    pub seconds: f64,
    /// Threads; the most of a run.
    pub threads: usize,
    /// The largest part of the flux that a run lost to numerical failure.
    pub lost: f64,
}

/// A run, and what is stored of it.
#[derive(Clone, Copy)]
pub(super) struct StoredRun<'a> {
    pub(super) run: &'a ConvergeRun,
    pub(super) result: &'a CaseResult,
}

impl StoredRun<'_> {
    fn outcome(&self) -> &Outcome {
        &self.result.outcome
    }

    /// Mean fluxes of the bins that are compared.
    fn fluxes(&self) -> &[f64] {
        let means = self.outcome().statistics.means();
        &means[means.spec().recorded_entries(Component::All)]
    }

    fn rays_per_surface(&self) -> u64 {
        self.outcome().work.rays / self.run.effort.surfaces()
    }

    /// Seconds that it took, or would take by the rays of a peer.
    fn seconds(&self, peer_rate: Option<f64>) -> f64 {
        let work = &self.outcome().work;
        peer_rate.map_or(work.machine.seconds, |rate| work.rays as f64 / rate)
    }
}

/// Reference of the runs.
struct Targets {
    reference: Target,
    /// The expected relative error of the reference itself.
    error: f64,
    /// The exact fluxes, where they are known.
    exact: Option<Target>,
    /// `true` if all light must be found on the sides that are recorded.
    returns_all_light: bool,
}

impl<'a> ConvergedCase<'a> {
    /// Outcome of `case` by all of its `runs`: the reference, then those of all methods.
    pub(super) fn of(
        plan: &ConvergePlan,
        case: &'a Case,
        runs: &[StoredRun<'_>],
    ) -> Result<Self, StudyError> {
        let first = &runs[0];
        let statistics = &first.outcome().statistics;
        let target = Target::new(first.fluxes()).ok_or(StudyError::NoLight)?;
        let squares = statistics.error_squares();
        let squares = &squares[plan.spec.recorded_entries(Component::All)];
        let errors: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
        let targets = Targets {
            error: target.own_error(&errors),
            reference: target,
            exact: exact_fluxes(case, &plan.spec)?.and_then(|fluxes| Target::new(&fluxes)),
            returns_all_light: match case.material {
                Material::Mirror => plan.spec.records(Side::Reflected),
                Material::Dielectric { .. } | Material::Coated { kappa: 0.0, .. } => {
                    !case.material.absorbs()
                        && Side::BOTH.iter().all(|&side| plan.spec.records(side))
                }
                _ => false,
            },
        };
        let reference = Reference {
            method: first.run.method,
            size: first.run.case.surface.size().unwrap_or_default(),
            rays_per_surface: first.rays_per_surface(),
            surfaces: first.run.effort.surfaces(),
            error: targets.error,
            error_exact: (targets.exact.as_ref()).map(|exact| exact.relative_rms(first.fluxes())),
            seconds: first.seconds(None),
        };
        let methods = plan.methods.iter().map(|method| {
            let own = runs[1..].iter().copied();
            let own = own.filter(|one| one.run.method == method.timed());
            let own: Vec<StoredRun<'_>> = own.collect();
            let setup = own.first().filter(|_| method.peer_rate.is_none());
            let setup =
                setup.and_then(|one| one.result.findings["machine"][SETUP_SECONDS].as_f64());
            let measurements = plan.efforts.iter().map(|effort| {
                let runs = own.iter().copied().filter(|one| one.run.effort == *effort);
                Measurement::of(&runs.collect::<Vec<_>>(), method.peer_rate, &targets)
            });
            MethodOutcome::of(plan, *method, setup.unwrap_or(0.0), measurements.collect())
        });
        let mut methods: Vec<MethodOutcome> = methods.collect();
        compare(&mut methods);
        Ok(Self {
            case,
            reference,
            is_exact: targets.exact.is_some(),
            methods,
            work: ConvergeWork::of(runs),
        })
    }
}

impl MethodOutcome {
    /// Outcome of the measurements of a method, as far as it needs no other method.
    fn of(
        plan: &ConvergePlan,
        method: Method,
        setup_seconds: f64,
        measurements: Vec<Measurement>,
    ) -> Self {
        let usable = measurements.iter().filter(|m| m.usable);
        let points: Vec<(f64, f64)> = usable.map(|m| (m.seconds, m.error.rms)).collect();
        let fit = Fit::over(&points);
        let seconds_to = plan.errors.iter().map(|&error| {
            let seconds = fit.seconds_to(error);
            SecondsTo {
                error,
                seconds,
                extrapolated: seconds.map(|_| fit.is_beyond(error)),
                plain_random_over_this: None,
            }
        });
        Self {
            name: method.name(&plan.methods),
            method,
            setup_seconds,
            measurements,
            fit,
            seconds_to: seconds_to.collect(),
            efficiency: None,
        }
    }

    /// `err_plain^2 t_plain / (err^2 t)`, the geometric mean over the efforts at which both are usable.
    fn efficiency(&self, plain: &Self) -> Option<Efficiency> {
        let is_itself = plain.method == self.method.timed();
        let cost = |m: &Measurement| m.error.rms.powi(2) * m.seconds;
        // The variance of twice the logarithm of an error.
        let variance = |m: &Measurement| m.error.se.map(|se| (2.0 * se / m.error.rms).powi(2));
        let (mut efforts, mut logs, mut variances) = (0.0, 0.0, Some(0.0));
        for (plain, own) in plain.measurements.iter().zip(&self.measurements) {
            if plain.usable && own.usable {
                efforts += 1.0;
                logs += ln(cost(plain) / cost(own));
                variances = (|| Some(variances? + variance(plain)? + variance(own)?))();
            }
        }
        let ratio = exp(logs / efforts);
        let variances = variances.filter(|_| !is_itself);
        (efforts > 0.0).then(|| Efficiency {
            ratio,
            se: variances.map(|sum| ratio * f64::sqrt(sum) / efforts),
        })
    }
}

/// Plain random rays on the grid of `method` and with its accelerator, if they were measured: those that split, else
/// those that pick.
fn baseline<'m>(methods: &'m [MethodOutcome], method: &Method) -> Option<&'m MethodOutcome> {
    let plain = methods.iter().filter(|one| {
        let is_timed = one.method.peer_rate.is_none();
        is_timed && one.method.is_plain_and_random() && one.method.shares_grid(method)
    });
    plain.min_by_key(|one| one.method.branching == Branching::Pick)
}

/// Compares each method with plain random rays, where these were measured.
fn compare(methods: &mut [MethodOutcome]) {
    let measured = methods.to_vec();
    for method in methods {
        let Some(plain) = baseline(&measured, &method.method) else {
            continue;
        };
        for (own, plain) in method.seconds_to.iter_mut().zip(&plain.seconds_to) {
            let both = plain.seconds.zip(own.seconds);
            own.plain_random_over_this = both.map(|(plain, own)| plain / own);
        }
        method.efficiency = method.efficiency(plain);
    }
}

impl Measurement {
    /// Measurement by runs of equal method and effort, of which there is one at least.
    fn of(runs: &[StoredRun<'_>], peer_rate: Option<f64>, targets: &Targets) -> Self {
        let mut seconds: Vec<f64> = runs.iter().map(|run| run.seconds(peer_rate)).collect();
        seconds.sort_by(f64::total_cmp);
        let middle = seconds.len() / 2;
        let over = |error: &dyn Fn(&StoredRun<'_>) -> f64| {
            RepeatedError::over(&runs.iter().map(error).collect::<Vec<f64>>())
        };
        let against = |target: &Target| over(&|run| target.relative_rms(run.fluxes()));
        let energy_error = |run: &StoredRun<'_>| {
            let budget = run.outcome().statistics.means().budget();
            budget.reflected + budget.transmitted - 1.0
        };
        let error = against(&targets.reference);
        Self {
            rays_per_surface: runs[0].rays_per_surface(),
            surfaces: runs[0].run.effort.surfaces(),
            repeats: runs.len() as u64,
            seconds: 0.5 * (seconds[middle] + seconds[(seconds.len() - 1) / 2]),
            seconds_min: seconds[0],
            seconds_max: seconds[seconds.len() - 1],
            error,
            error_exact: targets.exact.as_ref().map(against),
            energy_error: (targets.returns_all_light).then(|| over(&energy_error).rms),
            usable: error.rms > 0.0 && error.rms >= AT_THE_REFERENCE * targets.error,
        }
    }
}

impl ConvergeWork {
    fn of(runs: &[StoredRun<'_>]) -> Self {
        let outcomes = || runs.iter().map(StoredRun::outcome);
        let count = |of: fn(&SummaryWork) -> u64| outcomes().map(|one| of(&one.work)).sum();
        let seconds =
            |of: fn(&MachineWork) -> f64| outcomes().map(|one| of(&one.work.machine)).sum();
        let lost = outcomes().map(|one| one.statistics.means().budget().lost.abs());
        let threads = outcomes().map(|one| one.work.machine.threads);
        Self {
            runs: runs.len(),
            surfaces: count(|work| work.realisations),
            rays: count(|work| work.rays),
            segments: count(|work| work.segments),
            segments_skipped: count(|work| work.segments_skipped),
            generate_seconds: seconds(|machine| machine.generate_seconds),
            build_seconds: seconds(|machine| machine.build_seconds),
            trace_seconds: seconds(|machine| machine.trace_seconds),
            seconds: seconds(|machine| machine.seconds),
            threads: threads.max().unwrap_or(0),
            lost: lost.fold(0.0, f64::max),
        }
    }
}

#[cfg(test)]
mod tests {
    use asperity_simulate::Estimator;
    use asperity_tracer::{AcceleratorKind, Sampling};

    use super::super::ConvergeConfig;
    use super::*;
    use crate::config::values::{Number, PerAxis};

    fn method(estimator: Estimator, sampling: Sampling) -> Method {
        Method {
            estimator,
            sampling,
            branching: Branching::Split,
            peer_rate: None,
            accelerator: AcceleratorKind::Auto,
            spacing: PerAxis::Both(Number(1.0)),
        }
    }

    /// A method with single runs of these seconds and errors, of which those of 2e-3 and more are usable.
    fn outcome(method: Method, points: &[(f64, f64)]) -> MethodOutcome {
        let plan = ConvergePlan {
            errors: vec![1e-2],
            ..ConvergeConfig::default().plan().unwrap()
        };
        let measurement = |&(seconds, error): &(f64, f64)| Measurement {
            rays_per_surface: 64,
            surfaces: 2,
            repeats: 1,
            seconds,
            seconds_min: seconds,
            seconds_max: seconds,
            error: RepeatedError::over(&[error]),
            error_exact: None,
            energy_error: None,
            usable: error >= 2e-3,
        };
        let measurements = points.iter().map(measurement);
        MethodOutcome::of(&plan, method, 0.0, measurements.collect())
    }

    #[test]
    fn a_point_at_the_reference_bends_no_line() {
        let plain = method(Estimator::Plain, Sampling::Random);
        let points = [(1.0, 2e-2), (4.0, 1e-2), (16.0, 5e-3), (256.0, 1.5e-3)];
        let fit = outcome(plain, &points).fit;
        assert_eq!(fit.points, 3);
        assert!((fit.slope.unwrap() + 0.5).abs() < 1e-12);
        assert_eq!(fit.errors, [5e-3, 2e-2]);
        assert!((fit.seconds_to(1e-3).unwrap() / 400.0 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn gains_are_over_plain_random_rays_on_the_same_grid() {
        let plain = method(Estimator::Plain, Sampling::Random);
        let controlled = method(Estimator::Controlled, Sampling::Stratified);
        let elsewhere = Method {
            accelerator: AcceleratorKind::Mesh,
            ..controlled
        };
        let fifth = [(1.0, 8e-3), (4.0, 4e-3)];
        let mut methods = vec![
            outcome(plain, &[(1.0, 4e-2), (4.0, 2e-2)]),
            outcome(controlled, &fifth),
            outcome(elsewhere, &fifth),
        ];
        compare(&mut methods);
        // A fifth of the error is 25 times the efficiency, and the same in seconds at slope -1/2.
        let gain = |m: usize| methods[m].efficiency.map(|efficiency| efficiency.ratio);
        assert!((gain(1).unwrap() - 25.0).abs() < 1e-10 && (gain(0).unwrap() - 1.0).abs() < 1e-12);
        let to = &methods[1].seconds_to[0];
        assert!((to.plain_random_over_this.unwrap() - 25.0).abs() < 1e-10);
        assert_eq!(to.extrapolated, Some(true));
        // Plain random rays were not measured with that accelerator.
        assert_eq!(gain(2), None);
        assert_eq!(methods[2].seconds_to[0].plain_random_over_this, None);
    }
}
