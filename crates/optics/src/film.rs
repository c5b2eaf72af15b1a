//! Thin films: reflection and transmission of a coherent stack of homogeneous layers on an interface.
//!
//! The tangential fields are carried from the substrate to the incident medium by the characteristic matrix of each layer. With `m` the
//! relative index of a layer, `q = m cos(theta) = sqrt(m^2 - sin^2(theta_i))`, `Im q >= 0`, `phi = 2 pi d / lambda`, `delta = phi q`, and
//! `x = q` for s, `x = q / m^2` for p,
//!
//! ```text
//! u' = cos(delta) u - i sin(delta) / x v       v' = cos(delta) v - i x sin(delta) u
//! ```
//!
//! where `(u, v)` is `(E, H)` for s and `(H, E)` for p, `(1, x)` in the substrate. Each matrix is taken times `exp(i delta)`, whose
//! magnitude is one at most: thick absorbing and evanescent layers do not overflow. `sin(delta) / x` has a limit at the critical angle of a
//! layer, and no quotient of fields is formed before the end:
//!
//! ```text
//! r = (x0 u - v) / (x0 u + v)       t = 2 x0 exp(i sum delta) / (x0 u + v)
//! ```
//!
//! # Limits
//! Layers are plane, parallel and much thinner than the distance over which a facet is flat; light is coherent over the stack.
//!
//! # Source
//! Born and Wolf, Principles of Optics, Sec. 1.6; signs of `r_p` and of phases as on the crate page.

use asperity_numerics::elementary::{exp, exp_m1, sin, sin_cos};
use num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::complex_root::first_quadrant_root;
use crate::material_error::{MAX_FILM_PHASE, MAX_FILMS, MaterialError, valid_eta, valid_kappa};
use crate::{FacetMueller, PolarisedFresnel, dielectric};

/// Homogeneous layer of a stack of thin films.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Film {
    /// Real part of the index relative to the incident medium, from 1e-6 to 1e6.
    pub eta: f64,
    /// Imaginary part, from 0 to 1e6.
    pub kappa: f64,
    /// Thickness times the wave number in the incident medium, `2 pi d / lambda`, from 0 to 1e6, radians.
    pub phase: f64,
}

/// Coherent stack of thin films, in the order in which light from the incident medium meets them.
///
/// # Examples
/// ```
/// use std::f64::consts::FRAC_PI_2;
/// use asperity_optics::{Film, Films, Material};
///
/// // A quarter wave of index 1.5 between air and an index of 2.25 reflects nothing.
/// let quarter = Film { eta: 1.5, kappa: 0.0, phase: FRAC_PI_2 / 1.5 };
/// let coated = Material::coated(Films::new(&[quarter])?, 2.25, 0.0)?;
/// assert!(coated.fresnel(1.0).reflected < 1e-30);
/// # Ok::<(), asperity_optics::MaterialError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<Film>", into = "Vec<Film>")]
pub struct Films {
    layers: [Film; MAX_FILMS],
    len: usize,
}

impl Films {
    /// Padding of unused layers.
    const NONE: Film = Film {
        eta: 1.0,
        kappa: 0.0,
        phase: 0.0,
    };

    /// The stack of these layers, the first of which the light meets first; none leave the interface bare.
    ///
    /// # Errors
    /// [`MaterialError`] for more than eight layers, or a value of a layer that is out of range.
    pub fn new(layers: &[Film]) -> Result<Self, MaterialError> {
        if layers.len() > MAX_FILMS {
            return Err(MaterialError::TooManyFilms(layers.len()));
        }
        let mut stack = [Self::NONE; MAX_FILMS];
        for (place, film) in stack.iter_mut().zip(layers) {
            valid_eta(film.eta)?;
            valid_kappa(film.kappa)?;
            if !(0.0..=MAX_FILM_PHASE).contains(&film.phase) {
                return Err(MaterialError::BadPhase(film.phase));
            }
            *place = *film;
        }
        Ok(Self {
            layers: stack,
            len: layers.len(),
        })
    }

    /// The layers, the first of which the light meets first.
    #[must_use]
    pub fn layers(&self) -> &[Film] {
        &self.layers[..self.len]
    }

    /// Returns `true` if a layer absorbs light.
    #[must_use]
    pub fn absorbs(&self) -> bool {
        self.layers()
            .iter()
            .any(|film| film.kappa > 0.0 && film.phase > 0.0)
    }

