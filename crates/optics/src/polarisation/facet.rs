//! Facet: Fresnel terms of an interface for polarised light, in the axes of the plane of incidence.
//!
//! One ratio serves dielectrics, total reflection and conductors alike. With `m` the relative index, `c = cos(theta_i)`,
//! `sin2 = sin^2(theta_i)` and `g = m cos(theta_t)`, complex in general and with `Im g >= 0`,
//!
//! ```text
//! r_s = (c - g) / (c + g)         r_p = (m^2 c - g) / (m^2 c + g)         r_p / r_s = (sin2 - c g) / (sin2 + c g)
//! t_s = 2 c / (c + g)             t_p = 2 m c / (m^2 c + g)               t_p / t_s = m / (sin2 + c g)
//! ```
//!
//! so that `r_p = -r_s` at normal incidence. The ratio gives `1 - |r_p / r_s|^2` and the phase between both without
//! differences of numbers that are nearly equal.
//!
//! # Source
//! Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, rearranged; signs as in SCATMECH.

use crate::{Fresnel, dielectric};

/// Mueller matrix of an interface in the axes of its plane of incidence, by its four distinct elements:
///
/// ```text
/// m00  m01    0    0
/// m01  m00    0    0
///   0    0  m22  m23
///   0    0 -m23  m22
/// ```
///
/// With amplitudes `r_s` and `r_p`: `m00 = (|r_s|^2 + |r_p|^2) / 2`, `m01 = (|r_s|^2 - |r_p|^2) / 2`,
/// `m22 + i m23 = r_s r_p*`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetMueller {
    /// Fraction of unpolarised light, `[0, 1]`.
    pub m00: f64,
    /// Difference between s and p, `[-m00, m00]`.
    pub m01: f64,
    /// Cosine of the phase between s and p, times the product of their magnitudes.
    pub m22: f64,
    /// Sine of that phase, times the same.
    pub m23: f64,
}

impl FacetMueller {
    /// No light.
    pub const NONE: Self = Self {
        m00: 0.0,
        m01: 0.0,
        m22: 0.0,
        m23: 0.0,
    };

    /// Reflection by a perfect mirror, `r_s = -1`, `r_p = 1`: U and V change their signs.
    pub const MIRROR: Self = Self {
        m00: 1.0,
        m01: 0.0,
        m22: -1.0,
        m23: 0.0,
    };
}

/// Fresnel terms of an interface for polarised light.
///
/// # Examples
/// ```
/// use asperity_optics::{dielectric, polarised_dielectric};
///
/// // At Brewster's angle reflected light is fully polarised along s.
/// let brewster = 1.5_f64.atan().cos();
/// let fresnel = polarised_dielectric(brewster, 1.5);
/// assert!((fresnel.reflected.m01 - fresnel.reflected.m00).abs() < 1e-16);
/// // Unpolarised light is reflected and transmitted as ever.
/// assert_eq!(fresnel.transmitted.m00, dielectric(brewster, 1.5).transmitted);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolarisedFresnel {
    /// Reflected flux per incident flux.
    pub reflected: FacetMueller,
    /// Transmitted flux per incident flux; none for conductors, which absorb what they do not reflect.
    pub transmitted: FacetMueller,
    /// Cosine of the angle of refraction; zero under total reflection and for conductors.
    pub cos_theta_t: f64,
}

impl PolarisedFresnel {
    /// A perfect mirror.
    pub(crate) const MIRROR: Self = Self {
        reflected: FacetMueller::MIRROR,
        transmitted: FacetMueller::NONE,
        cos_theta_t: 0.0,
    };
}

