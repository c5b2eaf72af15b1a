//! Importance sampling of a model: a visible facet, which reflects or refracts by Fresnel's equations.
//!
//! Facets have the normals that Smith's statistics make visible from the light, those of GGX slopes or else Gaussian ones, whatever the
//! masking of the model. The density of directions is then `p(wo) = D_wi(m) chi P`, where `D_wi` is the density of visible normals, `chi` the
//! Jacobian of the half vector and `P` the probability of reflection or of refraction.
//!
//! # Source
//! Heitz and d'Eon 2014 for visible normals; Walter et al. 2007, Eq. 17, for the Jacobian.

use asperity_tally::Side;
use glam::DVec3;
use rand::{Rng, RngExt};

use crate::microfacet::beckmann::Beckmann;
use crate::microfacet::facet_normals::FacetNormals;
use crate::microfacet::half_vector::{outgoing_direction, scattering_facet};
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::smith_normals::SmithNormals;
use crate::models::model::ScatteringModel;

/// Facets of the slopes of a model: GGX, or else Gaussian.
fn facets_of(model: &dyn ScatteringModel) -> SmithNormals {
    match model.slopes() {
        SlopeDistribution::Ggx { ggx, .. } => SmithNormals::Ggx(ggx),
        slopes => SmithNormals::Beckmann(Beckmann::new(slopes.covariance())),
    }
}

/// Probability with which a facet is taken to reflect rather than refract.
fn reflection_probability(model: &dyn ScatteringModel, cos_theta_i: f64) -> f64 {
    let refracts = model.material().transmitting_index().is_some();
    match [Side::Reflected, Side::Transmitted].map(|side| model.sides().includes(side)) {
        [true, true] if refracts => model.material().fresnel(cos_theta_i.min(1.0)).reflected,
        [false, _] => 0.0,
        _ => 1.0,
    }
}

/// Draws a direction into which a single facet scatters light from `wi`, a unit vector with `z > 0`. `None` if the facet sends the light to
/// the other side of the mean plane: light of multiple scattering, which counts as zero.
///
/// # Examples
/// ```
/// use asperity_analysis::{SlopeCovariance, closed_form, sample_direction, sampling_density};
/// use asperity_optics::{Material, from_spherical};
/// use rand::SeedableRng;
/// use rand_chacha::ChaCha8Rng;
///
/// let model = closed_form("smith", SlopeCovariance::isotropic(3.0)?, Material::dielectric(1.5)?)?;
/// let wi = from_spherical(0.5, 0.0);
/// let mut rng = ChaCha8Rng::seed_from_u64(1);
/// let wo = std::iter::repeat_with(|| sample_direction(model.as_ref(), wi, &mut rng)).flatten().next();
/// let wo = wo.ok_or("no direction")?;
/// assert!(sampling_density(model.as_ref(), wi, wo) > 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn sample_direction(
    model: &dyn ScatteringModel,
    wi: DVec3,
    rng: &mut impl Rng,
) -> Option<DVec3> {
    let m = facets_of(model).sample_visible(wi, rng);
    let material = model.material();
    let is_reflected = rng.random::<f64>() < reflection_probability(model, wi.dot(m));
    let index = material.transmitting_index().filter(|_| !is_reflected);
    let wo = outgoing_direction(&material, wi, m, index)?;
    (is_reflected == (wo.z > 0.0) && wo.z != 0.0).then_some(wo)
}

/// Density of [`sample_direction`] at `wo`, in 1/sr. Its integral over the sphere is the probability of a direction.
#[must_use]
pub fn sampling_density(model: &dyn ScatteringModel, wi: DVec3, wo: DVec3) -> f64 {
    let Some(facet) = scattering_facet(&model.material(), wi, wo) else {
        return 0.0;
    };
    let reflects = reflection_probability(model, facet.cos_theta_i);
    let chosen = if wo.z > 0.0 { reflects } else { 1.0 - reflects };
    let facets = facets_of(model);
    let visible = facet.cos_theta_i * facets.d(facet.m) / (wi.z * (1.0 + facets.lambda(wi)));
    visible * facet.chi * chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{CLOSED_FORMS, SlopeCovariance, closed_form, hemispherical_energy};
    use asperity_optics::{Material, from_spherical};
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    /// The mean of `f |cos theta_o| / p` over sampled directions is the energy by quadrature, side by side, for every model and kind of
    /// material.
    #[test]
    fn sampled_energy_is_that_by_quadrature() {
        const SAMPLES: u32 = 40_000;
        let slopes = SlopeCovariance::isotropic(2.5).unwrap();
        let mut tested = 0;
        for material in [
            Material::dielectric(1.5),
            Material::dielectric(1.0 / 1.5),
            Material::conductor(0.2, 3.4),
        ] {
            for name in CLOSED_FORMS {
                let Ok(model) = closed_form(name, slopes, material.clone().unwrap()) else {
                    continue;
                };
                tested += 1;
                let wi = from_spherical(0.9, 0.4);
                let mut rng = ChaCha8Rng::seed_from_u64(7);
                let mut sums = [[0.0; 2]; 2];
                for _ in 0..SAMPLES {
                    let Some(wo) = sample_direction(model.as_ref(), wi, &mut rng) else {
                        continue;
                    };
                    let value =
                        model.bsdf(wi, wo) * wo.z.abs() / sampling_density(model.as_ref(), wi, wo);
                    let [sum, squares] = &mut sums[usize::from(wo.z < 0.0)];
                    *sum += value;
                    *squares += value * value;
                }
                let energy = hemispherical_energy(model.as_ref(), wi);
                for ([sum, squares], exact) in
                    sums.into_iter().zip([energy.reflected, energy.transmitted])
                {
                    let n = f64::from(SAMPLES);
                    let mean = sum / n;
                    let se = ((squares / n - mean * mean) / n).sqrt();
                    // 60 comparisons: 4.5 standard errors are passed once in 2000 runs
                    assert!(
                        (mean - exact).abs() <= 4.5 * se + 1e-9,
                        "{name}: {mean} +- {se}, exact {exact}"
                    );
                }
            }
        }
        assert!(tested > 2 * CLOSED_FORMS.len(), "{tested}");
    }
}
