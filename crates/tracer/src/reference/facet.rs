//! Facet: reflects, transmits and absorbs light by the Fresnel equations and Snell's law, or by Lambert's law.

use asperity_optics::{Material, around, reflect, refract};
use asperity_tally::Event;
use glam::DVec3;
use rand::{Rng, RngExt};

use super::amplitudes::Amplitudes;
use super::fields::{Deflection, Fields};
use crate::periodic::Heading;

/// Fractions of the flux that arrives at a facet, and their directions.
pub(super) struct Scattered {
    /// Transmission and reflection; a branch without flux has the fraction zero and may have no direction.
    pub(super) branches: [Branch; 2],
    pub(super) absorbed: f64,
    /// `true` if the direction of reflection is one of many possible ones.
    pub(super) is_diffuse: bool,
}

/// One of the directions in which light leaves a facet.
#[derive(Clone, Copy)]
pub(super) struct Branch {
    pub(super) event: Event,
    /// Unit direction.
    pub(super) direction: DVec3,
    pub(super) fraction: f64,
    /// Fields, if the path has any.
    pub(super) fields: Option<Fields>,
}

impl Scattered {
    fn new([transmitted, reflected]: [(f64, DVec3); 2], absorbed: f64) -> Self {
        let branch = |event, (fraction, direction)| Branch {
            event,
            direction,
            fraction,
            fields: None,
        };
        Self {
            branches: [
                branch(Event::Transmission, transmitted),
                branch(Event::Reflection, reflected),
            ],
            absorbed,
            is_diffuse: false,
        }
    }

    /// Light from `wi` at a smooth facet of normal `m`, on the side of `wi`; the indices of `material` are relative to the
    /// medium of the light.
    pub(super) fn smoothly(material: Material, wi: DVec3, m: DVec3) -> Self {
        let fresnel = material.fresnel(wi.dot(m).clamp(0.0, 1.0));
        let reflected = (fresnel.reflected, reflect(wi, m));
        match material.transmitting_index() {
            Some(eta) if fresnel.transmitted > 0.0 => {
                let wt = refract(wi, m, eta, fresnel.cos_theta_t);
                Self::new(
                    [(fresnel.transmitted, wt), reflected],
                    material.absorbed(&fresnel),
                )
            }
            _ => Self::new([(0.0, DVec3::ZERO), reflected], material.absorbed(&fresnel)),
        }
    }

    /// Light at a Lambertian facet of normal `m`.
    pub(super) fn diffusely<R: Rng>(reflectance: f64, m: DVec3, rng: &mut R) -> Self {
        // Lambert: the squared cosine to the normal is evenly distributed.
        let cos_theta_o = rng.random::<f64>().sqrt();
        let wo = around(m, cos_theta_o, rng.random());
        Self {
            is_diffuse: true,
            ..Self::new([(0.0, DVec3::ZERO), (reflectance, wo)], 1.0 - reflectance)
        }
    }

    /// This light with the fractions of the fields that a path brings to a point of normal `m`, in the world also in a mirrored tile.
    pub(super) fn polarised(
        mut self,
        heading: &Heading,
        fields: &Fields,
        m: DVec3,
        amplitudes: &Amplitudes,
    ) -> Self {
        let amplitudes = [amplitudes.transmission, amplitudes.reflection];
        for (branch, amplitudes) in self.branches.iter_mut().zip(amplitudes) {
            // A branch without light has no direction.
            if branch.fraction > 0.0 {
                let ray = Deflection {
                    k: heading.world_direction(),
                    k_out: heading.to_world(branch.direction),
                    m: heading.to_world(m),
                };
                let fields = fields.after(&ray, amplitudes);
                branch.fraction = fields.flux();
                branch.fields = Some(fields.normalised());
            }
        }
        let kept: f64 = self.branches.iter().map(|branch| branch.fraction).sum();
        if self.absorbed > 0.0 {
            self.absorbed = 1.0 - kept;
        } else {
            // Without absorption both fractions add up to one but for rounding, which is taken out.
            for branch in &mut self.branches {
                branch.fraction /= kept;
            }
        }
        self
    }

    /// This light, unpolarised.
    pub(super) fn depolarised(mut self, heading: &Heading) -> Self {
        for branch in &mut self.branches {
            let k = heading.to_world(branch.direction);
            branch.fields = Some(Fields::unpolarised(k));
        }
        self
    }
}

#[cfg(test)]
pub(super) mod tests {
    use asperity_optics::{Film, Films};

    use super::*;
    use crate::interaction::facet::{Incident, scatter};
    use crate::interaction::polarised::AveragedLight;

    /// A substrate of that index under two films, the first of which absorbs by `kappa`.
    pub(crate) fn coated([n, k]: [f64; 2], kappa: f64) -> Material {
        let layers = [(2.3, kappa, 0.9), (1.38, 0.0, 1.1)];
        let films = layers.map(|(eta, kappa, phase)| Film { eta, kappa, phase });
        Material::coated(Films::new(&films).unwrap(), n, k).unwrap()
    }

    /// To the bit, but for bare conductors: their reflectance follows from real numbers there, and from complex amplitudes here.
    #[test]
    fn the_path_engine_scatters_averaged_light_as_the_reference() {
        let materials = [
            Material::Dielectric { eta: 1.5 },
            Material::Dielectric { eta: 1.0 },
            Material::Conductor {
                eta: 0.43,
                kappa: 2.455,
            },
            Material::Mirror,
            coated([1.5, 0.0], 0.0),
            coated([1.5, 0.0], 0.3),
            coated([0.43, 2.455], 0.3),
        ];
        let m = DVec3::new(0.48, -0.6, 0.64);
        for material in materials {
            for is_entering in [true, false] {
                for step in 0..=400 {
                    let theta = f64::from(step) / 400.0 * std::f64::consts::FRAC_PI_2;
                    let across = m.any_orthonormal_vector();
                    let wi = theta.cos() * m + theta.sin() * across;
                    let light = Incident::averaged(is_entering, wi, m);
                    let found = scatter::<AveragedLight, 0>(material, &light);
                    let from_here = if is_entering {
                        material
                    } else {
                        material.reversed()
                    };
                    let expected = Scattered::smoothly(from_here, wi, m);
                    let rounding = match material {
                        Material::Conductor { .. } => 1e-14,
                        _ => 0.0,
                    };
                    let near = |found: f64, expected: f64| {
                        let error = (found - expected).abs();
                        assert!(
                            error <= rounding,
                            "{material:?} {theta}: {found} {expected}"
                        );
                    };
                    near(found.absorbed, expected.absorbed);
                    for ((event, out), branch) in
                        found.branches().into_iter().zip(expected.branches)
                    {
                        assert_eq!(event, branch.event);
                        near(out.passed.fraction, branch.fraction);
                        if branch.fraction > 0.0 {
                            assert_eq!(out.direction, branch.direction, "{material:?} {theta}");
                        }
                    }
                }
            }
        }
    }
}
