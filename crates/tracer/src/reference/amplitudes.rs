//! Amplitudes: the factors of an interface for the electric fields along s and p.
//!
//! # Source
//! Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, with `r_p = -r_s` at normal incidence.

use asperity_optics::{FilmAmplitudes, FresnelAmplitudes, Material, conductor_amplitudes};
use num_complex::Complex64;

/// Amplitudes of an interface for fields along s and p, `[s, p]`, whose squares are fluxes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Amplitudes {
    pub(super) reflection: [Complex64; 2],
    /// With the root of the factor of flux, `n cos(theta_t) / cos(theta_i)`; zero where no light is transmitted.
    pub(super) transmission: [Complex64; 2],
}

impl Amplitudes {
    /// Amplitudes of light that meets an interface at `cos_theta_i` in `[0, 1]`, from the medium that the indices of `material` are
    /// relative to.
    pub(super) fn of(material: Material, cos_theta_i: f64) -> Self {
        match material {
            Material::Dielectric { eta } => Self::of_dielectric(cos_theta_i, eta),
            Material::Conductor { eta, kappa } => Self {
                reflection: reflection(cos_theta_i, eta, kappa),
                transmission: [Complex64::ZERO; 2],
            },
            Material::Coated { films, eta, kappa } => {
                let FilmAmplitudes { r, t, flux } = films.amplitudes(cos_theta_i, eta, kappa);
                let is_opaque = kappa > 0.0;
                Self {
                    reflection: r,
                    transmission: [0, 1].map(|i| match is_opaque {
                        true => Complex64::ZERO,
                        false => t[i] * flux[i].sqrt(),
                    }),
                }
            }
            _ => Self {
                reflection: [(-1.0).into(), 1.0.into()],
                transmission: [Complex64::ZERO; 2],
            },
        }
    }

    fn of_dielectric(cos_theta_i: f64, eta: f64) -> Self {
        if eta == 1.0 {
            // At grazing incidence the quotients have no value.
            return Self {
                reflection: [Complex64::ZERO; 2],
                transmission: [Complex64::ONE; 2],
            };
        }
        // g = n cos(theta_t) by Snell's law; total reflection leaves no real root.
        let g_squared = (eta - 1.0) * (eta + 1.0) + cos_theta_i * cos_theta_i;
        let g = g_squared.max(0.0).sqrt();
        let root = 2.0 * (g * cos_theta_i).sqrt();
        let t_s = root / (cos_theta_i + g);
        let t_p = eta * root / (eta * eta * cos_theta_i + g);
        let is_transmitted = g > 0.0;
        Self {
            reflection: reflection(cos_theta_i, eta, 0.0),
            transmission: [t_s, t_p].map(|t| {
                if is_transmitted {
                    t.into()
                } else {
                    Complex64::ZERO
                }
            }),
        }
    }
}

fn reflection(cos_theta_i: f64, eta: f64, kappa: f64) -> [Complex64; 2] {
    let FresnelAmplitudes { r_s, r_p } = conductor_amplitudes(cos_theta_i, eta, kappa);
    [r_s, r_p]
}
