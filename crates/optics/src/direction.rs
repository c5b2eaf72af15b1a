//! Directions on the unit sphere and the direction of the light.

use std::f64::consts::{FRAC_PI_2, TAU};

use asperity_numerics::elementary::{atan2, hypot, sin, sin_cos, sin_cos_of_turn};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// The horizontal unit vector of an azimuth from +x, radians.
#[must_use]
pub fn horizontal(phi: f64) -> DVec2 {
    let (sin, cos) = sin_cos(phi);
    DVec2::new(cos, sin)
}

/// The unit vector of polar angle `theta` from +z and azimuth `phi` from +x, both in radians.
#[must_use]
pub fn from_spherical(theta: f64, phi: f64) -> DVec3 {
    let (sin_theta, cos_theta) = sin_cos(theta);
    let (sin_phi, cos_phi) = sin_cos(phi);
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// Polar angle from +z in `[0, pi]`; accurate near the poles and near grazing alike.
#[must_use]
pub fn polar_angle(w: DVec3) -> f64 {
    atan2(hypot(w.x, w.y), w.z)
}

/// Azimuth from +x towards +y in `[0, 2 pi)`; zero for a vertical direction.
#[must_use]
pub fn azimuth(w: DVec3) -> f64 {
    if w.x == 0.0 && w.y == 0.0 {
        return 0.0;
    }
    let phi = atan2(w.y, w.x);
    if phi < 0.0 {
        // A tiny negative angle rounds up to the full turn, which is zero.
        let wrapped = phi + TAU;
        if wrapped < TAU { wrapped } else { 0.0 }
    } else {
        phi
    }
}

/// The unit vector at the angle of cosine `mu` to the unit vector `axis`, at the azimuth `2 pi turn`
/// about it.
///
/// # Source
/// The frame is that of Duff et al. 2017, Building an Orthonormal Basis, Revisited.
#[must_use]
#[inline(always)]
pub fn around(axis: DVec3, mu: f64, turn: f64) -> DVec3 {
    let sign = 1.0_f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    let s = DVec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    let t = DVec3::new(b, sign + axis.y * axis.y * a, -axis.y);
    let [sin_phi, cos_phi] = sin_cos_of_turn(turn);
    let sin_theta = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
    let w = sin_theta * (cos_phi * s + sin_phi * t) + mu * axis;
    // Its length squared is 1 + e with e from rounding alone, which must not add up over many turns.
    w * (1.5 - 0.5 * w.length_squared())
}

/// Error of an invalid direction of incidence.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IncidenceError {
    /// The polar angle is outside `[0, 90)` degrees.
    #[error(
        "theta is {0} deg; light must come from theta >= 0 and below 90 deg (at 90 deg no flux falls on the surface)"
    )]
    BadTheta(f64),
    /// The azimuth is not finite.
    #[error("phi is {0} deg; it must be finite")]
    BadPhi(f64),
}

/// The direction of collimated light: polar angle below a right angle, any azimuth.
///
/// # Examples
/// ```
/// use asperity_optics::Incidence;
///
/// let wi = Incidence::from_degrees(60.0, 90.0)?.wi();
/// assert!((wi.z - 0.5).abs() < 1e-15 && wi.y > 0.0);
/// assert!(Incidence::from_degrees(90.0, 0.0).is_err());
/// # Ok::<(), asperity_optics::IncidenceError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Incidence {
    theta: f64,
    phi: f64,
    theta_deg: f64,
}

impl Incidence {
    /// `theta` in `[0, 90)` and `phi`, both in degrees, of the direction *towards the light*.
    ///
    /// # Errors
    /// [`IncidenceError`] outside these ranges.
    pub fn from_degrees(theta: f64, phi: f64) -> Result<Self, IncidenceError> {
        let radians = theta.to_radians();
        if !((0.0..90.0).contains(&theta) && radians < FRAC_PI_2) {
            return Err(IncidenceError::BadTheta(theta));
        }
        if !phi.is_finite() {
            return Err(IncidenceError::BadPhi(phi));
        }
        Ok(Self {
            theta: radians,
            phi: phi.rem_euclid(360.0).to_radians(),
            theta_deg: theta,
        })
    }

