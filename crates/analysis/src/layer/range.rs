//! Integrals of light scattered once over ranges of directions.

use std::f64::consts::PI;

use asperity_numerics::quadrature::{Breaks, Pieces, Tolerance, integrate};
use asperity_optics::{Incidence, PhaseFunction};
use asperity_tally::Side;

use super::faces::Inside;
use super::flat_layer::FlatLayer;

/// Error allowed in the flux into one range of directions.
const OUTER: Tolerance = Tolerance {
    absolute: 1e-13,
    relative: 1e-11,
    max_pieces: 400,
};

/// Error allowed in the integral over azimuth, per unit of polar angle.
const INNER: Tolerance = Tolerance {
    absolute: 1e-14,
    relative: 1e-12,
    max_pieces: 200,
};

/// Distances from the peak of a phase function, in units of its width, at which integrals are subdivided.
const PEAK: [f64; 5] = [-5.0, -1.0, 0.0, 1.0, 5.0];

/// Ranges of directions on one side.
pub(super) struct Range<'a> {
    layer: &'a FlatLayer,
    inside: Inside,
    side: Side,
    /// Azimuth of undeviated light.
    forward: f64,
    /// Polar angles at which the density has the root of a critical angle, and a peak.
    roots: Vec<f64>,
    peaks: Vec<f64>,
    /// Width of the phase function's peak, radians.
    width: f64,
}

impl<'a> Range<'a> {
    pub(super) fn new(layer: &'a FlatLayer, incidence: Incidence, side: Side) -> Self {
        let inside = layer.enter(incidence.wi());
        let beyond = layer.bottom.index_beyond();
        // Horizontal components outside at which light grazes a face, from inside or outside
        let (grazing, ratio) = match side {
            Side::Reflected => (
                vec![
                    layer.eta,
                    beyond.map_or(f64::NAN, |beyond| layer.eta * beyond),
                ],
                1.0 / layer.eta,
            ),
            Side::Transmitted => {
                let beyond = beyond.unwrap_or(f64::NAN);
                (vec![1.0 / beyond, 1.0 / (layer.eta * beyond)], beyond)
            }
        };
        let polar = |sin: f64| {
            let angle = sin.asin();
            match side {
                Side::Reflected => angle,
                Side::Transmitted => PI - angle,
            }
        };
        let exists = |sin: &f64| (0.0..=1.0).contains(sin);
        Self {
            layer,
            side,
            forward: incidence.phi() + PI,
            roots: grazing.into_iter().filter(exists).map(polar).collect(),
            // Equal cosines inside before and after scattering
            peaks: Some(inside.across.length() / ratio)
                .filter(exists)
                .map(polar)
                .into_iter()
                .collect(),
            inside,
            width: (1.0 - layer.phase.mean_cosine().abs()).max(1e-6),
        }
    }

    /// Flux into polar angles `theta` from +z, on the side, and azimuths `phi`, radians, ascending.
    pub(super) fn flux(&self, theta: [f64; 2], phi: [f64; 2]) -> f64 {
        let mut breaks = Breaks::new(theta[0], theta[1]);
        self.roots.iter().for_each(|&root| breaks.add_root(root));
        for peak in &self.peaks {
            PEAK.iter()
                .for_each(|w| breaks.add_smooth(peak + w * self.width));
        }
        breaks.finish();
        let mut azimuths = Breaks::new(phi[0], phi[1]);
        let half_turns = (((phi[0] - self.forward) / PI).floor() as i64)..;
        for centre in half_turns
            .map(|k| self.forward + PI * k as f64)
            .take_while(|&x| x < phi[1] + PI)
        {
            PEAK.iter()
                .for_each(|w| azimuths.add_smooth(centre + w * self.width));
        }
        azimuths.finish();
        let (mut outer, mut inner) = (Pieces::default(), Pieces::default());
        integrate(&breaks, OUTER, &mut outer, |theta| {
            let (sin, cos) = theta.sin_cos();
            let Some(exit) = self.layer.leave(&self.inside, self.side, cos.abs()) else {
                return 0.0;
            };
            let h = exit.ratio * sin * self.inside.across.length();
            let of_azimuth = |phi: f64| {
                self.layer
                    .by_cosine(&self.inside, &exit, h * (phi - self.forward).cos())
            };
            let turn = if h == 0.0 || self.layer.phase == PhaseFunction::Isotropic {
                (phi[1] - phi[0]) * of_azimuth(phi[0])
            } else {
                integrate(&azimuths, INNER, &mut inner, of_azimuth)
            };
            turn * sin * cos.abs()
        })
    }
}
