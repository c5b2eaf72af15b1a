//! Light on a path: what the walk knows of its polarisation, of which facets reflect more or less.

use asperity_optics::{Fresnel, Material, Stokes, Turn, incidence_axis};
use glam::DVec3;

/// The state of light of unit flux on a path. Its flux is the weight of the path.
pub(crate) trait Light: Copy {
    /// Unpolarised light, as it falls on the surface.
    const INCIDENT: Self;

    /// Numbers that tell the state, of at most [`LIGHT_COLUMNS`].
    const KEPT: usize;

    /// The state as numbers, of which the first [`Self::KEPT`] count.
    fn to_numbers(self) -> [f64; LIGHT_COLUMNS];

    /// The state of these numbers.
    fn from_numbers(numbers: [f64; LIGHT_COLUMNS]) -> Self;

    /// Scattering of this light by a facet: `material` seen from the side of the light, `w` the unit direction towards
    /// its origin, `m` the normal.
    fn scattered(self, material: Material, w: DVec3, m: DVec3) -> Scattered<Self>;
}

/// Most numbers that tell the state of light.
pub(super) const LIGHT_COLUMNS: usize = 6;

/// Light that a facet divides.
pub(crate) struct Scattered<L> {
    /// The fractions that are reflected, and transmitted or absorbed.
    pub(super) fresnel: Fresnel,
    /// Reflected light.
    pub(super) reflected: L,
    /// Transmitted light, in the frame with z reversed: in the mirror image of the scene.
    pub(super) transmitted: L,
}

/// Light that is taken as unpolarised at every facet, as Heitz et al. 2016 do.
#[derive(Clone, Copy)]
pub(crate) struct Averaged;

impl Light for Averaged {
    const INCIDENT: Self = Self;
    const KEPT: usize = 0;

    #[inline(always)]
    fn to_numbers(self) -> [f64; LIGHT_COLUMNS] {
        [0.0; LIGHT_COLUMNS]
    }

    #[inline(always)]
    fn from_numbers(_: [f64; LIGHT_COLUMNS]) -> Self {
        Self
    }

    #[inline(always)]
    fn scattered(self, material: Material, w: DVec3, m: DVec3) -> Scattered<Self> {
        Scattered {
            fresnel: material.fresnel(w.dot(m).clamp(0.0, 1.0)),
            reflected: Self,
            transmitted: Self,
        }
    }
}

/// Light with its state of polarisation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polarised {
    /// Stokes vector of unit flux, in axes of which `s` is the first.
    stokes: Stokes,
    /// Axis across the ray, not of unit length: that of the facet which the light comes from.
    s: DVec3,
}

impl Light for Polarised {
    const INCIDENT: Self = Self {
        stokes: Stokes::UNPOLARISED,
        s: DVec3::Y,
    };
    const KEPT: usize = LIGHT_COLUMNS;

    #[inline(always)]
    fn to_numbers(self) -> [f64; LIGHT_COLUMNS] {
        let Stokes([_, q, u, v]) = self.stokes;
        [q, u, v, self.s.x, self.s.y, self.s.z]
    }

    #[inline(always)]
    fn from_numbers([q, u, v, x, y, z]: [f64; LIGHT_COLUMNS]) -> Self {
        Self {
            stokes: Stokes([1.0, q, u, v]),
            s: DVec3::new(x, y, z),
        }
    }

    #[inline(always)]
    fn scattered(self, material: Material, w: DVec3, m: DVec3) -> Scattered<Self> {
        // Turn to the axes of the plane of incidence
        let s = incidence_axis(-w, m);
        let stokes = self
            .stokes
            .turned(Turn::to_axis(-w, self.s).inverse())
            .turned(Turn::to_axis(-w, s));
        // Divide the light, which keeps these axes on both branches
        let fresnel = material.polarised_fresnel(w.dot(m).clamp(0.0, 1.0));
        let (reflectance, reflected) = split(stokes.after(fresnel.reflected));
        let (transmittance, transmitted) = split(stokes.after(fresnel.transmitted));
        Scattered {
            fresnel: Fresnel {
                reflected: reflectance,
                transmitted: match material.transmitting_index() {
                    Some(_) => transmittance,
                    None => 1.0 - reflectance,
                },
                cos_theta_t: fresnel.cos_theta_t,
            },
            reflected: Self {
                stokes: reflected,
                s,
            },
            transmitted: Self {
                stokes: transmitted,
                s,
            }
            .seen_from_behind(),
        }
    }
}

