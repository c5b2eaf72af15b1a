//! Pictures of explicit surfaces and what lies below them.
//!
//! Light is reversible: the radiance that a camera sees along a line is what arrives on all paths that
//! begin with that line, followed backwards, from where they leave. On the way radiance changes by the
//! square of the index at each interface, and back again, so that for paths that begin and end above all
//! factors cancel, and a path may be followed as light is ([`asperity_tracer::PathIntegrator`]).
//!
//! A sun behind a refracting surface is hardly found by chance. Where a path is scattered inside a medium, the
//! facets that light it from one direction of the sun's disc are computed ([`asperity_tracer::LightBeams`]), a
//! direction for each pass; chance finds the rest: what is reflected, or meets several facets on its way.
//!
//! A picture is made in passes, each with as many samples per pixel, spread evenly over it; every row of a pass
//! has a random stream of its own. Errors are those of the mean over passes.

mod lights;
mod view;

use asperity_simulate::{
    BottomSurface, LayerBelow, Observer, SearchedSurface, SimulateError, StoppedBy, check_memory,
    hierarchy_bytes, meshes_bytes, picture_stream,
};
use std::time::Instant;

use asperity_io::Picture;
use asperity_optics::{Layer, Material};
use asperity_surface::HeightField;
use asperity_tally::BatchStatistics;
use asperity_tracer::{
    AcceleratorKind, BeamContribution, BuildAccelerator, BuildError, CameraContribution,
    FlightSearch, Geometry, LightBeams, MAX_TILES, MeshSurface, PathEnd, PathIntegrator,
    PathResult, PathSettings, Surface, TracedLayerError, can_traverse, tiles_crossed,
};
use glam::{DVec2, DVec3};
use rand::{Rng, RngExt};
use rayon::prelude::*;

pub use lights::{Lights, LightsError, Patch, Sun};
use view::Camera;
pub use view::{Projection, View, ViewError};

/// What a picture shows, and how it is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderSettings {
    /// The camera.
    pub view: View,
    /// What shines.
    pub lights: Lights,
    /// Columns and rows.
    pub size: [usize; 2],
    /// Samples per pixel, at least; rounded up to whole passes.
    pub samples: u64,
    /// Seed of the lines and paths.
    pub seed: u64,
    /// How paths are ended.
    pub paths: PathSettings,
    /// How hits are found.
    pub accelerator: AcceleratorKind,
    /// The shape of the bottom, unless one of its own is given; none is drawn here.
    pub bottom: BottomSurface,
    /// Scatterings inside a layer after which a path is truncated.
    pub most_scatterings: u32,
}

/// A picture, and how it came about.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOutcome {
    /// Radiance, relative to the unit of the lights.
    pub picture: Picture,
    /// Samples per pixel.
    pub samples: u64,
    /// Passes, from which the errors are.
    pub passes: u64,
    /// Mean fraction of a line's light that was ended by a limit, without roulette, which is zero on average.
    pub truncated: f64,
    /// That of light that left an open patch sideways.
    pub left_patch: f64,
    /// That of light that failed numerically.
    pub lost: f64,
    /// Seconds for building and for following light.
    pub seconds: [f64; 2],
    /// What ended it before its time, if anything did.
    pub stopped_by: Option<StoppedBy>,
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The surface is too large.
    #[error(transparent)]
    Run(#[from] SimulateError),
    /// No accelerator for the surface.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// The layer does not fit below the surface.
    #[error(transparent)]
    Layer(#[from] TracedLayerError),
    /// The camera stands badly.
    #[error(transparent)]
    View(#[from] ViewError),
    /// Lines so flat that they would cross too many tiles.
    #[error(
        "{what} at theta {theta_deg} deg is too flat: straight lines cross up to {tiles:.0} tiles between the highest and the lowest point, {} is the most; take a larger tile or a smaller angle",
        MAX_TILES
    )]
    TooGrazing {
        /// Camera or sun.
        what: &'static str,
        /// Polar angle, degrees.
        theta_deg: f64,
        /// Tiles crossed.
        tiles: f64,
    },
    /// There is no picture yet.
    #[error("stopped before two passes were finished; nothing is written")]
    Interrupted,
    /// No pixel, or too many.
    #[error("the picture has {0} x {1} pixels; 1 to {MOST_PIXELS} along a side are possible")]
    BadSize(usize, usize),
}

