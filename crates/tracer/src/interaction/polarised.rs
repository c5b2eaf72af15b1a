//! Polarised light: what paths carry of it, and what interfaces and media do with that.
//!
//! Besides its flux a path carries numbers relative to it: three for its Stokes vector, and more where it also keeps what averaged light
//! would do, or a whole Mueller matrix. They refer to [`asperity_optics::reference_axes`] of the ray in the
//! world with +z on the incident side. Paths go on, by their random choices and by roulette, as the light that falls on the surface
//! does; where Mueller matrices are kept, as unpolarised light does.

use asperity_optics::{FacetMueller, Stokes, Turn};
use glam::DVec3;

/// Most numbers that a path carries.
pub(crate) const MAX_NUMBERS: usize = 15;

/// One interface, or one scattering in a medium, on the way of polarised light.
#[derive(Clone, Copy)]
pub(crate) struct Passage {
    /// From the axes of the ray that arrives to those of its plane of incidence.
    pub(crate) turn_in: Turn,
    pub(crate) facet: FacetMueller,
    /// From there to the axes of the ray that leaves.
    pub(crate) turn_out: Turn,
    /// Minus one where directions are mirrored against the world, which changes the signs of U and V; otherwise one.
    pub(crate) handedness: f64,
}

impl Passage {
    /// The passage of a ray from the direction `k` to `k_out`, in the plane of which `axis` is the normal.
    #[inline(always)]
    pub(crate) fn new(
        [k, k_out]: [DVec3; 2],
        axis: DVec3,
        facet: FacetMueller,
        handedness: f64,
    ) -> Self {
        Self {
            turn_in: Turn::to_axis(k, axis),
            facet,
            turn_out: Turn::to_axis(k_out, axis).inverse(),
            handedness,
        }
    }

    /// A Stokes vector after the passage.
    #[inline(always)]
    const fn apply(&self, [i, q, u, v]: [f64; 4]) -> [f64; 4] {
        let h = self.handedness;
        let light = Stokes([i, q, h * u, h * v]).turned(self.turn_in);
        let Stokes([i, q, u, v]) = light.after(self.facet).turned(self.turn_out);
        [i, q, h * u, h * v]
    }
}

/// The light of a path after a passage.
#[derive(Clone, Copy)]
pub(crate) struct Passed<const N: usize> {
    /// Flux per flux that has arrived.
    pub(crate) fraction: f64,
    /// What the path carries now.
    pub(crate) light: [f64; N],
}

/// What a path carries of its light besides its flux: `N` numbers.
pub(crate) trait CarriedLight<const N: usize> {
    /// The light after a passage.
    fn after(light: [f64; N], passage: &Passage) -> Passed<N>;

    /// The light after its polarisation was lost.
    fn depolarised(light: [f64; N]) -> [f64; N];
}

/// Q, U and V over I.
pub(crate) struct TrackedLight;

impl CarriedLight<3> for TrackedLight {
    #[inline(always)]
    fn after([q, u, v]: [f64; 3], passage: &Passage) -> Passed<3> {
        let [i, q, u, v] = passage.apply([1.0, q, u, v]);
        let inverse = inverse_flux([i, q, u, v]);
        Passed {
            fraction: if i > 0.0 { i } else { 0.0 },
            light: [q * inverse, u * inverse, v * inverse],
        }
    }

    #[inline(always)]
    fn depolarised(_: [f64; 3]) -> [f64; 3] {
        [0.0; 3]
    }
}

/// The same, then the flux that the path would carry if light were unpolarised at each interface, over its flux.
pub(crate) struct BothLight;

impl CarriedLight<4> for BothLight {
    #[inline(always)]
    fn after([q, u, v, averaged]: [f64; 4], passage: &Passage) -> Passed<4> {
        let Passed {
            fraction,
            light: [q, u, v],
        } = TrackedLight::after([q, u, v], passage);
        // Exactly one where unpolarised light arrives.
        let ratio = passage.facet.m00 / if fraction > 0.0 { fraction } else { 1.0 };
        Passed {
            fraction,
            light: [q, u, v, averaged * ratio],
        }
    }

    #[inline(always)]
    fn depolarised([.., averaged]: [f64; 4]) -> [f64; 4] {
        [0.0, 0.0, 0.0, averaged]
    }
}

/// The Mueller matrix of the path over its first element, column by column, without that element.
pub(crate) struct MuellerLight;

impl MuellerLight {
    /// The matrix of a path without any passage.
    pub(crate) const INCIDENT: [f64; MAX_NUMBERS] = [
        0.0, 0.0, 0.0, //
        0.0, 1.0, 0.0, 0.0, //
        0.0, 0.0, 1.0, 0.0, //
        0.0, 0.0, 0.0, 1.0,
    ];
}

impl CarriedLight<MAX_NUMBERS> for MuellerLight {
    #[inline(always)]
    fn after(light: [f64; 15], passage: &Passage) -> Passed<15> {
        let [q, u, v, a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3] = light;
        let [i, q, u, v] = passage.apply([1.0, q, u, v]);
        let [a0, a1, a2, a3] = passage.apply([a0, a1, a2, a3]);
        let [b0, b1, b2, b3] = passage.apply([b0, b1, b2, b3]);
        let [c0, c1, c2, c3] = passage.apply([c0, c1, c2, c3]);
        let inverse = inverse_flux([i, q, u, v]);
        let mut light = [q, u, v, a0, a1, a2, a3, b0, b1, b2, b3, c0, c1, c2, c3];
        for number in &mut light {
            *number *= inverse;
        }
        Passed {
            fraction: if i > 0.0 { i } else { 0.0 },
            light,
        }
    }

    #[inline(always)]
    fn depolarised([_, _, _, a, _, _, _, b, _, _, _, c, _, _, _]: [f64; 15]) -> [f64; 15] {
        [
            0.0, 0.0, 0.0, a, 0.0, 0.0, 0.0, b, 0.0, 0.0, 0.0, c, 0.0, 0.0, 0.0,
        ]
    }
}

/// One over the flux of a Stokes vector.
///
/// Where nearly all light is lost, rounding may leave more polarised light than light: then one over that, so that no path ever
/// carries more.
#[inline(always)]
fn inverse_flux([i, q, u, v]: [f64; 4]) -> f64 {
    let polarised = (q * q + u * u + v * v).sqrt();
    let flux = if i > polarised { i } else { polarised };
    1.0 / if flux > 0.0 { flux } else { 1.0 }
}
