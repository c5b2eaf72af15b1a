//! Cameras: the ray through each point of a picture.

use std::f64::consts::PI;

use asperity_numerics::elementary::{sin_cos, tan};
use asperity_optics::{Incidence, horizontal};
use asperity_surface::{Length, LengthUnit};
use glam::{DVec2, DVec3};

/// Projection of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays are parallel.
    Orthographic,
    /// All rays start at the eye.
    Pinhole {
        /// Vertical field of view, radians.
        field_of_view: f64,
    },
}

/// A camera that looks at a point of the mean plane.
///
/// Up in the picture is the direction of decreasing theta, towards +z. At theta 0 the limit counts: with phi 270
/// degrees x points to the right and y upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    projection: Projection,
    towards: Incidence,
    target: DVec2,
    width: f64,
    /// Unit of the lengths in errors.
    unit: LengthUnit,
}

/// Error of an invalid view.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// The field of view is invalid.
    #[error("the field of view is {0} deg; it must be above 0 and below 180 deg")]
    BadFieldOfView(f64),
    /// The width is invalid.
    #[error("the width of the view is {0:?}; it must be a length above zero")]
    BadWidth(f64),
    /// The eye is in the surface, or below it.
    #[error(
        "the eye is {height} above the mean plane, but the surface rises to {highest}: take a wider view, a smaller field of view, or a smaller theta"
    )]
    EyeTooLow {
        /// Height of the eye.
        height: Length,
        /// Height of the highest point.
        highest: Length,
    },
}

impl View {
    /// A camera in the direction `towards` from the point `target` of the mean plane.
    ///
    /// `width`: of the visible part of the plane through the target that is parallel to the picture, in length
    /// units of the surface as `target` is; it decides how far away a pinhole is.
    ///
    /// # Errors
    /// [`ViewError`] unless `0 < width <= 1e150` and `0 < field_of_view < pi`.
    pub fn new(
        projection: Projection,
        towards: Incidence,
        target: [f64; 2],
        width: f64,
    ) -> Result<Self, ViewError> {
        if let Projection::Pinhole { field_of_view } = projection
            && !(field_of_view > 0.0 && field_of_view < PI)
        {
            return Err(ViewError::BadFieldOfView(field_of_view.to_degrees()));
        }
        if !(width > 0.0 && width <= 1e150) {
            return Err(ViewError::BadWidth(width));
        }
        Ok(Self {
            projection,
            towards,
            target: DVec2::from_array(target),
            width,
            unit: LengthUnit::Arbitrary,
        })
    }

    /// A view with its lengths in `unit`, which errors name.
    #[must_use]
    pub const fn in_unit(self, unit: LengthUnit) -> Self {
        Self { unit, ..self }
    }

    /// Polar angle of the rays, radians, if all are parallel.
    pub(crate) fn parallel_theta(&self) -> Option<f64> {
        (self.projection == Projection::Orthographic).then(|| self.towards.theta())
    }

    /// The camera of a picture of the given columns and rows, over a surface that rises to `highest` above its mean
    /// plane.
    ///
    /// # Errors
    /// [`ViewError::EyeTooLow`] if a pinhole is not above that.
    pub(crate) fn camera(
        &self,
        [columns, rows]: [usize; 2],
        highest: f64,
    ) -> Result<Camera, ViewError> {
        let back = self.towards.wi();
        // The derivative of the direction by theta, turned about, which has a limit at the pole.
        let (sin, cos) = sin_cos(self.towards.theta());
        let level = horizontal(self.towards.phi());
        let up = (-cos * level).extend(sin);
        let right = up.cross(back);
        let half_width = 0.5 * self.width;
        let half_height = half_width * rows as f64 / columns as f64;
        let eye = match self.projection {
            Projection::Orthographic => None,
            Projection::Pinhole { field_of_view } => {
                let distance = half_height / tan(0.5 * field_of_view);
                let eye = self.target.extend(0.0) + distance * back;
                if eye.z.partial_cmp(&highest) != Some(std::cmp::Ordering::Greater) {
                    let [height, highest] = [eye.z, highest].map(|value| Length {
                        value,
                        unit: self.unit,
                    });
                    return Err(ViewError::EyeTooLow { height, highest });
                }
                Some(eye)
            }
        };
        Ok(Camera {
            back,
            right: half_width * right,
            up: half_height * up,
            target: self.target.extend(0.0),
            eye,
            highest,
        })
    }
}

