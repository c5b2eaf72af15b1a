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
//! orders. At the first facet light goes on both ways, by reflection and by transmission, at others one
//! way, picked by what is left of it; roulette ends paths that have become weak against their own
//! beginning.
//!
//! # Source
//! Heitz, Hanika, d'Eon and Dachsbacher 2016, "Multiple-scattering microfacet BSDFs with the Smith model".

#[cfg(test)]
mod analog;
mod height;
mod way;

use asperity_optics::Material;
use asperity_tally::{EventPath, Exit, Loss, Record, Side};
use glam::DVec3;
use rand::RngExt;
use rand::distr::Open01;
use rand_chacha::ChaCha8Rng;

use crate::microfacet::slopes::SlopeCovariance;
use crate::microfacet::visible_normals::visible_normal;
use crate::models::model::{BsdfModel, ModelError, RandomWalk, ScatteringModel, Scope};
use crate::models::smith::{Masking, Smith};
use height::Height;
use way::{Way, ways_on};

/// Light of all orders on the Smith microsurface of Gaussian slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heitz {
    single: Smith,
    slopes: SlopeCovariance,
    material: Material,
}

/// Interactions after which a path is ended. What is left of it is booked as truncated.
const MOST_INTERACTIONS: u32 = 1000;

/// Roulette begins where the weight of a path has fallen below this share of that with which light sets
/// out for its second facet: relative, so that it does not matter how rare that is.
const ROULETTE_BELOW: f64 = 0.25;

/// Weight that a path is not followed for: a hundredth of the rounding of energies near one. Most light on
/// a smooth surface leaves less behind.
const NEGLIGIBLE: f64 = 1e-18;

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
        "any Gaussian slopes, all orders; successive facets taken as independent, not as neighbours: light scattered more than once was found at 0.4 to 1.5 times that of explicit surfaces of smoothness 2 and 3"
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

    fn random_walk(&self) -> Option<&dyn RandomWalk> {
        Some(self)
    }
}

impl RandomWalk for Heitz {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, record: &mut Record<'_>) {
        let first = Arrival {
            side: Side::Reflected,
            height: Height::ABOVE_ALL.descended(self.slopes.lambda(wi), rng.sample(Open01)),
            w: wi,
            weight: 1.0,
            path: EventPath::default(),
        };
        let ways = self.scatter(&first, rng, record);
        let threshold = ROULETTE_BELOW * ways.iter().map(|way| way.left).sum::<f64>();
        for way in ways {
            self.go_on(&way, way.left, first.path, threshold, rng, record);
        }
    }
}

/// Light that has come to a facet.
struct Arrival {
    /// Where the medium that it comes through lies; the frame is the one in which that is +z.
    side: Side,
    height: Height,
    /// Unit direction towards where it comes from.
    w: DVec3,
    weight: f64,
    /// Before this facet.
    path: EventPath,
}

impl Heitz {
    /// Draws the facet, and books what it absorbs and what escapes from it. The light that is left has not
    /// escaped either way.
    fn scatter(&self, at: &Arrival, rng: &mut ChaCha8Rng, record: &mut Record<'_>) -> [Way; 2] {
        let m = visible_normal(&self.slopes, at.w, rng);
        let (ways, absorbed) = ways_on(&self.slopes, self.material, at, m);
        if absorbed > 0.0 {
            record.add_loss(Loss::Absorbed, at.weight * absorbed);
        }
        for way in &ways {
            let flux = at.weight * way.escaping;
            if flux > 0.0 {
                record.add_exit(&Exit {
                    side: way.side,
                    wo: way.upright_direction(),
                    flux,
                    path: at.path.then(way.event),
                    scatterings: 0,
                });
            }
        }
        ways
    }

    /// Follows light of that `weight` which goes on one `way` from a facet and does not escape.
    fn go_on(
        &self,
        way: &Way,
        mut weight: f64,
        mut path: EventPath,
        threshold: f64,
        rng: &mut ChaCha8Rng,
        record: &mut Record<'_>,
    ) {
        let mut way = *way;
        while path.order() + 1 < MOST_INTERACTIONS {
            if weight < NEGLIGIBLE {
                break;
            }
            if weight < threshold {
                let survives = rng.random::<f64>() * threshold < weight;
                let kept = if survives { threshold } else { 0.0 };
                record.add_loss(Loss::Truncated, weight - kept);
                if !survives {
                    return;
                }
                weight = kept;
            }
            path = path.then(way.event);
            let at = Arrival {
                side: way.side,
                height: way.next_height(rng.sample(Open01)),
                w: -way.direction,
                weight,
                path,
            };
            let [reflected, transmitted] = self.scatter(&at, rng, record);
            let left = reflected.left + transmitted.left;
            way = if rng.random::<f64>() * left < transmitted.left {
                transmitted
            } else {
                reflected
            };
            weight *= left;
        }
        record.add_loss(Loss::Truncated, weight);
    }
}