    /// The stack as light from the other side meets it, whose medium has the real index `eta`.
    pub(crate) const fn reversed(self, eta: f64) -> Self {
        let mut layers = [Self::NONE; MAX_FILMS];
        let mut i = 0;
        while i < self.len {
            let film = self.layers[self.len - 1 - i];
            layers[i] = Film {
                eta: film.eta / eta,
                kappa: film.kappa / eta,
                phase: film.phase * eta,
            };
            i += 1;
        }
        Self { layers, ..self }
    }

    /// Amplitudes at `cos_theta_i` in `[0, 1]` on a substrate of relative index `eta + i kappa`.
    ///
    /// At grazing incidence all light is reflected.
    #[must_use]
    pub fn amplitudes(&self, cos_theta_i: f64, eta: f64, kappa: f64) -> FilmAmplitudes {
        let sin2 = (1.0 - cos_theta_i) * (1.0 + cos_theta_i);
        if cos_theta_i <= 0.0 {
            return FilmAmplitudes {
                r: [-Complex64::ONE; 2],
                t: [Complex64::ZERO; 2],
                flux: [0.0; 2],
            };
        }
        // Start with the wave in the substrate, for s and for p
        let substrate = Medium::new(eta, kappa, sin2);
        let mut fields = substrate.x().map(|x| (Complex64::ONE, x));
        // Carry the fields through the layers
        let mut passed = Complex64::ONE;
        for film in self.layers().iter().rev() {
            let medium = Medium::new(film.eta, film.kappa, sin2);
            let phase = Complex64::I * medium.q * film.phase;
            let turn = exp_minus_one(2.0 * phase);
            let cos = 1.0 + 0.5 * turn;
            passed *= complex_exp(phase);
            let [x, weight] = [medium.x(), [Complex64::ONE, medium.m2]];
            for (i, (u, v)) in fields.iter_mut().enumerate() {
                let sin = if x[i] == Complex64::ZERO {
                    -Complex64::I * film.phase * weight[i]
                } else {
                    -0.5 * turn / x[i]
                };
                (*u, *v) = (cos * *u + sin * *v, cos * *v + sin * x[i] * x[i] * *u);
            }
        }
        // Split the fields above the stack into the incident and the reflected wave
        let x0 = cos_theta_i;
        let m = Complex64::new(eta, kappa);
        let amplitudes = fields.map(|(u, v)| {
            let incident = x0 * u + v;
            ((x0 * u - v) / incident, 2.0 * x0 * passed / incident)
        });
        let [(r_s, t_s), (r_p, t_p)] = amplitudes;
        FilmAmplitudes {
            r: [r_s, r_p],
            t: [t_s, t_p / m],
            flux: [substrate.q.re / x0, substrate.x()[1].re * m.norm_sqr() / x0],
        }
    }

    /// Fresnel terms on a substrate of relative index `eta + i kappa`, transparent if `kappa = 0`, for `cos_theta_i` in `[0, 1]`.
    ///
    /// Into a transparent substrate, both fractions add to one exactly if no layer absorbs. Nothing is transmitted into an absorbing one.
    #[must_use]
    pub fn fresnel(&self, cos_theta_i: f64, eta: f64, kappa: f64) -> PolarisedFresnel {
        let FilmAmplitudes { r, t, flux } = self.amplitudes(cos_theta_i, eta, kappa);
        let mut reflectances = r.map(|r| r.norm_sqr().min(1.0));
        let mut transmittances = [0, 1].map(|i| (t[i].norm_sqr() * flux[i]).min(1.0));
        let transmits = kappa == 0.0;
        if transmits && !self.absorbs() {
            // The smaller fraction keeps its relative accuracy, and both add to one exactly.
            for (r, t) in reflectances.iter_mut().zip(&mut transmittances) {
                if *r < 0.5 {
                    *t = 1.0 - *r;
                } else {
                    *r = 1.0 - *t;
                }
            }
        }
        let transmitted = if transmits {
            matrix(transmittances, t[0] * t[1].conj() * flux[0])
        } else {
            FacetMueller::NONE
        };
        PolarisedFresnel {
            reflected: matrix(reflectances, r[0] * r[1].conj()),
            transmitted,
            cos_theta_t: if transmits {
                dielectric(cos_theta_i, eta).cos_theta_t
            } else {
                0.0
            },
        }
    }
}

