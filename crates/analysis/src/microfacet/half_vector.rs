//! Half vectors: the facet that scatters light from one direction into another, and the reverse.

use asperity_optics::{Material, reflect, refract};
use glam::DVec3;

/// A facet that reflects or refracts light from `wi` into `wo`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Unit normal, on the side of `wi`.
    pub m: DVec3,
    /// `wi . m`, above zero: the local angle of incidence, not the polar angle of `wi`.
    pub cos_theta_i: f64,
    /// `|wo . m|`, above zero.
    pub cos_theta_t: f64,
    /// `chi = dOmega_m / dOmega_o`: solid angle of normals per solid angle of `wo`.
    pub chi: f64,
}

/// The facet that mirrors `wi` into `wo`; `None` unless both are on its front side and it faces upward.
///
/// `m = normalise(wi + wo)`, `chi = 1 / (4 cos theta_i)`.
///
/// # Source
/// Torrance and Sparrow 1967; Walter et al. 2007, Eqs. 13 and 14.
#[must_use]
#[inline(always)]
pub fn reflecting_facet(wi: DVec3, wo: DVec3) -> Option<Facet> {
    let m = (wi + wo).try_normalize()?;
    let cos_theta_i = wi.dot(m);
    (cos_theta_i > 0.0 && m.z > 0.0).then(|| Facet {
        m,
        cos_theta_i,
        cos_theta_t: cos_theta_i,
        chi: 0.25 / cos_theta_i,
    })
}

/// The facet that refracts `wi` into `wo`; `None` unless `wi` is on its front side, `wo` is on
/// its back side and it faces upward.
///
/// The half vector `wi + eta wo` points down for `eta > 1` and up for `eta < 1`: the facet normal
/// is on the side of `wi`. With `|wi + eta wo| = |eta cos theta_t - cos theta_i|`,
/// `chi = eta^2 cos theta_t / (eta cos theta_t - cos theta_i)^2`.
///
/// # Source
/// Xu and Sun 2008, Eq. A.14, simplified; identical to Walter et al. 2007, Eqs. 16 and 17.
#[must_use]
#[inline(always)]
pub fn refracting_facet(wi: DVec3, wo: DVec3, eta: f64) -> Option<Facet> {
    let half = if eta > 1.0 {
        -(wi + eta * wo)
    } else {
        wi + eta * wo
    };
    let length_squared = half.length_squared();
    let m = half.try_normalize()?;
    let cos_theta_i = wi.dot(m);
    let cos_theta_t = -wo.dot(m);
    (cos_theta_i > 0.0 && cos_theta_t > 0.0 && m.z > 0.0).then(|| Facet {
        m,
        cos_theta_i,
        cos_theta_t,
        chi: eta * eta * cos_theta_t / length_squared,
    })
}

/// The facet that scatters light from `wi` into `wo`, by reflection if `wo.z > 0` and by refraction otherwise.
///
/// `None` unless `wi.z > 0`, `wo` is not horizontal, and a facet of `material` connects both.
pub(crate) fn scattering_facet(material: &Material, wi: DVec3, wo: DVec3) -> Option<Facet> {
    if wi.z <= 0.0 || wo.z == 0.0 {
        None
    } else if wo.z > 0.0 {
        reflecting_facet(wi, wo)
    } else {
        let eta = material.transmitting_index()?;
        refracting_facet(wi, wo, eta)
    }
}

