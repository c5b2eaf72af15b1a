//! Light on one surface.

use std::time::Instant;

use asperity_optics::{Incidence, Material};
use asperity_surface::HeightField;
use asperity_tally::BatchStatistics;
use asperity_tracer::{Geometry, Medium, MeshSurface, Surface, Tracer, Work};

use crate::blocks::{Blocks, RaySettings, run_blocks};
use crate::limits::{
    RunError, check_grazing, check_memory, check_results, hierarchy_bytes, traced_bytes,
};
use crate::method::Method;
use crate::pilot;
use crate::progress::Progress;
use crate::stopping::{StoppedBy, Stopping};
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
    /// How the run came to its end, if a target was set or the run was stopped.
    pub stopping: Option<Stopping>,
}

/// Rays of a pilot run, which tells how many reach a target: so many blocks of so many strata.
const PILOT: [u64; 2] = [16, 64];

/// Times that rays are added to those planned, at most, and how many times more than seem needed.
const MOST_ROUNDS: u32 = 4;
const MARGIN: f64 = 1.2;

/// Fewest rays of a run with a target, and the most of any run.
const RAYS: [f64; 2] = [65_536.0, 1e15];

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
    let (outcome, surface) = trace_on(build, material, incidence, incident, settings, progress)?;
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
    let build = || mesh;
    Ok(trace_on(build, material, incidence, incident, settings, progress)?.0)
}

/// Traces light on what `build` builds.
fn trace_on<G: Geometry>(
    build: impl FnOnce() -> G,
    material: Material,
    incidence: Incidence,
    incident: Medium,
    settings: &RaySettings,
    progress: &dyn Progress,
) -> Result<(TraceOutcome, G), RunError> {
    let began = Instant::now();
    check_results(&settings.layout, 1, 1)?;
    progress.begin("building", 1);
    let geometry = build();
    let accelerator = geometry.accelerator(settings.accelerator)?;
    check_grazing(&geometry, incidence)?;
    let build_seconds = began.elapsed().as_secs_f64();
    progress.end();

    let tracing = Instant::now();
    let tracer = Tracer::new(&geometry, &*accelerator, material, incident, settings.paths);
    let method = Method::PLAIN;
    let light = method.illumination(incidence, false, settings);
    let run = |realisation, blocks: Blocks, statistics: &mut BatchStatistics| {
        run_blocks(
            &tracer,
            (&light, method.control.as_ref()),
            settings,
            realisation,
            blocks,
            progress,
            |values| statistics.push(values),
        )
    };
    let error = |statistics: &BatchStatistics| {
        let aim = settings.target?.of();
        aim.error(&settings.layout, statistics)
    };

    // Rays of a pilot run are none of those of the result.
    let mut rays = settings.rays;
    if let Some(target) = settings.target {
        let [count, strata] = PILOT;
        let fewest = Blocks::plan(count * strata * strata, count, settings.sampling);
        progress.begin("planning", fewest.rays());
        let mut pilot = BatchStatistics::new(settings.layout.len());
        run(pilot::FIRST, fewest, &mut pilot);
        progress.end();
        let ratio = error(&pilot).unwrap_or(0.0) / target.error();
        let needed = MARGIN * fewest.rays() as f64 * ratio * ratio;
        rays = needed.clamp(RAYS[0], RAYS[1]).ceil() as u64;
    }
    let planned = Blocks::plan(rays, FEWEST_BLOCKS, settings.sampling);
    let mut blocks = planned;
    let mut statistics = BatchStatistics::new(settings.layout.len());
    let mut work = Work::default();
    let mut rounds = 0;
    let stopped_by = loop {
        progress.begin(
            if rounds == 0 { "tracing" } else { "adding" },
            blocks.rays(),
        );
        let done = run(0, blocks, &mut statistics);
        progress.end();
        work += done;
        if done.rays < blocks.rays() {
            break progress.stop().unwrap_or(StoppedBy::Interrupt);
        }
        let (Some(error), Some(target)) = (error(&statistics), settings.target) else {
            break StoppedBy::Plan;
        };
        if error <= target.error() {
            break StoppedBy::Target;
        }
        let ratio = (error / target.error()).powi(2) * MARGIN;
        let all = (statistics.batches() as f64 * ratio)
            .min(RAYS[1] / planned.rays() as f64 * planned.count as f64);
        let more = all as u64 - statistics.batches().min(all as u64);
        if rounds == MOST_ROUNDS || more == 0 {
            break StoppedBy::Plan;
        }
        rounds += 1;
        blocks = blocks.more(more);
    };
    let stopping = Stopping {
        target_error: settings.target.map(|target| target.error()),
        of: settings.target.map(|target| target.of()),
        error: error(&statistics),
        mesh_error: None,
        pilot: None,
        realisations: 1,
        rays_per_surface: planned.rays(),
        size: None,
        spacing: None,
        rounds,
        stopped_by,
        warnings: Vec::new(),
    };
    let told = settings.target.is_some() || stopped_by != StoppedBy::Plan;
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
        stopping: told.then(|| stopping.with_warning()),
    };
    Ok((outcome, geometry))
}
