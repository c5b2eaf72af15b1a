//! Light on one surface.

use std::time::Instant;

use asperity_optics::{Incidence, Layer, Material};
use asperity_surface::{Border, HeightField, RefinementError};
use asperity_tally::TallyStatistics;
use asperity_tracer::{BuildAccelerator, Geometry, HalfSpace, MeshSurface, Surface, Tracer, Work};

use crate::engine::blocks::{Blocks, FEWEST_BLOCKS, LitMesh, RaySettings, run_blocks};
use crate::engine::pilot;
use crate::errors::budget::ErrorBudget;
use crate::errors::mesh_error::{
    MeshErrors, MeshShifts, MeshStatistics, Meshes, NOT_ASKED, Refinement,
};
use crate::input::estimator::Estimator;
use crate::input::layer::substrate;
use crate::input::limits::{
    RunError, check_grazing, check_memory, check_results, hierarchy_bytes, meshes_bytes,
};
use crate::methods::method::{Method, with_least_errors};
use crate::observer::Observer;
use crate::observer::StoppedBy;
use crate::output::stopping::Stopping;
use crate::output::work::{SummaryWork, Used};

/// What light did on one surface.
#[derive(Clone, Debug)]
pub struct TraceOutcome {
    /// Flux fractions by the spec of the settings; a batch is a block of rays.
    pub statistics: TallyStatistics,
    /// The errors of the fluxes by where they come from.
    pub errors: ErrorBudget,
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

/// Light, and what it falls on beside the shape of the surface.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// What the surface is made of.
    pub material: Material,
    /// What lies below it, if there is anything.
    pub layer: Option<Layer>,
    /// Where the light comes from.
    pub incidence: Incidence,
    /// The side that it comes from.
    pub incident: HalfSpace,
    /// Whether each ray comes from an azimuth of its own; what leaves is turned back.
    pub any_azimuth: bool,
}

impl Scene {
    /// Light from above onto a surface with nothing but its material below.
    #[must_use]
    pub const fn new(material: Material, incidence: Incidence) -> Self {
        Self {
            material,
            layer: None,
            incidence,
            incident: HalfSpace::Above,
            any_azimuth: false,
        }
    }
}

/// Traces light onto one surface; `bottom` is the surface on which a layer below it ends, where that has a
/// shape of its own.
///
/// # Errors
/// [`RunError`] if surface or results are too large, the light too flat, a surface with an open border
/// is to be refined, or a layer does not fit below it.
pub fn trace(
    field: HeightField,
    bottom: Option<HeightField>,
    scene: &Scene,
    settings: &RaySettings,
    progress: &dyn Observer,
) -> Result<TraceOutcome, RunError> {
    if settings.refine && field.border() == Border::Open {
        return Err(RefinementError::Open.into());
    }
    if scene.any_azimuth && settings.estimator == Estimator::Controlled {
        return Err(RunError::AzimuthControl);
    }
    let is_flat = field.is_flat();
    let bytes = meshes_bytes(
        field.shape(),
        settings.accelerator,
        is_flat,
        settings.refine,
    );
    let surfaces = 1 + usize::from(bottom.is_some());
    let more = surfaces.saturating_mul(bytes) - surfaces * size_of_val(field.heights());
    check_memory("tracing this surface", more)?;
    let spec = settings.spec;
    let (spacing, border) = (field.spacing(), field.border());
    let mesh_errors = |shifts: Option<MeshShifts>| match shifts {
        Some(shifts) => MeshErrors::of_refined(Refinement::new(spacing, shifts)),
        None if is_flat => MeshErrors::of_flat(spec),
        None if border == Border::Open => MeshErrors::unknown(spec, OPEN),
        None => MeshErrors::unknown(spec, NOT_ASKED),
    };
    let build = || {
        let own = bottom.map(|field| Meshes::new(field, settings.refine));
        Ok((Meshes::new(field, settings.refine)?, own.transpose()?))
    };
    let Scene {
        material,
        incidence,
        incident,
        ..
    } = *scene;
    let method = |surface: &Surface| match scene.layer {
        // No control knows of a medium, and that of one surface is of light from one azimuth.
        Some(_) => Ok(Method::PLAIN),
        None if scene.any_azimuth => Ok(Method::PLAIN),
        None => Method::of_surface(surface, material, incidence, incident, settings),
    };
    let (outcome, meshes) = trace_on((build, method), scene, settings, mesh_errors, progress)?;
    Ok(TraceOutcome {
        field: Some(meshes.into_given()),
        ..outcome
    })
}

/// [`trace`] on a triangle mesh, which is never refined.
///
/// # Errors
/// As [`trace`].
pub fn trace_mesh(
    mesh: MeshSurface,
    bottom: Option<MeshSurface>,
    scene: &Scene,
    settings: &RaySettings,
    progress: &dyn Observer,
) -> Result<TraceOutcome, RunError> {
    check_memory(
        "this mesh with its hierarchy",
        hierarchy_bytes(mesh.facet_count()),
    )?;
    if settings.estimator == Estimator::Controlled {
        return Err(RunError::MeshControl);
    }
    let spec = settings.spec;
    let build = || Ok((Meshes::of_one(mesh), bottom.map(Meshes::of_one)));
    let mesh_errors = |_| MeshErrors::unknown(spec, TRIANGLES);
    let method = |_: &MeshSurface| Ok(Method::PLAIN);
    Ok(trace_on((build, method), scene, settings, mesh_errors, progress)?.0)
}