/// Amplitudes of a stack of thin films for s and p, `[s, p]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmAmplitudes {
    /// Reflected electric field; `r_p = -r_s` at normal incidence.
    pub r: [Complex64; 2],
    /// Electric field in the substrate, at its face.
    pub t: [Complex64; 2],
    /// Factors from the squares of `t` to fluxes; zero where the wave in a transparent substrate is evanescent.
    pub flux: [f64; 2],
}

/// Mueller matrix of the fractions of s and p, and of the product of one amplitude and the conjugate of the other.
fn matrix([s, p]: [f64; 2], product: Complex64) -> FacetMueller {
    FacetMueller {
        m00: 0.5 * (s + p),
        m01: 0.5 * (s - p),
        m22: product.re,
        m23: product.im,
    }
}

/// Wave in a homogeneous medium.
struct Medium {
    /// Square of the index.
    m2: Complex64,
    /// Component of the wave vector across the layers, in units of the wave number in the incident medium.
    q: Complex64,
}

impl Medium {
    fn new(eta: f64, kappa: f64, sin2: f64) -> Self {
        // m^2 - 1 + cos^2 without cancellation for an index near one.
        let cos2 = 1.0 - sin2;
        let re = (eta - 1.0) * (eta + 1.0) - kappa * kappa + cos2;
        let im = 2.0 * eta * kappa;
        Self {
            m2: Complex64::new((eta - kappa) * (eta + kappa), im),
            q: first_quadrant_root(re, im),
        }
    }

    /// Ratio of the tangential fields of a wave, for s and p.
    fn x(&self) -> [Complex64; 2] {
        [self.q, self.q / self.m2]
    }
}

fn complex_exp(z: Complex64) -> Complex64 {
    let (sin, cos) = sin_cos(z.im);
    exp(z.re) * Complex64::new(cos, sin)
}

/// `exp(z) - 1` without cancellation for small `z`.
fn exp_minus_one(z: Complex64) -> Complex64 {
    let half = sin(0.5 * z.im);
    let (sin, cos) = sin_cos(z.im);
    Complex64::new(exp_m1(z.re) * cos - 2.0 * half * half, exp(z.re) * sin)
}

impl TryFrom<Vec<Film>> for Films {
    type Error = MaterialError;

    fn try_from(layers: Vec<Film>) -> Result<Self, MaterialError> {
        Self::new(&layers)
    }
}

