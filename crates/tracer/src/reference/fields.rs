//! Fields: the electric field vectors of the light of a path, in the world.
//!
//! Partly polarised light is two fields that do not interfere. They are complex vectors in space, of the time factor
//! `exp(-i w t)`: no axes go along with a ray, and no Stokes vector. Those appear only where a path begins and ends, so that
//! this is a check of the path engine, which turns Stokes vectors from axes to axes.

use asperity_optics::{PhaseFunction, Stokes, reference_axes};
use glam::DVec3;
use num_complex::Complex64;
use rand::{Rng, RngExt};

/// Square of the sine of the angle of incidence below which the plane of incidence is lost in rounding.
const NORMAL_INCIDENCE: f64 = 1e-30;

/// A field vector.
type Field = [Complex64; 3];

/// The light of a path, as two fields without coherence between them.
///
/// Both are across the ray. Their squared lengths add up to the flux relative to that of the path, which is one between
/// interactions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fields([Field; 2]);

/// A ray before and after an interface, with the normal of the interface: unit vectors in the world.
pub(super) struct Deflection {
    /// Direction of travel before.
    pub(super) k: DVec3,
    /// Direction of travel after.
    pub(super) k_out: DVec3,
    /// Normal, on either side.
    pub(super) m: DVec3,
}

impl Fields {
    /// The fields of light along `k` of a Stokes vector in the [`reference_axes`] of `k`, whose flux counts as one.
    ///
    /// The first field has all of s, and what of p is coherent with it; the second has the rest of p.
    pub(super) fn from_stokes(k: DVec3, Stokes([i, q, u, v]): Stokes) -> Self {
        let s = (0.5 * (i + q)).max(0.0).sqrt();
        let p = if s > 0.0 {
            Complex64::new(u, v) / (2.0 * s)
        } else {
            Complex64::ZERO
        };
        let rest = (0.5 * (i - q) - p.norm_sqr()).max(0.0).sqrt();
        let axes = reference_axes(k);
        let fields = [[s.into(), p], [Complex64::ZERO, rest.into()]];
        Self(fields.map(|components| field(axes, components))).normalised()
    }

    /// Unpolarised light along `k`.
    pub(super) fn unpolarised(k: DVec3) -> Self {
        Self::from_stokes(k, Stokes::UNPOLARISED)
    }

    /// The Stokes vector in the [`reference_axes`] of `k`, along which the light travels.
    pub(super) fn stokes(&self, k: DVec3) -> Stokes {
        let axes = reference_axes(k);
        let mut sum = [0.0; 4];
        for field in &self.0 {
            let [s, p] = axes.map(|axis| along(field, axis));
            let cross = s.conj() * p;
            sum[0] += s.norm_sqr() + p.norm_sqr();
            sum[1] += s.norm_sqr() - p.norm_sqr();
            sum[2] += 2.0 * cross.re;
            sum[3] += 2.0 * cross.im;
        }
        Stokes(sum)
    }

    /// Flux, per flux of the path.
    pub(super) fn flux(&self) -> f64 {
        self.0.as_flattened().iter().map(Complex64::norm_sqr).sum()
    }

    /// These fields scaled to the flux one; unchanged if there is no light.
    pub(super) fn normalised(self) -> Self {
        let flux = self.flux();
        let scale = if flux > 0.0 { 1.0 / flux.sqrt() } else { 1.0 };
        Self(self.0.map(|field| field.map(|component| component * scale)))
    }

    /// The fields after an interface of these amplitudes for s and p.
    ///
    /// s is along `k x m` and `p = k x s` for either ray; at normal incidence any s will do.
    pub(super) fn after(&self, ray: &Deflection, amplitudes: [Complex64; 2]) -> Self {
        let Deflection { k, k_out, m } = *ray;
        let axis = k.cross(m);
        let s = if axis.length_squared() < NORMAL_INCIDENCE {
            k.any_orthonormal_vector()
        } else {
            axis.reject_from_normalized(k).normalize()
        };
        let [p, p_out] = [k.cross(s), k_out.cross(s)];
        let [a_s, a_p] = amplitudes;
        Self(self.0.map(|incident| {
            let components = [a_s * along(&incident, s), a_p * along(&incident, p)];
            field([s, p_out], components)
        }))
    }

    /// The fields that dipoles along these fields radiate along the unit vector `d`: `E' = E - d (d . E)`.
    fn radiated(&self, d: DVec3) -> Self {
        Self(self.0.map(|field| {
            let longitudinal = along(&field, d);
            let d = d.to_array();
            [0, 1, 2].map(|i| field[i] - longitudinal * d[i])
        }))
    }

    /// A direction of Rayleigh scattering, and the fields there.
    ///
    /// Directions are proposed evenly over the sphere and accepted with the probability of the flux that the dipoles radiate
    /// there; two of three are.
    pub(super) fn rayleigh<R: Rng>(&self, rng: &mut R) -> (DVec3, Self) {
        loop {
            let d = PhaseFunction::Isotropic.sample(DVec3::Z, [rng.random(), rng.random()]);
            let radiated = self.radiated(d);
            if rng.random::<f64>() < radiated.flux() {
                return (d, radiated.normalised());
            }
        }
    }
}

/// The field of components along two axes.
fn field([s, p]: [DVec3; 2], [e_s, e_p]: [Complex64; 2]) -> Field {
    [0, 1, 2].map(|i| e_s * s[i] + e_p * p[i])
}

/// The component of a field along an axis.
fn along(field: &Field, axis: DVec3) -> Complex64 {
    field[0] * axis.x + field[1] * axis.y + field[2] * axis.z
}