/// Dielectric interface of relative index `eta > 0`, met at `cos_theta_i` in `[0, 1]`.
///
/// `m00` of both matrices and `cos_theta_t` are those of [`dielectric`], bit by bit; the sum of both matrices keeps the flux
/// of any incident state. Total reflection has `m00 = 1`, `m01 = 0` exactly and `m23 >= 0`; the two matrices for `eta = 1` are zero
/// and one.
#[must_use]
#[inline(always)]
pub fn polarised_dielectric(cos_theta_i: f64, eta: f64) -> PolarisedFresnel {
    // All cases are computed and one is selected, without branches: so loops over many angles take vector
    // instructions.
    let Fresnel {
        reflected,
        transmitted,
        cos_theta_t,
    } = dielectric(cos_theta_i, eta);
    let delta = (eta - 1.0) * (eta + 1.0);
    // Compute g = eta cos_theta_t by Snell's law; it is imaginary under total reflection.
    let g_squared = delta + cos_theta_i * cos_theta_i;
    let is_total = g_squared <= 0.0;
    let root = g_squared.abs().sqrt();
    let g = [
        if is_total { 0.0 } else { root },
        if is_total { root } else { 0.0 },
    ];
    // Reflect: all light under total reflection, none where the indices match.
    let is_matched = delta == 0.0;
    let s_sum = cos_theta_i + g[0];
    let s_squared = s_sum * s_sum;
    let r_s = -delta / s_squared;
    let partial = if is_total { 1.0 } else { r_s * r_s };
    let reflectance_s = if is_matched { 0.0 } else { partial };
    let reflection = reflection(reflectance_s, cos_theta_i, g);
    // Transmit; both are in phase.
    let t_s = 4.0 * cos_theta_i * g[0] / s_squared;
    let sin2 = (1.0 - cos_theta_i) * (1.0 + cos_theta_i);
    let product = t_s * eta / (sin2 + cos_theta_i * g[0]);
    let partial = if is_total { 0.0 } else { product };
    PolarisedFresnel {
        reflected: FacetMueller {
            m00: reflected,
            ..reflection
        },
        transmitted: FacetMueller {
            m00: transmitted,
            // What is missing in one polarisation is more in the other.
            m01: 0.0 - reflection.m01,
            m22: if is_matched { 1.0 } else { partial },
            m23: 0.0,
        },
        cos_theta_t,
    }
}

/// Absorbing conductor of relative index `eta + i kappa`; what is not reflected is absorbed.
///
/// `eta > 0`, `kappa >= 0`, `cos_theta_i` in `[0, 1]`. `m00` is that of [`conductor`](crate::conductor) to rounding.
#[must_use]
#[inline(always)]
pub fn polarised_conductor(cos_theta_i: f64, eta: f64, kappa: f64) -> PolarisedFresnel {
    // Compute g, the root of g^2 = m^2 - 1 + c^2 in the first quadrant. Its larger part comes first, without
    // cancellation.
    let re = (eta - 1.0) * (eta + 1.0) - kappa * kappa + cos_theta_i * cos_theta_i;
    let im = 2.0 * eta * kappa;
    let larger = (0.5 * ((re * re + im * im).sqrt() + re.abs())).sqrt();
    let smaller = 0.5 * im / if larger > 0.0 { larger } else { 1.0 };
    let is_below_one = re < 0.0;
    let g = [
        if is_below_one { smaller } else { larger },
        if is_below_one { larger } else { smaller },
    ];
    // |m^2 - 1|^2 / |c + g|^4
    let kappa2 = kappa * kappa;
    let delta_squared = ((eta - 1.0) * (eta - 1.0) + kappa2) * ((eta + 1.0) * (eta + 1.0) + kappa2);
    let s_sum = cos_theta_i + g[0];
    let s_squared = s_sum * s_sum + g[1] * g[1];
    let partial = delta_squared / (s_squared * s_squared);
    let is_matched = delta_squared == 0.0;
    let reflection = reflection(if is_matched { 0.0 } else { partial }, cos_theta_i, g);
    // What is absorbed of s light, and of both on average: the smaller fraction keeps its relative accuracy.
    let absorbed_s = 4.0 * cos_theta_i * g[0] / s_squared;
    let absorbed = absorbed_s + reflection.m01;
    PolarisedFresnel {
        reflected: FacetMueller {
            m00: if reflection.m00 < 0.5 {
                reflection.m00
            } else {
                1.0 - absorbed
            },
            ..reflection
        },
        transmitted: FacetMueller::NONE,
        cos_theta_t: 0.0,
    }
}

/// Reflection by the reflectance for s light and the ratio `(sin2 - c g) / (sin2 + c g)` of `r_p` to `r_s`.
///
/// `g`: its real and its imaginary part.
#[inline(always)]
fn reflection(reflectance_s: f64, cos_theta_i: f64, g: [f64; 2]) -> FacetMueller {
    let sin2 = (1.0 - cos_theta_i) * (1.0 + cos_theta_i);
    let [re, im] = [cos_theta_i * g[0], cos_theta_i * g[1]];
    let sum = sin2 + re;
    let scale = reflectance_s / (sum * sum + im * im);
    let (sin4, cg_squared) = (sin2 * sin2, re * re + im * im);
    FacetMueller {
        m00: scale * (sin4 + cg_squared),
        m01: scale * (2.0 * sin2 * re),
        m22: scale * (sin4 - cg_squared),
        m23: scale * (2.0 * sin2 * im),
    }
}

#[cfg(test)]
mod tests {
    use num_complex::Complex64;

    use super::*;
    use crate::{FresnelAmplitudes, conductor, conductor_amplitudes};

    const INDICES: [f64; 10] = [
        1e-6,
        0.25,
        1.0 / 1.5,
        0.999_999_999,
        1.0,
        1.000_000_001,
        1.33,
        1.5,
        4.0,
        1e6,
    ];