impl From<Films> for Vec<Film> {
    fn from(films: Films) -> Self {
        films.layers().to_vec()
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::{Material, polarised_conductor, polarised_dielectric};

    const fn film(eta: f64, kappa: f64, phase: f64) -> Film {
        Film { eta, kappa, phase }
    }

    fn coated(layers: &[Film], eta: f64, kappa: f64) -> Material {
        Material::coated(Films::new(layers).unwrap(), eta, kappa).unwrap()
    }

    fn cosines() -> impl Iterator<Item = f64> {
        (1..=200).map(|i| f64::from(i) / 200.0)
    }

    fn elements(f: PolarisedFresnel) -> [f64; 9] {
        let [r, t] = [f.reflected, f.transmitted];
        let cos_theta_t = f.cos_theta_t;
        [
            r.m00,
            r.m01,
            r.m22,
            r.m23,
            t.m00,
            t.m01,
            t.m22,
            t.m23,
            cos_theta_t,
        ]
    }

    #[track_caller]
    fn assert_near(a: PolarisedFresnel, b: PolarisedFresnel, tolerance: f64, at: &str) {
        for (x, y) in elements(a).into_iter().zip(elements(b)) {
            assert!((x - y).abs() < tolerance, "{at}: {a:?} {b:?}");
        }
    }

    #[test]
    fn a_quarter_wave_has_the_closed_form() {
        // R = ((n_s - n^2) / (n_s + n^2))^2 at normal incidence.
        for (n, n_s) in [(1.38_f64, 1.5_f64), (2.3, 1.5), (1.2, 1.44), (1.38, 0.8)] {
            let found = coated(&[film(n, 0.0, FRAC_PI_2 / n)], n_s, 0.0).fresnel(1.0);
            let expected = ((n_s - n * n) / (n_s + n * n)).powi(2);
            assert!((found.reflected - expected).abs() < 1e-15, "{n} {n_s}");
        }
    }

    #[test]
    fn films_that_change_nothing_leave_the_bare_interface() {
        for eta in [1.5, 1.0 / 1.5, 2.4] {
            for c in cosines() {
                let expected = polarised_dielectric(c, eta);
                // Rounding is magnified near the critical angle, where the root of a small number is taken.
                let g = ((eta - 1.0) * (eta + 1.0) + c * c).abs().sqrt();
                let tolerance = 1e-14 * (1.0 + 1.0 / g);
                for layers in [
                    &[][..],
                    &[film(1.0, 0.0, 2.3)],
                    &[film(eta, 0.0, 0.0), film(2.0, 1.0, 0.0)],
                ] {
                    let found = coated(layers, eta, 0.0).polarised_fresnel(c);
                    let mut found = found;
                    let mut expected = expected;
                    if layers.first().is_some_and(|film| film.phase > 0.0) {
                        // A layer of the incident medium turns the phases of s and p alike.
                        [found, expected] = [found, expected].map(|mut f| {
                            f.transmitted.m23 = 0.0;
                            f
                        });
                    }
                    assert_near(found, expected, tolerance, &format!("{layers:?} {eta} {c}"));
                }
                if eta > 1.0 {
                    let found = coated(&[film(eta, 0.0, 1.7)], eta, 0.0).polarised_fresnel(c);
                    assert_near(found, expected, tolerance, &format!("{eta} {c}"));
                }
            }
        }
        for (eta, kappa) in [(0.43, 2.455), (1.5, 0.1)] {
            for c in cosines() {
                let expected = polarised_conductor(c, eta, kappa);
                for layers in [&[][..], &[film(1.0, 0.0, 2.3)], &[film(eta, kappa, 0.7)]] {
                    let found = coated(layers, eta, kappa).polarised_fresnel(c);
                    assert_near(found, expected, 2e-14, &format!("{layers:?} {eta} {c}"));
                }
            }
        }
    }

    #[test]
    fn one_layer_follows_airys_formula() {
        let airy = |[a, b]: [Complex64; 2], turn: Complex64| (a + b * turn) / (1.0 + a * b * turn);
        for (layer, substrate) in [
            (film(1.38, 0.0, 1.1), [1.5, 0.0]),
            (film(2.3, 0.4, 0.8), [1.5, 0.0]),
            (film(1.8, 0.0, 2.1), [0.2, 3.3]),
            (film(0.7, 0.0, 1.2), [1.0, 0.0]),
        ] {
            for c in cosines() {
                let sin2 = (1.0 - c) * (1.0 + c);
                let indices = [[1.0, 0.0], [layer.eta, layer.kappa], substrate]
                    .map(|[n, k]| Complex64::new(n, k));
                let [_, q1, q2] = indices.map(|m| (m * m - sin2).sqrt());
                let q0 = Complex64::from(c);
                let [e0, e1, e2] = indices.map(|m| m * m);
                let turn = (2.0 * Complex64::I * layer.phase * q1).exp();
                let r_s = [(q0 - q1) / (q0 + q1), (q1 - q2) / (q1 + q2)];
                let r_p = [
                    (e1 * q0 - e0 * q1) / (e1 * q0 + e0 * q1),
                    (e2 * q1 - e1 * q2) / (e2 * q1 + e1 * q2),
                ];
                let films = Films::new(&[layer]).unwrap();
                let found = films.amplitudes(c, substrate[0], substrate[1]).r;
                for (found, expected) in found.into_iter().zip([airy(r_s, turn), airy(r_p, turn)]) {
                    assert!((found - expected).norm() < 1e-13, "{layer:?} {c}");
                }
            }
        }
    }

    #[test]
    fn light_is_reflected_transmitted_or_absorbed() {
        let clear = [
            film(2.3, 0.0, 0.9),
            film(0.6, 0.0, 3.0),
            film(1.4, 0.0, 1.7),
        ];
        let metal = [film(1.4, 0.0, 1.7), film(0.2, 3.3, 0.1)];
        for eta in [1.5, 0.7, 1.0] {
            for c in cosines().chain([0.0, 1e-12]) {
                let f = coated(&clear, eta, 0.0).fresnel(c);
                assert!((f.reflected + f.transmitted - 1.0).abs() < 4e-16);
                let material = coated(&metal, eta, 0.0);
                let f = material.fresnel(c);
                let sum = f.reflected + f.transmitted;
                assert!(
                    sum < 1.0 + 1e-15 && (c < 1e-9 || sum < 1.0),
                    "{eta} {c} {f:?}"
                );
                assert!((material.absorbed(&f) + sum - 1.0).abs() < 1e-15);
                let opaque = coated(&metal, eta, 0.3).fresnel(c);
                assert!((opaque.reflected + opaque.transmitted - 1.0).abs() < 1e-15);
            }
        }
        // Flux of clear films before the fractions are made to add to one.
        let films = Films::new(&clear).unwrap();
        for c in cosines() {
            let FilmAmplitudes { r, t, flux } = films.amplitudes(c, 1.5, 0.0);
            for i in 0..2 {
                let sum = r[i].norm_sqr() + flux[i] * t[i].norm_sqr();
                assert!((sum - 1.0).abs() < 1e-13, "{c} {sum}");
            }
        }
    }

    #[test]
    fn both_sides_transmit_alike() {
        let layers = [
            film(2.3, 0.2, 0.9),
            film(1.4, 0.0, 1.7),
            film(0.2, 3.3, 0.1),
        ];
        for eta in [1.5, 0.7] {
            let material = coated(&layers, eta, 0.0);
            for c in cosines() {
                let forth = material.polarised_fresnel(c);
                if forth.transmitted.m00 == 0.0 {
                    assert!(forth.reflected.m00 < 1.0);
                    continue;
                }
                let back = material.reversed().polarised_fresnel(forth.cos_theta_t);
                let [forth, back] = [forth, back].map(elements);
                for (a, b) in forth[4..8].iter().zip(&back[4..8]) {
                    assert!((a - b).abs() < 1e-13 / c, "{eta} {c}: {a} {b}");
                }
                assert!(
                    (forth[0] - back[0]).abs() > 1e-6,
                    "a lossy stack has two faces"
                );
            }
        }
    }

    #[test]
    fn a_thick_absorbing_layer_is_a_half_space_of_it() {
        for (eta, kappa) in [(0.2, 3.3), (1.7, 0.5)] {
            for phase in [100.0, 1e6] {
                for c in cosines() {
                    let found = coated(&[film(eta, kappa, phase)], 1.5, 0.0).polarised_fresnel(c);
                    let expected = polarised_conductor(c, eta, kappa).reflected;
                    let expected = PolarisedFresnel {
                        reflected: expected,
                        transmitted: FacetMueller::NONE,
                        ..found
                    };
                    assert_near(found, expected, 1e-14, &format!("{eta} {phase} {c}"));
                }
            }
        }
    }

    #[test]
    fn a_gap_at_its_critical_angle_has_a_finite_value() {
        // q of the layer is zero: the fields are linear across it, between media of index 1.
        let (eta, phase) = (0.6_f64, 2.0);
        let c = (1.0 - eta * eta).sqrt();
        let films = Films::new(&[film(eta, 0.0, phase)]).unwrap();
        let at = |c: f64| films.fresnel(c, 1.0, 0.0).reflected.m00;
        let fraction = |a: f64| a * a / (4.0 + a * a);
        let expected = 0.5 * (fraction(phase * c) + fraction(phase * eta * eta * c));
        assert!((at(c) - expected).abs() < 1e-14, "{} {expected}", at(c));
        assert!((at(c) - at(c + 1e-9)).abs() < 1e-7 && (at(c) - at(c - 1e-9)).abs() < 1e-7);
    }

    #[test]
    fn invalid_stacks_are_refused() {
        let good = film(1.38, 0.0, 1.0);
        assert!(Films::new(&[good; 8]).is_ok());
        assert_eq!(Films::new(&[good; 9]), Err(MaterialError::TooManyFilms(9)));
        for bad in [
            film(0.0, 0.0, PI),
            film(1.0, -1.0, PI),
            film(1.0, 0.0, -1.0),
            film(1.0, 0.0, f64::NAN),
        ] {
            assert!(Films::new(&[bad]).is_err(), "{bad:?}");
        }
        assert!(Material::coated(Films::new(&[]).unwrap(), 1.5, -1.0).is_err());
    }
}
