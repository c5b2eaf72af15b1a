//! Frame: the axes of a ray to which its Stokes vector refers, and turns of them about the ray.

use glam::DVec3;

/// Square of the horizontal part of a unit direction below which the direction counts as vertical: fourth powers
/// of that part, which turns are made of, stay normal numbers above it.
const VERTICAL: f64 = 1e-150;

/// Square of the sine of the angle of incidence below which the plane of incidence is lost in rounding.
const NORMAL_INCIDENCE: f64 = 1e-30;

/// The horizontal part of `k` that decides its axes: `(1, 0)` for a vertical ray.
#[inline(always)]
fn heading(k: DVec3) -> [f64; 2] {
    let is_vertical = k.x * k.x + k.y * k.y < VERTICAL;
    [
        if is_vertical { 1.0 } else { k.x },
        if is_vertical { 0.0 } else { k.y },
    ]
}

/// The unit axes s and p of a ray along the unit vector `k`: `s = z x k / |z x k|`, `p = k x s`.
///
/// A vertical ray, one whose horizontal part is shorter than 1e-75, has `s = +y`.
///
/// # Examples
/// ```
/// use asperity_optics::reference_axes;
/// use glam::DVec3;
///
/// // Light that falls obliquely and travels towards +x: s is horizontal, p is in the vertical plane.
/// let [s, p] = reference_axes(DVec3::new(0.6, 0.0, -0.8));
/// assert!((s - DVec3::Y).length() < 1e-15);
/// assert!((p - DVec3::new(0.8, 0.0, 0.6)).length() < 1e-15);
/// assert_eq!(reference_axes(DVec3::NEG_Z), [DVec3::Y, DVec3::X]);
/// ```
#[must_use]
#[inline]
pub fn reference_axes(k: DVec3) -> [DVec3; 2] {
    let [x, y] = heading(k);
    let inverse = 1.0 / (x * x + y * y).sqrt();
    let s = DVec3::new(-y * inverse, x * inverse, 0.0);
    // k x s, without the third component of s. Each term keeps its relative accuracy, at any angle.
    let p = DVec3::new(-k.z * s.y, k.z * s.x, k.x * s.y - k.y * s.x);
    [s, p]
}

/// A vector along the normal of the plane of incidence, which is the s axis of the facet for all rays that
/// meet and leave it: `k x m`, not of unit length.
///
/// `k`: unit direction of the incident ray; `m`: unit normal of the facet, on either side. At normal incidence, where
/// any axis will do, it is along the s axis of the ray. The sign has no effect on a [`Turn`].
#[must_use]
#[inline(always)]
pub fn incidence_axis(k: DVec3, m: DVec3) -> DVec3 {
    let axis = k.cross(m);
    let [x, y] = heading(k);
    let is_normal = axis.length_squared() < NORMAL_INCIDENCE;
    DVec3::new(
        if is_normal { -y } else { axis.x },
        if is_normal { x } else { axis.y },
        if is_normal { 0.0 } else { axis.z },
    )
}

/// A turn of the reference axes about a ray by the angle psi, counter-clockwise when looking against the ray: s towards p.
///
/// It is kept as the cosine and the sine of `2 psi`, all that Stokes vectors need, and found without
/// trigonometric functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// `cos(2 psi)`.
    pub cos_2psi: f64,
    /// `sin(2 psi)`.
    pub sin_2psi: f64,
}

impl Turn {
    /// No turn.
    pub const NONE: Self = Self {
        cos_2psi: 1.0,
        sin_2psi: 0.0,
    };

    /// The turn that takes s of [`reference_axes`] of a ray along the unit vector `k` to `axis`.
    ///
    /// `axis`: of any length that is not tiny, across the ray; a part along the ray, such as rounding leaves, does not
    /// count. An axis along the ray gives no turn. The error is that of rounding in `axis`, near the pole and at grazing alike.
    #[must_use]
    #[inline(always)]
    pub fn to_axis(k: DVec3, axis: DVec3) -> Self {
        let [x, y] = heading(k);
        // Project the axis on s and p, both times |z x k|.
        let along_s = x * axis.y - y * axis.x;
        let along_p = (k.x * x + k.y * y) * axis.z - k.z * (x * axis.x + y * axis.y);
        // Double the angle.
        let (s_squared, p_squared) = (along_s * along_s, along_p * along_p);
        let sum = s_squared + p_squared;
        let is_defined = sum > 0.0;
        let inverse = 1.0 / if is_defined { sum } else { 1.0 };
        Self {
            cos_2psi: if is_defined {
                (s_squared - p_squared) * inverse
            } else {
                1.0
            },
            sin_2psi: 2.0 * along_s * along_p * inverse,
        }
    }

