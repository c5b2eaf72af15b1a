//! A random walk that carries the field of the light as a complex vector in space: no Stokes vectors, no Mueller
//! matrices, no axes of rays, one frame for both sides of the surface.

use asperity_analysis::{Beckmann, RandomWalk, SlopeCovariance};
use asperity_optics::Material;
use asperity_tally::{Event, EventPath, Exit, Loss, Side, Tally};
use glam::DVec3;
use num_complex::Complex64;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Interactions after which a path is dropped: beyond the orders that are compared.
const MAX_INTERACTIONS: u32 = 100;

/// The walk of Heitz et al. 2016 with the sign rule of Lambda and `C1` itself, as light whose flux is the square of its
/// field. Of both branches of a dielectric facet one is followed, each with probability one half.
pub(super) struct FieldWalk {
    distribution: Beckmann,
    material: Material,
}

impl FieldWalk {
    pub(super) fn new(slopes: SlopeCovariance, material: Material) -> Self {
        Self {
            distribution: Beckmann::new(slopes),
            material,
        }
    }

    /// Lambda of a direction anywhere on the sphere, for a ray whose medium lies towards `up`.
    fn lambda(&self, d: DVec3, up: f64) -> f64 {
        let lambda = self.distribution.lambda(d);
        if d.z * up > 0.0 {
            lambda
        } else {
            -1.0 - lambda
        }
    }
}

/// A complex vector, by its real and its imaginary part.
#[derive(Clone, Copy)]
struct Field {
    re: DVec3,
    im: DVec3,
}

impl Field {
    fn along(self, axis: DVec3) -> Complex64 {
        Complex64::new(self.re.dot(axis), self.im.dot(axis))
    }

    fn flux(self) -> f64 {
        self.re.length_squared() + self.im.length_squared()
    }

    fn of(amplitudes: [Complex64; 2], axes: [DVec3; 2]) -> Self {
        Self {
            re: amplitudes[0].re * axes[0] + amplitudes[1].re * axes[1],
            im: amplitudes[0].im * axes[0] + amplitudes[1].im * axes[1],
        }
    }
}

/// A ray at a facet of relative index `n`, whose normal `m` is on its side.
struct Arrival {
    d: DVec3,
    m: DVec3,
    n: Complex64,
}

impl Arrival {
    fn cos_i(&self) -> f64 {
        -self.d.dot(self.m)
    }

    /// The cosine of the angle of refraction, complex, with a positive imaginary part of the wave vector.
    fn cos_t(&self) -> Complex64 {
        let sin2 = 1.0 - self.cos_i().powi(2);
        let root = (1.0 - sin2 / (self.n * self.n)).sqrt();
        if (self.n * root).im < 0.0 {
            -root
        } else {
            root
        }
    }

    /// The normal of the plane of incidence.
    fn axis(&self) -> DVec3 {
        let axis = self.d.cross(self.m);
        axis.try_normalize()
            .unwrap_or_else(|| self.d.any_orthonormal_vector())
    }

    /// The field along `d_out` after factors for the field across the plane of incidence and in it.
    fn carried(&self, e: Field, factors: [Complex64; 2], d_out: DVec3) -> Field {
        let s = self.axis();
        let amplitudes = [
            e.along(s) * factors[0],
            e.along(self.d.cross(s)) * factors[1],
        ];
        Field::of(amplitudes, [s, d_out.cross(s)])
    }

    fn reflected(&self, e: Field) -> (DVec3, Field) {
        let (c, ct, n) = (self.cos_i(), self.cos_t(), self.n);
        let d = (self.d + 2.0 * c * self.m).normalize();
        let r_s = (c - n * ct) / (c + n * ct);
        let r_p = (n * c - ct) / (n * c + ct);
        (d, self.carried(e, [r_s, r_p], d))
    }

    /// Refracted light, its field scaled such that its square is flux; `None` under total reflection.
    fn refracted(&self, e: Field) -> Option<(DVec3, Field)> {
        let (c, ct, n) = (self.cos_i(), self.cos_t(), self.n);
        if ct.re <= 0.0 {
            return None;
        }
        let d = (self.d / n.re + (c / n.re - ct.re) * self.m).normalize();
        let scale = (n.re * ct.re / c).sqrt();
        let t_s = scale * 2.0 * c / (c + n * ct);
        let t_p = scale * 2.0 * c / (n * c + ct);
        Some((d, self.carried(e, [t_s, t_p], d)))
    }
}

impl RandomWalk for FieldWalk {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        let mut path = EventPath::default();
        // +1 in the incident medium, -1 in the other.
        let mut up = 1.0;
        let mut d = -wi;
        // Fraction of the surface on the far side of the medium that the ray is in.
        let mut c1: f64 = 1.0;
        // Unpolarised light is linearly polarised light of all azimuths.
        let a = d.any_orthonormal_vector();
        let (sin, cos) = (std::f64::consts::TAU * rng.random::<f64>()).sin_cos();
        let mut e = Field {
            re: cos * a + sin * d.cross(a),
            im: DVec3::ZERO,
        };
        while path.order() < MAX_INTERACTIONS {
            let lambda = self.lambda(d, up);
            let u: f64 = rng.random();
            if d.z * up > 0.0 && u >= 1.0 - c1.powf(lambda) {
                let side = if up > 0.0 {
                    Side::Reflected
                } else {
                    Side::Transmitted
                };
                tally.add_exit(&Exit {
                    side,
                    wo: d,
                    flux: e.flux(),
                    path,
                    scatterings: 0,
                });
                return;
            }
            c1 /= (1.0 - u).powf(1.0 / lambda);
            let flip = DVec3::new(1.0, 1.0, up);
            let m = flip * self.distribution.sample_visible(-d * flip, rng);
            let Material::Dielectric { eta } = self.material else {
                let arrival = Arrival {
                    d,
                    m,
                    n: metal(self.material),
                };
                let flux = e.flux();
                (d, e) = arrival.reflected(e);
                tally.add_loss(Loss::Absorbed, flux - e.flux());
                path = path.then(Event::Reflection);
                continue;
            };
            let n = Complex64::from(if up > 0.0 { eta } else { 1.0 / eta });
            let arrival = Arrival { d, m, n };
            let transmits = rng.random::<bool>();
            match (transmits, arrival.refracted(e)) {
                (true, Some(refracted)) => {
                    (d, e) = refracted;
                    path = path.then(Event::Transmission);
                    up = -up;
                    c1 = 1.0 - c1;
                }
                // Nothing is transmitted, and half of the paths are dropped.
                (true, None) => return,
                (false, _) => {
                    (d, e) = arrival.reflected(e);
                    path = path.then(Event::Reflection);
                }
            }
            // Twice the flux for half of the paths.
            let root = std::f64::consts::SQRT_2;
            e = Field {
                re: root * e.re,
                im: root * e.im,
            };
        }
    }
}

fn metal(material: Material) -> Complex64 {
    match material {
        Material::Conductor { eta, kappa } => Complex64::new(eta, kappa),
        other => panic!("{other:?} has no complex index"),
    }
}
