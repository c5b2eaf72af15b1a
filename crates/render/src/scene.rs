//! Scene: follows the camera rays of one row of a picture.

use asperity_tracer::{
    BeamContribution, CameraContribution, Geometry, LightBeams, PathEnd, PathIntegrator, PathResult,
};
use rand::{Rng, RngExt};

use crate::lights::Lights;
use crate::spread::spread;
use crate::tile_frame::TileFrame;
use crate::view::{Camera, CameraRay};

/// One row of one pass.
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
    /// Follows `samples` camera rays through each pixel of a row.
    pub(crate) fn row<R: Rng>(
        &self,
        row: usize,
        samples: u64,
        beams: Option<&LightBeams<G>>,
        rng: &mut R,
    ) -> Row {
        let columns = self.size[0];
        let mut out = Row {
            radiance: Vec::with_capacity(columns),
            coverage: Vec::with_capacity(columns),
            losses: Losses::default(),
        };
        for column in 0..columns {
            let shift = [rng.random::<f64>(), rng.random::<f64>()];
            let (mut radiance, mut hits) = (0.0, 0_u64);
            for sample in 0..samples {
                let ray = self.camera_ray([column, row], spread(sample, shift));
                let mut hit = false;
                self.integrator.trace_camera_ray(
                    ray.origin,
                    ray.direction,
                    beams,
                    rng,
                    |contribution| match contribution {
                        CameraContribution::Path(path) => {
                            hit |= path.path.order() > 0;
                            radiance += self.radiance(&path, &mut out.losses);
                        }
                        CameraContribution::Beam(lit) => radiance += self.sunlit(&lit, beams),
                    },
                );
                hits += u64::from(hit);
            }
            out.radiance.push(radiance / samples as f64);
            out.coverage.push(hits as f64 / samples as f64);
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

    /// Radiance from sunlight that a light beam brings to a point of the medium.
    fn sunlit(&self, lit: &BeamContribution, beams: Option<&LightBeams<G>>) -> f64 {
        let (Some(sun), Some(beams)) = (self.lights.sun(), beams) else {
            return 0.0;
        };
        let place = self.frame.on_mean_plane(lit.origin, beams.towards());
        lit.fraction * sun.collimated(place)
    }

    /// Radiance along a path, by where it ends.
    fn radiance(&self, path: &PathResult, losses: &mut Losses) -> f64 {
        let radiance = match path.end {
            PathEnd::Above if path.sampled_by_beams => self.lights.sky(path.direction),
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