    /// The turn back.
    #[must_use]
    #[inline(always)]
    pub const fn inverse(self) -> Self {
        Self {
            cos_2psi: self.cos_2psi,
            sin_2psi: -self.sin_2psi,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::{from_spherical, reflect};

    /// Directions over the sphere, next to the poles, at grazing and exactly vertical.
    fn directions() -> Vec<DVec3> {
        let thetas = [
            0.0,
            1e-80,
            1e-40,
            1e-9,
            0.3,
            1.2,
            FRAC_PI_2 - 3e-7,
            1.6,
            3.0,
            PI - 5e-8,
        ];
        let mut all = vec![DVec3::NEG_Z];
        for theta in thetas {
            for phi in [0.0, 0.7, 2.0, 4.0] {
                all.push(from_spherical(theta, phi));
            }
        }
        all
    }

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        for k in directions() {
            let [s, p] = reference_axes(k);
            assert!((s.length() - 1.0).abs() < 1e-15 && (p.length() - 1.0).abs() < 1e-15);
            assert!((s.cross(p) - k).length() < 1e-15, "{k}");
            assert_eq!(s.z, 0.0);
        }
    }

    #[test]
    fn s_is_across_the_vertical_plane_and_y_at_the_pole() {
        for k in directions() {
            let across = DVec3::Z.cross(k);
            if k.x == 0.0 && k.y == 0.0 {
                assert_eq!(reference_axes(k)[0], DVec3::Y);
                assert_eq!(reference_axes(k)[1], DVec3::X * -k.z);
            } else if across.length() > 1e-75 {
                assert!(
                    (reference_axes(k)[0] - across.normalize()).length() < 1e-15,
                    "{k}"
                );
            }
        }
    }

    #[test]
    fn turns_are_those_of_the_angle() {
        for k in directions() {
            let [s, p] = reference_axes(k);
            for i in 0..64 {
                let psi = 0.1 * f64::from(i);
                // The length, the sign and a part along the ray have no effect.
                let axis = (psi.cos() * s + psi.sin() * p) * -3.0 + 0.5 * k;
                let turn = Turn::to_axis(k, axis);
                assert!(
                    (turn.cos_2psi - (2.0 * psi).cos()).abs() < 4e-15,
                    "{k} {psi}"
                );
                assert!(
                    (turn.sin_2psi - (2.0 * psi).sin()).abs() < 4e-15,
                    "{k} {psi}"
                );
                assert_eq!(turn.inverse().inverse(), turn);
            }
        }
    }

    #[test]
    fn an_axis_along_the_ray_gives_no_turn() {
        assert_eq!(Turn::to_axis(DVec3::X, DVec3::X), Turn::NONE);
        assert_eq!(Turn::to_axis(DVec3::Z, DVec3::Z), Turn::NONE);
    }

    #[test]
    fn the_axis_of_a_facet_is_across_both_rays() {
        for k in directions() {
            for m in directions() {
                let axis = incidence_axis(k, m);
                let k_out = -reflect(k, m);
                assert!(axis.length() > 1e-75);
                // Rounding of k and m, over the sine of the angle of incidence.
                let tolerance = 1e-15 / axis.length().min(1.0);
                if k.cross(m).length() > 1e-14 {
                    let [along_k, along_out] = [k, k_out].map(|k| axis.normalize().dot(k).abs());
                    assert!(
                        along_k < tolerance && along_out < 4.0 * tolerance,
                        "{k} {m}"
                    );
                }
            }
        }
    }

    #[test]
    fn at_normal_incidence_the_axis_is_that_of_the_ray() {
        for k in directions() {
            for m in [k, -k, -(k + DVec3::splat(1e-17)).normalize()] {
                let turn = Turn::to_axis(k, incidence_axis(k, m));
                assert_eq!(turn.sin_2psi, 0.0, "{k} {m}");
                assert!((turn.cos_2psi - 1.0).abs() < 4e-16, "{k} {m}");
            }
        }
    }
}
