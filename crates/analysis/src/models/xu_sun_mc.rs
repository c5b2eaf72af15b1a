//! Xu-Sun Monte Carlo: the statistical Monte Carlo of Xu and Sun as published.
//!
//! A ray is shot from the direction of the light. The height of a hit is sampled from the density of heights and its
//! normal `n` from the density of slopes, independently of everything before. A shot ray has the weight
//! `W = V(zeta, theta_i) (wi . n) / n.z` (Eq. 26) and the flux `W / wi.z` (Eq. 28). It splits into `F_r W` and
//! `F_t W`, or into one ray under total reflection. A ray whose weight is below a threshold ends. Any other is
//! blocked with a probability that follows from its direction and the visibility at its height, and hits again
//! if it is blocked.
//!
//! # Parameters
//! The slope covariance, the material, and the visibility: that of Eq. 24, or Smith's with nothing else changed.
//!
//! # Source
//! Xu and Sun 2008, Sec. 4, with the choices below.
//!
//! # Valid range
//! Xu and Sun's visibility: isotropic surfaces with `s` from about 3. Smith's: any Gaussian slopes.
//!
//! # What the paper leaves open
//! 1. *`V(zeta, theta)`* is given for `zeta = 0` only: `V(0, theta) = exp(-K)` with `K = (k0 tan(theta) / s)
//!    exp(-s^2 / (4 tan^2(theta)))`, `k0 = 0.7` (Eq. 24, from Sun 2007). With the distribution of heights `Phi`,
//!    independent obstacles along a ray give `Phi(zeta / sigma)^Lambda`, and `k0` is `ln 2 = -ln Phi(0)` to one
//!    percent. So `V(zeta, theta) = Phi(zeta / sigma)^(K / ln 2)`, which is Eq. 24 at `zeta = 0` exactly. Smith's
//!    visibility is `Phi(zeta / sigma)^Lambda` with Lambda of facets that face the ray. Below the surface both
//!    hold with `-zeta`.
//! 2. *Rays that go into the surface*: a reflected ray that goes down, or a refracted one that goes up, is
//!    always blocked, since a ray has a visibility only at an angle from its own side.
//! 3. *Normals that face away*: for a shot ray they count zero, as Eq. 26 has no meaning for them. At a later hit
//!    the flux of the ray would vanish. There the normal is sampled among those that face the ray, and without
//!    the weight of Eq. 26, which the paper gives to shot rays alone. Visible facets would be weighted by `v . n`,
//!    which rays scattered more than once lack here.
//! 4. *The height of a later hit* is sampled like that of the first, independently of the height that the ray comes
//!    from and of whether it goes up or down.
//! 5. *Light that Eq. 26 does not account for*: the mean of `W / wi.z` is not one, but the mean of `V` over
//!    heights times `1 + Lambda`. For Smith's visibility that is `1`, for Eq. 24 `(1 + Lambda) / (1 + K / ln 2)`,
//!    which at `s = 1` is 0.818, 0.597 and 0.557 at 30, 60 and 80 degrees. It is not normalised, and the rest is
//!    tallied nowhere: the budget of `xu-sun-mc` does not close, and one minus its sum is missing.
//! 6. *The threshold* has no value in the paper: here it is 1e-5 of the flux of an incident ray. It is applied to
//!    `W / wi.z`, so that it means the same at all angles. The flux that it ends is tallied as truncated. So is
//!    that of the rays left when those of one incident ray have hit 30 000 times, low orders first. That
//!    happens for slopes of about 20 and more (`s` below 0.1), where total reflection traps light.
//!
//! For large `tan(theta_i) / s` the weights of Eq. 26 vary widely, since steep facets are rarely sampled and
//! catch most of the light. The variance of `W` is about `(tan(theta_i) / s)^2` of its mean squared, so rough
//! surfaces (`s` below 1) need many rays.

use std::collections::VecDeque;
use std::f64::consts::LN_2;

use asperity_numerics::elementary::pow;
use asperity_optics::{Material, reflect, refract};
use asperity_tally::{Event, EventPath, Exit, Loss, Side, Sides, Tally};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::microfacet::bsdf::MicrofacetInterface;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::model::{
    Constructor, ModelEntry, ModelError, ModelInfo, RandomWalk, ScatteringModel, Scope,
    smoothness_of, valid_interface,
};
use crate::models::xu_sun::negative_log_visibility;

/// A ray below this fraction of the flux of an incident ray ends.
const MIN_FLUX: f64 = 1e-5;

/// Hits of all rays that one incident ray splits into, after which blocked rays end.
const MAX_HITS: u32 = 30_000;

/// The visibility of points for rays that leave the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayVisibility {
    /// Eq. 24, continued to all heights: `Phi^(K / ln 2)`; for isotropic slopes.
    XuSun,
    /// Smith's, for facets that face the ray: `Phi^Lambda`.
    Smith,
}

