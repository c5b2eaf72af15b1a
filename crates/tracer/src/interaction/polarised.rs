//! Polarised light: the polarisation that a path carries, and how interfaces and media change it.
//!
//! In addition to its flux a path carries Q, U and V divided by the flux. On request it also carries the averaged flux, or instead a
//! whole Mueller matrix, normalised in the same way. They refer to [`asperity_optics::reference_axes`] of the ray in the world, with
//! +z on the incident side. Branches and Russian roulette are decided by the intensity of the incident light; with Mueller matrices
//! by that of unpolarised incident light.

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
    /// Numbers that the path carries now.
    pub(crate) light: [f64; N],
}

/// Polarisation that a path carries besides its flux: `N` numbers.
pub(crate) trait CarriedLight<const N: usize> {
    /// The light after a passage.
    fn after(light: [f64; N], passage: &Passage) -> Passed<N>;

    /// The light after its polarisation was lost.
    fn depolarised(light: [f64; N]) -> [f64; N];
}

/// Nothing: light counts as unpolarised at every interface.
pub(crate) struct AveragedLight;

impl CarriedLight<0> for AveragedLight {
    #[inline(always)]
    fn after(_: [f64; 0], passage: &Passage) -> Passed<0> {
        Passed {
            fraction: passage.facet.m00,
            light: [],
        }
    }

    #[inline(always)]
    fn depolarised(_: [f64; 0]) -> [f64; 0] {
        []
    }
}

/// Normalised Stokes parameters Q/I, U/I, V/I.
pub(crate) struct TrackedLight;

impl CarriedLight<3> for TrackedLight {
    #[inline(always)]
    fn after([q, u, v]: [f64; 3], passage: &Passage) -> Passed<3> {
        let [i, q, u, v] = passage.apply([1.0, q, u, v]);
        let inverse = inverse_norm([i, q, u, v]);
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

/// Normalised Stokes parameters as in [`TrackedLight`], followed by the ratio of the averaged flux of the path (s and p
/// averaged at every interface) to its flux.
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

/// The normalised Mueller matrix of the path, column by column, without m00 = 1.
pub(crate) struct MuellerLight;

impl MuellerLight {
    /// The identity matrix: no interaction yet.
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
        let inverse = inverse_norm([i, q, u, v]);
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

/// Reciprocal of the norm of a Stokes vector; one if there is no light.
#[inline(always)]
fn inverse_norm(stokes: [f64; 4]) -> f64 {
    let norm = Stokes(stokes).norm();
    1.0 / if norm > 0.0 { norm } else { 1.0 }
}