/// The direction into which the facet `m` scatters light from `wi`: mirrored, or refracted by `material` if
/// `refracted` gives its index.
///
/// `None` if `wi` is behind the facet or total reflection leaves nothing to refract. The direction may lie on
/// either side of the mean plane.
pub(crate) fn outgoing_direction(
    material: &Material,
    wi: DVec3,
    m: DVec3,
    refracted: Option<f64>,
) -> Option<DVec3> {
    let cos_theta_i = wi.dot(m);
    if cos_theta_i <= 0.0 {
        return None;
    }
    let Some(eta) = refracted else {
        return Some(reflect(wi, m));
    };
    let fresnel = material.fresnel(cos_theta_i.min(1.0));
    (fresnel.transmitted > 0.0).then(|| refract(wi, m, eta, fresnel.cos_theta_t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::{dielectric, from_spherical};

    /// Solid angle of outgoing directions per solid angle of normals, by central differences along
    /// two tangents of the unit sphere at `m`.
    fn stretch(m: DVec3, outgoing: impl Fn(DVec3) -> DVec3) -> f64 {
        let h = 1e-5;
        let t = m.any_orthonormal_vector();
        let b = m.cross(t);
        let d = |v: DVec3| {
            (outgoing((m + h * v).normalize()) - outgoing((m - h * v).normalize())) / (2.0 * h)
        };
        d(t).cross(d(b)).length()
    }

    #[test]
    fn jacobian_is_the_ratio_of_solid_angles() {
        // Central differences err by h^2 times third derivatives (h = 1e-5; derivatives up to some
        // hundred towards the critical angle) and by eps / h = 2e-11.
        let wi = from_spherical(0.6, 0.3);
        for (theta, phi) in [(0.1, 0.0), (0.5, 2.0), (0.9, 5.5), (1.2, 1.0)] {
            let m = from_spherical(theta, phi);
            if wi.dot(m) <= 0.05 {
                continue;
            }
            let wo = reflect(wi, m);
            let facet = reflecting_facet(wi, wo).unwrap();
            assert!((facet.m - m).length() < 1e-14);
            let numeric = stretch(m, |m| reflect(wi, m));
            assert!((facet.chi * numeric - 1.0).abs() < 1e-7);

            for eta in [1.0 / 1.5, 0.9, 1.1, 1.5, 2.4] {
                let fresnel = dielectric(wi.dot(m), eta);
                if fresnel.transmitted < 0.2 {
                    continue;
                }
                let turn = |m: DVec3| refract(wi, m, eta, dielectric(wi.dot(m), eta).cos_theta_t);
                let facet = refracting_facet(wi, turn(m), eta).unwrap();
                assert!((facet.m - m).length() < 1e-13, "{eta}");
                assert!((facet.cos_theta_t - fresnel.cos_theta_t).abs() < 1e-13);
                let numeric = stretch(m, turn);
                assert!((facet.chi * numeric - 1.0).abs() < 1e-6, "{eta} {theta}");
            }
        }
    }

    #[test]
    fn jacobian_equals_the_appendix_formula_where_that_is_defined() {
        // Eq. A.14: sin(alpha) / sin(alpha - beta) / (1 - cos(alpha) / (n cos(beta))).
        for eta in [0.7, 1.4] {
            let alpha: f64 = 0.5;
            let beta = (alpha.sin() / eta).asin();
            let wi = from_spherical(alpha, 0.0);
            let wo = -from_spherical(beta, 0.0);
            let facet = refracting_facet(wi, wo, eta).unwrap();
            let appendix =
                alpha.sin() / (alpha - beta).sin() / (1.0 - alpha.cos() / (eta * beta.cos()));
            assert!((facet.chi / appendix - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn normal_incidence_has_the_finite_limit() {
        for eta in [0.7_f64, 1.4] {
            let facet = refracting_facet(DVec3::Z, DVec3::NEG_Z, eta).unwrap();
            assert!((facet.chi / (eta / (eta - 1.0)).powi(2) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn directions_that_no_facet_connects_give_none() {
        let wi = from_spherical(0.5, 0.0);
        // Refraction cannot turn light by more than the critical angle allows.
        assert!(refracting_facet(wi, from_spherical(2.0, 0.0), 1.5).is_none());
        assert!(refracting_facet(wi, from_spherical(2.0, 0.0), 1.0 / 1.5).is_none());
        // Nor does any facet send light straight back through the surface.
        assert!(reflecting_facet(wi, -wi).is_none());
    }
}
