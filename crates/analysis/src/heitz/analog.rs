//! The walk in its plainest form, to check the quicker one by: one branch, weight one, escape by chance.

use asperity_optics::{Material, dielectric, reflect, refract};
use asperity_tally::{Event, EventPath, Exit, Loss, Record, Side};
use glam::DVec3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use crate::model::Walk;
use crate::slopes::SlopeCovariance;
use crate::visible_normals::visible_normal;

/// The random walk of Heitz et al. 2016 as they write it, in one frame, with `C1` itself and the sign
/// rule of Lambda.
pub(crate) struct Analog {
    pub(crate) slopes: SlopeCovariance,
    pub(crate) material: Material,
}

impl Analog {
    /// Lambda of a direction anywhere on the sphere, for a ray whose medium lies towards `up`.
    fn lambda(&self, d: DVec3, up: f64) -> f64 {
        let lambda = self.slopes.lambda(d);
        if d.z * up > 0.0 {
            lambda
        } else {
            -1.0 - lambda
        }
    }
}

impl Walk for Analog {
    fn follow(&self, wi: DVec3, rng: &mut ChaCha8Rng, record: &mut Record<'_>) {
        let mut path = EventPath::default();
        // +1 in the incident medium, -1 in the other.
        let mut up = 1.0;
        let mut d = -wi;
        // Share of the surface on the far side of the medium that the ray is in.
        let mut c1: f64 = 1.0;
        while path.order() < 1000 {
            let lambda = self.lambda(d, up);
            let u: f64 = rng.random();
            if d.z * up > 0.0 && u >= 1.0 - c1.powf(lambda) {
                let side = if up > 0.0 {
                    Side::Reflected
                } else {
                    Side::Transmitted
                };
                let wo = d;
                record.add_exit(&Exit {
                    side,
                    wo,
                    flux: 1.0,
                    path,
                });
                return;
            }
            c1 /= (1.0 - u).powf(1.0 / lambda);
            let flip = DVec3::new(1.0, 1.0, up);
            let m = flip * visible_normal(&self.slopes, -d * flip, rng);
            let cos_alpha = m.dot(-d).clamp(0.0, 1.0);
            match self.material {
                Material::Dielectric { eta } => {
                    let eta = if up > 0.0 { eta } else { 1.0 / eta };
                    let fresnel = dielectric(cos_alpha, eta);
                    if rng.random::<f64>() < fresnel.reflected {
                        path = path.then(Event::Reflection);
                        d = reflect(-d, m);
                    } else {
                        path = path.then(Event::Transmission);
                        d = refract(-d, m, eta, fresnel.cos_beta);
                        up = -up;
                        c1 = 1.0 - c1;
                    }
                }
                opaque => {
                    if rng.random::<f64>() >= opaque.fresnel(cos_alpha).reflected {
                        record.add_loss(Loss::Absorbed, 1.0);
                        return;
                    }
                    path = path.then(Event::Reflection);
                    d = reflect(-d, m);
                }
            }
        }
        record.add_loss(Loss::Truncated, 1.0);
    }
}
