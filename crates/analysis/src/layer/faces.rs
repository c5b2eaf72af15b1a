//! Faces of a layer: light on its way in and out.

use asperity_optics::{Fresnel, dielectric};
use asperity_tally::Side;
use glam::{DVec2, DVec3};

use super::depth::{against, along};
use super::flat_layer::{FlatLayer, LayerPaths};

/// Unscattered light inside the layer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inside {
    /// Horizontal component of the direction that it travels in.
    pub(super) across: DVec2,
    /// Cosine of its angle to the normal.
    pub(super) mu: f64,
    /// Fresnel terms of the top face on the way in.
    pub(super) top: Fresnel,
    tau: f64,
    /// Flux that goes down, below the top.
    pub(super) down: f64,
    /// Flux that goes up, above the bottom.
    pub(super) up: f64,
}

impl Inside {
    /// Transmittance from face to face.
    pub(super) fn attenuation(&self) -> f64 {
        // Under total reflection at the top there is no cosine inside, and no light.
        if self.tau == 0.0 {
            return 1.0;
        }
        (-self.tau / self.mu).exp()
    }
}

/// Light that leaves in directions of one polar angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaving {
    /// Horizontal components inside over those outside.
    pub(super) ratio: f64,
    /// Cosine inside.
    pub(super) mu: f64,
    /// Factor of the phase function from down to up and from up to down.
    turned: f64,
    /// Factor of the phase function from down to down and from up to up.
    kept: f64,
}

impl FlatLayer {
    /// Unscattered light inside the layer, from `wi` with `z > 0`.
    pub(super) fn enter(&self, wi: DVec3) -> Inside {
        let top = dielectric(wi.z.min(1.0), self.eta);
        let mu = top.cos_theta_t;
        let mut inside = Inside {
            across: -wi.truncate() / self.eta,
            mu,
            top,
            tau: self.tau,
            down: top.transmitted,
            up: 0.0,
        };
        if self.paths == LayerPaths::All && top.transmitted > 0.0 {
            let bottom = self.bottom_face(mu);
            // Both sides of the top reflect alike (Stokes).
            inside.down /= one_less_round_trip(&top, &bottom, self.tau / mu);
            inside.up = inside.down * bottom.reflected * inside.attenuation();
        }
        inside
    }

    /// Light that leaves on `side` at the cosine `c > 0` outside, or `None` if no light leaves there.
    pub(super) fn leave(&self, inside: &Inside, side: Side, c: f64) -> Option<Leaving> {
        if self.albedo == 0.0 || inside.top.transmitted == 0.0 {
            return None;
        }
        let c = c.min(1.0);
        // The reversed path, from outside
        let (ratio, near) = match side {
            Side::Reflected => (1.0 / self.eta, dielectric(c, self.eta)),
            Side::Transmitted => {
                let eta = self.bottom.index_beyond()?;
                (eta, dielectric(c, 1.0 / eta))
            }
        };
        let mu = near.cos_theta_t;
        if near.transmitted == 0.0 || mu == 0.0 {
            return None;
        }
        let (series, back) = match self.paths {
            LayerPaths::HanrahanKrueger => (1.0, 0.0),
            LayerPaths::All => {
                let far = match side {
                    Side::Reflected => self.bottom_face(mu),
                    Side::Transmitted => dielectric(mu, 1.0 / self.eta),
                };
                let series = one_less_round_trip(&near, &far, self.tau / mu);
                (1.0 / series, far.reflected * (-self.tau / mu).exp())
            }
        };
        let (down, up) = (inside.down, inside.up);
        let a = against(self.tau, inside.mu, mu);
        let b = along(self.tau, inside.mu, mu);
        let (turned, kept) = match side {
            Side::Reflected => (a * (down + up * back), b * (up + down * back)),
            Side::Transmitted => (a * (up + down * back), b * (down + up * back)),
        };
        let scale = self.albedo * ratio * ratio * near.transmitted * series;
        Some(Leaving {
            ratio,
            mu,
            turned: scale * turned,
            kept: scale * kept,
        })
    }

    /// The BSDF towards a direction of horizontal component `across`, outside.
    pub(super) fn scattered(&self, inside: &Inside, exit: &Leaving, across: DVec2) -> f64 {
        self.by_cosine(inside, exit, exit.ratio * across.dot(inside.across))
    }

    /// The BSDF, given the product `h` of the horizontal components inside.
    pub(super) fn by_cosine(&self, inside: &Inside, exit: &Leaving, h: f64) -> f64 {
        let z = inside.mu * exit.mu;
        let p = |cos: f64| self.phase.density(cos.clamp(-1.0, 1.0));
        let mut f = 0.0;
        // Skip phase functions without light
        if exit.turned > 0.0 {
            f += exit.turned * p(h - z);
        }
        if exit.kept > 0.0 {
            f += exit.kept * p(h + z);
        }
        f
    }
}

/// `1 - R R' exp(-2 path)`, one minus the fraction left after a round trip, without cancellation where that is
/// nearly one; `path` from face to face, in mean free paths.
fn one_less_round_trip(near: &Fresnel, far: &Fresnel, path: f64) -> f64 {
    let lost_beyond = far.transmitted - far.reflected * (-2.0 * path).exp_m1();
    near.transmitted + near.reflected * lost_beyond
}