impl Polarised {
    /// This light in the mirror image of the scene, with z reversed. The axis s is mirrored, and of `p = k x s` the
    /// other sense is: so U and V change their signs.
    #[inline(always)]
    const fn seen_from_behind(self) -> Self {
        let Self {
            stokes: Stokes([i, q, u, v]),
            s,
        } = self;
        Self {
            stokes: Stokes([i, q, -u, -v]),
            s: DVec3::new(s.x, s.y, -s.z),
        }
    }
}

/// Splits a Stokes vector into its flux and the normalised vector `[1, Q/I, U/I, V/I]`; unpolarised if the flux is zero.
#[inline(always)]
fn split(stokes: Stokes) -> (f64, Stokes) {
    let Stokes([flux, q, u, v]) = stokes;
    let norm = stokes.norm();
    // Selected, not branched to, so that loops over many paths take vector instructions.
    let is_lit = norm > 0.0;
    let over = |x: f64| if is_lit { x / norm } else { 0.0 };
    let kept = if flux > 0.0 { flux } else { 0.0 };
    (
        if is_lit { kept } else { 0.0 },
        Stokes([1.0, over(q), over(u), over(v)]),
    )
}

#[cfg(test)]
mod tests {
    use asperity_optics::{Mueller, from_spherical, reflect, refract};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    fn materials() -> [Material; 4] {
        [
            Material::Mirror,
            Material::conductor(0.43, 2.455).unwrap(),
            Material::dielectric(1.5).unwrap(),
            Material::dielectric(1.0 / 1.5).unwrap(),
        ]
    }

    fn mirrored(w: DVec3) -> DVec3 {
        DVec3::new(w.x, w.y, -w.z)
    }

    /// A unit vector anywhere on the sphere.
    fn random_direction(rng: &mut ChaCha8Rng) -> DVec3 {
        let z = 2.0 * rng.random::<f64>() - 1.0;
        from_spherical(z.acos(), 6.3 * rng.random::<f64>())
    }

    /// A path followed twice: as the walk does, in a frame whose z is reversed by every transmission, and as a Mueller
    /// matrix in the axes of the rays, in one frame.
    struct Path {
        light: Polarised,
        flux: f64,
        matrix: Mueller,
        /// Direction in the one frame.
        k: DVec3,
        is_reversed: bool,
    }

    impl Path {
        /// Meets the facet whose normal, in the one frame, is along `m`; is transmitted if it can be and `transmits`.
        fn meet(&mut self, material: Material, m: DVec3, transmits: bool) {
            let material = if self.is_reversed {
                material.reversed()
            } else {
                material
            };
            let m = if self.k.dot(m) < 0.0 { m } else { -m };
            let own = |v| if self.is_reversed { mirrored(v) } else { v };
            let scattered = self.light.scattered(material, -own(self.k), own(m));
            let axis = incidence_axis(self.k, m);
            let fresnel = material.polarised_fresnel(-self.k.dot(m));
            let eta = material.transmitting_index().unwrap_or(1.0);
            let transmits = transmits && fresnel.transmitted.m00 > 0.0;
            let (fraction, k_out, facet) = if transmits {
                self.light = scattered.transmitted;
                self.is_reversed = !self.is_reversed;
                let k_out = refract(-self.k, m, eta, fresnel.cos_theta_t);
                (scattered.fresnel.transmitted, k_out, fresnel.transmitted)
            } else {
                self.light = scattered.reflected;
                let k_out = reflect(-self.k, m);
                (scattered.fresnel.reflected, k_out, fresnel.reflected)
            };
            self.flux *= fraction;
            self.matrix = self.matrix.then_facet(
                Turn::to_axis(self.k, axis),
                facet,
                Turn::to_axis(k_out, axis).inverse(),
            );
            self.k = k_out;
        }

