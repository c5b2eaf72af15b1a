//! Reflection and refraction of directions at a plane facet.

use glam::DVec3;

/// The mirrored direction `wo = 2 (wi . m) m - wi`, renormalised.
///
/// `wi` points away from the facet; `m` is the unit normal on the same side.
#[must_use]
#[inline(always)]
pub fn reflect(wi: DVec3, m: DVec3) -> DVec3 {
    let wo = 2.0 * wi.dot(m) * m - wi;
    // Its length squared is 1 + e with e from rounding alone; 1 / sqrt(1 + e) = 1 - e / 2 to 3 e^2 / 8.
    wo * (1.5 - 0.5 * wo.length_squared())
}

/// The refracted direction `wt = (cos_theta_i / eta - cos_theta_t) m - wi / eta`, Snell's law in vector
/// form, renormalised.
///
/// `cos_theta_t` is that of [`crate::dielectric`] for `cos_theta_i = wi . m` and `eta`. For `eta = 1` the result is
/// `-wi` exactly.
#[must_use]
#[inline(always)]
pub fn refract(wi: DVec3, m: DVec3, eta: f64, cos_theta_t: f64) -> DVec3 {
    let eta_inverse = 1.0 / eta;
    let cos_theta_i = wi.dot(m);
    let wt = (cos_theta_i * eta_inverse - cos_theta_t) * m - eta_inverse * wi;
    let wt = wt * (1.0 / wt.length_squared().sqrt());
    // Selected, not branched to, so that loops over many directions take vector instructions.
    let is_matched = eta == 1.0;
    DVec3::new(
        if is_matched { -wi.x } else { wt.x },
        if is_matched { -wi.y } else { wt.y },
        if is_matched { -wi.z } else { wt.z },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{dielectric, from_spherical};

    #[test]
    fn refraction_obeys_snell_and_stays_in_plane() {
        let m = from_spherical(0.3, 1.0);
        for eta in [0.7, 1.2, 1.5, 2.0] {
            for (theta, phi) in [(0.3, 1.0), (0.2, 0.4), (0.9, 3.0), (1.1, 1.0)] {
                let wi = from_spherical(theta, phi);
                let fresnel = dielectric(wi.dot(m), eta);
                if fresnel.transmitted == 0.0 {
                    continue;
                }
                let wt = refract(wi, m, eta, fresnel.cos_theta_t);
                let sin_theta_i = wi.cross(m).length();
                let sin_theta_t = wt.cross(m).length();
                assert!((sin_theta_i - eta * sin_theta_t).abs() < 1e-14);
                assert!((wi.cross(m) + eta * wt.cross(m)).length() < 1e-14);
                assert!(wt.dot(m) < 0.0);
            }
        }
    }

    #[test]
    fn reflection_mirrors_the_angle() {
        let m = from_spherical(0.4, 2.0);
        let wi = from_spherical(1.0, 0.5);
        let wo = reflect(wi, m);
        assert!((wo.dot(m) - wi.dot(m)).abs() < 1e-15);
        assert!((wo + wi).cross(m).length() < 1e-15);
    }
}
