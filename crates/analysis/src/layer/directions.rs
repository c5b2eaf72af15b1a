//! Integrals of light scattered once over ranges of directions.

use std::f64::consts::PI;
use std::ops::Range;

use asperity_numerics::elementary::{asin, cos, sin_cos};
use asperity_numerics::quadrature::{Breaks, Pieces, Tolerance, integrate};
use asperity_optics::Incidence;
use asperity_tally::{Side, SideFluxes, TallySpec};
use rayon::prelude::*;

use super::flat_layers::FlatLayers;
use super::passage::Passage;

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

/// Ranges of directions on one side, into which some of the layers scatter light.
pub(super) struct Directions<'a> {
    stack: &'a FlatLayers,
    numbers: Range<usize>,
    incident: Passage,
    /// Horizontal component of the direction of incidence.
    across: f64,
    side: Side,
    /// Azimuth of undeviated light.
    forward: f64,
    /// Polar angles at which the density has the root of a critical angle.
    roots: Vec<f64>,
    /// Polar angle of undeviated light, if it leaves on this side or would.
    peak: Option<f64>,
    /// Widths of the peaks of phase functions, radians.
    widths: Vec<f64>,
}

impl<'a> Directions<'a> {
    pub(super) fn new(
        stack: &'a FlatLayers,
        numbers: Range<usize>,
        incidence: Incidence,
        side: Side,
    ) -> Self {
        let outside = match side {
            Side::Reflected => 0,
            Side::Transmitted => stack.faces.len(),
        };
        let index = stack.indices.get(outside).copied().unwrap_or(f64::NAN);
        let across = incidence.wi().truncate().length();
        let polar = |sin: f64| {
            let angle = asin(sin);
            let angle = match side {
                Side::Reflected => angle,
                Side::Transmitted => PI - angle,
            };
            (0.0..=1.0).contains(&sin).then_some(angle)
        };
        // Light that grazes a face in another medium
        let others = stack.indices.iter().enumerate();
        let others = others.filter(|(medium, _)| *medium != outside);
        let mut widths: Vec<f64> = numbers
            .clone()
            .map(|number| (1.0 - stack.media[number].phase.mean_cosine().abs()).max(1e-6))
            .collect();
        widths.dedup();
        Self {
            roots: others.filter_map(|(_, n)| polar(n / index)).collect(),
            // Equal cosines inside before and after scattering
            peak: polar(across / index),
            incident: Passage::of_incident(stack, incidence.wi()),
            forward: incidence.phi() + PI,
            across,
            stack,
            numbers,
            side,
            widths,
        }
    }

    /// Distances from a peak at which integrals are subdivided.
    fn around_peak(&self) -> impl Iterator<Item = f64> {
        let widths = self.widths.iter();
        widths.flat_map(|width| PEAK.map(|distance| distance * width))
    }

    /// Fluxes into the bins and the in-plane slice of `spec`.
    pub(super) fn fluxes(&self, spec: &TallySpec) -> SideFluxes {
        let filter = spec.bin_filter(self.side);
        let bins = (0..filter.len())
            .into_par_iter()
            .map(|i| {
                let bin = filter.bin(i);
                self.flux(bin.theta, bin.phi)
            })
            .collect();
        let slice = spec.in_plane_filter(self.side);
        let half_width = slice.half_width();
        let in_plane = (0..slice.len())
            .into_par_iter()
            .map(|i| {
                let [from, to] = slice.theta_deg(i).map(f64::to_radians);
                // Bins do not straddle the normal.
                let (azimuth, near, far) = if to > 0.0 {
                    (self.forward, from, to)
                } else {
                    (self.forward - PI, -to, -from)
                };
                let theta = match self.side {
                    Side::Reflected => [near, far],
                    Side::Transmitted => [PI - far, PI - near],
                };
                self.flux(theta, [azimuth - half_width, azimuth + half_width])
            })
            .collect();
        SideFluxes::from_bins(&filter, bins, in_plane)
    }

    /// Flux into polar angles `theta` from +z, on the side, and azimuths `phi`, radians, ascending.
    fn flux(&self, theta: [f64; 2], phi: [f64; 2]) -> f64 {
        let mut breaks = Breaks::new(theta[0], theta[1]);
        self.roots.iter().for_each(|&root| breaks.add_root(root));
        if let Some(peak) = self.peak {
            self.around_peak()
                .for_each(|distance| breaks.add_smooth(peak + distance));
        }
        breaks.finish();
        let mut azimuths = Breaks::new(phi[0], phi[1]);
        let half_turns = (((phi[0] - self.forward) / PI).floor() as i64)..;
        for centre in half_turns
            .map(|k| self.forward + PI * k as f64)
            .take_while(|&x| x < phi[1] + PI)
        {
            self.around_peak()
                .for_each(|distance| azimuths.add_smooth(centre + distance));
        }
        azimuths.finish();
        let (mut outer, mut inner) = (Pieces::default(), Pieces::default());
        integrate(&breaks, OUTER, &mut outer, |theta| {
            let (sin_theta, cos_theta) = sin_cos(theta);
            let numbers = self.numbers.clone();
            let leaving = self
                .stack
                .leave(&self.incident, numbers, self.side, cos_theta.abs());
            if leaving.is_dark() {
                return 0.0;
            }
            let h = sin_theta * self.across;
            let of_azimuth = |phi: f64| leaving.bsdf(h * cos(phi - self.forward));
            let turn = if h == 0.0 || leaving.is_isotropic() {
                (phi[1] - phi[0]) * of_azimuth(phi[0])
            } else {
                integrate(&azimuths, INNER, &mut inner, of_azimuth)
            };
            turn * sin_theta * cos_theta.abs()
        })
    }
}
