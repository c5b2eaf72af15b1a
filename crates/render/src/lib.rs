//! Pictures of explicit surfaces and what lies below them.
//!
//! Light paths are reversible: the radiance along a camera ray is that which arrives on all paths that begin with
//! this ray, followed backwards to the light sources. Radiance changes by the square of the index at each
//! interface. For paths that begin and end above the surface these factors cancel, so that a path is followed as
//! light is: many at a time ([`asperity_tracer::Tracer::given_rays`]), or one by one where paths are connected to a sun
//! ([`asperity_tracer::PathIntegrator`]).
//!
//! Random paths hardly ever hit a sun. Where a path is scattered diffusely, by a Lambertian face or a medium, it is connected to
//! the sun ([`asperity_tracer::Sunlight`]): above a surface by a ray to a point of the disc, below it by the
//! facets that bring light from one direction of the disc per sample ([`asperity_tracer::LightBeams`]). Random paths add the rest: sunlight
//! that smooth facets reflect, or that interacts with several of them, and all of it below smooth cells, which have no facets.
//!
//! A picture is made in passes of four samples per pixel, one of each of four independent sequences. A sequence fills the
//! pixel, and the first decisions of paths that are followed one by one, evenly; errors come from the scatter between sequences.

mod denoise;
mod error;
mod exposure;
mod lights;
mod passes;
mod scene;
mod sequence;
mod settings;
mod tile_frame;
mod tone;
mod view;

use asperity_simulate::{
    Observer, SearchedSurface, Shape, StoppedBy, check_height, check_memory, check_shape_memory,
};
use std::sync::Arc;
use std::time::Instant;

use asperity_io::Picture;
use asperity_optics::{Layer, Material};
use asperity_tracer::{
    Branching, BuildAccelerator, FlightSearch, Geometry, HalfSpace, LightBeams, MeshSurface,
    PathIntegrator, Polarisation, Surface, TracedStack, Tracer, can_traverse, tiles_crossed,
};

pub use denoise::denoise;
pub use error::RenderError;
pub use exposure::exposure;
pub use lights::{Lights, LightsError, Patch, Sun};
use passes::{AimedBeams, BeginBeams, Film, expose};
use scene::{SEQUENCES, Scene};
pub use settings::{MAX_PIXELS, RenderSettings};
use tile_frame::TileFrame;
pub use tone::{LOG_DECADES, Tone, ToneCurve};
pub use view::{Projection, View, ViewError};

/// Roulette threshold of branches: low, since a bright sun may lie at their end.
const WEAKEST: f64 = 1e-3;

/// A picture, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOutcome {
    /// Radiance, relative to the unit of the lights.
    pub picture: Picture,
    /// Samples per pixel.
    pub samples: u64,
    /// Mean fraction of the light of a camera ray that was truncated by a limit, not counting roulette, which is zero
    /// on average.
    pub truncated: f64,
    /// Mean fraction of the light of a camera ray that left an open patch sideways.
    pub left_patch: f64,
    /// Mean fraction of the light of a camera ray that failed numerically.
    pub lost: f64,
    /// Seconds for building and for tracing.
    pub seconds: [f64; 2],
    /// Reason for an early stop, if there was one.
    pub stopped_by: Option<StoppedBy>,
}

/// Makes a picture of a surface of `material`, with layers below it or nothing; `shape` holds the surfaces of
/// their bottoms that have one of their own.
///
/// Smooth cells have no light beams: sunlight in a layer below them is found by random paths alone.
///
/// A run that is to stop ends with the passes that are complete. Once the time is over, only a first
/// pass is still completed, unless [`Observer::gives_up_first`] says otherwise.
///
/// # Errors
/// [`RenderError`] if the surface or the picture is too large, a layer too thin, the eye too low, parallel
/// camera rays or the sun too flat, or if an interrupt comes before the first pass is complete.
pub fn render(
    shape: &Shape,
    material: Material,
    layers: &[Layer],
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Result<RenderOutcome, RenderError> {
    let matter = Matter { material, layers };
    check_shape_memory(shape, settings.accelerator, false)?;
    match shape {
        Shape::HeightField { top, below } => {
            let geometries = Geometries { top: &**top, below };
            let beams: Option<BeginBeams<Surface>> = Some(LightBeams::new);
            render_on(&geometries, beams, matter, settings, progress)
        }
        Shape::Smooth { top, below } => {
            let geometries = Geometries { top: &**top, below };
            render_on(&geometries, None, matter, settings, progress)
        }
        Shape::TriangleMesh { top, below } => {
            let geometries = Geometries { top: &**top, below };
            let beams: Option<BeginBeams<MeshSurface>> = Some(LightBeams::new);
            render_on(&geometries, beams, matter, settings, progress)
        }
    }
}

/// The surface, and the bottoms of the layers below it where they have one of their own.
struct Geometries<'a, G> {
    top: &'a G,
    below: &'a [Option<Arc<G>>],
}

/// Materials of a picture: the interface, and the layers below it.
#[derive(Clone, Copy)]
struct Matter<'a> {
    material: Material,
    layers: &'a [Layer],
}

