//! Light on one surface.

use std::time::Instant;

use asperity_optics::{Incidence, Material};
use asperity_surface::HeightField;
use asperity_tally::BatchStatistics;
use asperity_tracer::{Geometry, Medium, MeshSurface, Surface, Tracer};

use crate::blocks::{Blocks, RaySettings, run_blocks};
use crate::estimator::Estimator;
use crate::limits::{
    RunError, check_grazing, check_memory, check_results, hierarchy_bytes, traced_bytes,
};
use crate::method::{Method, with_least_errors};
use crate::progress::Progress;
use crate::summary::{SummaryWork, Used};

/// Blocks that a single surface gets at least, since its errors come from them.
pub(crate) const FEWEST_BLOCKS: u64 = 64;

/// What light did on one surface.
#[derive(Clone, Debug)]
pub struct TraceOutcome {
    /// Flux fractions by the layout of the settings; a batch is a block of rays.
    pub statistics: BatchStatistics,
    /// What was done.
    pub work: SummaryWork,
    /// The surface, given back; of a mesh none.
    pub field: Option<HeightField>,
}

/// Traces light from `incidence`, coming from the medium `incident`, onto one surface.
///
/// # Errors
/// [`RunError`] if surface or results are too large, or the light too flat.
pub fn trace(
    field: HeightField,
    material: Material,
    incidence: Incidence,
    incident: Medium,
    settings: &RaySettings,
    progress: &dyn Progress,
) -> Result<TraceOutcome, RunError> {
    let accelerator = settings
        .accelerator
        .on_height_field(field.cells(), field.is_flat());
    check_memory(
        "tracing this surface",
        traced_bytes(field.shape(), accelerator) - size_of_val(field.heights()),
    )?;
    let build = || Surface::new(field);
    let method =
        |surface: &Surface| Method::of_surface(surface, material, incidence, incident, settings);
    let light = (material, incidence, incident);
    let (outcome, surface) = trace_on(build, method, light, settings, progress)?;
    Ok(TraceOutcome {
        field: Some(surface.into_field()),
        ..outcome
    })
}

/// [`trace`] on a triangle mesh.
///
/// # Errors
/// As [`trace`].
pub fn trace_mesh(
    mesh: MeshSurface,
    material: Material,
    incidence: Incidence,
    incident: Medium,
    settings: &RaySettings,
    progress: &dyn Progress,
) -> Result<TraceOutcome, RunError> {
    check_memory(
        "this mesh with its hierarchy",
        hierarchy_bytes(mesh.facet_count()),
    )?;
    if settings.estimator == Estimator::Controlled {
        return Err(RunError::MeshControl);
    }
    let build = || mesh;
    let method = |_: &MeshSurface| Ok(Method::PLAIN);
    let light = (material, incidence, incident);
    Ok(trace_on(build, method, light, settings, progress)?.0)
}

/// Traces light on what `build` builds.
fn trace_on<G: Geometry>(
    build: impl FnOnce() -> G,
    method: impl FnOnce(&G) -> Result<Method, RunError>,
    (material, incidence, incident): (Material, Incidence, Medium),
    settings: &RaySettings,
    progress: &dyn Progress,
) -> Result<(TraceOutcome, G), RunError> {
    let began = Instant::now();
    let blocks = Blocks::plan(settings.rays, FEWEST_BLOCKS, settings.sampling);
    check_results(&settings.layout, 1, 1)?;
    progress.begin("building", 1);
    let geometry = build();
    let accelerator = geometry.accelerator(settings.accelerator)?;
    check_grazing(&geometry, incidence)?;
    let method = method(&geometry)?;
    let build_seconds = began.elapsed().as_secs_f64();
    progress.end();

    progress.begin("tracing", blocks.rays());
    let tracing = Instant::now();
    let tracer = Tracer::new(&geometry, &*accelerator, material, incident, settings.paths);
    let mut statistics = BatchStatistics::new(settings.layout.len());
    let light = method.illumination(incidence, false, settings);
    let work = run_blocks(
        &tracer,
        (&light, method.control()),
        settings,
        0,
        blocks,
        progress,
        |values| {
            statistics.push(values);
        },
    );
    progress.end();
    let statistics = with_least_errors(&method, &settings.layout, statistics, work.rays);
    let outcome = TraceOutcome {
        statistics,
        work: SummaryWork {
            realisations: 1,
            generate_seconds: 0.0,
            build_seconds,
            trace_seconds: tracing.elapsed().as_secs_f64(),
            seconds: began.elapsed().as_secs_f64(),
            ..SummaryWork::new(work, Used::of(&*accelerator), &method, settings.sampling)
        },
        field: None,
    };
    Ok((outcome, geometry))
}
