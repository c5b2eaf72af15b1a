//! Flux integral: the flux of any scattering into a range of polar angle and azimuth.
//!
//! The integral over a bin is nested: azimuth within polar angle. Narrow lobes and edges of the integrand are
//! located beforehand, since a few samples per bin might miss both:
//!
//! - The density of slopes falls as `exp(-E)`, and the valleys of `E` along azimuth and polar angle are
//!   known: see [`Lobe`]. For isotropic slopes `E` grows with `sin^2(psi / 2)` about `psi = 0`, the
//!   forward azimuth, by `kappa = 2 eta sin theta_i sin theta / (variance h_z^2)`.
//! - The extent of the lobe in `theta` is that of the directions into which facets tilted within the
//!   plane of incidence send the light, or, for correlated slopes, the most likely facets at
//!   their tilt. Where slopes are not isotropic, the lobe may also leave the range
//!   through an end in azimuth; its valleys along both ends are marked too.
//! - Refraction ends, and total reflection sets in with a square root, on circles
//!   `wi . wo = constant`, whose crossings with `theta` and `psi` have closed forms. So have the
//!   kinks of a model: see [`Kinks`].

use std::f64::consts::{PI, TAU};

use asperity_numerics::elementary::{acos, asin, atan2, cos, hypot, sin_cos};
use asperity_numerics::vector::{Instructions, Stage};
use asperity_optics::{Material, polar_angle};
use asperity_tally::Side;
use glam::{DVec2, DVec3};

use crate::integrals::lobe::{Lobe, NEGLIGIBLE};
use crate::microfacet::bsdf_columns::Directions;
use crate::microfacet::half_vector::outgoing_direction;
use crate::microfacet::slope_distribution::SlopeDistribution;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::BsdfModel;
use asperity_numerics::quadrature::{AllowedError, Breaks, Pieces, integrate, integrate_columns};

/// Facet slopes in units of their deviation times the root of two whose images bound the first subdivisions; the slope density
/// falls as `exp(-t^2)`.
const LOBE_SLOPES: [f64; 5] = [-5.0, -2.0, 0.0, 2.0, 5.0];

/// A BSDF as of [`BsdfModel::bsdf_columns`].
pub(crate) type BsdfColumns<'a> = &'a (dyn Fn(DVec3, Directions<'_>, &mut [f64]) + Sync);

/// Tolerance in azimuth, radians, for a range that is symmetric about the plane of incidence.
const EVEN: f64 = 1e-12;

/// The integrand, and its properties that place the subdivisions.
#[derive(Clone, Copy)]
pub(crate) struct Scattering<'a> {
    pub(crate) slopes: SlopeCovariance,
    /// `true` if light that facets of rare slopes scatter counts, as of GGX: no direction is left out.
    pub(crate) long_tails: bool,
    pub(crate) material: Material,
    pub(crate) kinks: Kinks,
    /// The BSDF of `wi` and columns of `wo`, in 1/sr. It is isotropic if the slopes are, and negligible where these are rare, unless it has long tails.
    pub(crate) bsdf: BsdfColumns<'a>,
    /// Error allowed in the flux of one range.
    pub(crate) error: AllowedError,
}

impl<'a> Scattering<'a> {
    /// The scattering of a model; `bsdf` must be its BSDF.
    pub(crate) fn of(model: &dyn BsdfModel, bsdf: BsdfColumns<'a>) -> Self {
        let slopes = model.slopes();
        Self {
            slopes: *slopes.ggx().beckmann(),
            long_tails: matches!(slopes, SlopeDistribution::Ggx { .. }),
            material: model.material(),
            kinks: model.kinks(),
            bsdf,
            error: Self::EXACT,
        }
    }

    /// The error allowed in fluxes that are reported as exact.
    pub(crate) const EXACT: AllowedError = AllowedError {
        absolute: 1e-12,
        relative: 1e-11,
    };
}

/// Integrals of flux for one direction of light and one side.
pub(crate) struct FluxIntegral<'a> {
    scattering: Scattering<'a>,
    shape: Lobe,
    wi: DVec3,
    sin_i: f64,
    cos_i: f64,
    /// Azimuth of undeviated light.
    forward: f64,
    /// Index that enters the half vector: 1 for reflection.
    eta: f64,
    /// The index, if light is refracted.
    refracted: Option<f64>,
    /// `wi . wo` on the circle where refraction ends or total reflection sets in.
    edge: Option<f64>,
    /// Polar angles of the light from facets tilted within the plane of incidence.
    lobe: Vec<f64>,
    outer_pieces: Pieces,
    inner_pieces: Pieces,
    inner_breaks: Breaks,
    /// Error allowed in the flux per radian of polar angle.
    ring_error: AllowedError,
    /// Directions of one column of azimuths.
    directions: [Vec<f64>; 3],
}

