//! Passes: makes a picture in passes over all rows, and collects their mean and error.

use asperity_io::Picture;
use asperity_optics::Material;
use asperity_simulate::{Observer, StoppedBy, picture_stream};
use asperity_tally::BatchStatistics;
use asperity_tracer::{Geometry, LightBeams};
use glam::DVec3;
use rand::RngExt;
use rayon::prelude::*;

use crate::lights::Sun;
use crate::scene::{Losses, Row, Scene};
use crate::settings::RenderSettings;
use crate::spread::spread;

/// Passes, if there are as many samples: enough for errors, few enough to spread rays evenly in each.
const PASSES: u64 = 16;

/// Most samples per pixel of a pass: more samples take more passes, so that each is soon complete.
const MAX_SAMPLES_PER_PASS: u64 = 4;

/// Passes that are completed even after the time limit, if they soon are: fewer give no error.
const MIN_PASSES: u64 = 2;

/// Division of the samples into passes.
#[derive(Clone, Copy)]
pub(crate) struct PassPlan {
    pub(crate) passes: u64,
    /// Samples per pixel of each pass.
    pub(crate) samples: u64,
}

impl PassPlan {
    /// The plan for at least `samples` per pixel.
    pub(crate) fn new(samples: u64) -> Self {
        let passes = samples.clamp(MIN_PASSES, PASSES);
        let passes = passes.max(samples.div_ceil(MAX_SAMPLES_PER_PASS));
        Self {
            passes,
            samples: samples.div_ceil(passes),
        }
    }
}

/// The passes that were completed.
pub(crate) struct Film {
    size: [usize; 2],
    radiance: BatchStatistics,
    /// Sums over passes.
    coverage: Vec<f64>,
    pub(crate) losses: Losses,
}

impl Film {
    fn new(size: [usize; 2]) -> Self {
        let pixels = size[0] * size[1];
        Self {
            size,
            radiance: BatchStatistics::new(pixels),
            coverage: vec![0.0; pixels],
            losses: Losses::default(),
        }
    }

    fn add_pass(&mut self, rows: Vec<Row>) {
        let columns = self.size[0];
        let mut values = Vec::with_capacity(self.coverage.len());
        for (row, coverage) in rows
            .into_iter()
            .zip(self.coverage.chunks_exact_mut(columns))
        {
            for (all, here) in coverage.iter_mut().zip(&row.coverage) {
                *all += here;
            }
            values.extend(row.radiance);
            self.losses.add(&row.losses);
        }
        self.radiance.push(&values);
    }

    /// Passes that were completed.
    pub(crate) fn passes(&self) -> u64 {
        self.radiance.batches()
    }

    /// The mean over passes, with its standard error, which is NaN for a single pass.
    pub(crate) fn develop(mut self) -> Picture {
        let passes = self.passes() as f64;
        self.coverage.iter_mut().for_each(|c| *c /= passes);
        Picture {
            size: self.size,
            radiance: self.radiance.means().to_vec(),
            error: self.radiance.error_squares().map(f64::sqrt).collect(),
            coverage: self.coverage,
            colour: None,
        }
    }
}

/// Makes passes until the plan is complete, or the run is to stop.
pub(crate) fn expose<G: Geometry>(
    scene: &Scene<'_, G>,
    sunlight: Option<SunlightInMedium<'_, G>>,
    plan: PassPlan,
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Film {
    let rows = settings.size[1];
    let mut film = Film::new(settings.size);
    let mut sunlight = sunlight;
    progress.begin("rendering", plan.passes.saturating_mul(rows as u64));
    for pass in 0..plan.passes {
        let beams = sunlight.as_mut().map(|sunlight| sunlight.aimed(pass));
        let stops = || match progress.stop() {
            Some(StoppedBy::Interrupt) => true,
            other => {
                let is_enough = pass >= MIN_PASSES || pass > 0 && progress.gives_up();
                other.is_some() && (is_enough || progress.gives_up_first())
            }
        };
        let done: Option<Vec<Row>> = (0..rows)
            .into_par_iter()
            .with_max_len(1)
            .map(|row| {
                if stops() {
                    return None;
                }
                let mut rng = picture_stream(settings.seed, pass, row as u64);
                let row = scene.row(row, plan.samples, beams, &mut rng);
                progress.advance(1);
                Some(row)
            })
            .collect();
        let Some(done) = done else { break };
        film.add_pass(done);
    }
    progress.end();
    film
}

/// Makes the beams of light on a geometry of a material from a direction; of facets alone, which are flat.
pub(crate) type BeginBeams<G> = fn(&G, Material, DVec3) -> LightBeams<G>;

/// Sunlight inside a medium: light beams from one direction of the sun's disc per pass.
pub(crate) struct SunlightInMedium<'a, G: Geometry> {
    geometry: &'a G,
    begin: BeginBeams<G>,
    material: Material,
    sun: Sun,
    shift: [f64; 2],
    beams: Option<LightBeams<G>>,
}

impl<'a, G: Geometry> SunlightInMedium<'a, G> {
    pub(crate) fn new(
        geometry: &'a G,
        begin: BeginBeams<G>,
        (material, sun): (Material, Sun),
        seed: u64,
        plan: PassPlan,
    ) -> Self {
        let mut rng = picture_stream(seed, plan.passes, 0);
        Self {
            geometry,
            begin,
            material,
            sun,
            shift: [rng.random::<f64>(), rng.random::<f64>()],
            beams: None,
        }
    }

    /// The beams of a pass.
    fn aimed(&mut self, pass: u64) -> &LightBeams<G> {
        let towards = self.sun.point(spread(pass, self.shift));
        let beams = match self.beams.take() {
            Some(mut beams) => {
                beams.aim(self.geometry, towards);
                beams
            }
            None => (self.begin)(self.geometry, self.material, towards),
        };
        self.beams.insert(beams)
    }
}