    /// Polar angle in radians, `[0, pi/2)`.
    #[must_use]
    pub const fn theta(self) -> f64 {
        self.theta
    }

    /// Azimuth in radians, `[0, 2 pi)`.
    #[must_use]
    pub const fn phi(self) -> f64 {
        self.phi
    }

    /// Polar angle in degrees, as it was given.
    #[must_use]
    pub const fn theta_deg(self) -> f64 {
        self.theta_deg
    }

    /// Azimuth in degrees, `[0, 360)`: of the numbers that are this angle in radians the one of few digits, such as it was given.
    #[must_use]
    pub fn phi_deg(self) -> f64 {
        let degrees = self.phi.to_degrees();
        let short = (degrees * 1e9).round() / 1e9;
        if short.to_radians() == self.phi {
            short
        } else {
            degrees
        }
    }

    /// Returns `true` if the light comes from straight above, so that its azimuth has no meaning.
    #[must_use]
    pub fn is_vertical(self) -> bool {
        sin(self.theta) == 0.0
    }

    /// `wi`, the unit vector towards the light, `z > 0`.
    #[must_use]
    pub fn wi(self) -> DVec3 {
        from_spherical(self.theta, self.phi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn azimuths_are_given_back_as_they_were_given() {
        for phi in (0..3600).map(|i| f64::from(i) / 10.0) {
            let incidence = Incidence::from_degrees(10.0, phi).expect("the angles are allowed");
            assert_eq!(incidence.phi_deg(), phi);
        }
    }

    #[test]
    fn spherical_coordinates_are_recovered() {
        for theta_deg in [0.0, 1e-6, 30.0, 89.999_999, 90.0, 120.0, 180.0 - 1e-6] {
            for phi_deg in [0.0, 45.0, 180.0, 359.0] {
                let (theta, phi) = (f64::to_radians(theta_deg), f64::to_radians(phi_deg));
                let w = from_spherical(theta, phi);
                assert!((polar_angle(w) - theta).abs() < 1e-15);
                if theta > 0.0 {
                    assert!((azimuth(w) - phi).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn only_light_from_straight_above_is_vertical() {
        let vertical = |theta| Incidence::from_degrees(theta, 70.0).unwrap().is_vertical();
        assert!(vertical(0.0) && vertical(-0.0));
        assert!(!vertical(1e-300) && !vertical(1e-6) && !vertical(30.0));
    }

    #[test]
    fn directions_around_an_axis_keep_their_angle_to_it() {
        for axis in [DVec3::Z, DVec3::NEG_Z, DVec3::X, from_spherical(2.0, 5.0)] {
            for mu in [-1.0, -0.3, 0.0, 0.99, 1.0] {
                for turn in [0.0, 0.2, 0.9] {
                    let w = around(axis, mu, turn);
                    assert!((w.dot(axis) - mu).abs() < 1e-15);
                    assert!((w.length() - 1.0).abs() < 1e-15);
                }
            }
        }
        let quarter = around(DVec3::Z, 0.0, 0.25).cross(around(DVec3::Z, 0.0, 0.0));
        assert!((quarter + DVec3::Z).length() < 1e-15);
    }

    #[test]
    fn azimuth_stays_below_a_full_turn() {
        assert_eq!(azimuth(DVec3::new(1.0, -1e-300, 0.0)), 0.0);
        assert_eq!(azimuth(DVec3::Z), 0.0);
        assert_eq!(azimuth(DVec3::new(-0.0, 0.0, 1.0)), 0.0);
    }

    #[test]
    fn grazing_light_is_accepted_and_horizontal_light_refused() {
        assert!(Incidence::from_degrees(89.99, 0.0).is_ok());
        assert!(Incidence::from_degrees(90.0, 0.0).is_err());
        assert!(Incidence::from_degrees(-1.0, 0.0).is_err());
        assert!(Incidence::from_degrees(f64::NAN, 0.0).is_err());
        assert!(Incidence::from_degrees(30.0, f64::INFINITY).is_err());
        // The largest number below 90 is refused or still falls on the surface.
        if let Ok(grazing) = Incidence::from_degrees(90.0_f64.next_down(), 0.0) {
            assert!(grazing.wi().z > 0.0);
        }
    }
}
