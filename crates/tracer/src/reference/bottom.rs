//! What a bottom does with light.

use asperity_optics::{Bottom, Material, around, reflect};
use asperity_tally::Event;
use glam::DVec3;
use rand::{Rng, RngExt};

use super::state::Space;
use crate::interaction::facet::{Branch, Scattered, scatter};

/// What a bottom does with light that comes through a space from `wi`, to a place of normal `m` on the side
/// of `wi`.
pub(super) fn at_bottom<R: Rng>(
    bottom: Bottom,
    space: Space,
    wi: DVec3,
    m: DVec3,
    rng: &mut R,
) -> Scattered {
    let (share, direction) = match bottom {
        Bottom::Interface { eta } => {
            return scatter(Material::Dielectric { eta }, space == Space::Inside, wi, m);
        }
        Bottom::Mirror => (1.0, reflect(wi, m)),
        // Lambert: the squared cosine to the normal is evenly distributed.
        Bottom::Lambertian { reflectance } => {
            let cos = rng.random::<f64>().sqrt();
            (reflectance, around(m, cos, rng.random()))
        }
        _ => (0.0, DVec3::ZERO),
    };
    let mut scattered = nothing();
    scattered.branches[1].share = share;
    scattered.branches[1].direction = direction;
    scattered.absorbed = 1.0 - share;
    scattered
}

/// No light goes on.
pub(super) fn nothing() -> Scattered {
    let branch = |event| Branch {
        event,
        direction: DVec3::ZERO,
        share: 0.0,
    };
    Scattered {
        branches: [branch(Event::Transmission), branch(Event::Reflection)],
        absorbed: 0.0,
    }
}
