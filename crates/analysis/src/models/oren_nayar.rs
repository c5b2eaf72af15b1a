//! Oren and Nayar: rough surfaces of Lambertian facets, with one interreflection.
//!
//! Facets lie in V-shaped cavities of all azimuths, whose facet normals are Gaussian in angle. With `alpha` the larger and `beta` the smaller
//! of the polar angles of light and view, `dphi` the azimuth between them and `s2 = sigma^2`,
//!
//! ```text
//! f1 = rho / pi (C1 + cos(dphi) C2 tan(beta) + (1 - |cos(dphi)|) C3 tan((alpha + beta) / 2))
//! f2 = 0.17 rho^2 / pi s2 / (s2 + 0.13) (1 - cos(dphi) (2 beta / pi)^2)
//!     C1 = 1 - 0.5 s2 / (s2 + 0.33)
//!     C2 = 0.45 s2 / (s2 + 0.09) (sin(alpha) - (2 beta / pi)^3, the latter only where cos(dphi) < 0)
//!     C3 = 0.125 s2 / (s2 + 0.09) (4 alpha beta / pi^2)^2
//! ```
//!
//! `f1` is the light of one facet, shadowed and masked, and `f2` that of two. They are fits by the authors to their integrals.
//!
//! # Parameters
//! Isotropic slopes and the reflectance `rho`. `sigma`, the standard deviation of the facet angle about one axis, is the root of half the
//! mean square angle of the facets of Gaussian slopes, by area; for gentle ones it is their standard deviation, `sqrt 2 / s`.
//!
//! # Source
//! M. Oren, S. Nayar, *Generalization of Lambert's reflectance model*, SIGGRAPH 1994.
//!
//! # Valid range
//! Light scattered once and twice by Lambertian facets, as fitted for `sigma` up to about 1.

use std::f64::consts::{FRAC_1_PI, PI, TAU};

use asperity_numerics::elementary::{atan, atan2, exp, hypot, sin, sin_cos, tan};
use asperity_optics::Material;
use asperity_tally::{EventPath, Exit, Loss, Side, Sides, Tally};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::model::{
    Constructor, ModelEntry, ModelError, ModelInfo, RandomWalk, ScatteringModel, Scope,
};

/// A rough surface of Lambertian facets.
///
/// # Examples
/// ```
/// use asperity_analysis::{OrenNayar, SlopeCovariance};
/// use asperity_optics::{Material, from_spherical};
///
/// let model = OrenNayar::new(SlopeCovariance::isotropic(3.0)?, Material::lambertian(0.8)?)?;
/// let light = from_spherical(1.0, 0.0);
/// // Back towards the light a rough surface is brighter than away from it.
/// let [once, twice] = model.bsdf(light, from_spherical(1.0, 0.0));
/// assert!(once > model.bsdf(light, from_spherical(1.0, std::f64::consts::PI))[0]);
/// assert!(twice < once);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrenNayar {
    slopes: SlopeCovariance,
    reflectance: f64,
    sigma: f64,
}

const INFO: ModelInfo = ModelInfo {
    name: OrenNayar::NAME,
    description: "Lambertian facets in V-cavities, light of one and two facets (Oren and Nayar 1994)",
    valid_range: "isotropic Gaussian slopes of Lambertian facets; a fit by its authors, without light of three facets and more",
    scope: Scope::AllOrders,
    sides: Sides::Both,
};

impl OrenNayar {
    /// The name of the model.
    pub const NAME: &'static str = "oren-nayar";

