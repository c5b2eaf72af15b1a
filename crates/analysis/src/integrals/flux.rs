//! Flux that a model sends into ranges of polar angle and azimuth.
//!
//! The integral over a bin is nested: azimuth within polar angle. Where the integrand has a narrow
//! lobe or an edge is known beforehand, so no bin is judged by a few samples that may miss both:
//!
//! - The density of slopes falls as `exp(-E)`, and the valleys of `E` along azimuth and polar angle are
//!   known: see [`Lobe`]. For isotropic slopes `E` grows with `sin^2(psi / 2)` about `psi = 0`, the
//!   forward azimuth, by `kappa = 2 eta sin theta_i sin theta / (variance h_z^2)`.
//! - The extent of the lobe in `theta` is that of the directions into which facets tilted within the
//!   plane of incidence send the light, or, of slopes that are correlated, those facets that are the
//!   likeliest at their tilt. Where slopes are not isotropic, the lobe may also leave the range
//!   through an end in azimuth; its valleys along both ends are marked too.
//! - Refraction ends, and total reflection sets in with a square root, on circles
//!   `wi . wo = constant`, whose crossings with `theta` and `psi` have closed forms. So have the kinks that a
//!   model may have beside: see [`Kinks`].

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use asperity_optics::{Incidence, Material, from_spherical, polar_angle};
use asperity_tally::{HemisphereGrid, Layout, Side, Sides};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

use crate::integrals::lobe::{Lobe, NEGLIGIBLE};
use crate::microfacet::half_vector::outgoing_direction;
use crate::microfacet::slopes::SlopeCovariance;
use crate::models::kinks::Kinks;
use crate::models::model::BsdfModel;
use crate::numerics::quadrature::{Breaks, Pieces, Tolerance, integrate};

/// Error allowed in the flux of one range.
const FLUX_ERROR: f64 = 1e-12;

/// Facet slopes in units of their deviation times the root of two whose images bound the first subdivisions; the slope density
/// falls as `exp(-t^2)`.
const LOBE_SLOPES: [f64; 5] = [-5.0, -2.0, 0.0, 2.0, 5.0];

/// Flux fractions that `model` sends into the bins of `grid`, in the order of the grid.
///
/// `wi` is a unit vector with `z > 0`. The error of a bin is about 1e-12 of the incident flux.
#[must_use]
pub fn bin_fluxes(model: &dyn BsdfModel, wi: DVec3, grid: &HemisphereGrid) -> Vec<f64> {
    bin_fluxes_of(model, wi, grid, Sides::Both)
}

/// [`bin_fluxes`] on the sides that are asked for, and zero on the other.
pub(crate) fn bin_fluxes_of(
    model: &dyn BsdfModel,
    wi: DVec3,
    grid: &HemisphereGrid,
    sides: Sides,
) -> Vec<f64> {
    let bsdf = |wi, wo| model.bsdf(wi, wo);
    fluxes_into_bins(&Scattering::of(model, &bsdf), wi, grid, sides)
}

/// Flux fractions into the bins of `grid`, to about 1e-12, and zero on sides that are not asked for.
pub(crate) fn fluxes_into_bins(
    scattering: &Scattering<'_>,
    wi: DVec3,
    grid: &HemisphereGrid,
    sides: Sides,
) -> Vec<f64> {
    let n_phi = grid.n_phi();
    let isotropic = scattering.slopes.is_isotropic();
    let vertical = wi.x == 0.0 && wi.y == 0.0;
    let mirror = mirror_sum(wi, n_phi);
    let mut fluxes = vec![0.0; grid.len()];
    for side in Side::BOTH.into_iter().filter(|&side| sides.ask(side)) {
        let first_of_side = side.index() * grid.bins_per_side();
        fluxes[first_of_side..][..grid.bins_per_side()]
            .par_chunks_exact_mut(n_phi)
            .enumerate()
            .for_each(|(ring, fluxes)| {
                let Some(mut range) = FluxIntegral::new(scattering, wi, side) else {
                    return;
                };
                for sector in 0..n_phi {
                    // Another bin of the ring that holds the same by symmetry, if it came before.
                    let twin = if !isotropic {
                        None
                    } else if vertical && sector > 0 {
                        Some(0)
                    } else {
                        mirror
                            .map(|sum| (sum + n_phi - sector) % n_phi)
                            .filter(|&twin| twin < sector)
                    };
                    fluxes[sector] = match twin {
                        Some(twin) => fluxes[twin],
                        None => {
                            let bin = grid.bin(first_of_side + ring * n_phi + sector);
                            range.over(bin.theta, bin.phi)
                        }
                    };
                }
            });
    }
    fluxes
}

