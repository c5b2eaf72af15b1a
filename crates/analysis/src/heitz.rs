//! Multiple scattering on the Smith microsurface: a random walk among independent facets.
//!
//! Parameters: the slope covariance and the material. Light is followed from facet to facet. Where it is
//! among them is told by `C1`, the share of the surface below it; the free path, the facets that are met
//! and the chance to escape follow from Smith's Lambda alone:
//!
//! ```text
//! escape upwards        C1^Lambda(w)
//! facets met            D_w(m) = max(0, w . m) D(m) / (cos(theta_w) (1 + Lambda(w)))
//! downwards             Lambda(-w) = -1 - Lambda(w)
//! behind the surface    C1 -> 1 - C1, z -> -z, eta -> 1 / eta
//! ```
//!
//! Light scattered once has a closed form, the height-correlated [`Smith`] model; the walk is there for
//! what is scattered more often, which is rare on smooth surfaces. So at each facet the light that escapes
//! is booked as an expectation, and the walk goes on with the rest: every ray contributes to all
//! orders.
//!
//! # Source
//! Heitz, Hanika, d'Eon and Dachsbacher 2016, "Multiple-scattering microfacet BSDFs with the Smith model".

#[cfg(test)]
mod analog;
mod height;

use asperity_optics::{Material, dielectric, reflect, refract};
use asperity_tally::{Event, EventPath, Exit, Loss, Record, Side};
use glam::DVec3;
use rand::distr::Open01;
use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

use crate::model::{BsdfModel, ModelError, ScatteringModel, Scope, Walk};
use crate::slopes::SlopeCovariance;
use crate::visible_normals::visible_normal;
use crate::{Masking, Smith};
use height::Height;

/// Light of all orders on the Smith microsurface of Gaussian slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heitz {
    single: Smith,
    slopes: SlopeCovariance,
    material: Material,
}

/// Interactions after which a path is ended; the share of light that is left then is far below rounding
/// unless a mirror is all but vertical everywhere.
const MOST_INTERACTIONS: u32 = 1000;

/// Roulette begins where the weight of a path has fallen below this share of that with which it set out
/// for its second facet.
const ROULETTE_BELOW: f64 = 0.5;

impl Heitz {
    /// The name of the model.
    pub const NAME: &'static str = "heitz";

    /// The model for a surface of such facet slopes.
    ///
    /// # Errors
    /// [`ModelError`] for an impossible material or equal indices.
    pub fn new(slopes: SlopeCovariance, material: Material) -> Result<Self, ModelError> {
        Ok(Self {
            single: Smith::new(slopes, material, Masking::HeightCorrelated)?,
            slopes,
            material,
        })
    }
}

impl ScatteringModel for Heitz {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn description(&self) -> &'static str {
        "Beckmann microfacets, all orders by a random walk on the Smith microsurface (Heitz et al. 2016)"
    }

    fn valid_range(&self) -> &'static str {
        "any Gaussian slopes, all orders; heights and slopes of successive facets taken as independent, so that multiple scattering is off by some tens of percent, where light meets the neighbours of a facet"
    }

    fn scope(&self) -> Scope {
        Scope::AllOrders
    }

    fn material(&self) -> Material {
        self.material
    }

    fn slopes(&self) -> SlopeCovariance {
        self.slopes
    }

    fn density(&self) -> Option<&dyn BsdfModel> {
        Some(&self.single)
    }

    fn walk(&self) -> Option<&dyn Walk> {
        Some(self)
    }
}

