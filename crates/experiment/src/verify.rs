//! Explicit surfaces against statistical models.

use std::time::{Duration, Instant};

use asperity_analysis::{
    BsdfModel, Comparison, ComparisonError, Grouping, HemisphericalEnergy, ModelError, Scope,
    SlopeCovariance, SlopeError, Verdict, compare, create_model, flux_into, hemispherical_energy,
    sidak_level, verdicts,
};
use asperity_surface::{CoarseningError, HeightField, Psd, Synthesis, SynthesisError};
use asperity_tally::{BatchStatistics, Layout, Share, Side};
use rayon::prelude::*;

use crate::blocks::RaySettings;
use crate::budget::ErrorBudget;
use crate::case::Case;
use crate::config::{ConfigError, VerifyConfig};
use crate::ensemble::Ensemble;
use crate::limits::{RunError, check_results};
use crate::mesh_error::{MeshErrors, Refinement};
use crate::method::{Method, with_least_errors};
use crate::progress::{Deadline, Progress};
use crate::sharing::{Sharing, Traced};
use crate::stopping::Stopping;
use crate::summary::SummaryWork;
use crate::values::{Count, Number, PerAxis};

/// Rays that a bin must hold, found or expected, to enter a test. Where rings are spread evenly over
/// azimuth, a bin stands for its ring, and the rays of the ring count.
const ENOUGH_RAYS: f64 = 20.0;