/// Why the error of a mesh is not known.
const OPEN: &str = "not estimated: a surface with an open border cannot be refined";
const TRIANGLES: &str = "none: the triangles given are the surface";

/// The meshes of a surface, and of what a layer below it ends on, if that has a shape of its own.
type Built<G> = (Meshes<G>, Option<Meshes<G>>);

/// Traces light on what `build` builds, whose mesh has the errors that follow from what differs between
/// its meshes.
fn trace_on<G: BuildAccelerator>(
    (build, method): (
        impl FnOnce() -> Result<Built<G>, RunError>,
        impl Fn(&G) -> Result<Method, RunError>,
    ),
    scene: &Scene,
    settings: &RaySettings,
    mesh_errors: impl FnOnce(Option<MeshShifts>) -> MeshErrors,
    progress: &dyn Observer,
) -> Result<(TraceOutcome, Meshes<G>), RunError> {
    let began = Instant::now();
    check_results(&settings.spec, 1, 1, settings.refine)?;
    progress.begin("building", 1);
    let (meshes, bottoms) = build()?;
    let accelerators = meshes.accelerators(settings.accelerator)?;
    let below = match &bottoms {
        Some(bottoms) => bottoms.accelerators(settings.accelerator)?,
        None => Vec::new(),
    };
    for surface in &meshes.surfaces {
        check_grazing(surface, scene.incidence)?;
    }
    let methods = meshes
        .surfaces
        .iter()
        .map(method)
        .collect::<Result<Vec<_>, _>>()?;
    let build_seconds = began.elapsed().as_secs_f64();
    progress.end();

    let tracing = Instant::now();
    let lit: Vec<LitMesh<'_, G>> = meshes
        .surfaces
        .iter()
        .zip(&accelerators)
        .zip(&methods)
        .enumerate()
        .map(|(i, ((surface, found_by), method))| {
            let (material, incident) = (scene.material, scene.incident);
            let mut tracer = Tracer::new(surface, &**found_by, material, incident, settings.paths);
            if let Some(layer) = &scene.layer {
                let own = bottoms.as_ref().map(|b| (&b.surfaces[i], &*below[i]));
                let shape = (settings.bottom, own);
                let top = (surface, &**found_by);
                tracer = tracer.over(substrate(top, layer, shape, settings.most_scatterings)?);
            }
            Ok(LitMesh {
                tracer,
                light: method.illumination(scene.incidence, scene.any_azimuth, settings),
                control: method.control(),
            })
        })
        .collect::<Result<_, RunError>>()?;
    let method = &methods[0];
    let spec = settings.spec;
    let run = |realisation, blocks: Blocks, statistics: &mut MeshStatistics| {
        run_blocks(&lit, settings, realisation, blocks, progress, |values| {
            statistics.push(values);
        })
    };
    let error = |statistics: &TallyStatistics, rays| {
        let statistics = with_least_errors(method, statistics.clone(), rays);
        settings.target?.of().error(&statistics)
    };

    // Rays of a pilot run are none of those of the result.
    let mut rays = settings.rays;
    if let Some(target) = settings.target {
        let [count, strata] = PILOT;
        let fewest = Blocks::plan(count * strata * strata, count, settings.sampling);
        progress.begin("planning", fewest.rays());
        let mut pilot = MeshStatistics::new(spec, lit.len());
        run(pilot::FIRST, fewest, &mut pilot);
        progress.end();
        let ratio = error(&pilot.tallies, fewest.rays()).unwrap_or(0.0) / target.error();
        let needed = MARGIN * fewest.rays() as f64 * ratio * ratio;
        rays = needed.clamp(RAYS[0], RAYS[1]).ceil() as u64;
    }
    let planned = Blocks::plan(rays, FEWEST_BLOCKS, settings.sampling);
    let mut blocks = planned;
    let mut statistics = MeshStatistics::new(spec, lit.len());
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
        let (Some(error), Some(target)) = (error(&statistics.tallies, work.rays), settings.target)
        else {
            break StoppedBy::Plan;
        };
        if error <= target.error() {
            break StoppedBy::Target;
        }
        let ratio = (error / target.error()).powi(2) * MARGIN;
        let all = (statistics.tallies.batches() as f64 * ratio)
            .min(RAYS[1] / planned.rays() as f64 * planned.count as f64);
        let more = all as u64 - statistics.tallies.batches().min(all as u64);
        if rounds == MOST_ROUNDS || more == 0 {
            break StoppedBy::Plan;
        }
        rounds += 1;
        blocks = blocks.more(more);
    };
    let stopping = Stopping {
        target_error: settings.target.map(|target| target.error()),
        of: settings.target.map(|target| target.of()),
        error: error(&statistics.tallies, work.rays),
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
    let MeshStatistics { tallies, shifts } = statistics;
    let errors = ErrorBudget::of_one(&tallies, method, work.rays, mesh_errors(shifts));
    let tallies = with_least_errors(method, tallies, work.rays);
    let told = settings.target.is_some() || stopped_by != StoppedBy::Plan;
    let outcome = TraceOutcome {
        statistics: tallies,
        errors,
        work: SummaryWork {
            realisations: 1,
            generate_seconds: 0.0,
            build_seconds,
            trace_seconds: tracing.elapsed().as_secs_f64(),
            seconds: began.elapsed().as_secs_f64(),
            ..SummaryWork::new(work, Used::of(&*accelerators[0]), method, settings.sampling)
        },
        field: None,
        stopping: told.then(|| stopping.with_warning()),
    };
    drop((accelerators, below));
    Ok((outcome, meshes))
}