impl Walk for Heitz {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, record: &mut Record<'_>) {
        let mut height = Height::ABOVE_ALL.descended(self.slopes.lambda(wi), open(rng));
        let mut side = Side::Reflected;
        let mut w = wi;
        let mut weight = 1.0;
        let mut path = EventPath::default();
        let mut threshold = 0.0;
        while path.order() < MOST_INTERACTIONS {
            let m = visible_normal(&self.slopes, w, rng);
            let (ways, absorbed) = self.ways_on(side, height, w, m);
            if absorbed > 0.0 {
                record.add_loss(Loss::Absorbed, weight * absorbed);
            }
            for way in &ways {
                let flux = weight * way.share * way.escape;
                if flux > 0.0 {
                    record.add_exit(&Exit {
                        side: way.side,
                        wo: upright(way.side, way.direction),
                        flux,
                        path: path.then(way.event),
                    });
                }
            }
            let [staying, passing] = ways.each_ref().map(|way| way.share * way.blocked);
            let left = staying + passing;
            let picked = if rng.random::<f64>() * left < passing {
                &ways[1]
            } else {
                &ways[0]
            };
            weight *= left;
            // Nothing to speak of, and too little to divide by.
            if left < f64::MIN_POSITIVE {
                break;
            }
            if path.order() == 0 {
                threshold = ROULETTE_BELOW * weight;
            } else if weight < threshold {
                let survives = rng.random::<f64>() * threshold < weight;
                let kept = if survives { threshold } else { 0.0 };
                record.add_loss(Loss::Truncated, weight - kept);
                if !survives {
                    return;
                }
                weight = kept;
            }
            height = picked.next_height(open(rng));
            path = path.then(picked.event);
            side = picked.side;
            w = -picked.direction;
        }
        record.add_loss(Loss::Truncated, weight);
    }
}

/// A way on from a facet, in a frame whose +z points into the medium that the way leads through.
#[derive(Clone, Copy)]
struct Way {
    event: Event,
    side: Side,
    direction: DVec3,
    /// Share of the flux that arrived.
    share: f64,
    height: Height,
    lambda: f64,
    /// Probability that it leads away from the surface,
    escape: f64,
    /// and that it does not.
    blocked: f64,
}

impl Way {
    fn new(
        slopes: &SlopeCovariance,
        event: Event,
        side: Side,
        direction: DVec3,
        share: f64,
        height: Height,
    ) -> Self {
        let lambda = slopes.lambda(direction);
        let (escape, blocked) = if direction.z > 0.0 {
            height.escape(lambda)
        } else {
            (0.0, 1.0)
        };
        Self {
            event,
            side,
            direction,
            share,
            height,
            lambda,
            escape,
            blocked,
        }
    }

    /// Where light that does not escape meets the next facet.
    fn next_height(&self, u: f64) -> Height {
        if self.direction.z > 0.0 {
            self.height.ascended(self.lambda, self.blocked, u)
        } else {
            self.height.descended(self.lambda, u)
        }
    }
}

impl Heitz {
    /// The ways on by reflection and by transmission for light on `side` that comes from `w` to a facet
    /// `m`, and the share that is absorbed.
    fn ways_on(&self, side: Side, height: Height, w: DVec3, m: DVec3) -> ([Way; 2], f64) {
        let cos_alpha = w.dot(m).clamp(0.0, 1.0);
        let index = self.material.transmitting_index().map(|eta| match side {
            Side::Reflected => eta,
            Side::Transmitted => 1.0 / eta,
        });
        let fresnel = match index {
            Some(eta) => dielectric(cos_alpha, eta),
            None => self.material.fresnel(cos_alpha),
        };
        let reflected = Way::new(
            &self.slopes,
            Event::Reflection,
            side,
            reflect(w, m),
            fresnel.reflected,
            height,
        );
        match index {
            Some(eta) if fresnel.transmitted > 0.0 => {
                let d = refract(w, m, eta, fresnel.cos_beta);
                let transmitted = Way::new(
                    &self.slopes,
                    Event::Transmission,
                    behind(side),
                    DVec3::new(d.x, d.y, -d.z),
                    fresnel.transmitted,
                    height.seen_from_behind(),
                );
                ([reflected, transmitted], 0.0)
            }
            _ => {
                let nothing = Way {
                    share: 0.0,
                    ..reflected
                };
                ([reflected, nothing], 1.0 - fresnel.reflected)
            }
        }
    }
}

/// A uniform number in (0, 1), both ends excluded.
fn open<R: Rng>(rng: &mut R) -> f64 {
    rng.sample(Open01)
}

const fn behind(side: Side) -> Side {
    match side {
        Side::Reflected => Side::Transmitted,
        Side::Transmitted => Side::Reflected,
    }
}

/// Between the frame of a side and that in which +z points into the incident medium.
fn upright(side: Side, w: DVec3) -> DVec3 {
    match side {
        Side::Reflected => w,
        Side::Transmitted => DVec3::new(w.x, w.y, -w.z),
    }
}
