//! Scene: follows the camera rays of one row of a picture.

use asperity_simulate::picture_stream;
use asperity_tracer::{
    CameraContribution, Geometry, PathEnd, PathIntegrator, PathResult, SunContribution, Sunlight,
};
use rand::RngExt;

use crate::lights::Lights;
use crate::sequence::{SampleNumbers, scrambles};
use crate::tile_frame::TileFrame;
use crate::view::{Camera, CameraRay};

/// Independent sequences of samples, whose scatter gives the errors.
pub(crate) const SEQUENCES: u64 = 4;

/// Sample of all pixels.
pub(crate) struct Sample {
    pub(crate) seed: u64,
    /// Number of its sequence, below [`SEQUENCES`].
    pub(crate) sequence: u64,
    /// Number in the sequence.
    pub(crate) number: u64,
}

/// One row of one pass in one sequence.
pub(crate) struct Row {
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
    pub(crate) frame: TileFrame,
    /// Columns and rows.
    pub(crate) size: [usize; 2],
}

impl<G: Geometry> Scene<'_, G> {
    /// Follows a camera ray through each pixel of a row.
    pub(crate) fn row(
        &self,
        row: usize,
        sample: &Sample,
        sunlight: Option<&Sunlight<'_, G>>,
    ) -> Row {
        let columns = self.size[0];
        let mut out = Row {
            radiance: Vec::with_capacity(columns),
            coverage: Vec::with_capacity(columns),
            losses: Losses::default(),
        };
        let &Sample {
            seed,
            sequence,
            number,
        } = sample;
        let scrambles = scrambles(seed, sequence, row);
        let mut rng = picture_stream(
            seed,
            number.wrapping_mul(SEQUENCES).wrapping_add(sequence),
            row as u64,
        );
        for (column, scramble) in (0..columns).zip(scrambles) {
            let mut numbers = SampleNumbers::new(number, scramble, &mut rng);
            let place = [numbers.random(), numbers.random()];
            let ray = self.camera_ray([column, row], place);
            let (mut radiance, mut is_hit) = (0.0, false);
            self.integrator.trace_camera_ray(
                ray.origin,
                ray.direction,
                sunlight,
                &mut numbers,
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
        }
        out
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