/// Xu and Sun's Monte Carlo of rays that meet independent heights and normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XuSunMonteCarlo {
    interface: MicrofacetInterface,
    visibility: Visibility,
}

/// [`RayVisibility`] with its parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Visibility {
    XuSun { smoothness: f64 },
    Smith,
}

const XU_SUN: ModelInfo = ModelInfo {
    name: XuSunMonteCarlo::NAME,
    description: "statistical Monte Carlo with the visibility of Eq. 24 (Xu and Sun 2008, Sec. 4)",
    valid_range: "isotropic Gaussian surfaces that are smooth to moderately rough (s from about 3); below, its weights lose the light that its visibility counts twice, and its budget does not close",
    scope: Scope::AllOrders,
    sides: Sides::Both,
};

const SMITH: ModelInfo = ModelInfo {
    name: XuSunMonteCarlo::NAME_SMITH,
    description: "statistical Monte Carlo of Xu and Sun 2008, Sec. 4, with Smith's visibility in place of Eq. 24",
    valid_range: "any Gaussian slopes; all orders, the height and the facet of each hit sampled independently of those before; weights vary widely for s below 1",
    ..XU_SUN
};

impl XuSunMonteCarlo {
    /// The name of the model with the visibility of Eq. 24.
    pub const NAME: &'static str = "xu-sun-mc";
    /// The name of the model with Smith's visibility.
    pub const NAME_SMITH: &'static str = "xu-sun-mc-smith";

    pub(crate) const ENTRY: ModelEntry = ModelEntry {
        info: &XU_SUN,
        constructor: Constructor::RandomWalk(|slopes, material| {
            Ok(Box::new(Self::new(
                slopes.covariance(),
                material,
                RayVisibility::XuSun,
            )?))
        }),
    };
    pub(crate) const ENTRY_SMITH: ModelEntry = ModelEntry {
        info: &SMITH,
        constructor: Constructor::RandomWalk(|slopes, material| {
            Ok(Box::new(Self::new(
                slopes.covariance(),
                material,
                RayVisibility::Smith,
            )?))
        }),
    };

    /// The model for a surface of these slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an invalid material or equal indices, and for anisotropic slopes with
    /// [`RayVisibility::XuSun`].
    pub fn new(
        slopes: SlopeCovariance,
        material: Material,
        visibility: RayVisibility,
    ) -> Result<Self, ModelError> {
        let interface = valid_interface(slopes, material)?;
        let visibility = match visibility {
            RayVisibility::XuSun => Visibility::XuSun {
                smoothness: smoothness_of(&slopes, Self::NAME)?,
            },
            RayVisibility::Smith => Visibility::Smith,
        };
        Ok(Self {
            interface,
            visibility,
        })
    }

    /// `V(zeta, theta)` of the direction `w`, above the surface or below it; `clear` is the fraction of heights
    /// below the point, or above it.
    fn visibility(&self, w: DVec3, clear: f64) -> f64 {
        match self.visibility {
            Visibility::XuSun { smoothness } => {
                pow(clear, negative_log_visibility(w, smoothness) / LN_2)
            }
            Visibility::Smith => self.interface.distribution.visibility(w, clear),
        }
    }

    /// The rays into which `ray` splits at a facet of normal `m`, facing up; absorbed flux is tallied.
    fn split(&self, ray: Ray, m: DVec3, tally: &mut Tally<'_>) -> [Option<Ray>; 2] {
        let v = -ray.direction;
        let (m, material) = match ray.side {
            Side::Reflected => (m, self.interface.material),
            Side::Transmitted => (-m, self.interface.material.reversed()),
        };
        let fresnel = material.fresnel(v.dot(m).clamp(0.0, 1.0));
        let reflected = Ray {
            direction: reflect(v, m),
            flux: ray.flux * fresnel.reflected,
            path: ray.path.then(Event::Reflection),
            ..ray
        };
        let rest = ray.flux * fresnel.transmitted;
        let transmitted = match material.transmitting_index() {
            Some(eta) if rest > 0.0 => Some(Ray {
                direction: refract(v, m, eta, fresnel.cos_theta_t),
                side: match ray.side {
                    Side::Reflected => Side::Transmitted,
                    Side::Transmitted => Side::Reflected,
                },
                flux: rest,
                path: ray.path.then(Event::Transmission),
                ..ray
            }),
            Some(_) => None,
            None => {
                tally.add_loss(Loss::Absorbed, rest);
                None
            }
        };
        [Some(reflected), transmitted]
    }

    /// Samples whether `ray` leaves the surface.
    fn escapes(&self, ray: &Ray, rng: &mut ChaCha8Rng) -> bool {
        let (outward, clear) = match ray.side {
            Side::Reflected => (ray.direction.z > 0.0, ray.height),
            Side::Transmitted => (ray.direction.z < 0.0, 1.0 - ray.height),
        };
        outward && rng.random::<f64>() < self.visibility(ray.direction, clear)
    }
}