/// Most pixels along a side.
pub const MOST_PIXELS: usize = 16_384;

/// Passes, where there are as many samples: enough for errors, few enough to spread lines evenly in each.
const PASSES: u64 = 16;

/// Most samples per pixel of a pass: more samples take more passes, so that each is soon complete.
const MOST_OF_PASS: u64 = 4;

/// Passes that are made even if time is over: fewer give no error.
const PASSES_IN_ANY_CASE: u64 = 2;

/// Makes a picture of a surface of `material`, with a layer below it or nothing; `bottom` is the bottom's own
/// surface, if it has one.
///
/// A run that is to stop ends with the passes that are complete: for want of time after two at least.
///
/// # Errors
/// [`RenderError`] if the surface or the picture is too large, the layer too thin, the eye too low, parallel
/// lines of sight or the sun too flat, or if an interrupt comes before two passes.
pub fn render(
    field: HeightField,
    bottom: Option<HeightField>,
    material: Material,
    layer: Option<&Layer>,
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Result<RenderOutcome, RenderError> {
    let bytes = |field: &HeightField| {
        let all = meshes_bytes(field.shape(), settings.accelerator, field.is_flat(), false);
        all.saturating_sub(size_of_val(field.heights()))
    };
    let both = bytes(&field).saturating_add(bottom.as_ref().map_or(0, bytes));
    check_memory("this surface", both)?;
    let build = || (Surface::new(field), bottom.map(Surface::new));
    render_on(build, material, layer, settings, progress)
}

/// [`render()`] of a triangle mesh.
///
/// # Errors
/// As [`render()`].
pub fn render_mesh(
    mesh: MeshSurface,
    bottom: Option<MeshSurface>,
    material: Material,
    layer: Option<&Layer>,
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Result<RenderOutcome, RenderError> {
    let bottom_count = bottom.as_ref().map_or(0, Geometry::facet_count);
    let bytes = hierarchy_bytes(mesh.facet_count().saturating_add(bottom_count));
    check_memory("this mesh with its hierarchy", bytes)?;
    render_on(|| (mesh, bottom), material, layer, settings, progress)
}

fn render_on<G: BuildAccelerator>(
    build: impl FnOnce() -> (G, Option<G>),
    material: Material,
    layer: Option<&Layer>,
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Result<RenderOutcome, RenderError> {
    let began = Instant::now();
    let [columns, rows] = settings.size;
    if !settings.size.iter().all(|n| (1..=MOST_PIXELS).contains(n)) {
        return Err(RenderError::BadSize(columns, rows));
    }
    // Means, squares, a pass, coverage and the picture.
    check_memory("this picture", 64 * columns * rows)?;
    let (geometry, bottom) = build();
    check_grazing(&geometry, settings)?;
    let accelerator = geometry.accelerator(settings.accelerator)?;
    let bottom_accelerator = bottom
        .as_ref()
        .map(|bottom| bottom.accelerator(settings.accelerator))
        .transpose()?;
    let own = bottom.as_ref().zip(bottom_accelerator.as_deref());
    let own = own.map(|(geometry, accelerator)| SearchedSurface {
        geometry,
        accelerator,
    });
    let top = SearchedSurface {
        geometry: &geometry,
        accelerator: &*accelerator,
    };
    let medium = layer
        .map(|&layer| {
            let bottom = settings.bottom;
            LayerBelow { layer, bottom }.traced(top, own, settings.most_scatterings)
        })
        .transpose()?;
    let scatters = layer.is_some_and(|layer| !layer.medium().is_clear());
    let place = Place::of(&geometry);
    let scene = Scene {
        camera: settings.view.camera(settings.size, place.highest())?,
        lights: settings.lights,
        integrator: PathIntegrator::new(&geometry, &*accelerator, material, settings.paths, medium)
            .with_flight_search(FlightSearch::Nearby),
        place,
        size: settings.size,
    };
    let build_seconds = began.elapsed().as_secs_f64();

    let tracing = Instant::now();
    let passes = settings.samples.clamp(PASSES_IN_ANY_CASE, PASSES);
    let passes = passes.max(settings.samples.div_ceil(MOST_OF_PASS));
    let of_pass = settings.samples.div_ceil(passes);
    let mut radiance = BatchStatistics::new(columns * rows);
    let mut coverage = vec![0.0; columns * rows];
    let mut losses = Losses::default();
    progress.begin("rendering", passes.saturating_mul(rows as u64));
    let mut beams = None;
    let sun_shift = {
        let mut rng = picture_stream(settings.seed, passes, 0);
        [rng.random::<f64>(), rng.random::<f64>()]
    };
    for pass in 0..passes {
        // Inside a medium sunlight comes from one direction per pass.
        if let (Some(sun), true) = (settings.lights.sun(), scatters) {
            let towards = sun.point(spread(pass, sun_shift));
            match &mut beams {
                None => beams = Some(LightBeams::new(&geometry, material, towards)),
                Some(beams) => beams.aim(&geometry, towards),
            }
        }
        let beams = beams.as_ref();
        let surely = pass < PASSES_IN_ANY_CASE;
        let stops = || match progress.stop() {
            Some(StoppedBy::Interrupt) => true,
            other => other.is_some() && !surely,
        };
        let done: Option<Vec<Row>> = (0..rows)
            .into_par_iter()
            .with_max_len(1)
            .map(|row| {
                if stops() {
                    return None;
                }
                let mut rng = picture_stream(settings.seed, pass, row as u64);
                let row = scene.row(row, of_pass, beams, &mut rng);
                progress.advance(1);
                Some(row)
            })
            .collect();
        let Some(done) = done else { break };
        let mut values = Vec::with_capacity(columns * rows);
        for (row, coverage) in done.into_iter().zip(coverage.chunks_exact_mut(columns)) {
            for (all, here) in coverage.iter_mut().zip(&row.coverage) {
                *all += here;
            }
            values.extend(row.radiance);
            losses.add(&row.losses);
        }
        radiance.push(&values);
    }
    progress.end();
    let done = radiance.batches();
    if done < PASSES_IN_ANY_CASE {
        return Err(RenderError::Interrupted);
    }
    coverage.iter_mut().for_each(|c| *c /= done as f64);
    let lines = (done * of_pass) as f64 * (columns * rows) as f64;
    Ok(RenderOutcome {
        picture: Picture {
            size: settings.size,
            radiance: radiance.means().to_vec(),
            error: radiance.error_squares().map(f64::sqrt).collect(),
            coverage,
        },
        samples: done * of_pass,
        passes: done,
        truncated: losses.truncated / lines,
        left_patch: losses.left_patch / lines,
        lost: losses.lost / lines,
        seconds: [build_seconds, tracing.elapsed().as_secs_f64()],
        stopped_by: (done < passes).then(|| progress.stop().unwrap_or(StoppedBy::Interrupt)),
    })
}

/// The factor by which radiance becomes the brightness of a picture, where one is white: so that it is
/// nine tenths of white in the brightest hundredth of what is seen of the surface, or of all if that is
/// nothing.
#[must_use]
pub fn exposure(picture: &Picture) -> f64 {
    let pixels = picture.radiance.iter().zip(&picture.coverage);
    let mut seen: Vec<f64> = pixels
        .filter(|(_, coverage)| **coverage >= 0.5)
        .map(|(radiance, _)| *radiance)
        .collect();
    if seen.is_empty() {
        seen.clone_from(&picture.radiance);
    }
    seen.sort_unstable_by(f64::total_cmp);
    let brightest = seen.get(seen.len() * 99 / 100).copied().unwrap_or(0.0);
    if brightest > 0.0 {
        0.9 / brightest
    } else {
        1.0
    }
}

/// Refuses parallel lines of sight, and a sun, that would cross more tiles than a ray may.
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

/// What one row of one pass found.
struct Row {
    radiance: Vec<f64>,
    coverage: Vec<f64>,
    losses: Losses,
}

/// Light that ended without a place to come from, in lines.
#[derive(Clone, Copy, Default)]
struct Losses {
    truncated: f64,
    left_patch: f64,
    lost: f64,
}

impl Losses {
    fn add(&mut self, other: &Self) {
        self.truncated += other.truncated;
        self.left_patch += other.left_patch;
        self.lost += other.lost;
    }
}

/// Everything that a row needs.
struct Scene<'a, G: Geometry> {
    camera: Camera,
    lights: Lights,
    integrator: PathIntegrator<'a, G>,
    place: Place,
    size: [usize; 2],
}

impl<G: Geometry> Scene<'_, G> {
    fn row<R: Rng>(
        &self,
        row: usize,
        samples: u64,
        beams: Option<&LightBeams<G>>,
        rng: &mut R,
    ) -> Row {
        let [columns, rows] = self.size;
        let mut out = Row {
            radiance: Vec::with_capacity(columns),
            coverage: Vec::with_capacity(columns),
            losses: Losses::default(),
        };
        for column in 0..columns {
            let shift = [rng.random::<f64>(), rng.random::<f64>()];
            let (mut radiance, mut met) = (0.0, 0_u64);
            for sample in 0..samples {
                let [u, v] = spread(sample, shift);
                let point = [
                    (column as f64 + u) / columns as f64,
                    (row as f64 + v) / rows as f64,
                ];
                let (origin, direction) = self.camera.line(point);
                let mut meets = false;
                let origin = self.place.in_tile(origin);
                self.integrator.trace_camera_ray(
                    origin,
                    direction,
                    beams,
                    rng,
                    |seen| match seen {
                        CameraContribution::Path(path) => {
                            meets |= path.path.order() > 0;
                            radiance += self.radiance(&path, &mut out.losses);
                        }
                        CameraContribution::Beam(lit) => radiance += self.sunlit(&lit, beams),
                    },
                );
                met += u64::from(meets);
            }
            out.radiance.push(radiance / samples as f64);
            out.coverage.push(met as f64 / samples as f64);
        }
        out
    }

    /// What the sun adds where it is found inside the medium.
    fn sunlit(&self, lit: &BeamContribution, beams: Option<&LightBeams<G>>) -> f64 {
        let (Some(sun), Some(beams)) = (self.lights.sun(), beams) else {
            return 0.0;
        };
        let place = self.place.on_mean_plane(lit.origin, beams.towards());
        lit.fraction * sun.collimated(place)
    }

    /// What comes along a path, from where it leaves.
    fn radiance(&self, path: &PathResult, losses: &mut Losses) -> f64 {
        let radiance = match path.end {
            PathEnd::Above if path.sampled_by_beams => self.lights.sky(),
            PathEnd::Above => {
                let place = || self.place.on_mean_plane(path.origin, path.direction);
                self.lights.above(path.direction, place)
            }
            PathEnd::Below => self.lights.below(),
            PathEnd::Absorbed => 0.0,
            PathEnd::Truncated => {
                losses.truncated += path.flux;
                0.0
            }
            PathEnd::LeftPatch => {
                losses.left_patch += path.flux;
                0.0
            }
            PathEnd::Lost => {
                losses.lost += path.flux;
                0.0
            }
        };
        path.flux * radiance
    }
}

/// Point `k` of a sequence that fills the unit square evenly from its beginning, moved by `shift`.
///
/// # Source
/// Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": the lattice of the plastic
/// number.
fn spread(k: u64, shift: [f64; 2]) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
    [0, 1].map(|axis| (shift[axis] + k as f64 * STEPS[axis]).fract())
}

/// Between lengths of the world, z from the mean plane, and tile coordinates.
#[derive(Clone, Copy)]
struct Place {
    unit: f64,
    aspect: f64,
    mean_plane: f64,
    highest: f64,
}

impl Place {
    fn of<G: Geometry>(geometry: &G) -> Self {
        Self {
            unit: geometry.unit(),
            aspect: geometry.aspect(),
            mean_plane: geometry.mean_plane(),
            highest: geometry.z_range()[1],
        }
    }

    /// Height of the highest point.
    fn highest(&self) -> f64 {
        (self.highest - self.mean_plane) * self.unit
    }

    fn in_tile(&self, p: DVec3) -> DVec3 {
        let p = p / self.unit;
        DVec3::new(p.x, p.y * self.aspect, p.z + self.mean_plane)
    }

    /// Where a straight line meets the mean plane; `origin` in tile coordinates, the rest in the world.
    fn on_mean_plane(&self, origin: DVec3, direction: DVec3) -> DVec2 {
        let back = (origin.z - self.mean_plane) / direction.z;
        let there = DVec2::new(origin.x, origin.y / self.aspect) - back * direction.truncate();
        there * self.unit
    }
}

#[cfg(test)]
mod tests;
