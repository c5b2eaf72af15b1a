//! Explanations: what is about to be traced, and why so, in one line each.

use asperity_tracer::{AcceleratorKind, BuildAccelerator, Instructions, Shape};

use super::ensemble_run::{EnsembleRun, Members};
use super::given_run::GivenRun;
use super::random::RandomGroup;
use super::ready_group::ReadyGroup;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::input::settings::Settings;
use crate::input::surface_source::SurfaceSource;
use crate::methods::method::{ControlVariateMean, Method};
use crate::output::chosen_paths::WayOfPaths;
use crate::store::Stage;
use crate::text::{counted, error_in_short, short};

/// A case that is about to be traced.
struct Explained<'a> {
    /// Number of the case among those of the run.
    number: usize,
    case: &'a Case,
    method: &'a Method,
    /// Whether a pilot run tried other paths.
    tried: bool,
    /// Rays over all surfaces.
    rays: u64,
}

impl Explained<'_> {
    fn line(&self, settings: &Settings) -> String {
        format!(
            "case {}, theta = {} deg: {} rays, {} bins per side; paths: {}; estimator: {}",
            self.number + 1,
            short(self.case.light.incidence.theta_deg()),
            self.rays,
            settings.spec_of(self.case).grid(),
            WayOfPaths::of(self.method),
            self.reason(settings)
        )
    }

    /// Why this estimator.
    fn reason(&self, settings: &Settings) -> &'static str {
        if settings.estimator != Estimator::Auto {
            return "as given";
        }
        if self.tried {
            return "the pilot run found it best";
        }
        match self.method.control_variate_mean() {
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
            None if self.case.layer.is_some() => {
                "plain, since no control variate covers a medium below the surface"
            }
            None if self.case.light.is_polarised() => {
                "plain, since no control variate covers polarised light"
            }
            None if has_structure(&self.case.surface) => {
                "plain, since the distribution of slopes of structured surfaces is not known"
            }
            None => "plain, since there is no control variate for this case that saves time",
        }
    }
}

/// Whether surfaces are random and structured.
fn has_structure(surface: &SurfaceSource) -> bool {
    match surface {
        SurfaceSource::Random(surfaces) => surfaces.recipe().structured().is_some(),
        SurfaceSource::Given(_) | SurfaceSource::Described(_) => false,
    }
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

impl RandomGroup {
    /// Surfaces, accelerator, and how each case is estimated.
    pub(super) fn explained(&self) -> Vec<String> {
        let settings = &self.settings;
        let [ny, nx] = self.surfaces.shape();
        let lengths = self.surfaces.recipe().axis_correlation_lengths();
        let spacing = self.surfaces.spacing();
        let [dx, dy] = [0, 1].map(|i| short(spacing[i] / lengths[i]));
        let plan = match settings.target() {
            None => "as given",
            Some(_) => "planned by a pilot run",
        };
        let surfaces = format!(
            "{} ({plan}) of {nx} x {ny} {} cells, spacing {dx} x {dy} correlation lengths, seed {}",
            counted(self.plan.surfaces, "random surface"),
            self.surfaces.cells(),
            settings.seed
        );
        let analytic = self.analytic.iter().map(|case| {
            format!(
                "case {}: not traced, since shadowing, masking and multiple scattering change no flux by more than {}",
                case.number + 1,
                error_in_short(case.result.bound)
            )
        });
        let of_surface = self.group(Stage::Result).blocks().rays();
        let traced = self.traced.iter().zip(&self.pilot.tried);
        let traced = traced.map(|(case, tried)| {
            let explained = Explained {
                number: case.number,
                case: &case.case,
                method: &case.method,
                tried: !tried.is_empty(),
                rays: of_surface.saturating_mul(self.plan.surfaces),
            };
            explained.line(settings)
        });
        let mut lines: Vec<String> = analytic.chain(traced).collect();
        if !self.traced.is_empty() {
            let used = settings.accelerator.on_height_field(false);
            lines.splice(0..0, [surfaces, accelerator_line(settings, used)]);
        }
        lines
    }
}

/// What is said of given surfaces.
fn given_lines<'a>(
    surfaces: &str,
    settings: &Settings,
    used: AcceleratorKind,
    cases: impl Iterator<Item = Explained<'a>>,
) -> Vec<String> {
    let head = [
        format!("{surfaces}, seed {}", settings.seed),
        accelerator_line(settings, used),
    ];
    let cases = cases.map(|case| case.line(settings));
    head.into_iter().chain(cases).collect()
}

impl GivenRun {
    /// Accelerator, and how each case is estimated.
    pub(super) fn explained(&self) -> Vec<String> {
        let cases = self.cases.iter().map(|case| Explained {
            number: case.number,
            case: &case.case,
            method: &case.methods[0],
            tried: !case.tried.is_empty(),
            rays: self.blocks(case).rays(),
        });
        let used = self.built.used().kind();
        given_lines("one given surface", &self.settings, used, cases)
    }
}

impl EnsembleRun {
    /// Accelerator, and how each case is estimated.
    pub(super) fn explained(&self) -> Vec<String> {
        let group = self.group();
        let rays = self.surfaces() * group.rays_of_surface();
        let cases = self.cases.iter().map(|traced| Explained {
            number: traced.number,
            case: &traced.case,
            method: &traced.method,
            tried: false,
            rays,
        });
        let kind = self.settings.accelerator;
        let (surfaces, used) = match &self.members {
            Members::Regions(built, _) => ("one given surface".to_owned(), built.used().kind()),
            Members::Surfaces(shapes) => {
                let used = match &shapes[0] {
                    Shape::HeightField { top, .. } => top.resolve(kind),
                    Shape::Smooth { top, .. } => top.resolve(kind),
                    Shape::TriangleMesh { top, .. } => top.resolve(kind),
                };
                (counted(self.surfaces(), "given surface"), used)
            }
        };
        given_lines(&surfaces, &self.settings, used, cases)
    }
}