/// Flux fraction that `model` sends into one range of directions on `side`.
///
/// `theta` from +z and `phi` from +x towards +y, radians, both `[from, to]` and ascending; `theta`
/// within `[0, pi/2]` for reflection and `[pi/2, pi]` for transmission (what lies outside counts
/// nothing), `phi` anywhere, up to a full turn wide. The error is about 1e-12 of the incident flux.
#[must_use]
pub fn flux_into(
    model: &dyn BsdfModel,
    wi: DVec3,
    side: Side,
    theta: [f64; 2],
    phi: [f64; 2],
) -> f64 {
    let bsdf = |wi, wo| model.bsdf(wi, wo);
    let theta = within_side(side, theta);
    FluxIntegral::new(&Scattering::of(model, &bsdf), wi, side)
        .map_or(0.0, |mut range| range.over(theta, phi))
}

/// Flux fraction that `model` sends to `side` between two signed angles from the normal of that side,
/// radians, negative where the light comes from, within `half_width` of the plane of incidence.
///
/// `from <= to`, both within a quarter of a turn; they may lie on either side of the normal. The plane is
/// that of the azimuth of `incidence`, also where the light is vertical.
#[must_use]
pub fn in_plane_flux(
    model: &dyn BsdfModel,
    incidence: Incidence,
    half_width: f64,
    side: Side,
    angles: [f64; 2],
) -> f64 {
    let bsdf = |wi, wo| model.bsdf(wi, wo);
    in_plane_flux_of(
        &Scattering::of(model, &bsdf),
        incidence,
        half_width,
        side,
        angles,
    )
}

/// [`in_plane_flux`] of any scattering.
pub(crate) fn in_plane_flux_of(
    scattering: &Scattering<'_>,
    incidence: Incidence,
    half_width: f64,
    side: Side,
    [from, to]: [f64; 2],
) -> f64 {
    let wedge = |azimuth: f64, [near, far]: [f64; 2]| {
        if far <= near {
            return 0.0;
        }
        let theta = match side {
            Side::Reflected => [near, far],
            Side::Transmitted => [PI - far, PI - near],
        };
        let phi = [azimuth - half_width, azimuth + half_width];
        FluxIntegral::new(scattering, incidence.wi(), side)
            .map_or(0.0, |mut range| range.over(theta, phi))
    };
    let backward = incidence.phi();
    wedge(backward + PI, [from.max(0.0), to.max(0.0)])
        + wedge(backward, [(-to).max(0.0), (-from).max(0.0)])
}

/// Flux fractions that `model` sends into the in-plane bins of `side`.
pub(crate) fn in_plane_fluxes(
    model: &dyn BsdfModel,
    incidence: Incidence,
    layout: &Layout,
    side: Side,
) -> Vec<f64> {
    let bsdf = |wi, wo| model.bsdf(wi, wo);
    in_plane_fluxes_of(&Scattering::of(model, &bsdf), incidence, layout, side)
}

/// [`in_plane_fluxes`] of any scattering.
pub(crate) fn in_plane_fluxes_of(
    scattering: &Scattering<'_>,
    incidence: Incidence,
    layout: &Layout,
    side: Side,
) -> Vec<f64> {
    let last = layout.in_plane_len() - 1;
    (0..=last)
        .into_par_iter()
        .map(|i| {
            // Vertical light has no forward side on facets that tilt one way as often as any other.
            let i = if incidence.is_vertical() && scattering.slopes.is_isotropic() {
                i.max(last - i)
            } else {
                i
            };
            let angles = layout.in_plane_edges_deg(i).map(f64::to_radians);
            let half_width = layout.in_plane_half_width();
            in_plane_flux_of(scattering, incidence, half_width, side, angles)
        })
        .collect()
}

