//! Passes: a picture is made in passes over all rows; its means and errors.

use asperity_io::Picture;
use asperity_optics::Material;
use asperity_simulate::{Observer, StoppedBy};
use asperity_tally::BatchStatistics;
use asperity_tracer::{Geometry, LightBeams, Sunlight};
use glam::DVec3;
use rayon::prelude::*;

use crate::lights::Sun;
use crate::scene::{Losses, SEQUENCES, Sample, Scene, Strip};
use crate::sequence::shared_numbers;
use crate::settings::RenderSettings;

/// The passes that were completed.
pub(crate) struct Film {
    size: [usize; 2],
    pub(crate) passes: u64,
    /// Sums over passes, by sequence.
    radiance: [Vec<f64>; SEQUENCES as usize],
    /// Sums over passes and sequences.
    coverage: Vec<f64>,
    pub(crate) losses: Losses,
}

impl Film {
    fn new(size: [usize; 2]) -> Self {
        let dark = vec![0.0; size[0] * size[1]];
        Self {
            size,
            passes: 0,
            radiance: [(); SEQUENCES as usize].map(|()| dark.clone()),
            coverage: dark,
            losses: Losses::default(),
        }
    }

    /// Adds a pass: the strips of all sequences, from the first row to the last.
    fn add_pass(&mut self, sequences: Vec<Vec<Strip>>) {
        let add = |sums: &mut [f64], values: &[f64]| {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        };
        for (strips, radiance) in sequences.into_iter().zip(&mut self.radiance) {
            let mut first = 0;
            for strip in strips {
                add(&mut radiance[first..], &strip.radiance);
                add(&mut self.coverage[first..], &strip.coverage);
                self.losses.add(&strip.losses);
                first += strip.radiance.len();
            }
        }
        self.passes += 1;
    }

    /// The mean over sequences, with its standard error.
    pub(crate) fn develop(mut self) -> Picture {
        let passes = self.passes as f64;
        let all = passes * SEQUENCES as f64;
        self.coverage.iter_mut().for_each(|c| *c /= all);
        let mut statistics = BatchStatistics::new(self.coverage.len());
        for mut radiance in self.radiance {
            radiance.iter_mut().for_each(|value| *value /= passes);
            statistics.push(&radiance);
        }
        Picture {
            size: self.size,
            radiance: statistics.means().to_vec(),
            error: statistics.error_squares().map(f64::sqrt).collect(),
            coverage: self.coverage,
            colour: None,
        }
    }
}

/// Makes passes, of one sample per pixel in each sequence, until the run is to stop.
pub(crate) fn expose<G: Geometry>(
    scene: &Scene<'_, G>,
    mut beams: Option<AimedBeams<'_, G>>,
    passes: u64,
    settings: &RenderSettings,
    progress: &dyn Observer,
) -> Film {
    let rows = settings.size[1];
    let height = scene.rows_of_strip();
    let mut film = Film::new(settings.size);
    let total = passes.saturating_mul(SEQUENCES * rows as u64);
    progress.begin("rendering", total);
    for pass in 0..passes {
        let stops = || match progress.stop() {
            Some(StoppedBy::Interrupt) => true,
            Some(_) => pass > 0 || progress.gives_up_first(),
            None => false,
        };
        let samples = (0..SEQUENCES).map(|sequence| Sample {
            seed: settings.seed,
            sequence,
            number: pass,
        });
        let samples: Vec<Sample> = samples.collect();
        let follow = |sample: &Sample, sunlight: Option<&Sunlight<'_, G>>| {
            let strips = (0..rows.div_ceil(height)).into_par_iter().with_max_len(1);
            let strips = strips.map(|strip| {
                if stops() {
                    return None;
                }
                let rows = strip * height..rows.min((strip + 1) * height);
                let done = rows.len() as u64;
                let strip = scene.strip(rows, sample, sunlight);
                progress.advance(done);
                Some(strip)
            });
            strips.collect::<Option<Vec<Strip>>>()
        };
        let sun = settings.lights.sun();
        let done: Option<Vec<_>> = match (sun, &mut beams) {
            (Some(sun), Some(beams)) => {
                let geometry = beams.geometry;
                let followed = samples.iter().map(|sample| {
                    let numbers = shared_numbers(settings.seed, sample.stream());
                    let aimed = beams.aimed(sun.point(numbers));
                    follow(sample, Some(&sun.sunlight().with_beams(geometry, aimed)))
                });
                followed.collect()
            }
            _ => {
                let sunlight = sun.map(Sun::sunlight);
                let followed = samples.par_iter();
                followed
                    .map(|sample| follow(sample, sunlight.as_ref()))
                    .collect()
            }
        };
        let Some(done) = done else { break };
        film.add_pass(done);
    }
    progress.end();
    film
}

/// Makes the beams of light on a geometry of a material from a direction; of facets alone, which are flat.
pub(crate) type BeginBeams<G> = fn(&G, Material, DVec3) -> LightBeams<G>;

/// Light beams below a surface, aimed at one direction of the sun after the other.
pub(crate) struct AimedBeams<'a, G: Geometry> {
    pub(crate) geometry: &'a G,
    pub(crate) begin: BeginBeams<G>,
    pub(crate) material: Material,
    pub(crate) beams: Option<LightBeams<G>>,
}

impl<G: Geometry> AimedBeams<'_, G> {
    /// The beams from the direction `towards`.
    fn aimed(&mut self, towards: DVec3) -> &LightBeams<G> {
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
