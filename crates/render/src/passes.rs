//! Passes: a picture is made in passes over all rows; its means and errors.

use asperity_io::Picture;
use asperity_optics::Material;
use asperity_simulate::{Observer, StoppedBy};
use asperity_tally::BatchStatistics;
use asperity_tracer::{Geometry, LightBeams};
use glam::DVec3;
use rayon::prelude::*;

use crate::scene::{Losses, Row, SEQUENCES, Sample, Scene};
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

    /// Adds a pass: the rows of all sequences.
    fn add_pass(&mut self, sequences: Vec<Vec<Row>>) {
        let add = |sums: &mut [f64], values: &[f64]| {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        };
        let columns = self.size[0];
        for (rows, radiance) in sequences.into_iter().zip(&mut self.radiance) {
            let sums = radiance.chunks_exact_mut(columns);
            let sums = sums.zip(self.coverage.chunks_exact_mut(columns));
            for (row, (radiance, coverage)) in rows.into_iter().zip(sums) {
                add(radiance, &row.radiance);
                add(coverage, &row.coverage);
                self.losses.add(&row.losses);
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
    let mut film = Film::new(settings.size);
    let total = passes.saturating_mul(SEQUENCES * rows as u64);
    progress.begin("rendering", total);
    for pass in 0..passes {
        let stops = || match progress.stop() {
            Some(StoppedBy::Interrupt) => true,
            Some(_) => pass > 0 || progress.gives_up_first(),
            None => false,
        };
        let in_sequence = |sequence| {
            let sample = Sample {
                seed: settings.seed,
                sequence,
                number: pass,
            };
            let sunlight = settings.lights.sun().map(|sun| {
                let sunlight = sun.sunlight();
                match &mut beams {
                    Some(beams) => {
                        let number = pass.wrapping_mul(SEQUENCES).wrapping_add(sequence);
                        let numbers = shared_numbers(settings.seed, number);
                        sunlight.with_beams(beams.geometry, beams.aimed(sun.point(numbers)))
                    }
                    None => sunlight,
                }
            });
            (0..rows)
                .into_par_iter()
                .with_max_len(1)
                .map(|row| {
                    if stops() {
                        return None;
                    }
                    let row = scene.row(row, &sample, sunlight.as_ref());
                    progress.advance(1);
                    Some(row)
                })
                .collect()
        };
        let done: Option<Vec<Vec<Row>>> = (0..SEQUENCES).map(in_sequence).collect();
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