/// The part of a range of polar angles that lies on `side`.
fn within_side(side: Side, theta: [f64; 2]) -> [f64; 2] {
    let (lowest, highest) = match side {
        Side::Reflected => (0.0, FRAC_PI_2),
        Side::Transmitted => (FRAC_PI_2, PI),
    };
    [theta[0].max(lowest), theta[1].min(highest)]
}

/// Sum of the sectors that mirror each other at the plane of incidence, modulo their number, if
/// the sectors lie evenly about it.
fn mirror_sum(wi: DVec3, n_phi: usize) -> Option<usize> {
    let forward = f64::atan2(-wi.y, -wi.x).rem_euclid(TAU);
    let twice = 2.0 * forward / TAU * n_phi as f64;
    // Sector j mirrors into twice - 1 - j; what rounding shifts the plane by is far below a bin.
    let nearest = twice.round();
    ((twice - nearest).abs() < 1e-11 * n_phi as f64)
        .then(|| (nearest as usize + 2 * n_phi - 1) % n_phi)
}

/// What is integrated, and what is known of it beforehand.
#[derive(Clone, Copy)]
pub(crate) struct Scattering<'a> {
    pub(crate) slopes: SlopeCovariance,
    pub(crate) material: Material,
    pub(crate) kinks: Kinks,
    /// Of `wi` and `wo`, in 1/sr; as isotropic as the slopes are, and negligible where they are rare.
    pub(crate) bsdf: &'a (dyn Fn(DVec3, DVec3) -> f64 + Sync),
    /// Error allowed in the flux of one range, absolute and as a share.
    pub(crate) error: [f64; 2],
}

impl<'a> Scattering<'a> {
    /// That of a model, whose `bsdf` this must be.
    fn of(model: &dyn BsdfModel, bsdf: &'a (dyn Fn(DVec3, DVec3) -> f64 + Sync)) -> Self {
        Self {
            slopes: model.slopes(),
            material: model.material(),
            kinks: model.kinks(),
            bsdf,
            error: Self::EXACT,
        }
    }

    /// The error of fluxes that are to be exact.
    pub(crate) const EXACT: [f64; 2] = [FLUX_ERROR, 1e-11];
}

/// What integrals for one direction of light and one side share.
pub(crate) struct FluxIntegral<'a> {
    scattering: Scattering<'a>,
    shape: Lobe,
    wi: DVec3,
    sin_i: f64,
    cos_i: f64,
    /// Azimuth of light that is not deviated.
    forward: f64,
    /// Index that enters the half vector: 1 for reflection.
    eta: f64,
    /// That index, if light is refracted.
    refracted: Option<f64>,
    /// `wi . wo` on the circle where refraction ends or total reflection sets in.
    edge: Option<f64>,
    /// Polar angles of the light from facets tilted within the plane of incidence.
    lobe: Vec<f64>,
    outer_pieces: Pieces,
    inner_pieces: Pieces,
    inner_breaks: Breaks,
}