    const CONDUCTORS: [(f64, f64); 7] = [
        (0.43, 2.455),
        (0.21, 3.272),
        (1.0, 1e-3),
        (4.0, 0.03),
        (1.5, 0.0),
        (0.6, 0.0),
        (1e-6, 1e6),
    ];

    fn cosines() -> impl Iterator<Item = f64> {
        (0..=1000)
            .map(|i| f64::from(i) / 1000.0)
            .chain([1e-300, 1e-12, 1.0 - 1e-15])
    }

    fn of_amplitudes(s: Complex64, p: Complex64, power: f64) -> FacetMueller {
        let cross = power * s * p.conj();
        FacetMueller {
            m00: 0.5 * power * (s.norm_sqr() + p.norm_sqr()),
            m01: 0.5 * power * (s.norm_sqr() - p.norm_sqr()),
            m22: cross.re,
            m23: cross.im,
        }
    }

    #[track_caller]
    fn assert_near(a: FacetMueller, b: FacetMueller, tolerance: f64, at: &str) {
        for (a, b) in [
            (a.m00, b.m00),
            (a.m01, b.m01),
            (a.m22, b.m22),
            (a.m23, b.m23),
        ] {
            assert!((a - b).abs() <= tolerance, "{at}: {a} {b}");
        }
    }

    /// Rounding, and that of `g^2` near the critical angle, where its root magnifies it.
    fn tolerance(c: f64, eta: f64, kappa: f64) -> f64 {
        let g = (Complex64::new(eta, kappa).powi(2) - 1.0 + c * c)
            .norm()
            .sqrt();
        2e-15 + 1e-15 * c * (c / g).min(1e8)
    }

    /// Difference `m00^2 - m01^2 - m22^2 - m23^2`, which is zero for an interface that does not depolarise.
    fn depolarisation(m: FacetMueller) -> f64 {
        m.m00 * m.m00 - m.m01 * m.m01 - m.m22 * m.m22 - m.m23 * m.m23
    }

    #[test]
    fn unpolarised_light_meets_a_dielectric_as_without_polarisation() {
        for eta in INDICES {
            for c in cosines() {
                let (found, expected) = (polarised_dielectric(c, eta), dielectric(c, eta));
                assert_eq!(found.reflected.m00, expected.reflected, "{eta} {c}");
                assert_eq!(found.transmitted.m00, expected.transmitted, "{eta} {c}");
                assert_eq!(found.cos_theta_t, expected.cos_theta_t, "{eta} {c}");
            }
        }
    }

    #[test]
    fn unpolarised_light_meets_a_conductor_as_without_polarisation() {
        for (eta, kappa) in CONDUCTORS {
            for c in cosines() {
                let found = polarised_conductor(c, eta, kappa).reflected.m00;
                let expected = conductor(c, eta, kappa).reflected;
                assert!((found - expected).abs() < 1e-15, "{eta} {kappa} {c}");
            }
        }
    }

    #[test]
    fn reflection_is_that_of_complex_amplitudes() {
        let dielectrics = INDICES.map(|eta| (eta, 0.0));
        for (eta, kappa) in dielectrics.into_iter().chain(CONDUCTORS) {
            for c in cosines() {
                let at = format!("{eta} {kappa} {c}");
                if eta == 1.0 && kappa == 0.0 {
                    assert_eq!(polarised_dielectric(c, eta).reflected, FacetMueller::NONE);
                    assert_eq!(
                        polarised_conductor(c, eta, kappa).reflected,
                        FacetMueller::NONE
                    );
                    continue;
                }
                let FresnelAmplitudes { r_s, r_p } = conductor_amplitudes(c, eta, kappa);
                let expected = of_amplitudes(r_s, r_p, 1.0);
                let tolerance = tolerance(c, eta, kappa);
                assert_near(
                    polarised_conductor(c, eta, kappa).reflected,
                    expected,
                    tolerance,
                    &at,
                );
                if kappa == 0.0 {
                    let found = polarised_dielectric(c, eta).reflected;
                    assert_near(found, expected, tolerance, &at);
                }
            }
        }
    }

    #[test]
    fn transmission_is_that_of_amplitudes_with_the_factor_of_flux() {
        for eta in INDICES {
            for c in cosines() {
                let cos_theta_t = dielectric(c, eta).cos_theta_t;
                let found = polarised_dielectric(c, eta).transmitted;
                if c == 0.0 || found.m00 == 0.0 {
                    continue;
                }
                let g = eta * cos_theta_t;
                let t_s = Complex64::from(2.0 * c / (c + g));
                let t_p = Complex64::from(2.0 * c / (eta * c + cos_theta_t));
                let expected = of_amplitudes(t_s, t_p, g / c);
                let tolerance = 2e-15 + 1e-15 * c / g.max(1e-12);
                assert_near(found, expected, tolerance, &format!("{eta} {c}"));
            }
        }
    }