fn render_on<G: BuildAccelerator>(
    geometries: &Geometries<'_, G>,
    beams: Option<BeginBeams<G>>,
    matter: Matter<'_>,
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Result<RenderOutcome, RenderError> {
    let building = Instant::now();
    check_size(settings.size)?;
    check_height(geometries.top)?;
    check_grazing(geometries.top, settings)?;
    let accelerator = geometries.top.accelerator(settings.accelerator)?;
    let of_bottom = |bottom: &Option<Arc<G>>| {
        let bottom = bottom.as_ref();
        bottom
            .map(|bottom| bottom.accelerator(settings.accelerator))
            .transpose()
    };
    let accelerators = geometries.below.iter().map(of_bottom);
    let accelerators = accelerators.collect::<Result<Vec<_>, _>>()?;
    let top = SearchedSurface {
        geometry: geometries.top,
        accelerator: &*accelerator,
    };
    let bottoms = geometries.below.iter().zip(&accelerators);
    let bottoms = bottoms.map(|(bottom, accelerator)| {
        Some(SearchedSurface {
            geometry: bottom.as_deref()?,
            accelerator: accelerator.as_deref()?,
        })
    });
    let scene = scene(top, &bottoms.collect::<Vec<_>>(), matter, settings)?;
    let build_seconds = building.elapsed().as_secs_f64();

    let tracing = Instant::now();
    let passes = settings.samples.div_ceil(SEQUENCES);
    let scatters = matter.layers.first().is_some_and(|layer| {
        let bottom = layer.end().map(|slab| slab.bottom.material());
        !layer.medium().is_clear() || matches!(bottom, Some(Material::Lambertian { .. }))
    });
    let beams = beams.filter(|_| scatters).map(|begin| AimedBeams {
        geometry: geometries.top,
        begin,
        material: matter.material,
        beams: None,
    });
    let film = expose(&scene, beams, passes, settings, progress);
    if film.passes == 0 {
        return Err(RenderError::Interrupted);
    }
    let is_stopped = film.passes < passes;
    let stopped_by = is_stopped.then(|| progress.stop().unwrap_or(StoppedBy::Interrupt));
    let seconds = [build_seconds, tracing.elapsed().as_secs_f64()];
    Ok(outcome(film, seconds, stopped_by))
}

/// The scene of a picture: camera, lights and matter.
fn scene<'a, G: Geometry>(
    top: SearchedSurface<'a, G>,
    bottoms: &[Option<SearchedSurface<'a, G>>],
    matter: Matter<'_>,
    settings: &RenderSettings,
) -> Result<Scene<'a, G>, RenderError> {
    let frame = TileFrame::of(top.geometry);
    let (geometry, accelerator) = (top.geometry, top.accelerator);
    let most = settings.most_scatterings;
    let stack = TracedStack::new(top, matter.layers, bottoms, most)?;
    let paths = settings.paths.with_polarisation(Polarisation::Averaged);
    let material = matter.material;
    let integrator = PathIntegrator::new(geometry, accelerator, material, paths).over(stack);
    // Nothing scatters diffusely, and light that leaves depends on its direction alone
    let is_plain = matter.layers.is_empty()
        && !material.is_diffuse()
        && !settings.lights.sun().is_some_and(Sun::is_limited);
    let tracer = is_plain.then(|| {
        let paths = paths.with(Branching::Split, WEAKEST);
        Tracer::new(geometry, accelerator, material, HalfSpace::Above, paths)
    });
    Ok(Scene {
        camera: settings.view.camera(settings.size, frame.highest())?,
        lights: settings.lights,
        integrator: integrator.with_flight_search(FlightSearch::Nearby),
        tracer,
        frame,
        size: settings.size,
    })
}

fn outcome(film: Film, seconds: [f64; 2], stopped_by: Option<StoppedBy>) -> RenderOutcome {
    let samples = film.passes * SEQUENCES;
    let losses = film.losses;
    let picture = film.develop();
    let rays = samples as f64 * (picture.size[0] * picture.size[1]) as f64;
    RenderOutcome {
        picture,
        samples,
        truncated: losses.truncated / rays,
        left_patch: losses.left_patch / rays,
        lost: losses.lost / rays,
        seconds,
        stopped_by,
    }
}

/// Refuses pictures without pixels, with too many, or too large for the memory.
fn check_size([columns, rows]: [usize; 2]) -> Result<(), RenderError> {
    if ![columns, rows].iter().all(|n| (1..=MAX_PIXELS).contains(n)) {
        return Err(RenderError::BadSize(columns, rows));
    }
    // Four sequences and coverage, a pass of each, the statistics and the picture.
    check_memory("this picture", 144 * columns * rows)?;
    Ok(())
}

/// Refuses parallel camera rays, and a sun, that would cross more tiles than a ray may.
fn check_grazing<G: Geometry>(geometry: &G, settings: &RenderSettings) -> Result<(), RenderError> {
    let camera = settings.view.parallel_theta();
    let sun = settings.lights.sun().map(Sun::theta);
    for (what, theta) in [("the camera", camera), ("the sun", sun)] {
        if let Some(theta) = theta.filter(|theta| !can_traverse(geometry, *theta)) {
            return Err(RenderError::TooGrazing {
                what,
                theta_deg: theta.to_degrees(),
                tiles: tiles_crossed(geometry, theta),
            });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