        /// The Stokes vector in the axes of the last ray, in the one frame.
        fn stokes(&self) -> [f64; 4] {
            let light = if self.is_reversed {
                self.light.seen_from_behind()
            } else {
                self.light
            };
            let own = Turn::to_axis(self.k, light.s);
            light.stokes.turned(own.inverse()).0.map(|x| self.flux * x)
        }
    }

    #[test]
    fn paths_have_the_stokes_vectors_of_mueller_matrices() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut most = [0.0_f64; 4];
        for material in materials() {
            for _ in 0..500 {
                let mut path = Path {
                    light: Polarised::INCIDENT,
                    flux: 1.0,
                    matrix: Mueller::IDENTITY,
                    k: random_direction(&mut rng),
                    is_reversed: false,
                };
                for _ in 0..8 {
                    let m = random_direction(&mut rng);
                    path.meet(material, m, rng.random());
                    let Stokes(expected) = path.matrix.apply(Stokes::UNPOLARISED);
                    // Some roundings per facet. Light that its polarisation keeps from being reflected has lost digits
                    // of its flux: the facet magnifies rounding by what it takes away.
                    for (i, (found, expected)) in
                        path.stokes().into_iter().zip(expected).enumerate()
                    {
                        assert!(
                            (found - expected).abs() < 1e-12 * path.flux,
                            "{material:?} {i}"
                        );
                        most[i] = most[i].max(expected.abs() / path.flux);
                    }
                }
            }
        }
        // All kinds of polarisation occur.
        assert!(most.iter().all(|&part| part > 0.9), "{most:?}");
    }

    #[test]
    fn a_dielectric_keeps_the_flux_of_any_state() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for material in materials() {
            for _ in 0..2000 {
                let w = random_direction(&mut rng);
                let m = random_direction(&mut rng);
                let m = if w.dot(m) < 0.0 { -m } else { m };
                // Fully polarised along any axis, in part circular.
                let v = 2.0 * rng.random::<f64>() - 1.0;
                let light = Polarised {
                    stokes: Stokes([1.0, (1.0 - v * v).sqrt(), 0.0, v]),
                    s: w.cross(random_direction(&mut rng)),
                };
                let fresnel = light.scattered(material, w, m).fresnel;
                let total = fresnel.reflected + fresnel.transmitted;
                assert!((total - 1.0).abs() < 1e-15 && fresnel.reflected <= 1.0 + 1e-15);
            }
        }
    }

    #[test]
    fn unpolarised_light_is_divided_as_without_polarisation() {
        for material in materials() {
            for i in 0..=100 {
                let w = from_spherical(0.0157 * f64::from(i), 0.3);
                let [plain, tracked] = [
                    Averaged::INCIDENT.scattered(material, w, DVec3::Z).fresnel,
                    Polarised::INCIDENT.scattered(material, w, DVec3::Z).fresnel,
                ];
                let is_metal = matches!(material, Material::Conductor { .. });
                let tolerance = if is_metal { 1e-15 } else { 0.0 };
                assert!((plain.reflected - tracked.reflected).abs() <= tolerance);
                assert!((plain.transmitted - tracked.transmitted).abs() <= tolerance);
                assert_eq!(plain.cos_theta_t, tracked.cos_theta_t);
            }
        }
    }

    #[test]
    fn states_that_rounding_spoils_are_made_valid() {
        let (none, state) = split(Stokes([-1e-17, 0.0, 0.0, 0.0]));
        assert_eq!((none, state), (0.0, Stokes::UNPOLARISED));
        let (flux, Stokes([i, q, u, v])) = split(Stokes([1e-17, 3e-17, 0.0, 4e-17]));
        assert_eq!((flux, i, u), (1e-17, 1.0, 0.0));
        assert!((q.hypot(v) - 1.0).abs() < 1e-15);
        // Light that is valid keeps its state.
        let (flux, state) = split(Stokes([0.5, 0.25, -0.125, 0.0]));
        assert_eq!((flux, state), (0.5, Stokes([1.0, 0.5, -0.25, 0.0])));
    }
}
