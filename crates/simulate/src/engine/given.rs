//! Cases on one given surface: what is refused, and the surface built.

use std::sync::Arc;
use std::time::Instant;

use asperity_surface::{Border, HeightField, RefinementError};
use asperity_tracer::{BuildAccelerator, Geometry, MeshSurface, SmoothSurface};

use super::built_surface::{BuiltSurface, Meshes, SurfaceMeshes};
use super::given_run::{GivenCase, GivenRun};
use super::ready_group::ReadyGroup;
use super::region_run::RegionRun;
use super::traced_case::NumberedCase;
use crate::error::SimulateError;
use crate::input::case::Case;
use crate::input::estimator::Estimator;
use crate::input::layer::BottomSurface;
use crate::input::limits::{
    check_grazing, check_memory, check_results, hierarchy_bytes, meshes_bytes,
    smooth_accelerator_bytes,
};
use crate::input::settings::Settings;
use crate::input::surface_source::Shape;
use crate::methods::method::Method;
use crate::observer::Observer;

/// Cases on one given surface.
#[derive(Clone)]
pub(crate) struct GivenGroup {
    shape: Shape,
    settings: Settings,
    cases: Vec<NumberedCase>,
}

impl GivenGroup {
    /// Refuses what no run on this surface does.
    pub(crate) fn new(
        shape: Shape,
        cases: Vec<NumberedCase>,
        settings: &Settings,
    ) -> Result<Self, SimulateError> {
        let mut layers = cases.iter().filter_map(|one| one.case.layer);
        if layers.any(|layer| layer.bottom == BottomSurface::Independent) {
            return Err(SimulateError::IndependentBottom);
        }
        let group = Self {
            shape,
            settings: *settings,
            cases,
        };
        match &group.shape {
            Shape::HeightField { top, bottom } => {
                group.check_height_field(top.field(), 1 + usize::from(bottom.is_some()))?;
            }
            Shape::Smooth { top, bottom } => {
                group.check_smooth(top, 1 + usize::from(bottom.is_some()))?;
            }
            Shape::TriangleMesh { top, .. } => group.check_triangle_mesh(top)?,
        }
        let tallies = settings.regions.map_or(1, |regions| regions.count());
        let spec = settings.largest_spec(group.cases.iter().map(|one| &one.case));
        check_results(&spec, tallies, group.cases.len(), settings.refine)?;
        Ok(group)
    }

    /// `surfaces`: this one, and the bottom if there is one.
    fn check_height_field(
        &self,
        field: &HeightField,
        surfaces: usize,
    ) -> Result<(), SimulateError> {
        let settings = &self.settings;
        if settings.refine && field.border() == Border::Open {
            return Err(RefinementError::Open.into());
        }
        let random_azimuth = self.cases.iter().any(|one| one.case.light.random_azimuth);
        if random_azimuth && settings.estimator == Estimator::Controlled {
            return Err(SimulateError::AzimuthControl);
        }
        let bytes = meshes_bytes(
            field.shape(),
            settings.accelerator,
            field.is_flat(),
            settings.refine,
        );
        let more = surfaces.saturating_mul(bytes) - surfaces * size_of_val(field.heights());
        check_memory("tracing this surface", more)
    }

    /// `surfaces`: this one, and the bottom if there is one.
    fn check_smooth(&self, surface: &SmoothSurface, surfaces: usize) -> Result<(), SimulateError> {
        if self.settings.refine {
            return Err(SimulateError::SmoothRefinement);
        }
        if self.settings.estimator == Estimator::Controlled {
            return Err(SimulateError::SmoothControl);
        }
        let shape = surface.spline().shape();
        let bytes = smooth_accelerator_bytes(shape, self.settings.accelerator);
        check_memory("tracing this surface", surfaces.saturating_mul(bytes))
    }

    fn check_triangle_mesh(&self, mesh: &MeshSurface) -> Result<(), SimulateError> {
        check_memory(
            "this mesh with its hierarchy",
            hierarchy_bytes(mesh.facet_count()),
        )?;
        if self.settings.estimator == Estimator::Controlled {
            return Err(SimulateError::MeshControl);
        }
        Ok(())
    }

    /// The same with another effort and seed.
    pub(crate) fn repeated(&self, settings: &Settings) -> Self {
        Self {
            settings: *settings,
            ..self.clone()
        }
    }

    /// Number of cases.
    pub(crate) const fn len(&self) -> usize {
        self.cases.len()
    }

    /// Rays of all cases, as far as they are planned without a pilot run.
    pub(crate) fn rays(&self) -> u64 {
        let cases = self.cases.len() as u64;
        self.settings.effort.total_rays().saturating_mul(cases)
    }

    /// Builds the accelerators, and finds how each case is estimated on each mesh.
    pub(crate) fn build(
        self,
        observer: &dyn Observer,
    ) -> Result<Box<dyn ReadyGroup>, SimulateError> {
        observer.begin("building", 1);
        let refine = self.settings.refine;
        let clock = Instant::now();
        let run: Box<dyn ReadyGroup> = match self.shape.clone() {
            Shape::HeightField { top, bottom } => {
                let bottom = bottom.map(|bottom| Meshes::new(bottom, refine));
                let meshes = SurfaceMeshes {
                    top: Meshes::new(top, refine)?,
                    bottom: bottom.transpose()?,
                };
                self.build_on(meshes, Method::of_surface, clock)?
            }
            Shape::Smooth { top, bottom } => self.build_plain(top, bottom, clock)?,
            Shape::TriangleMesh { top, bottom } => self.build_plain(top, bottom, clock)?,
        };
        observer.end();
        Ok(run)
    }

    /// Builds on one mesh, whose light no control variate foresees.
    fn build_plain<G: BuildAccelerator + 'static>(
        self,
        top: Arc<G>,
        bottom: Option<Arc<G>>,
        clock: Instant,
    ) -> Result<Box<dyn ReadyGroup>, SimulateError> {
        let meshes = SurfaceMeshes {
            top: Meshes::of_one(top),
            bottom: bottom.map(Meshes::of_one),
        };
        let plain = |_: &G, _: &Case, settings: &Settings| Ok(Method::plain(settings));
        self.build_on(meshes, plain, clock)
    }

    /// Builds on these meshes; `clock` began before they were made.
    fn build_on<G: BuildAccelerator + 'static>(
        self,
        meshes: SurfaceMeshes<G>,
        method_of: impl Fn(&G, &Case, &Settings) -> Result<Method, SimulateError>,
        clock: Instant,
    ) -> Result<Box<dyn ReadyGroup>, SimulateError> {
        let settings = self.settings;
        let built = BuiltSurface::build(meshes, settings.accelerator)?;
        let prepare = |NumberedCase { number, case }| {
            for mesh in built.meshes() {
                check_grazing(mesh, case.light.incidence)?;
            }
            let methods = built
                .meshes()
                .map(|mesh| method_of(mesh, &case, &settings).map(Arc::new))
                .collect::<Result<_, _>>()?;
            Ok(GivenCase {
                number,
                case,
                methods,
                tried: Vec::new(),
                rays: settings.effort.total_rays(),
            })
        };
        let cases = self.cases.into_iter().map(prepare);
        let cases = cases.collect::<Result<Vec<_>, SimulateError>>()?;
        let build_seconds = clock.elapsed().as_secs_f64() / cases.len().max(1) as f64;
        let run = GivenRun {
            built,
            cases,
            settings,
            build_seconds,
        };
        Ok(match settings.regions {
            None => Box::new(run),
            Some(regions) => Box::new(RegionRun { run, regions }),
        })
    }
}
