//! The Fresnel equations for unpolarised light.
//!
//! Written with differences of squares, `c^2 - g^2 = -(m - 1)(m + 1)`, so that nothing cancels for
//! an index near one, at normal incidence or at grazing:
//!
//! ```text
//! m   relative index, c = cos(theta_i), g = m cos(theta_t) = sqrt((m - 1)(m + 1) + c^2)
//! r_s = (c - g) / (c + g)         = -(m - 1)(m + 1) / (c + g)^2
//! r_p = (m^2 c - g) / (m^2 c + g) =  (m - 1)(m + 1) ((m^2 + 1) c^2 - 1) / (m^2 c + g)^2
//! ```
//!
//! # Source
//! Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, rearranged.

use num_complex::Complex64;

use crate::complex_root::first_quadrant_root;

/// Fresnel terms of an interface for unpolarised light.
///
/// # Examples
/// ```
/// use asperity_optics::dielectric;
///
/// // Brewster's angle: the reflected and the refracted ray are at right angles.
/// let eta = 1.5_f64;
/// let theta_i = eta.atan();
/// let fresnel = dielectric(theta_i.cos(), eta);
/// assert!((fresnel.cos_theta_t - theta_i.sin()).abs() < 1e-15);
/// // Beyond the critical angle all light is reflected.
/// assert_eq!(dielectric(0.2, 1.0 / eta).reflected, 1.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel {
    /// Fraction reflected, `[0, 1]`.
    pub reflected: f64,
    /// Fraction transmitted (dielectric) or absorbed (conductor), `[0, 1]`.
    pub transmitted: f64,
    /// Cosine of the angle of refraction; zero under total reflection and for conductors.
    pub cos_theta_t: f64,
}

impl Fresnel {
    /// All light is reflected: by a mirror, or beyond the critical angle.
    pub(crate) const TOTAL_REFLECTION: Self = Self {
        reflected: 1.0,
        transmitted: 0.0,
        cos_theta_t: 0.0,
    };
}

/// Dielectric interface of relative index `eta > 0`, met at `cos_theta_i` in `[0, 1]`.
///
/// Total reflection gives `reflected = 1`, `transmitted = 0` exactly. For `eta = 1` nothing is
/// reflected and `cos_theta_t = cos_theta_i`.
#[must_use]
#[inline(always)]
pub fn dielectric(cos_theta_i: f64, eta: f64) -> Fresnel {
    // All cases are computed and one is selected, without branches: so loops over many angles take vector
    // instructions.
    let delta = (eta - 1.0) * (eta + 1.0);
    // Compute g = eta cos_theta_t by Snell's law; total reflection leaves no real root.
    let g_squared = delta + cos_theta_i * cos_theta_i;
    let is_total = g_squared <= 0.0;
    let g = if is_total { 0.0 } else { g_squared }.sqrt();
    // Compute the amplitudes r_s and r_p, and average s and p.
    let eta2 = eta * eta;
    let s_sum = cos_theta_i + g;
    let p_sum = eta2 * cos_theta_i + g;
    let (s_squared, p_squared) = (s_sum * s_sum, p_sum * p_sum);
    let r_s = -delta / s_squared;
    let r_p = delta * ((eta2 + 1.0) * cos_theta_i * cos_theta_i - 1.0) / p_squared;
    let reflected = 0.5 * (r_s * r_s + r_p * r_p);
    // The smaller fraction keeps its relative accuracy, and both add to one exactly.
    let t_s = 4.0 * cos_theta_i * g / s_squared;
    let t_p = 4.0 * eta2 * cos_theta_i * g / p_squared;
    let transmitted = 0.5 * (t_s + t_p);
    let is_weak = reflected < 0.5;
    let partial = [
        if is_weak {
            reflected
        } else {
            1.0 - transmitted
        },
        if is_weak {
            1.0 - reflected
        } else {
            transmitted
        },
    ];
    // Select total reflection, grazing light, and indices that match.
    let is_all = is_total | (cos_theta_i <= 0.0);
    let is_matched = delta == 0.0;
    let [reflected, transmitted] = [
        if is_all { 1.0 } else { partial[0] },
        if is_all { 0.0 } else { partial[1] },
    ];
    let cos_theta_t = g / eta;
    let capped = if cos_theta_t > 1.0 { 1.0 } else { cos_theta_t };
    Fresnel {
        reflected: if is_matched { 0.0 } else { reflected },
        transmitted: if is_matched { 1.0 } else { transmitted },
        cos_theta_t: if is_matched { cos_theta_i } else { capped },
    }
}

/// Amplitude reflection coefficients for s and p polarised light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FresnelAmplitudes {
    /// Electric field perpendicular to the plane of incidence.
    pub r_s: Complex64,
    /// Electric field in the plane of incidence; equals `-r_s` at normal incidence.
    pub r_p: Complex64,
}