    pub(crate) const ENTRY: ModelEntry = ModelEntry {
        info: &INFO,
        constructor: Constructor::RandomWalk(|slopes, material| {
            Ok(Box::new(Self::new(slopes.covariance(), material)?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for slopes that are not isotropic, and for materials other than Lambertian ones.
    pub fn new(slopes: SlopeCovariance, material: Material) -> Result<Self, ModelError> {
        if !slopes.is_isotropic() {
            return Err(ModelError::Anisotropic {
                model: Self::NAME,
                advice: ", and no model describes anisotropic Lambertian facets; take none",
            });
        }
        let Material::Lambertian { reflectance } = material else {
            return Err(ModelError::NotDiffuse(Self::NAME));
        };
        Material::lambertian(reflectance)?;
        Ok(Self {
            slopes,
            reflectance,
            sigma: (0.5 * mean_square_angle(slopes.xx())).sqrt(),
        })
    }

    /// Standard deviation of the facet angle about one axis, radians.
    #[must_use]
    pub const fn sigma(&self) -> f64 {
        self.sigma
    }

    /// The BRDF of light of one facet and of two, 1/sr. Both directions are unit vectors; zero unless both have `z > 0`.
    #[must_use]
    pub fn bsdf(&self, wi: DVec3, wo: DVec3) -> [f64; 2] {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return [0.0; 2];
        }
        let (s2, rho) = (self.sigma * self.sigma, self.reflectance);
        let theta = |w: DVec3| atan2(hypot(w.x, w.y), w.z);
        let (alpha, beta) = (theta(wi).max(theta(wo)), theta(wi).min(theta(wo)));
        let horizontal = hypot(wi.x, wi.y) * hypot(wo.x, wo.y);
        let cos_phi = match horizontal > 0.0 {
            true => (wi.truncate().dot(wo.truncate()) / horizontal).clamp(-1.0, 1.0),
            false => 0.0,
        };
        let b = 2.0 * beta / PI;
        let c1 = 1.0 - 0.5 * s2 / (s2 + 0.33);
        let away = if cos_phi < 0.0 { b.powi(3) } else { 0.0 };
        let c2 = 0.45 * s2 / (s2 + 0.09) * (sin(alpha) - away);
        let c3 = 0.125 * s2 / (s2 + 0.09) * (4.0 * alpha * beta / (PI * PI)).powi(2);
        let once =
            c1 + cos_phi * c2 * tan(beta) + (1.0 - cos_phi.abs()) * c3 * tan(0.5 * (alpha + beta));
        let twice = 0.17 * rho * s2 / (s2 + 0.13) * (1.0 - cos_phi * b * b);
        [once, twice].map(|f| rho * FRAC_1_PI * f)
    }
}

/// Mean square of the angle of facets with Gaussian slopes of this variance per axis, by area: by Simpson's rule over the gradient, in units
/// of its deviation.
fn mean_square_angle(variance: f64) -> f64 {
    const STEPS: u32 = 2000;
    const LAST: f64 = 10.0;
    let mut sums = [0.0; 2];
    for i in 0..=STEPS {
        let t = LAST * f64::from(i) / f64::from(STEPS);
        let gradient = t * variance.sqrt();
        let weight = match i {
            0 | STEPS => 1.0,
            _ if i % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let area = weight * t * exp(-0.5 * t * t) * hypot(gradient, 1.0);
        sums[0] += area * atan(gradient).powi(2);
        sums[1] += area;
    }
    sums[0] / sums[1]
}

impl ScatteringModel for OrenNayar {
    fn info(&self) -> &'static ModelInfo {
        &INFO
    }

    fn material(&self) -> Material {
        Material::Lambertian {
            reflectance: self.reflectance,
        }
    }

    fn slopes(&self) -> SlopeDistribution {
        self.slopes.into()
    }

    /// The density of slopes says nothing of where diffuse light goes, so that quadrature by lobes does not serve it.
    fn random_walk(&self) -> Option<&dyn RandomWalk> {
        Some(self)
    }
}

impl RandomWalk for OrenNayar {
    /// One direction in the cosine distribution about the normal of the mean plane, with the light of both orders.
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        let (u, azimuth): (f64, f64) = (rng.random(), TAU * rng.random::<f64>());
        let (sin_theta, cos_theta) = (u.sqrt(), (1.0 - u).sqrt());
        let (sin_phi, cos_phi) = sin_cos(azimuth);
        let wo = DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta);
        let fluxes = self.bsdf(wi, wo).map(|f| PI * f);
        let once = EventPath::default().then(asperity_tally::Event::Reflection);
        let twice = once.then(asperity_tally::Event::Reflection);
        for (path, flux) in [once, twice].into_iter().zip(fluxes) {
            tally.add_exit(&Exit {
                side: Side::Reflected,
                wo,
                flux,
                path,
                scatterings: 0,
            });
        }
        tally.add_loss(Loss::Absorbed, 1.0 - fluxes[0] - fluxes[1]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_optics::from_spherical;

    fn model(smoothness: f64, reflectance: f64) -> OrenNayar {
        let slopes = SlopeCovariance::isotropic(smoothness).unwrap();
        OrenNayar::new(slopes, Material::lambertian(reflectance).unwrap()).unwrap()
    }

    #[test]
    fn a_smooth_surface_is_lambertian() {
        let [once, twice] =
            model(1e5, 0.6).bsdf(from_spherical(0.7, 0.0), from_spherical(1.1, 2.0));
        assert!((once * PI / 0.6 - 1.0).abs() < 1e-8 && twice < 1e-9);
    }

    /// Light from above on gentle slopes, seen from above: each facet shows `cos(theta_m)`, so that `pi f1 / rho` is 1 - v to first order in
    /// the slope variance v per axis. The fit has 1 - v / 0.66, within 0.04 of the exact mean of `cos(theta_m)` up to v = 0.5.
    #[test]
    fn vertical_light_sees_the_mean_cosine_of_the_facets() {
        let up = DVec3::Z;
        for s in [20.0, 6.0, 3.0, 2.0] {
            let variance: f64 = 2.0 / (s * s);
            // E[1 / sqrt(1 + g^2)], g^2 / v being exponential of mean 2
            let steps = 20_000;
            let exact: f64 = (0..steps)
                .map(|i| {
                    let p = (f64::from(i) + 0.5) / f64::from(steps);
                    (1.0 - 2.0 * variance * (1.0 - p).ln()).sqrt().recip() / f64::from(steps)
                })
                .sum();
            let [once, _] = model(s, 1.0).bsdf(up, up);
            assert!(
                (PI * once - exact).abs() < 0.04,
                "{s}: {} {exact}",
                PI * once
            );
        }
    }

    #[test]
    fn light_and_view_may_be_exchanged() {
        let model = model(2.0, 0.9);
        for (a, b, phi) in [(0.2, 1.3, 0.4), (1.0, 1.0, 2.9), (0.0, 0.8, 0.0)] {
            let (wi, wo) = (from_spherical(a, 0.3), from_spherical(b, 0.3 + phi));
            for (f, g) in model.bsdf(wi, wo).into_iter().zip(model.bsdf(wo, wi)) {
                assert!((f - g).abs() < 1e-14);
            }
        }
    }

    /// Polar angles and azimuths of equal terms, from the equations written out by hand for alpha = 60, beta = 30 degrees, sigma = 0.5: where the azimuths agree, are opposite and at right angles.
    #[test]
    fn terms_are_those_of_the_paper() {
        let on = OrenNayar {
            sigma: 0.5,
            ..model(2.0, 1.0)
        };
        let (wi, at) = (from_spherical(PI / 3.0, 0.0), |phi| {
            from_spherical(PI / 6.0, phi)
        });
        let c1 = 1.0 - 0.125 / 0.58;
        let (tan, root) = (1.0 / 3.0_f64.sqrt(), 3.0_f64.sqrt() / 2.0);
        for (phi, once, twice) in [
            (
                0.0,
                c1 + 0.1125 / 0.34 * root * tan,
                0.0425 / 0.38 * (8.0 / 9.0),
            ),
            (
                PI,
                c1 - 0.1125 / 0.34 * (root - 1.0 / 27.0) * tan,
                0.0425 / 0.38 * (10.0 / 9.0),
            ),
            (
                0.5 * PI,
                c1 + 0.03125 / 0.34 * (2.0_f64 / 9.0).powi(2),
                0.0425 / 0.38,
            ),
        ] {
            let found = on.bsdf(wi, at(phi)).map(|f| PI * f);
            assert!((found[0] - once).abs() < 1e-12, "{phi} {found:?} {once}");
            assert!((found[1] - twice).abs() < 1e-12, "{phi} {found:?} {twice}");
        }
    }
}
