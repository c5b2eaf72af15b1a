//! Stokes vectors, and the Mueller matrix of a light path.

use super::facet::FacetMueller;
use super::frame::Turn;

/// Stokes vector `[I, Q, U, V]` in the axes of a ray; signs as on the page of the crate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stokes(pub [f64; 4]);

impl Stokes {
    /// Unpolarised light of unit flux.
    pub const UNPOLARISED: Self = Self([1.0, 0.0, 0.0, 0.0]);

    /// The number by which Q, U and V are divided to normalise the vector: I, or the length of (Q, U, V) if rounding has made that
    /// longer, so that the degree of polarisation never exceeds one.
    #[must_use]
    #[inline(always)]
    pub fn norm(self) -> f64 {
        let Self([i, q, u, v]) = self;
        let polarised = (q * q + u * u + v * v).sqrt();
        if i > polarised { i } else { polarised }
    }

    /// This light in axes that are turned about the ray.
    #[must_use]
    #[inline(always)]
    pub const fn turned(self, turn: Turn) -> Self {
        let Self([i, q, u, v]) = self;
        let Turn { cos_2psi, sin_2psi } = turn;
        Self([
            i,
            cos_2psi * q + sin_2psi * u,
            cos_2psi * u - sin_2psi * q,
            v,
        ])
    }

    /// The light after an interface, from and to the axes of the plane of incidence.
    #[must_use]
    #[inline(always)]
    pub const fn after(self, facet: FacetMueller) -> Self {
        let Self([i, q, u, v]) = self;
        let FacetMueller { m00, m01, m22, m23 } = facet;
        Self([
            m00 * i + m01 * q,
            m01 * i + m00 * q,
            m22 * u + m23 * v,
            m22 * v - m23 * u,
        ])
    }
}

/// Mueller matrix of a light path, rows of `[I, Q, U, V]`: from the light in the axes of the first ray to that in the axes of the
/// last.
///
/// # Examples
/// ```
/// use asperity_optics::{Mueller, Stokes, Turn, incidence_axis, polarised_dielectric, reflect};
/// use glam::DVec3;
///
/// // Sunlight on a lake at Brewster's angle: what is reflected is horizontally polarised.
/// let eta = 1.33_f64;
/// let k = DVec3::new(eta, 0.0, -1.0).normalize();
/// let (m, k_out) = (DVec3::Z, reflect(-k, DVec3::Z));
/// let axis = incidence_axis(k, m);
/// let path = Mueller::IDENTITY.then_facet(
///     Turn::to_axis(k, axis),
///     polarised_dielectric(-k.dot(m), eta).reflected,
///     Turn::to_axis(k_out, axis).inverse(),
/// );
/// let Stokes([i, q, u, v]) = path.apply(Stokes::UNPOLARISED);
/// assert!((q - i).abs() < 1e-16 && u == 0.0 && v == 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mueller(pub [[f64; 4]; 4]);