impl<'a> FluxIntegral<'a> {
    /// `None` if no light leaves on `side`.
    pub(crate) fn new(scattering: &Scattering<'a>, wi: DVec3, side: Side) -> Option<Self> {
        let Scattering {
            slopes, material, ..
        } = *scattering;
        let index = material.transmitting_index();
        if wi.z <= 0.0 || (side == Side::Transmitted && index.is_none()) {
            return None;
        }
        let sin_i = hypot(wi.x, wi.y);
        let eta = match side {
            Side::Reflected => 1.0,
            Side::Transmitted => index?,
        };
        let refracted = (side == Side::Transmitted).then_some(eta);
        let edge = match (side, index) {
            // Refraction ends where the light arrives at the facet, or leaves it, at grazing.
            (Side::Transmitted, Some(eta)) => Some(-eta.min(1.0 / eta)),
            // cos(2 theta_i) at the critical angle, sin(theta_i) = eta.
            (Side::Reflected, Some(eta)) if eta < 1.0 => Some(1.0 - 2.0 * eta * eta),
            _ => None,
        };
        let along = if sin_i > 0.0 {
            wi.truncate() / sin_i
        } else {
            DVec2::X
        };
        let unit = slopes.times(along) * (2.0 / slopes.variance_along(along)).sqrt();
        let lobe = LOBE_SLOPES
            .iter()
            .filter_map(|t| {
                let m = (*t * unit).extend(1.0).normalize();
                outgoing_direction(&material, wi, m, refracted).map(polar_angle)
            })
            .collect();
        let forward = atan2(-wi.y, -wi.x);
        Some(Self {
            scattering: *scattering,
            shape: Lobe::new(&slopes, wi, forward, refracted),
            wi,
            sin_i,
            cos_i: wi.z,
            forward,
            eta,
            refracted,
            edge,
            lobe,
            outer_pieces: Pieces::default(),
            inner_pieces: Pieces::default(),
            inner_breaks: Breaks::default(),
            ring_error: Scattering::EXACT,
            directions: Default::default(),
        })
    }

    /// The flux fraction into the ranges `theta`, on the side of the integral, and `phi`.
    pub(crate) fn over(&mut self, theta: [f64; 2], phi: [f64; 2]) -> f64 {
        if !(theta[1] > theta[0] && phi[1] > phi[0]) {
            return 0.0;
        }
        // Measure azimuths from the forward direction, without whole turns, so that special points within a
        // turn of zero suffice
        let turns = ((0.5 * (phi[0] + phi[1]) - self.forward) / TAU).round() * TAU;
        let psi = [phi[0] - self.forward - turns, phi[1] - self.forward - turns];
        if !self.scattering.slopes.is_isotropic() {
            return self.over_azimuths(theta, psi);
        }
        // Scattering is symmetric about the plane of incidence: halve what lies evenly about it
        let (middle, half) = (0.5 * (psi[0] + psi[1]).abs(), 0.5 * (psi[1] - psi[0]));
        if middle < EVEN {
            2.0 * self.over_azimuths(theta, [0.0, half])
        } else if (middle - PI).abs() < EVEN {
            2.0 * self.over_azimuths(theta, [PI - half, PI])
        } else {
            self.over_azimuths(theta, psi)
        }
    }