impl<'a> FluxIntegral<'a> {
    /// `None` where nothing is sent.
    pub(crate) fn new(scattering: &Scattering<'a>, wi: DVec3, side: Side) -> Option<Self> {
        let Scattering {
            slopes, material, ..
        } = *scattering;
        let index = material.transmitting_index();
        if wi.z <= 0.0 || (side == Side::Transmitted && index.is_none()) {
            return None;
        }
        let sin_i = wi.x.hypot(wi.y);
        let eta = match side {
            Side::Reflected => 1.0,
            Side::Transmitted => index?,
        };
        let refracted = (side == Side::Transmitted).then_some(eta);
        let edge = match (side, index) {
            // Refraction ends where light meets the facet, or leaves it, at grazing.
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
        let forward = f64::atan2(-wi.y, -wi.x);
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
        })
    }

    /// The flux fraction into `theta`, on the side of the integral, by `phi`.
    pub(crate) fn over(&mut self, theta: [f64; 2], phi: [f64; 2]) -> f64 {
        if !(theta[1] > theta[0] && phi[1] > phi[0]) {
            return 0.0;
        }
        // Azimuth from the forward direction; a whole number of turns is left out first, so that
        // special points within a turn of zero suffice.
        let turns = ((0.5 * (phi[0] + phi[1]) - self.forward) / TAU).round() * TAU;
        let psi = [phi[0] - self.forward - turns, phi[1] - self.forward - turns];
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
        let theta_i = self.sin_i.atan2(self.cos_i);
        if let Some(t) = self.scattering.kinks.polar_angle(theta_i, self.refracted) {
            breaks.add_smooth(t);
        }
        if !self.scattering.slopes.is_isotropic() {
            for psi in psi {
                self.shape.mark_polar_angles(&mut breaks, theta, psi);
            }
        }
        breaks.finish();
        let [absolute, relative] = self.scattering.error;
        let tolerance = Tolerance {
            absolute,
            relative,
            max_pieces: 400,
        };
        let mut pieces = std::mem::take(&mut self.outer_pieces);
        let flux = integrate(&breaks, tolerance, &mut pieces, |t| self.ring(t, psi));
        self.outer_pieces = pieces;
        flux
    }

    /// Flux fraction per radian of polar angle at `theta`, over the azimuths `psi` from forward.
    fn ring(&mut self, theta: f64, psi: [f64; 2]) -> f64 {
        let (sin_theta, cos_theta) = theta.sin_cos();
        let product = self.sin_i * sin_theta;
        self.inner_breaks.reset(psi[0], psi[1]);
        let slopes = &self.scattering.slopes;
        let isotropic = slopes.is_isotropic();
        let least = if isotropic {
            self.shape.exponent(theta, 0.0_f64.clamp(psi[0], psi[1]))
        } else {
            self.shape.mark_azimuths(&mut self.inner_breaks, theta, psi)
        };
        if least > NEGLIGIBLE {
            return 0.0;
        }
        let h_z = self.cos_i + self.eta * cos_theta;
        let kappa = 2.0 * self.eta * product / (slopes.xx() * h_z * h_z);
        for turn in [-TAU, 0.0, TAU] {
            if isotropic {
                self.inner_breaks.add_smooth(turn);
                for t in [2.0, 6.0] {
                    // exp(-kappa sin^2(psi / 2)) has fallen to exp(-t^2).
                    let sin_half = t / kappa.sqrt();
                    if sin_half < 1.0 {
                        let width = 2.0 * sin_half.asin();
                        self.inner_breaks.add_smooth(turn - width);
                        self.inner_breaks.add_smooth(turn + width);
                    }
                }
            }
            if let Some(edge) = self.edge {
                let cos_psi = (self.cos_i * cos_theta - edge) / product;
                if cos_psi.abs() <= 1.0 {
                    let psi = cos_psi.acos();
                    self.inner_breaks.add_root(turn - psi);
                    self.inner_breaks.add_root(turn + psi);
                }
            }
        }
        let kinks = self.scattering.kinks;
        for x in kinks.products(self.cos_i, cos_theta, self.refracted) {
            let cos_psi = (self.cos_i * cos_theta - x) / product;
            if cos_psi.abs() <= 1.0 {
                let psi = cos_psi.acos();
                for turn in [-TAU, 0.0, TAU] {
                    self.inner_breaks.add_smooth(turn - psi);
                    self.inner_breaks.add_smooth(turn + psi);
                }
            }
        }
        self.inner_breaks.finish();
        let [absolute, relative] = self.scattering.error;
        let tolerance = Tolerance {
            absolute: 0.1 * absolute,
            relative: 0.1 * relative,
            max_pieces: 200,
        };
        let (bsdf, wi, forward) = (self.scattering.bsdf, self.wi, self.forward);
        let weight = cos_theta.abs() * sin_theta;
        integrate(
            &self.inner_breaks,
            tolerance,
            &mut self.inner_pieces,
            |psi| weight * bsdf(wi, from_spherical(theta, forward + psi)),
        )
    }

    /// Polar angles at which the circle `wi . wo = edge` crosses the azimuth `psi` from forward:
    /// `cos theta_i cos theta - sin theta_i sin theta cos psi = edge`.
    fn edge_at_azimuth(&self, edge: f64, psi: f64) -> [Option<f64>; 3] {
        let (a, b) = (self.cos_i, -self.sin_i * psi.cos());
        let ratio = edge / a.hypot(b);
        if ratio.abs() > 1.0 {
            return [None; 3];
        }
        let (centre, radius) = (b.atan2(a), ratio.acos());
        [
            Some(centre + radius),
            Some(centre - radius),
            Some(centre - radius + TAU),
        ]
    }
}
