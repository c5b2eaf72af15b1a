//! Scene: follows the camera rays of some rows of a picture.

use std::ops::Range;

use asperity_simulate::picture_stream;
use asperity_tally::Side;
use asperity_tracer::{
    CameraContribution, Geometry, Heading, PathEnd, PathIntegrator, PathResult, PathStream,
    SunContribution, Sunlight, Tracer,
};
use glam::DVec2;
use rand::{Rng, RngExt};

use crate::lights::Lights;
use crate::sequence::{SampleNumbers, scrambles};
use crate::tile_frame::TileFrame;
use crate::view::{Camera, CameraRay};

/// Independent sequences of samples, whose scatter gives the errors.
pub(crate) const SEQUENCES: u64 = 4;

/// Camera rays that are followed together, unless a row has more.
const RAYS_AT_ONCE: usize = 4096;

/// Sample of all pixels.
pub(crate) struct Sample {
    pub(crate) seed: u64,
    /// Number of its sequence, below [`SEQUENCES`].
    pub(crate) sequence: u64,
    /// Number in the sequence.
    pub(crate) number: u64,
}

impl Sample {
    /// Number of its random numbers, among those of all samples.
    pub(crate) const fn stream(&self) -> u64 {
        self.number
            .wrapping_mul(SEQUENCES)
            .wrapping_add(self.sequence)
    }

    /// Random numbers of a row that are not spread evenly.
    fn generator(&self, row: usize) -> impl Rng + use<> {
        picture_stream(self.seed, self.stream(), row as u64)
    }
}

/// Some rows of one pass in one sequence.
pub(crate) struct Strip {
    /// By pixel, row by row.
    pub(crate) radiance: Vec<f64>,
    pub(crate) coverage: Vec<f64>,
    pub(crate) losses: Losses,
}

/// Light whose path ended before it reached a source, in camera rays.
#[derive(Clone, Copy, Default)]
pub(crate) struct Losses {
    pub(crate) truncated: f64,
    pub(crate) left_patch: f64,
    pub(crate) lost: f64,
}

impl Losses {
    pub(crate) fn add(&mut self, other: &Self) {
        self.truncated += other.truncated;
        self.left_patch += other.left_patch;
        self.lost += other.lost;
    }
}

/// Scene of a picture, shared by all of its rows.
pub(crate) struct Scene<'a, G: Geometry> {
    pub(crate) camera: Camera,
    pub(crate) lights: Lights,
    pub(crate) integrator: PathIntegrator<'a, G>,
    /// Follows camera rays where no path is connected to the sun.
    pub(crate) tracer: Option<Tracer<'a, G>>,
    pub(crate) frame: TileFrame,
    /// Columns and rows.
    pub(crate) size: [usize; 2],
}