    #[test]
    fn energy_of_any_state_is_kept_by_a_dielectric() {
        for eta in INDICES {
            for c in cosines() {
                let f = polarised_dielectric(c, eta);
                // Row zero of R + T is (1, 0, 0, 0).
                assert!((f.reflected.m00 + f.transmitted.m00 - 1.0).abs() < 4e-16);
                assert_eq!(f.reflected.m01 + f.transmitted.m01, 0.0);
            }
        }
    }

    #[test]
    fn interfaces_do_not_depolarise() {
        for c in cosines() {
            for eta in INDICES {
                let f = polarised_dielectric(c, eta);
                for part in [f.reflected, f.transmitted] {
                    let rest = depolarisation(part).abs();
                    assert!(rest < tolerance(c, eta, 0.0), "{eta} {c} {f:?}");
                }
            }
            for (eta, kappa) in CONDUCTORS {
                let f = polarised_conductor(c, eta, kappa).reflected;
                let rest = depolarisation(f).abs();
                assert!(rest < tolerance(c, eta, kappa), "{eta} {kappa} {c} {f:?}");
            }
        }
        assert_eq!(depolarisation(FacetMueller::MIRROR), 0.0);
    }

    #[test]
    fn both_sides_of_an_interface_transmit_alike() {
        // Reciprocity: the flux matrices of a path and of its reverse are equal.
        for eta in [1.33, 1.5, 2.4] {
            for i in 1..=100 {
                let c = f64::from(i) / 100.0;
                let outside = polarised_dielectric(c, eta);
                let inside = polarised_dielectric(outside.cos_theta_t, 1.0 / eta);
                let tolerance = 8.0 * eta.powi(3) / c * f64::EPSILON;
                let at = format!("{eta} {c}");
                assert_near(outside.transmitted, inside.transmitted, tolerance, &at);
                // Reflection from the other side has the other sign of both amplitudes.
                assert_near(outside.reflected, inside.reflected, tolerance, &at);
            }
        }
    }

    #[test]
    fn reflected_light_is_along_s_at_brewster_angle() {
        for eta in [1.0 / 1.5, 1.33, 1.5, 2.4_f64] {
            let c = (1.0 / (1.0 + eta * eta)).sqrt();
            let f = polarised_dielectric(c, eta).reflected;
            assert!(
                (f.m01 - f.m00).abs() < 1e-16 && f.m22.abs() < 1e-16,
                "{f:?}"
            );
            // U changes its sign there.
            assert!(polarised_dielectric(c * 1.01, eta).reflected.m22 < 0.0);
            assert!(polarised_dielectric(c * 0.99, eta).reflected.m22 > 0.0);
        }
    }

    #[test]
    fn polarisations_are_alike_at_normal_incidence() {
        let f = polarised_dielectric(1.0, 1.5);
        assert_eq!((f.reflected.m01, f.reflected.m23), (0.0, 0.0));
        assert!((f.reflected.m22 + f.reflected.m00).abs() < 1e-17);
        assert_eq!((f.transmitted.m01, f.transmitted.m23), (0.0, 0.0));
        assert!((f.transmitted.m22 - f.transmitted.m00).abs() < 4e-16);
        let gold = polarised_conductor(1.0, 0.43, 2.455).reflected;
        assert_eq!((gold.m01, gold.m23), (0.0, 0.0));
        assert!((gold.m22 + gold.m00).abs() < 1e-15);
    }

    #[test]
    fn total_reflection_retards_by_the_textbook_phase() {
        let eta: f64 = 1.0 / 1.51;
        for degrees in [42.0_f64, 48.617, 54.617, 70.0, 89.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let f = polarised_dielectric(cos, eta).reflected;
            let phase = 2.0 * (cos * (sin * sin - eta * eta).sqrt() / (sin * sin)).atan();
            assert_eq!((f.m00, f.m01), (1.0, 0.0));
            assert!((f.m22 - phase.cos()).abs() < 2e-15, "{degrees}");
            assert!((f.m23 - phase.sin()).abs() < 2e-15, "{degrees}");
        }
        // Hardly any phase at the critical angle, none at grazing.
        assert_eq!(polarised_dielectric(0.0, eta).reflected.m22, 1.0);
        assert!(polarised_dielectric(0.6, 0.8).reflected.m22 > 1.0 - 1e-6);
    }

    #[test]
    fn good_conductors_approach_a_mirror() {
        let f = polarised_conductor(0.7, 0.01, 1e5).reflected;
        assert_near(f, FacetMueller::MIRROR, 1e-4, "silver and more");
        assert!(f.m23 > 0.0);
    }
}
