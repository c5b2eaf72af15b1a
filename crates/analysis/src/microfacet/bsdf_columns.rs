//! BSDF columns: single scattering into many directions, in loops that are compiled for each instruction set.

use asperity_numerics::vector::{Instructions, Stage};
use asperity_optics::{Material, dielectric};
use asperity_tally::Side;
use glam::DVec3;

use crate::microfacet::bsdf::{MicrofacetInterface, by_facet};
use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::half_vector::{Facet, reflecting_facet, refracting_facet};

/// Directions in columns: the components x, y and z of each.
pub(crate) type Directions<'a> = [&'a [f64]; 3];

/// Shadowing and masking of light from one direction.
pub(crate) trait Visibility {
    /// The fraction of the facets between the light and `wo` that are neither shadowed nor masked. It has no branches and is inlined.
    fn fraction(&self, wo: DVec3, facet: &Facet, side: Side) -> f64;
}

/// No shadowing and no masking.
pub(crate) struct Unshadowed;

impl Visibility for Unshadowed {
    #[inline(always)]
    fn fraction(&self, _: DVec3, _: &Facet, _: Side) -> f64 {
        1.0
    }
}

impl<D: FacetNormals + Copy> MicrofacetInterface<D> {
    /// [`Self::bsdf`] of columns of directions `wo`, all of them on one side. Light is scattered in lanes by clear media.
    pub(crate) fn bsdf_columns(
        &self,
        wi: DVec3,
        wo: Directions<'_>,
        values: &mut [f64],
        visibility: impl Visibility,
    ) {
        let is_reflected = wo[2].first().is_some_and(|z| *z > 0.0);
        match (self.material, is_reflected) {
            (Material::Dielectric { eta }, true) if wi.z > 0.0 => {
                self.in_lanes::<_, true>(eta, (wi, wo), values, visibility);
            }
            (Material::Dielectric { eta }, false) if wi.z > 0.0 => {
                self.in_lanes::<_, false>(eta, (wi, wo), values, visibility);
            }
            _ => {
                let side = side_of(is_reflected);
                let [x, y, z] = wo;
                for (i, value) in values.iter_mut().enumerate() {
                    let wo = DVec3::new(x[i], y[i], z[i]);
                    *value = self.bsdf(wi, wo, |facet| visibility.fraction(wo, facet, side));
                }
            }
        }
    }

    fn in_lanes<V: Visibility, const IS_REFLECTED: bool>(
        &self,
        eta: f64,
        (wi, wo): (DVec3, Directions<'_>),
        values: &mut [f64],
        visibility: V,
    ) {
        Instructions::best().run(Column::<_, _, IS_REFLECTED> {
            distribution: self.distribution,
            eta,
            wi,
            wo,
            values,
            visibility,
        });
    }
}

/// The loop over the facets of a clear medium that reflect light, or that refract it.
struct Column<'a, D, V, const IS_REFLECTED: bool> {
    distribution: D,
    eta: f64,
    wi: DVec3,
    wo: Directions<'a>,
    values: &'a mut [f64],
    visibility: V,
}

impl<D, V, const IS_REFLECTED: bool> Stage for Column<'_, D, V, IS_REFLECTED>
where
    D: FacetNormals,
    V: Visibility,
{
    #[inline(always)]
    fn run(self) {
        let Self {
            distribution,
            eta,
            wi,
            wo: [x, y, z],
            values,
            visibility,
        } = self;
        let side = side_of(IS_REFLECTED);
        let len = values.len();
        let (x, y, z) = (&x[..len], &y[..len], &z[..len]);
        for i in 0..len {
            let wo = DVec3::new(x[i], y[i], z[i]);
            let facet = match side {
                Side::Reflected => reflecting_facet(wi, wo),
                Side::Transmitted => refracting_facet(wi, wo, eta),
            };
            values[i] = match facet {
                Some(facet) => {
                    let d = distribution.d(facet.m);
                    let fresnel = dielectric(facet.cos_theta_i.min(1.0), eta);
                    let f = match side {
                        Side::Reflected => fresnel.reflected,
                        Side::Transmitted => fresnel.transmitted,
                    };
                    by_facet(wi, wo, &facet, d, f) * visibility.fraction(wo, &facet, side)
                }
                None => 0.0,
            };
        }
    }
}

#[inline(always)]
fn side_of(is_reflected: bool) -> Side {
    match is_reflected {
        true => Side::Reflected,
        false => Side::Transmitted,
    }
}