impl Mueller {
    /// The path without any interface.
    pub const IDENTITY: Self = Self([
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.0, 0.0, 0.0, 1.0],
    ]);

    /// The light that arrives of `incident`.
    #[must_use]
    #[inline(always)]
    pub fn apply(&self, incident: Stokes) -> Stokes {
        let [i, q, u, v] = incident.0;
        Stokes(
            self.0
                .map(|row| row[0] * i + row[1] * q + row[2] * u + row[3] * v),
        )
    }

    /// The path with one more interface at its end.
    ///
    /// `turn_in` takes the axes of the ray that arrives to those of the plane of incidence, `turn_out` the axes of the plane to
    /// those of the ray that leaves: [`Turn::to_axis`] of [`incidence_axis`](crate::incidence_axis), and the inverse of that for the
    /// other ray.
    #[must_use]
    #[inline(always)]
    pub fn then_facet(&self, turn_in: Turn, facet: FacetMueller, turn_out: Turn) -> Self {
        let [mut i, mut q, mut u, mut v] = self.0;
        for column in 0..4 {
            let light = Stokes([i[column], q[column], u[column], v[column]]);
            let after = light.turned(turn_in).after(facet).turned(turn_out);
            [i[column], q[column], u[column], v[column]] = after.0;
        }
        Self([i, q, u, v])
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use num_complex::Complex64;

    use super::*;
    use crate::{
        Material, conductor_amplitudes, dielectric, from_spherical, incidence_axis, reference_axes,
        reflect, refract,
    };

    /// One interaction: directions of travel, normal on the side of the light, material for that side.
    #[derive(Clone, Copy, Debug)]
    struct Hit {
        k: DVec3,
        m: DVec3,
        k_out: DVec3,
        material: Material,
        is_transmitted: bool,
    }

    impl Hit {
        fn new(k: DVec3, m: DVec3, material: Material, is_transmitted: bool) -> Option<Self> {
            let m = if k.dot(m) < 0.0 { m } else { -m };
            let k_out = if is_transmitted {
                let eta = material.transmitting_index()?;
                let fresnel = dielectric(-k.dot(m), eta);
                if fresnel.transmitted == 0.0 {
                    return None;
                }
                refract(-k, m, eta, fresnel.cos_theta_t)
            } else {
                reflect(-k, m)
            };
            Some(Self {
                k,
                m,
                k_out,
                material,
                is_transmitted,
            })
        }

        fn reversed(self) -> Self {
            let (m, material) = if self.is_transmitted {
                (-self.m, self.material.reversed())
            } else {
                (self.m, self.material)
            };
            Self {
                k: -self.k_out,
                m,
                k_out: -self.k,
                material,
                ..self
            }
        }

        fn extend(self, path: Mueller) -> Mueller {
            let axis = incidence_axis(self.k, self.m);
            let fresnel = self.material.polarised_fresnel(-self.k.dot(self.m));
            let facet = if self.is_transmitted {
                fresnel.transmitted
            } else {
                fresnel.reflected
            };
            let turn_out = Turn::to_axis(self.k_out, axis).inverse();
            path.then_facet(Turn::to_axis(self.k, axis), facet, turn_out)
        }

        /// The field after the interface, by amplitudes along the axes of the plane of incidence.
        fn field(self, e: Field) -> Field {
            let n = self.k.cross(self.m).normalize();
            let cos = -self.k.dot(self.m);
            let (eta, kappa) = match self.material {
                Material::Dielectric { eta } => (eta, 0.0),
                Material::Conductor { eta, kappa } => (eta, kappa),
                _ => unreachable!(),
            };
            let [a_s, a_p] = if self.is_transmitted {
                let cos_t = dielectric(cos, eta).cos_theta_t;
                let flux = (eta * cos_t / cos).sqrt();
                [cos + eta * cos_t, eta * cos + cos_t].map(|sum| (flux * 2.0 * cos / sum).into())
            } else {
                let r = conductor_amplitudes(cos, eta, kappa);
                [r.r_s, r.r_p]
            };
            let (e_s, e_p) = (a_s * along(e, n), a_p * along(e, self.k.cross(n)));
            let p_out = self.k_out.cross(n);
            [0, 1, 2].map(|i| e_s * n[i] + e_p * p_out[i])
        }
    }

    type Field = [Complex64; 3];

    fn along(e: Field, axis: DVec3) -> Complex64 {
        e[0] * axis.x + e[1] * axis.y + e[2] * axis.z
    }

    fn stokes(e: Field, k: DVec3) -> Stokes {
        let [e_s, e_p] = reference_axes(k).map(|axis| along(e, axis));
        let cross = 2.0 * e_s.conj() * e_p;
        let (s, p) = (e_s.norm_sqr(), e_p.norm_sqr());
        Stokes([s + p, s - p, cross.re, cross.im])
    }

    fn materials() -> [Material; 4] {
        [
            Material::dielectric(1.5).unwrap(),
            Material::dielectric(1.0 / 1.5).unwrap(),
            Material::conductor(0.43, 2.455).unwrap(),
            Material::dielectric(1.0).unwrap(),
        ]
    }

    /// Directions evenly over the sphere.
    fn direction(i: usize) -> DVec3 {
        let i = i as f64;
        from_spherical((2.0 * (0.618_034 * i).fract() - 1.0).acos(), 2.4 * i)
    }

    /// Paths of three interactions of all kinds.
    fn paths() -> Vec<Vec<Hit>> {
        let mut all = Vec::new();
        for i in 0..2000 {
            let mut k = direction(3 * i);
            let mut path = Vec::new();
            for j in 0..3 {
                let material = materials()[(i + j) % 3];
                let is_transmitted = (i >> j) & 1 == 1;
                if let Some(hit) = Hit::new(k, direction(7 * i + j + 1), material, is_transmitted) {
                    k = hit.k_out;
                    path.push(hit);
                }
            }
            all.push(path);
        }
        all
    }

    fn matrix(path: &[Hit]) -> Mueller {
        path.iter()
            .fold(Mueller::IDENTITY, |path, hit| hit.extend(path))
    }

    fn states() -> Vec<Stokes> {
        let polarised = (0..40).map(direction).map(|d| Stokes([1.0, d.x, d.y, d.z]));
        polarised.chain([Stokes::UNPOLARISED]).collect()
    }

    fn polarised_part(Stokes([_, q, u, v]): Stokes) -> f64 {
        DVec3::new(q, u, v).length()
    }

    #[test]
    fn matrices_are_those_of_fields_in_space() {
        let amplitudes = [
            [Complex64::ONE, Complex64::ZERO],
            [Complex64::ZERO, Complex64::ONE],
            [Complex64::ONE, Complex64::ONE],
            [Complex64::ONE, Complex64::I],
            [Complex64::new(0.3, -0.7), Complex64::new(0.1, 0.9)],
        ];
        let mut kinds = [0; 2];
        for path in paths() {
            let k = path[0].k;
            let [s, p] = reference_axes(k);
            for [e_s, e_p] in amplitudes {
                let incident = [0, 1, 2].map(|i| e_s * s[i] + e_p * p[i]);
                let exit = path.iter().fold(incident, |e, hit| hit.field(e));
                let expected = stokes(exit, path[path.len() - 1].k_out);
                let found = matrix(&path).apply(stokes(incident, k));
                for (a, b) in found.0.iter().zip(expected.0) {
                    assert!((a - b).abs() < 1e-13, "{path:?}: {found:?} {expected:?}");
                }
            }
            kinds[0] += path.iter().filter(|hit| hit.is_transmitted).count();
            kinds[1] += path.iter().filter(|hit| !hit.is_transmitted).count();
        }
        assert!(kinds[0] > 1000 && kinds[1] > 2000, "{kinds:?}");
    }

    #[test]
    fn stokes_vectors_of_fields_have_the_signs_of_the_convention() {
        // A ray towards +x; the viewer looks along -x, with s = +y to the right and p = +z up.
        let k = DVec3::X;
        assert_eq!(reference_axes(k), [DVec3::Y, DVec3::Z]);
        let diagonal = stokes([0.0.into(), 1.0.into(), 1.0.into()], k);
        assert_eq!(diagonal.0, [2.0, 0.0, 2.0, 0.0]);
        let circular = [0.0.into(), Complex64::ONE, Complex64::I];
        assert_eq!(stokes(circular, k).0, [2.0, 0.0, 0.0, 2.0]);
        // A quarter of a period after it points along s, the real field points along p: counter-clockwise.
        let at = |phase: f64| circular.map(|e: Complex64| (e * Complex64::cis(-phase)).re);
        let quarter = at(std::f64::consts::FRAC_PI_2);
        assert!(at(0.0)[1] == 1.0 && (quarter[2] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn reversed_paths_have_the_transposed_matrix() {
        // M(reverse) = D M^T D, D = diag(1, 1, -1, 1).
        let d = [1.0, 1.0, -1.0, 1.0];
        for path in paths() {
            let back: Vec<Hit> = path.iter().rev().map(|hit| hit.reversed()).collect();
            let (forth, back) = (matrix(&path).0, matrix(&back).0);
            // Rounding of a direction, over the cosine to a facet that it grazes.
            let cosines = path
                .iter()
                .flat_map(|hit| [hit.k, hit.k_out].map(|k| k.dot(hit.m).abs()));
            let tolerance = 1e-14 / cosines.fold(1.0, f64::min);
            for i in 0..4 {
                for j in 0..4 {
                    let difference = back[i][j] - d[i] * forth[j][i] * d[j];
                    assert!(
                        difference.abs() < tolerance,
                        "{path:?}: {i} {j} {difference}"
                    );
                }
            }
        }
    }

    #[test]
    fn light_of_any_state_stays_realisable_and_polarised() {
        for path in paths() {
            let m = matrix(&path);
            for incident in states() {
                let exit = m.apply(incident);
                let polarised = polarised_part(exit);
                assert!(exit.0[0] > -1e-15 && polarised <= exit.0[0] + 4e-15);
                if incident != Stokes::UNPOLARISED {
                    assert!((polarised - exit.0[0]).abs() < 4e-15, "{path:?} {exit:?}");
                }
            }
        }
    }

    #[test]
    fn flux_of_any_state_is_kept_by_a_facet() {
        for i in 0..500 {
            let (k, m) = (direction(i), direction(3 * i + 1));
            for material in [0, 1, 3].map(|i| materials()[i]) {
                let parts: Vec<Mueller> = [false, true]
                    .into_iter()
                    .filter_map(|is_transmitted| Hit::new(k, m, material, is_transmitted))
                    .map(|hit| hit.extend(Mueller::IDENTITY))
                    .collect();
                for incident in states() {
                    let flux: f64 = parts.iter().map(|m| m.apply(incident).0[0]).sum();
                    assert!((flux - 1.0).abs() < 1e-15, "{k} {m} {material:?} {flux}");
                }
            }
        }
    }

    #[test]
    fn a_fresnel_rhomb_turns_linear_into_circular_light() {
        // Born and Wolf, Sec. 1.5.4: n = 1.51, 54 deg 37 min, twice 45 degrees of phase.
        let theta = (54.0_f64 + 37.0 / 60.0).to_radians();
        let facet = Material::dielectric(1.0 / 1.51).unwrap();
        let facet = facet.polarised_fresnel(theta.cos()).reflected;
        let diagonal = Stokes([1.0, 0.0, 1.0, 0.0]);
        let [i, q, u, v] = diagonal.after(facet).after(facet).0;
        assert_eq!((i, q), (1.0, 0.0));
        assert!((v + 1.0).abs() < 1e-6 && u.abs() < 1e-3, "{u} {v}");
    }

    #[test]
    fn a_mirror_changes_the_signs_of_u_and_v() {
        // A horizontal mirror keeps the plane of incidence, and so does any mirror met at normal incidence.
        let obliquely = Hit::new(direction(5), DVec3::Z, Material::Mirror, false);
        let straight = Hit::new(DVec3::NEG_Z, DVec3::Z, Material::Mirror, false);
        let tilted = Hit::new(direction(5), direction(5), Material::Mirror, false);
        for hit in [obliquely, straight, tilted] {
            let m = hit.unwrap().extend(Mueller::IDENTITY);
            for (i, sign) in [1.0, 1.0, -1.0, -1.0].into_iter().enumerate() {
                for j in 0..4 {
                    let expected = if i == j { sign } else { 0.0 };
                    assert!((m.0[i][j] - expected).abs() < 1e-15, "{hit:?} {m:?}");
                }
            }
        }
    }

    #[test]
    fn nearly_normal_incidence_and_nearly_vertical_rays_lose_no_digits() {
        // The plane of incidence of the first facet drowns in rounding, and the axes of a nearly vertical ray hang on
        // its last digits. The matrix of two facets must show neither.
        let [glass, ..] = materials();
        let amplitude = glass.fresnel(1.0).transmitted.sqrt();
        for tilt in [0.0, 1e-300, 1e-80, 1e-30, 1e-16, 3e-16, 1e-12, 1e-9] {
            for towards in [DVec3::NEG_Z, direction(5)] {
                let [a, b] = reference_axes(towards);
                let k = towards + tilt * (0.3 * a + 0.4 * b);
                let m = -towards + tilt * (0.2 * a - 0.7 * b);
                let first = Hit::new(k, m, glass, true).unwrap();
                let second = Hit::new(first.k_out, direction(9), glass, false).unwrap();
                let found = matrix(&[first, second]);
                let [s, p] = reference_axes(k);
                for (e_s, e_p) in [
                    (Complex64::ONE, Complex64::ONE),
                    (Complex64::ONE, Complex64::I),
                ] {
                    // The field goes straight through the first facet, but for the tilt.
                    let incident = [0, 1, 2].map(|i| e_s * s[i] + e_p * p[i]);
                    let exit = second.field(incident.map(|e| amplitude * e));
                    let expected = stokes(exit, second.k_out);
                    let exit = found.apply(stokes(incident, k));
                    for (a, b) in exit.0.iter().zip(expected.0) {
                        let tolerance = 4e-15 + 4.0 * tilt;
                        assert!((a - b).abs() < tolerance, "{towards} {tilt}: {a} {b}");
                    }
                }
            }
        }
    }
}