/// A [`View`] with the frame of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    /// Unit vector from the target to the camera.
    back: DVec3,
    /// Vector from the middle of the picture to its right edge, in the plane through the target.
    right: DVec3,
    /// Vector to its upper edge.
    up: DVec3,
    target: DVec3,
    eye: Option<DVec3>,
    highest: f64,
}

impl Camera {
    /// The ray through the point `[u, v]` of the picture, from the left and from the top, both within `[0, 1]`.
    pub(crate) fn ray(&self, [u, v]: [f64; 2]) -> CameraRay {
        let point = self.target + (2.0 * u - 1.0) * self.right + (1.0 - 2.0 * v) * self.up;
        match self.eye {
            Some(eye) => CameraRay {
                origin: eye,
                direction: (point - eye).normalize(),
            },
            None => {
                let back = (self.highest - point.z) / self.back.z;
                CameraRay {
                    origin: point + back * self.back,
                    direction: -self.back,
                }
            }
        }
    }
}

/// A ray that starts at a camera, above the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CameraRay {
    pub(crate) origin: DVec3,
    /// Unit vector away from the camera.
    pub(crate) direction: DVec3,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(projection: Projection, theta: f64) -> View {
        let towards = Incidence::from_degrees(theta, 270.0).unwrap();
        View::new(projection, towards, [3.0, 5.0], 8.0).unwrap()
    }

    const PINHOLE: Projection = Projection::Pinhole { field_of_view: 0.8 };

    /// Point where a ray meets the mean plane.
    fn footprint(ray: CameraRay) -> DVec2 {
        (ray.origin - ray.direction * (ray.origin.z / ray.direction.z)).truncate()
    }

    #[test]
    fn both_cameras_see_the_target_in_the_middle_and_its_width_across() {
        for projection in [Projection::Orthographic, PINHOLE] {
            for theta in [0.0, 30.0, 75.0] {
                let camera = view(projection, theta).camera([200, 100], 1.0).unwrap();
                let at = |u, v| footprint(camera.ray([u, v]));
                let near = |p: DVec2, x: f64, y: f64| (p - DVec2::new(x, y)).length() < 1e-12;
                assert!(near(at(0.5, 0.5), 3.0, 5.0), "{projection:?} {theta}");
                assert!(near(at(0.0, 0.5), -1.0, 5.0) && near(at(1.0, 0.5), 7.0, 5.0));
                // Up in the picture lies behind.
                assert!(at(0.5, 0.2).y > 5.0);
            }
            // From above, half as high as wide.
            let camera = view(projection, 0.0).camera([200, 100], 1.5).unwrap();
            assert!((footprint(camera.ray([0.5, 0.0])).y - 7.0).abs() < 1e-12);
        }
    }

    #[test]
    fn rays_begin_above_the_surface_and_have_unit_length() {
        for projection in [Projection::Orthographic, PINHOLE] {
            let camera = view(projection, 60.0).camera([100, 100], 1.5).unwrap();
            for v in [0.0, 0.5, 1.0] {
                let ray = camera.ray([0.3, v]);
                assert!(ray.origin.z >= 1.5 - 1e-12, "{ray:?}");
                assert!((ray.direction.length() - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_pinhole_has_its_field_of_view() {
        let camera = view(PINHOLE, 20.0).camera([300, 100], 1.5).unwrap();
        let [top, bottom] = [0.0, 1.0].map(|v| camera.ray([0.5, v]).direction);
        assert!((top.dot(bottom).acos() - 0.8).abs() < 1e-12);
    }

    #[test]
    fn impossible_views_are_refused() {
        let towards = Incidence::from_degrees(20.0, 0.0).unwrap();
        for field_of_view in [0.0, PI, f64::NAN] {
            let pinhole = Projection::Pinhole { field_of_view };
            assert!(View::new(pinhole, towards, [0.0; 2], 1.0).is_err());
        }
        for width in [0.0, -1.0, f64::INFINITY] {
            assert!(View::new(Projection::Orthographic, towards, [0.0; 2], width).is_err());
        }
        let low = view(PINHOLE, 80.0).camera([100, 100], 3.0).unwrap_err();
        assert!(low.to_string().contains("rises to 3"), "{low}");
    }
}