    /// The flux fraction into the ranges `theta`, and `psi` from forward.
    fn over_azimuths(&mut self, theta: [f64; 2], psi: [f64; 2]) -> f64 {
        let mut breaks = Breaks::new(theta[0], theta[1]);
        for &t in &self.lobe {
            breaks.add_smooth(t);
        }
        if let Some(edge) = self.edge {
            for psi in [0.0, PI, psi[0], psi[1]] {
                for t in self.edge_at_azimuth(edge, psi).into_iter().flatten() {
                    breaks.add_root(t);
                }
            }
        }
        let theta_i = atan2(self.sin_i, self.cos_i);
        if let Some(t) = self.scattering.kinks.polar_angle(theta_i, self.refracted) {
            breaks.add_smooth(t);
        }
        if !self.scattering.slopes.is_isotropic() {
            for psi in psi {
                self.shape.mark_polar_angles(&mut breaks, theta, psi);
            }
        }
        breaks.finish();
        let tolerance = self.scattering.error.within(400);
        self.ring_error = AllowedError {
            absolute: 0.1 * tolerance.absolute / (theta[1] - theta[0]),
            relative: 0.1 * tolerance.relative,
        };
        let mut pieces = std::mem::take(&mut self.outer_pieces);
        let flux = integrate(&breaks, tolerance, &mut pieces, |t| self.ring(t, psi));
        self.outer_pieces = pieces;
        flux
    }

    /// Flux fraction per radian of polar angle at `theta`, over the azimuths `psi` from forward.
    fn ring(&mut self, theta: f64, mut psi: [f64; 2]) -> f64 {
        let (sin_theta, cos_theta) = sin_cos(theta);
        // Subdivide at the lobe, or return if it is elsewhere
        self.inner_breaks.reset(psi[0], psi[1]);
        let isotropic = self.scattering.slopes.is_isotropic();
        let least = if isotropic {
            self.shape.exponent(theta, 0.0_f64.clamp(psi[0], psi[1]))
        } else {
            self.shape.mark_azimuths(&mut self.inner_breaks, theta, psi)
        };
        if least > NEGLIGIBLE && !self.scattering.long_tails {
            return 0.0;
        }
        if isotropic {
            let kappa = self.kappa(sin_theta, cos_theta);
            if !self.scattering.long_tails && psi[0] >= -PI && psi[1] <= PI {
                // Leave out azimuths beyond the lobe, where E = E(0) + kappa sin^2(psi / 2) is above its limit
                let ahead = self.shape.exponent(theta, 0.0);
                let sin_half = ((NEGLIGIBLE - ahead) / kappa).sqrt();
                let end = 2.0 * asin(sin_half.min(1.0));
                psi = psi.map(|psi| psi.clamp(-end, end));
                self.inner_breaks.reset(psi[0], psi[1]);
            }
            self.mark_isotropic_lobe(kappa);
        }
        // Subdivide at edges and kinks
        self.mark_edges(sin_theta, cos_theta);
        self.mark_kinks(sin_theta, cos_theta);
        self.inner_breaks.finish();
        // Integrate over azimuth
        let (bsdf, wi, forward) = (self.scattering.bsdf, self.wi, self.forward);
        let weight = cos_theta.abs() * sin_theta;
        let [x, y, z] = &mut self.directions;
        integrate_columns(
            &self.inner_breaks,
            self.ring_error.within(200),
            &mut self.inner_pieces,
            |psi, values| {
                x.resize(psi.len(), 0.0);
                y.resize(psi.len(), 0.0);
                z.clear();
                z.resize(psi.len(), cos_theta);
                Instructions::best().run(Azimuths {
                    radius: sin_theta,
                    from: forward,
                    psi,
                    x,
                    y,
                });
                bsdf(wi, [&*x, &*y, &*z], values);
                values.iter_mut().for_each(|value| *value *= weight);
            },
        )
    }