/// Amplitudes of reflection at an absorbing conductor of relative index `eta + i kappa`.
///
/// `eta > 0`, `kappa >= 0`, `cos_theta_i` in `[0, 1]`.
#[must_use]
pub fn conductor_amplitudes(cos_theta_i: f64, eta: f64, kappa: f64) -> FresnelAmplitudes {
    let m = Complex64::new(eta, kappa);
    let m2 = m * m;
    let delta = (m - 1.0) * (m + 1.0);
    let g = first_quadrant_root(delta.re + cos_theta_i * cos_theta_i, delta.im);
    let s_sum = cos_theta_i + g;
    let p_sum = m2 * cos_theta_i + g;
    FresnelAmplitudes {
        r_s: -delta / (s_sum * s_sum),
        r_p: delta * ((m2 + 1.0) * (cos_theta_i * cos_theta_i) - 1.0) / (p_sum * p_sum),
    }
}

/// Absorbing conductor of relative index `eta + i kappa`; what is not reflected is absorbed.
///
/// `eta > 0`, `kappa >= 0`, `cos_theta_i` in `[0, 1]`.
#[must_use]
pub fn conductor(cos_theta_i: f64, eta: f64, kappa: f64) -> Fresnel {
    let FresnelAmplitudes { r_s, r_p } = conductor_amplitudes(cos_theta_i, eta, kappa);
    let reflected = (0.5 * (r_s.norm_sqr() + r_p.norm_sqr())).min(1.0);
    Fresnel {
        reflected,
        transmitted: 1.0 - reflected,
        cos_theta_t: 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_incidence_is_the_textbook_value() {
        let f = dielectric(1.0, 1.5);
        assert!((f.reflected - 0.04).abs() < 1e-17);
        assert_eq!(f.cos_theta_t, 1.0);
        let inverse = dielectric(1.0, 1.0 / 1.5);
        assert!((inverse.reflected - 0.04).abs() < 1e-16);
    }

    #[test]
    fn brewster_angle_reflects_no_p_light() {
        let eta: f64 = 1.5;
        let c = (1.0 / (1.0 + eta * eta)).sqrt();
        let amplitudes = conductor_amplitudes(c, eta, 0.0);
        assert!(amplitudes.r_p.norm() < 1e-15);
        let r_s = (1.0 - eta * eta) / (1.0 + eta * eta);
        assert!((dielectric(c, eta).reflected - 0.5 * r_s * r_s).abs() < 1e-15);
    }

    #[test]
    fn reflected_and_transmitted_add_to_one() {
        for eta in [
            0.25,
            1.0 / 1.5,
            0.999_999_999,
            1.0,
            1.000_000_001,
            1.33,
            4.0,
        ] {
            for i in 0..=1000 {
                let f = dielectric(f64::from(i) / 1000.0, eta);
                assert!(
                    (f.reflected + f.transmitted - 1.0).abs() < 4e-16,
                    "{eta} {i} {f:?}"
                );
                assert!((0.0..=1.0).contains(&f.reflected), "{eta} {i} {f:?}");
            }
        }
    }

    #[test]
    fn matched_indices_transmit_undeviated() {
        for c in [0.0, 1e-9, 0.3, 1.0] {
            let f = dielectric(c, 1.0);
            assert_eq!((f.reflected, f.transmitted, f.cos_theta_t), (0.0, 1.0, c));
        }
    }

    #[test]
    fn nearly_matched_indices_keep_their_relative_accuracy() {
        // To first order R = (delta / 2)^2 at normal incidence, delta = eta - 1.
        let f = dielectric(1.0, 1.0 + f64::EPSILON * 1024.0);
        let expected = (f64::EPSILON * 512.0).powi(2);
        assert!((f.reflected / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn light_beyond_the_critical_angle_is_totally_reflected() {
        let eta: f64 = 1.0 / 1.5;
        let critical = (1.0 - eta * eta).sqrt();
        assert_eq!(dielectric(critical * 0.999, eta).reflected, 1.0);
        assert!(dielectric(critical * 1.001, eta).reflected < 1.0);
    }

    #[test]
    fn both_sides_of_an_interface_reflect_alike() {
        // Stokes: the reflectance is the same at theta_i outside and at theta_t inside.
        for eta in [1.33, 1.5, 2.4] {
            for i in 1..100 {
                let c = f64::from(i) / 100.0;
                let outside = dielectric(c, eta);
                let inside = dielectric(outside.cos_theta_t, 1.0 / eta);
                // Near the critical angle c = sqrt(1 - eta^2 (1 - cos_theta_t^2)) magnifies the
                // rounding of cos_theta_t by eta^2 / c, and dR/dc is at most about 4 eta.
                let tolerance = 8.0 * eta.powi(3) / c * f64::EPSILON;
                assert!(
                    (outside.reflected - inside.reflected).abs() < tolerance,
                    "{eta} {i}"
                );
            }
        }
    }

    #[test]
    fn conductor_without_absorption_is_a_dielectric() {
        for i in 0..=100 {
            let c = f64::from(i) / 100.0;
            let difference = conductor(c, 1.5, 0.0).reflected - dielectric(c, 1.5).reflected;
            assert!(difference.abs() < 1e-15);
        }
    }

    #[test]
    fn conductor_at_normal_incidence_is_the_textbook_value() {
        let (n, k): (f64, f64) = (0.21, 3.272);
        let expected = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert!((conductor(1.0, n, k).reflected - expected).abs() < 1e-15);
    }
}
