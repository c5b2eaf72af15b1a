//! Explanations: what is about to be traced, and why so, in one line each.

use asperity_synthesis::SurfaceRecipe;
use asperity_tracer::{AcceleratorKind, BuildAccelerator, Instructions, Shape};

use super::case_run::CaseRun;
use super::group::Group;
use crate::input::estimator::Estimator;
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;
use crate::methods::method::ControlVariateMean;
use crate::store::Stage;
use crate::text::{counted, error_in_short, short};

impl CaseRun {
    /// The case that is about to be traced, with `rays` rays over all surfaces.
    fn line(&self, rays: u64, settings: &Settings) -> String {
        format!(
            "case {}, theta = {} deg: {rays} rays, {} bins per side; paths: {}; estimator: {}",
            self.number + 1,
            short(self.case.light.incidence.theta_deg()),
            settings.spec_of(&self.case).grid(),
            self.strategy(),
            self.reason(settings)
        )
    }

    /// Reason for the estimator.
    fn reason(&self, settings: &Settings) -> &'static str {
        if settings.estimator != Estimator::Auto {
            return "as given";
        }
        if !self.tried.is_empty() {
            return "the pilot run found it best";
        }
        match self.method().control_variate_mean() {
            Some(ControlVariateMean::GaussianSlopes) => {
                "controlled, since the mean of unshadowed single scattering follows from Gaussian slopes"
            }
            Some(ControlVariateMean::SlopeMixture) => {
                "controlled, since the mean of unshadowed single scattering follows from the distribution of slopes"
            }
            Some(ControlVariateMean::FacetsOfSurface) => {
                "controlled, since the mean of unshadowed single scattering follows from the facets"
            }
            None if self.case.surface.shapes().len() > 1 => {
                "plain, since a control variate of given surfaces is that of one alone"
            }
            None if !self.case.layers.is_empty() => {
                "plain, since no control variate covers a medium below the surface"
            }
            None if self.case.light.spread.is_some() => {
                "plain, since no control variate covers light of several directions"
            }
            None if self.case.light.is_polarised() => {
                "plain, since no control variate covers polarised light"
            }
            None if is_measured(&self.case.surface) => {
                "plain, since the distribution of the slopes of these surfaces is not known"
            }
            None => "plain, since there is no control variate for this case that saves time",
        }
    }
}

/// `true` if surfaces are random and their slopes measured.
fn is_measured(surface: &SurfaceSource) -> bool {
    surface.recipe().is_some_and(SurfaceRecipe::is_measured)
}

/// The accelerator, by which instructions it is searched, and by how many threads.
fn accelerator_line(settings: &Settings, used: AcceleratorKind) -> String {
    let why = match settings.accelerator {
        AcceleratorKind::Auto => "auto, by the kind of surface",
        _ => "as given",
    };
    format!(
        "accelerator: {used} ({why}); instruction set: {}, the widest of this processor; {}",
        Instructions::best(),
        counted(rayon::current_num_threads() as u64, "thread")
    )
}

impl Group {
    /// Surfaces, accelerator, and how each case is estimated, a line each.
    pub(in crate::engine) fn explanations(&self) -> Vec<String> {
        let settings = &self.settings;
        let analytic = self.analytic.iter().map(|one| {
            format!(
                "case {}: not traced, since shadowing, masking and multiple scattering change no flux by more than {}",
                one.run.number + 1,
                error_in_short(one.result.bound)
            )
        });
        let rays = self.run_of(Stage::Result).rays();
        let traced = self.cases.iter().map(|run| run.line(rays, settings));
        let mut lines: Vec<String> = analytic.chain(traced).collect();
        let is_first = self.built.as_ref().is_none_or(|built| built.is_first);
        if is_first && !self.cases.is_empty() {
            let surfaces = format!("{}, seed {}", self.surfaces_in_words(), settings.seed);
            let used = match (&self.built, self.source.shapes().first()) {
                (Some(built), _) => built.surface.used().kind(),
                (None, Some(shape)) => resolved(settings.accelerator, shape),
                (None, None) => settings.accelerator.on_height_field(false),
            };
            lines.splice(0..0, [surfaces, accelerator_line(settings, used)]);
        }
        lines
    }

    fn surfaces_in_words(&self) -> String {
        let Some(surfaces) = self.random() else {
            return match self.source.shapes().len() {
                1 => "one given surface".to_owned(),
                several => counted(several as u64, "given surface"),
            };
        };
        let [ny, nx] = surfaces.shape();
        let lengths = surfaces.recipe().axis_correlation_lengths();
        let spacing = surfaces.spacing();
        let [dx, dy] = [0, 1].map(|i| short(spacing[i] / lengths[i]));
        let plan = match self.settings.target() {
            None => "as given",
            Some(_) => "planned by a pilot run",
        };
        format!(
            "{} ({plan}) of {nx} x {ny} {} cells, spacing {dx} x {dy} correlation lengths",
            counted(self.plan.surfaces, "random surface"),
            surfaces.cells(),
        )
    }
}

/// The accelerator that a kind stands for on a surface.
fn resolved(kind: AcceleratorKind, shape: &Shape) -> AcceleratorKind {
    match shape {
        Shape::HeightField { top, .. } => top.resolve(kind),
        Shape::Smooth { top, .. } => top.resolve(kind),
        Shape::TriangleMesh { top, .. } => top.resolve(kind),
    }
}