    /// Growth of `E` with `sin^2(psi / 2)`, as at the head of this file; it may be infinite or NaN.
    fn kappa(&self, sin_theta: f64, cos_theta: f64) -> f64 {
        let h_z = self.cos_i + self.eta * cos_theta;
        let product = self.sin_i * sin_theta;
        2.0 * self.eta * product / (self.scattering.slopes.xx() * h_z * h_z)
    }

    /// Marks the forward azimuth, and the widths of the lobe of isotropic slopes about it.
    fn mark_isotropic_lobe(&mut self, kappa: f64) {
        for turn in [-TAU, 0.0, TAU] {
            self.inner_breaks.add_smooth(turn);
            for t in [2.0, 6.0] {
                // exp(-kappa sin^2(psi / 2)) has fallen to exp(-t^2).
                let sin_half = t / kappa.sqrt();
                if sin_half < 1.0 {
                    let width = 2.0 * asin(sin_half);
                    self.inner_breaks.add_smooth(turn - width);
                    self.inner_breaks.add_smooth(turn + width);
                }
            }
        }
    }

    /// Marks the azimuths where refraction ends or total reflection sets in.
    fn mark_edges(&mut self, sin_theta: f64, cos_theta: f64) {
        let edge = self.edge;
        let azimuth = edge.and_then(|edge| self.azimuth_at(edge, sin_theta, cos_theta));
        if let Some(psi) = azimuth {
            for turn in [-TAU, 0.0, TAU] {
                self.inner_breaks.add_root(turn - psi);
                self.inner_breaks.add_root(turn + psi);
            }
        }
    }

    /// Marks the azimuths of the kinks of the model.
    fn mark_kinks(&mut self, sin_theta: f64, cos_theta: f64) {
        let kinks = self.scattering.kinks;
        for x in kinks.products(self.cos_i, cos_theta, self.refracted) {
            if let Some(psi) = self.azimuth_at(x, sin_theta, cos_theta) {
                for turn in [-TAU, 0.0, TAU] {
                    self.inner_breaks.add_smooth(turn - psi);
                    self.inner_breaks.add_smooth(turn + psi);
                }
            }
        }
    }

    /// The azimuth from forward at which `wi . wo` has the value `x`, if there is one.
    fn azimuth_at(&self, x: f64, sin_theta: f64, cos_theta: f64) -> Option<f64> {
        let cos_psi = (self.cos_i * cos_theta - x) / (self.sin_i * sin_theta);
        (cos_psi.abs() <= 1.0).then(|| acos(cos_psi))
    }

    /// Polar angles at which the circle `wi . wo = edge` crosses the azimuth `psi` from forward:
    /// `cos theta_i cos theta - sin theta_i sin theta cos psi = edge`.
    fn edge_at_azimuth(&self, edge: f64, psi: f64) -> [Option<f64>; 3] {
        let (a, b) = (self.cos_i, -self.sin_i * cos(psi));
        let ratio = edge / hypot(a, b);
        if ratio.abs() > 1.0 {
            return [None; 3];
        }
        let (centre, radius) = (atan2(b, a), acos(ratio));
        [
            Some(centre + radius),
            Some(centre - radius),
            Some(centre - radius + TAU),
        ]
    }
}

/// Horizontal components of directions at azimuths `psi` past another one.
struct Azimuths<'a> {
    radius: f64,
    from: f64,
    psi: &'a [f64],
    x: &'a mut [f64],
    y: &'a mut [f64],
}

impl Stage for Azimuths<'_> {
    #[inline(always)]
    fn run(self) {
        for ((psi, x), y) in self.psi.iter().zip(self.x).zip(self.y) {
            let (sin, cos) = sin_cos(self.from + psi);
            (*x, *y) = (self.radius * cos, self.radius * sin);
        }
    }
}