impl<G: Geometry> Scene<'_, G> {
    /// Rows that are followed in one call of [`Scene::strip`]: as many as keep the lanes of a tracer full.
    pub(crate) fn rows_of_strip(&self) -> usize {
        match &self.tracer {
            Some(_) => (RAYS_AT_ONCE / self.size[0]).max(1),
            None => 1,
        }
    }

    /// Follows a camera ray through each pixel of some rows.
    pub(crate) fn strip(
        &self,
        rows: Range<usize>,
        sample: &Sample,
        sunlight: Option<&Sunlight<'_, G>>,
    ) -> Strip {
        match &self.tracer {
            Some(tracer) => self.strip_at_once(tracer, rows, sample),
            None => self.strip_one_by_one(rows, sample, sunlight),
        }
    }

    /// Follows all camera rays of some rows together.
    fn strip_at_once(&self, tracer: &Tracer<'_, G>, rows: Range<usize>, sample: &Sample) -> Strip {
        let columns = self.size[0];
        let mut rays = Vec::with_capacity(rows.len() * columns);
        for row in rows.clone() {
            self.for_each_ray((row, sample.generator(row)), sample, |ray, _| {
                rays.push(Heading {
                    origin: ray.origin,
                    direction: ray.direction,
                    mirrored: [false; 2],
                });
            });
        }
        let first = (rows.start * columns) as u64;
        let stream = PathStream::new(sample.seed, sample.stream()).from_path(first);
        let mut radiance = vec![0.0; rays.len()];
        let found = tracer.given_rays(&rays, stream, |ray, exit| {
            let light = match exit.side {
                Side::Reflected => self.lights.above(exit.wo, || DVec2::ZERO),
                Side::Transmitted => self.lights.below(),
            };
            radiance[ray as usize] += exit.flux * light;
        });
        Strip {
            radiance,
            coverage: found.met.into_iter().map(f64::from).collect(),
            losses: Losses {
                truncated: found.truncated,
                left_patch: found.left_patch,
                lost: found.lost,
            },
        }
    }

    /// Follows camera rays of some rows one after the other.
    fn strip_one_by_one(
        &self,
        rows: Range<usize>,
        sample: &Sample,
        sunlight: Option<&Sunlight<'_, G>>,
    ) -> Strip {
        let pixels = rows.len() * self.size[0];
        let mut out = Strip {
            radiance: Vec::with_capacity(pixels),
            coverage: Vec::with_capacity(pixels),
            losses: Losses::default(),
        };
        for row in rows {
            self.for_each_ray((row, sample.generator(row)), sample, |ray, numbers| {
                let (mut radiance, mut is_hit) = (0.0, false);
                self.integrator.trace_camera_ray(
                    ray.origin,
                    ray.direction,
                    sunlight,
                    numbers,
                    |contribution| match contribution {
                        CameraContribution::Path(path) => {
                            is_hit |= path.path.order() > 0;
                            radiance += self.radiance(&path, &mut out.losses);
                        }
                        CameraContribution::Sun(lit) => radiance += self.sunlit(&lit),
                    },
                );
                out.radiance.push(radiance);
                out.coverage.push(f64::from(u8::from(is_hit)));
            });
        }
        out
    }

    /// Makes a ray through each pixel of a row, with the random numbers of its path.
    fn for_each_ray<R: Rng>(
        &self,
        (row, mut rng): (usize, R),
        sample: &Sample,
        mut follow: impl FnMut(CameraRay, &mut SampleNumbers<'_, R>),
    ) {
        let columns = self.size[0];
        let scrambles = scrambles(sample.seed, sample.sequence, row);
        for (column, scramble) in (0..columns).zip(scrambles) {
            let mut numbers = SampleNumbers::new(sample.number, scramble, &mut rng);
            let place = [numbers.random(), numbers.random()];
            follow(self.camera_ray([column, row], place), &mut numbers);
        }
    }

    /// The ray through the point `[u, v]` of a pixel, its origin in tile coordinates.
    fn camera_ray(&self, [column, row]: [usize; 2], [u, v]: [f64; 2]) -> CameraRay {
        let [columns, rows] = self.size;
        let ray = self.camera.ray([
            (column as f64 + u) / columns as f64,
            (row as f64 + v) / rows as f64,
        ]);
        CameraRay {
            origin: self.frame.in_tile(ray.origin),
            ..ray
        }
    }

    /// Radiance of sunlight that is scattered into a path.
    fn sunlit(&self, lit: &SunContribution) -> f64 {
        let place = self.frame.on_mean_plane(lit.origin, lit.towards);
        let sun = self.lights.sun();
        lit.fraction * sun.map_or(0.0, |sun| sun.collimated(place))
    }

    /// Radiance along a path, by where it ends.
    fn radiance(&self, path: &PathResult, losses: &mut Losses) -> f64 {
        let radiance = match path.end {
            PathEnd::Above if path.has_connected_sun => self.lights.sky(path.direction),
            PathEnd::Above => {
                let place = || self.frame.on_mean_plane(path.origin, path.direction);
                self.lights.above(path.direction, place)
            }
            PathEnd::Below => self.lights.below(),
            PathEnd::Absorbed => 0.0,
            PathEnd::Truncated => {
                losses.truncated += path.flux;
                0.0
            }
            PathEnd::LeftPatch => {
                // What misses the surface is background
                if path.path.order() > 0 {
                    losses.left_patch += path.flux;
                }
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