/// Why a verification fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerifyError {
    /// The configuration makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The surfaces cannot be drawn.
    #[error(transparent)]
    Synthesis(#[from] SynthesisError),
    /// The rays cannot be traced.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The slopes of the surfaces have no density.
    #[error(transparent)]
    Slopes(#[from] SlopeError),
    /// A model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Every second sample makes no surface.
    #[error(transparent)]
    Coarsening(#[from] CoarseningError),
    /// There are no results yet.
    #[error("interrupted before the first surface was finished; nothing is written")]
    Interrupted,
    /// Results and model do not fit each other.
    #[error(transparent)]
    Comparison(#[from] ComparisonError),
}

/// One model beside the explicit surfaces of a case.
pub struct ModelOutcome {
    /// The model.
    pub model: Box<dyn BsdfModel>,
    /// Its energies.
    pub energy: HemisphericalEnergy,
    /// Against light scattered once, over the bins of the sides asked for.
    pub single: Comparison,
    /// Against all light.
    pub total: Comparison,
    /// What follows from the comparison with the light that the model describes.
    pub verdict: Verdict,
    /// Its flux into each in-plane bin, by side; empty on a side that is not asked for.
    pub in_plane: [Vec<f64>; 2],
}

impl ModelOutcome {
    /// The comparison with the light that the model describes.
    #[must_use]
    pub fn judged(&self) -> &Comparison {
        match self.model.scope() {
            Scope::AllOrders => &self.total,
            _ => &self.single,
        }
    }
}

/// What was found for one case.
pub struct CaseOutcome {
    /// The case.
    pub case: Case,
    /// Flux fractions by the layout of the run; a batch is a surface.
    pub statistics: BatchStatistics,
    /// What the batches are: `surfaces`, or `ray blocks` where there was one surface.
    pub errors_from: &'static str,
    /// The errors of the fluxes by where they come from.
    pub errors: ErrorBudget,
    /// Whether what leaves is spread evenly over azimuth: every bin holds its share of its ring.
    pub free_azimuth: bool,
    /// The models.
    pub models: Vec<ModelOutcome>,
    /// Level of each test: that of the configuration, shared among the models.
    pub level: f64,
    /// What the fluxes are sure not to differ by, if nothing was traced.
    pub deviation_bound: Option<f64>,
    /// Samples of its surfaces along x and y.
    pub size: [usize; 2],
    /// Length units a sample along x and y.
    pub spacing: [f64; 2],
    /// How the run came to its end, if that was to be found out.
    pub stopping: Option<Stopping>,
    /// What was done.
    pub work: SummaryWork,
}

/// What a verification found.
pub struct VerifyOutcome {
    /// The configuration that was run.
    pub config: VerifyConfig,
    /// Where each quantity stands in the statistics.
    pub layout: Layout,
    /// The cases, in the order of [`VerifyConfig::cases`].
    pub cases: Vec<CaseOutcome>,
    /// Those that an interrupt came before.
    pub left_out: Vec<Case>,
    /// Seconds from beginning to end.
    pub seconds: f64,
}

impl VerifyOutcome {
    /// Whether there were several cases to run.
    pub(crate) fn several(&self) -> bool {
        self.cases.len() + self.left_out.len() > 1
    }
}

impl VerifyConfig {
    /// The same for surfaces of `size` samples, `spacing` apart, along x and y.
    pub(crate) fn on_grid(&self, size: [usize; 2], spacing: [f64; 2]) -> Self {
        let mut config = self.clone();
        config.surface.size = PerAxis::Each(size.map(|n| Count(n as u64)));
        config.surface.spacing = PerAxis::Each(spacing.map(Number));
        config
    }

    /// Checks that the grid can resolve and hold the surfaces.
    ///
    /// # Errors
    /// [`VerifyError`] as from [`verify`].
    pub fn check_surfaces(&self) -> Result<(), VerifyError> {
        self.recipes().map(|_| ())
    }

    /// The first surface of a case, drawn again.
    pub(crate) fn first_surface(&self, case: &Case) -> Result<HeightField, VerifyError> {
        Ok(self.recipe(case)?.draw(self.run.seed, 0)?)
    }

    fn recipe(&self, case: &Case) -> Result<Synthesis, VerifyError> {
        let spacing = self.surface.spacing.xy().map(|s| s.0);
        Ok(Synthesis::new(
            case.psd,
            self.shape()?,
            spacing,
            self.surface.insist,
        )?)
    }

    /// One recipe a smoothness, with the cases that share it.
    fn recipes(&self) -> Result<Vec<(Synthesis, Vec<Case>)>, VerifyError> {
        let mut recipes: Vec<(Synthesis, Vec<Case>)> = Vec::new();
        for case in self.cases()? {
            match recipes.last_mut() {
                Some((synthesis, cases)) if *synthesis.psd() == case.psd => cases.push(case),
                _ => recipes.push((self.recipe(&case)?, vec![case])),
            }
        }
        Ok(recipes)
    }
}

/// Draws fresh surfaces, traces every case on them, and compares with the models.
///
/// Cases of equal smoothness share their surfaces.
///
/// # Errors
/// [`VerifyError`] if the configuration makes no sense or does not fit into memory.
pub fn verify(
    config: &VerifyConfig,
    progress: &dyn Progress,
) -> Result<VerifyOutcome, VerifyError> {
    let began = Instant::now();
    let time = config.run.max_time.map(|time| time.0);
    let time = time.and_then(|time| Duration::try_from_secs_f64(time).ok());
    let progress: &dyn Progress = &Deadline::new(progress, time);
    let settings = config.run.ray_settings()?;
    // All recipes are checked before the first is run.
    let recipes = config.recipes()?;
    let all_cases = recipes.iter().map(|(_, cases)| cases.len()).sum();
    let mut sharings = recipes
        .into_iter()
        .map(|(synthesis, cases)| Sharing::new(config, settings, synthesis, cases))
        .collect::<Result<Vec<_>, _>>()?;
    if settings.target.is_some() {
        let pilots = sharings.iter().map(Sharing::pilot_rays).sum();
        progress.begin("planning", pilots);
        for sharing in &mut sharings {
            sharing.plan(all_cases, progress)?;
        }
        progress.end();
    }
    let realisations = sharings.iter().map(|s| s.realisations).max();
    check_results(
        &settings.layout,
        realisations.unwrap_or(0),
        all_cases,
        settings.refine,
    )?;
    progress.begin("tracing", sharings.iter().map(Sharing::rays).sum());
    let mut traced = Vec::new();
    let mut left_out = Vec::new();
    for sharing in sharings {
        let (done, missing) = sharing.run(all_cases, progress)?;
        traced.extend(done);
        left_out.extend(missing);
    }
    progress.end();
    if traced.is_empty() {
        return Err(VerifyError::Interrupted);
    }

    progress.begin("comparing", traced.len() as u64);
    let cases = traced
        .into_par_iter()
        .map(|traced| {
            let outcome = judge(config, &settings, traced);
            progress.advance(1);
            outcome
        })
        .collect::<Result<_, _>>()?;
    progress.end();
    Ok(VerifyOutcome {
        config: config.clone(),
        layout: settings.layout,
        cases,
        left_out,
        seconds: began.elapsed().as_secs_f64(),
    })
}

/// Slopes of the continuous surface.
pub(crate) fn slopes(psd: &Psd) -> Result<SlopeCovariance, SlopeError> {
    let [xx, xy, yy] = psd.slope_covariance();
    if psd.is_isotropic() {
        // Whatever the axes, which rounding would tell apart.
        return SlopeCovariance::new(xx, xx, 0.0);
    }
    SlopeCovariance::new(xx, yy, xy)
}

/// Statistics of one case and its comparison with every model.
fn judge(
    config: &VerifyConfig,
    settings: &RaySettings,
    traced: Traced,
) -> Result<CaseOutcome, VerifyError> {
    let layout = &settings.layout;
    let Traced {
        case,
        method,
        ensemble,
        ..
    } = &traced;
    // With one surface the scatter between its blocks is all there is.
    let errors_from = match &ensemble.blocks_of_one {
        _ if traced.deviation_bound.is_some() => "deviation bound",
        Some(_) => "ray blocks",
        None => "surfaces",
    };
    let batches = ensemble.statistics();
    let batches = match traced.deviation_bound {
        Some(_) => batches,
        None => with_least_errors(method, layout, batches, ensemble.work.rays),
    };
    let errors = errors(config, settings, &traced, &batches)?;
    let mut models = config
        .compare
        .models
        .par_iter()
        .map(|name| {
            let model = create_model(name, case.smoothness, case.material)?;
            model_outcome(config, layout, (case, method), model, ensemble, &batches)
        })
        .collect::<Result<Vec<_>, _>>()?;
    let level = sidak_level(config.compare.alpha, models.len().max(1));
    let singles: Vec<Comparison> = models.iter().map(|m| m.judged().clone()).collect();
    for (model, verdict) in models
        .iter_mut()
        .zip(verdicts(&singles, config.compare.alpha))
    {
        model.verdict = verdict;
    }
    let realisations = match traced.deviation_bound {
        Some(_) => 0,
        None => ensemble.records.len() as u64,
    };
    Ok(CaseOutcome {
        case: *case,
        statistics: batches,
        errors_from,
        errors,
        free_azimuth: config.free_azimuth(case),
        models,
        level,
        deviation_bound: traced.deviation_bound,
        size: traced.size,
        spacing: traced.spacing,
        work: SummaryWork {
            realisations,
            generate_seconds: ensemble.seconds.generate,
            build_seconds: ensemble.seconds.build,
            trace_seconds: ensemble.seconds.trace,
            seconds: traced.seconds,
            ..SummaryWork::new(
                ensemble.work,
                ensemble.used.clone(),
                method,
                settings.sampling,
            )
        },
        stopping: traced.stopping,
    })
}

/// The errors of one case by where they come from.
fn errors(
    config: &VerifyConfig,
    settings: &RaySettings,
    traced: &Traced,
    statistics: &BatchStatistics,
) -> Result<ErrorBudget, VerifyError> {
    let layout = &settings.layout;
    let Traced {
        case,
        method,
        ensemble,
        ..
    } = traced;
    let method_and_rays = (method, layout, ensemble.work.rays);
    if traced.deviation_bound.is_some() {
        let bounds = (0..layout.len())
            .map(|i| statistics.estimate(i).se.unwrap_or(0.0))
            .collect();
        return Ok(ErrorBudget::of_bounds(bounds));
    }
    let [nx, ny] = traced.size;
    let synthesis = Synthesis::new(case.psd, [ny, nx], traced.spacing, config.surface.insist)?;
    let mesh = MeshErrors::of_case(
        &synthesis,
        (case, method),
        layout,
        config.any_azimuth(),
        Refinement::of_surfaces(synthesis.spacing(), layout.len(), &ensemble.shifts),
    );
    Ok(match ensemble.blocks_of_one {
        Some(_) => ErrorBudget::of_one(statistics, method_and_rays, mesh),
        None => ErrorBudget::of_surfaces(statistics, &ensemble.ray_squares, method_and_rays, mesh),
    })
}

fn model_outcome(
    config: &VerifyConfig,
    layout: &Layout,
    (case, method): (&Case, &Method),
    model: Box<dyn BsdfModel>,
    ensemble: &Ensemble,
    statistics: &BatchStatistics,
) -> Result<ModelOutcome, VerifyError> {
    let wi = case.incidence.wi();
    let asked = layout.asked_bins();
    let expected = model.expected_fluxes(wi, &layout.grid(), config.run.side);
    let expected = &expected.flux[asked.clone()];
    let rays = ensemble.work.rays as f64;
    let bins_of_a_value = if config.free_azimuth(case) {
        layout.grid().n_phi() as f64
    } else {
        1.0
    };
    let means = statistics.means();
    let against = |share: Share| {
        let surfaces: Vec<Vec<f64>> = ensemble
            .records
            .iter()
            .map(|record| record[layout.bins(share)][asked.clone()].to_vec())
            .collect();
        let single = &means[layout.hits(Share::Single)][asked.clone()];
        let multiple = &means[layout.hits(Share::Multiple)][asked.clone()];
        let enough: Vec<bool> = (0..expected.len())
            .map(|i| {
                let found = match share {
                    Share::Single => single[i],
                    Share::Multiple => multiple[i],
                    Share::Total => single[i] + multiple[i],
                };
                // Under a control a ray counts only if it deviates from what is expected.
                let counted = match method.control {
                    Some(_) => found,
                    None => found.max(expected[i]),
                };
                counted * rays * bins_of_a_value >= ENOUGH_RAYS
            })
            .collect();
        compare(
            &surfaces,
            expected,
            &enough,
            &rings_and_sides(layout),
            config.run.seed,
        )
    };
    let (single, total) = rayon::join(|| against(Share::Single), || against(Share::Total));
    Ok(ModelOutcome {
        energy: hemispherical_energy(model.as_ref(), wi),
        single: single?,
        total: total?,
        verdict: Verdict::Holds,
        in_plane: Side::BOTH.map(|side| {
            if layout.asks(side) {
                in_plane_fluxes(model.as_ref(), layout, case, side)
            } else {
                Vec::new()
            }
        }),
        model,
    })
}

/// Sums of bins in which a deviation is tested beside the bins: rings of equal polar angle, and whole
/// sides, which are the energies. Bins count from the first that is asked for.
fn rings_and_sides(layout: &Layout) -> [Grouping; 2] {
    let grid = layout.grid();
    let groups = |of_each: usize| -> Vec<Vec<usize>> {
        (0..layout.asked_bins().len())
            .step_by(of_each)
            .map(|i| (i..i + of_each).collect())
            .collect()
    };
    [
        Grouping {
            name: "rings",
            groups: groups(grid.n_phi()),
        },
        Grouping {
            name: "sides",
            groups: groups(grid.bins_per_side()),
        },
    ]
}

/// What a model expects in each in-plane bin.
fn in_plane_fluxes(model: &dyn BsdfModel, layout: &Layout, case: &Case, side: Side) -> Vec<f64> {
    (0..layout.in_plane_len())
        .into_par_iter()
        .map(|i| {
            let [from, to] = layout.in_plane_edges_deg(i).map(f64::to_radians);
            in_plane_flux(model, layout, case, side, [from, to])
        })
        .collect()
}

/// What a model expects between two signed angles from the normal of `side`, radians, within the
/// in-plane wedge; the angles may lie on either side of the normal.
pub(crate) fn in_plane_flux(
    model: &dyn BsdfModel,
    layout: &Layout,
    case: &Case,
    side: Side,
    [from, to]: [f64; 2],
) -> f64 {
    use std::f64::consts::PI;
    let backward_azimuth = case.incidence.phi();
    let half_width = layout.in_plane_half_width();
    let wedge = |azimuth: f64, [near, far]: [f64; 2]| {
        if far <= near {
            return 0.0;
        }
        let theta = match side {
            Side::Reflected => [near, far],
            Side::Transmitted => [PI - far, PI - near],
        };
        let phi = [azimuth - half_width, azimuth + half_width];
        flux_into(model, case.incidence.wi(), side, theta, phi)
    };
    wedge(backward_azimuth + PI, [from.max(0.0), to.max(0.0)])
        + wedge(backward_azimuth, [(-to).max(0.0), (-from).max(0.0)])
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;
    use std::f64::consts::PI;

    #[test]
    fn in_plane_fluxes_are_those_of_the_model_on_both_sides_of_the_normal() {
        let text =
            "[surface]\nsmoothness = 1\n[light]\ntheta = 25\nphi = 70\n[material]\neta = 1.4";
        let config = VerifyConfig::from_toml(text).unwrap();
        let case = config.cases().unwrap()[0];
        let layout = config.run.ray_settings().unwrap().layout;
        let model = create_model("smith", case.smoothness, case.material).unwrap();
        let mut compared = 0;
        for side in Side::BOTH {
            let fluxes = in_plane_fluxes(model.as_ref(), &layout, &case, side);
            for (i, flux) in fluxes.into_iter().enumerate() {
                let [from, to] = layout.in_plane_edges_deg(i).map(f64::to_radians);
                let angle = 0.5 * (from + to);
                let theta = match side {
                    Side::Reflected => angle.abs(),
                    Side::Transmitted => PI - angle.abs(),
                };
                let backward = case.incidence.phi();
                let phi = if angle > 0.0 { backward + PI } else { backward };
                let wo = from_spherical(theta, phi);
                let intensity = model.bsdf(case.incidence.wi(), wo) * wo.z.abs();
                let found = flux / layout.in_plane_solid_angle(i);
                // Where the lobe is not steep, its density bends little within a bin.
                if side == Side::Reflected && angle.abs() < 1.2 {
                    let ratio = found / intensity;
                    assert!(
                        (ratio - 1.0).abs() < 0.05,
                        "{side} {i}: {found} {intensity}"
                    );
                    compared += 1;
                } else if intensity > 0.1 && angle.abs() < 0.6 {
                    assert!(
                        (found / intensity - 1.0).abs() < 0.2,
                        "{side} {i}: {found} {intensity}"
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 30, "{compared}");
    }
}
