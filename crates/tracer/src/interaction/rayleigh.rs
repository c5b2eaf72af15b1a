//! Rayleigh scattering: scatters polarised light by dipoles along the field.

use asperity_optics::{FacetMueller, PhaseFunction, Stokes, incidence_axis};
use glam::DVec3;

use super::polarised::Passage;

/// Light after Rayleigh scattering.
pub(crate) struct RayleighScattered {
    pub(crate) direction: DVec3,
    /// Relative to unpolarised light.
    pub(crate) passage: Passage,
}

/// Scatters light along `k` of which `stokes` are Q, U and V over I, by three uniform numbers in `[0, 1)`.
///
/// The angle of scattering is that of unpolarised light, `1 + mu^2`. Of two planes of scattering at right angles one is chosen by
/// the flux that goes there, so that azimuths have the density `1 + a cos(2 phi)` that the polarisation asks for.
///
/// # Source
/// The matrix: Chandrasekhar, Radiative Transfer, Sec. 17; in the axes of the plane of scattering `E_s' = E_s`, `E_p' = mu E_p`.
#[inline]
pub(crate) fn scatter_rayleigh(
    k: DVec3,
    stokes: [f64; 3],
    handedness: f64,
    [u, azimuth, choice]: [f64; 3],
) -> RayleighScattered {
    let towards = |azimuth| PhaseFunction::Rayleigh.sample(k, [u, azimuth]);
    let first = towards(azimuth);
    let mu = k.dot(first);
    let square = mu * mu;
    let scale = 1.0 / (1.0 + square);
    let matrix = FacetMueller {
        m00: 1.0,
        m01: (1.0 - square) * scale,
        m22: 2.0 * mu * scale,
        m23: 0.0,
    };
    let passage_to = |direction| {
        let axis = incidence_axis(k, direction);
        Passage::new([k, direction], axis, matrix, handedness)
    };
    let passage = passage_to(first);
    let [q, u, v] = stokes;
    let light = Stokes([1.0, q, handedness * u, handedness * v]).turned(passage.turn_in);
    let Stokes([flux, ..]) = light.after(matrix);
    if 2.0 * choice < flux {
        return RayleighScattered {
            direction: first,
            passage,
        };
    }
    let second = towards((azimuth + 0.25).fract());
    RayleighScattered {
        direction: second,
        passage: passage_to(second),
    }
}
