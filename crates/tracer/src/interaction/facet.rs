//! Facet: reflects, transmits and absorbs light by the Fresnel equations and Snell's law, or diffusely by Lambert's law.
//!
//! The only place of the path engine where light is scattered at interfaces, for many facets at a time and for single ones alike.
//! Averaged light is polarised light that carries no numbers.
//!
//! # Source
//! Lambert, Photometria (1760).

use asperity_optics::{
    FacetMueller, Material, PolarisedFresnel, around, incidence_axis, polarised_conductor,
    polarised_dielectric, reflect, refract,
};
use asperity_tally::Event;
use glam::DVec3;

use super::polarised::{CarriedLight, Passage, Passed};

/// Light that arrives at a facet, and carries `N` numbers of its polarisation.
pub(crate) struct Incident<const N: usize> {
    /// Unit direction of travel.
    pub(crate) k: DVec3,
    /// Unit normal on the side of the light.
    pub(crate) m: DVec3,
    /// `true` if the light comes from the medium to which the indices of the material are relative.
    pub(crate) is_entering: bool,
    /// Minus one where directions are mirrored against the world: see [`Passage`].
    pub(crate) handedness: f64,
    /// Random numbers in `[0, 1)`, used by diffuse facets.
    pub(crate) numbers: [f64; 2],
    pub(crate) light: [f64; N],
}

impl Incident<0> {
    /// Averaged light from `wi` at a smooth facet of normal `m`.
    pub(crate) fn averaged(is_entering: bool, wi: DVec3, m: DVec3) -> Self {
        Self {
            k: -wi,
            m,
            is_entering,
            handedness: 1.0,
            numbers: [0.0; 2],
            light: [],
        }
    }
}

/// Light that leaves a facet. Its direction has no meaning where its fraction is zero.
pub(crate) struct Outgoing<const N: usize> {
    /// Unit direction of travel.
    pub(crate) direction: DVec3,
    pub(crate) passed: Passed<N>,
}

/// Light after a facet, as fractions of the flux that arrived.
pub(crate) struct Scattered<const N: usize> {
    pub(crate) transmitted: Outgoing<N>,
    pub(crate) reflected: Outgoing<N>,
    pub(crate) absorbed: f64,
}

impl<const N: usize> Scattered<N> {
    /// Transmission and reflection, with the events that they are.
    pub(crate) const fn branches(&self) -> [(Event, &Outgoing<N>); 2] {
        [
            (Event::Transmission, &self.transmitted),
            (Event::Reflection, &self.reflected),
        ]
    }
}

/// Scatters light of kind `L` at a facet.
///
/// Selects and does not branch, but for the kind of the material, so that loops over facets of one kind take vector instructions.
#[inline(always)]
pub(crate) fn scatter<L: CarriedLight<N>, const N: usize>(
    material: Material,
    incident: &Incident<N>,
) -> Scattered<N> {
    let &Incident { k, m, light, .. } = incident;
    let wi = -k;
    let cos_theta_i = incident.cos_theta_i();

    // Compute the Fresnel terms, and the index of the other medium relative to that of the light
    let (fresnel, eta) = match material {
        Material::Dielectric { eta } => {
            let etas = [eta, 1.0 / eta];
            let eta = if incident.is_entering {
                etas[0]
            } else {
                etas[1]
            };
            (polarised_dielectric(cos_theta_i, eta), eta)
        }
        Material::Coated { .. } => {
            let facing = if incident.is_entering {
                material
            } else {
                material.reversed()
            };
            let eta = facing.transmitting_index().unwrap_or(1.0);
            (facing.polarised_fresnel(cos_theta_i), eta)
        }
        Material::Lambertian { reflectance } => {
            return Scattered {
                transmitted: Outgoing {
                    direction: DVec3::ZERO,
                    passed: Passed {
                        fraction: 0.0,
                        light,
                    },
                },
                reflected: Outgoing {
                    direction: diffuse_direction(m, incident.numbers),
                    passed: Passed {
                        fraction: reflectance,
                        light: L::depolarised(light),
                    },
                },
                absorbed: 1.0 - reflectance,
            };
        }
        opaque => {
            let reflected = match opaque {
                Material::Conductor { eta, kappa } => {
                    polarised_conductor(cos_theta_i, eta, kappa).reflected
                }
                _ => FacetMueller::MIRROR,
            };
            let fresnel = PolarisedFresnel {
                reflected,
                transmitted: FacetMueller::NONE,
                cos_theta_t: 0.0,
            };
            (fresnel, 1.0)
        }
    };

    // Reflect and refract
    let axis = incidence_axis(k, m);
    let reflected = incident.leave::<L>(reflect(wi, m), axis, fresnel.reflected);
    let wt = refract(wi, m, eta, fresnel.cos_theta_t);
    let transmitted = incident.leave::<L>(wt, axis, fresnel.transmitted);
    let absorbed = match material {
        Material::Dielectric { .. } => 0.0,
        Material::Coated { .. } if !material.absorbs() => 0.0,
        _ => 1.0 - reflected.passed.fraction - transmitted.passed.fraction,
    };
    Scattered {
        transmitted,
        reflected,
        absorbed,
    }
}

impl<const N: usize> Incident<N> {
    /// Cosine of the angle of incidence, `[0, 1]`.
    #[inline(always)]
    pub(crate) fn cos_theta_i(&self) -> f64 {
        let cos_theta_i = (-self.k).dot(self.m);
        let cos_theta_i = if cos_theta_i > 0.0 { cos_theta_i } else { 0.0 };
        if cos_theta_i < 1.0 { cos_theta_i } else { 1.0 }
    }

    /// Passage of the light that is reflected, by a facet yet to be set.
    #[inline(always)]
    pub(crate) fn reflection(&self) -> Passage {
        let axis = incidence_axis(self.k, self.m);
        let rays = [self.k, reflect(-self.k, self.m)];
        Passage::new(rays, axis, FacetMueller::NONE, self.handedness)
    }

    /// The light that leaves along `direction`, in the plane of incidence of normal `axis`.
    #[inline(always)]
    fn leave<L: CarriedLight<N>>(
        &self,
        direction: DVec3,
        axis: DVec3,
        facet: FacetMueller,
    ) -> Outgoing<N> {
        let passage = Passage::new([self.k, direction], axis, facet, self.handedness);
        Outgoing {
            direction,
            passed: L::after(self.light, &passage),
        }
    }
}

/// A direction in the cosine distribution about a unit normal, from two numbers in `[0, 1)`: the squared sine of the angle to
/// the normal is evenly distributed.
#[inline(always)]
fn diffuse_direction(m: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    around(m, (1.0 - u).sqrt(), v)
}