/// A ray between two hits.
#[derive(Clone, Copy, Debug)]
struct Ray {
    direction: DVec3,
    /// Side of the medium that it travels through.
    side: Side,
    /// Fraction of the flux of the incident ray.
    flux: f64,
    /// `Phi(zeta / sigma)` at its last hit: uniform over hits.
    height: f64,
    path: EventPath,
}

impl ScatteringModel for XuSunMonteCarlo {
    fn info(&self) -> &'static ModelInfo {
        match self.visibility {
            Visibility::XuSun { .. } => &XU_SUN,
            Visibility::Smith => &SMITH,
        }
    }

    fn material(&self) -> Material {
        self.interface.material
    }

    fn slopes(&self) -> SlopeDistribution {
        (*self.interface.distribution.slopes()).into()
    }

    fn random_walk(&self) -> Option<&dyn RandomWalk> {
        Some(self)
    }
}

impl RandomWalk for XuSunMonteCarlo {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, tally: &mut Tally<'_>) {
        // Shoot a ray: Eqs. 26 and 28
        let height = rng.random::<f64>();
        let m = self.interface.distribution.sample(rng);
        let facing = wi.dot(m).max(0.0) / (m.z * wi.z);
        let shot = Ray {
            direction: -wi,
            side: Side::Reflected,
            flux: self.visibility(wi, height) * facing,
            height,
            path: EventPath::default(),
        };
        if shot.flux.is_nan() || shot.flux <= 0.0 {
            return;
        }
        // Follow all rays that it splits into, low orders first, so that the limit ends high ones alone
        let mut rays = VecDeque::new();
        let mut hits = 1;
        rays.extend(self.split(shot, m, tally).into_iter().flatten());
        while let Some(ray) = rays.pop_front() {
            if ray.flux < MIN_FLUX {
                tally.add_loss(Loss::Truncated, ray.flux);
            } else if self.escapes(&ray, rng) {
                tally.add_exit(&Exit {
                    side: ray.side,
                    wo: ray.direction,
                    flux: ray.flux,
                    path: ray.path,
                    scatterings: 0,
                });
            } else if hits == MAX_HITS {
                tally.add_loss(Loss::Truncated, ray.flux);
            } else {
                hits += 1;
                let front = match ray.side {
                    Side::Reflected => -ray.direction,
                    Side::Transmitted => ray.direction,
                };
                let hit = Ray {
                    height: rng.random::<f64>(),
                    ..ray
                };
                let m = self.interface.distribution.sample_facing(front, rng);
                rays.extend(self.split(hit, m, tally).into_iter().flatten());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::microfacet::beckmann::Beckmann;
    use crate::models::xu_sun::xu_sun_visibility;
    use asperity_optics::from_spherical;

    fn model(s: f64, visibility: RayVisibility) -> XuSunMonteCarlo {
        let slopes = SlopeCovariance::isotropic(s).unwrap();
        XuSunMonteCarlo::new(slopes, Material::Mirror, visibility).unwrap()
    }

    /// Half of all heights are below the mean one, and `(1/2)^(K / ln 2) = exp(-K)`.
    #[test]
    fn visibility_at_mean_height_is_the_published_one() {
        for s in [0.3, 1.0, 4.0] {
            for theta in [20.0, 50.0, 75.0, 89.0] {
                let w = from_spherical(f64::to_radians(theta), 0.4);
                let published = xu_sun_visibility(w, s);
                for w in [w, -w] {
                    let found = model(s, RayVisibility::XuSun).visibility(w, 0.5);
                    // An exponent of K is rounded to 2e-16 of itself.
                    let rounding = 1e-15 * (1.0 - published.ln());
                    println!("{s} {theta}: {found:e} of {published:e}");
                    assert!((found - published).abs() <= rounding * published);
                }
            }
        }
    }

    /// The mean of `Phi^a` over heights is `1 / (1 + a)`; it is one at the top and zero at the bottom.
    #[test]
    fn mean_visibility_over_heights_follows_from_its_exponent() {
        let w = from_spherical(1.2, 0.4);
        let lambda = Beckmann::new(SlopeCovariance::isotropic(0.7).unwrap()).lambda(w);
        let published = -xu_sun_visibility(w, 0.7).ln() / std::f64::consts::LN_2;
        for (visibility, exponent) in [
            (RayVisibility::Smith, lambda),
            (RayVisibility::XuSun, published),
        ] {
            let model = model(0.7, visibility);
            assert_eq!(model.visibility(w, 1.0), 1.0);
            assert_eq!(model.visibility(w, 0.0), 0.0);
            let steps = 20_000;
            let at = |i: u32| model.visibility(w, (f64::from(i) + 0.5) / f64::from(steps));
            let mean = (0..steps).map(at).sum::<f64>() / f64::from(steps);
            println!("{visibility:?} {mean} of {}", 1.0 / (1.0 + exponent));
            assert!((mean * (1.0 + exponent) - 1.0).abs() < 1e-4);
        }
    }
}
