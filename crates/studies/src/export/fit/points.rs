//! Points: the bins of one side that laws are fitted to, with the directions at which a law is taken in each.

use asperity_numerics::elementary::{cos, sin};
use asperity_optics::from_spherical;
use asperity_simulate::Outcome;
use asperity_tally::{Component, Side, TallyResult};
use glam::DVec3;

use crate::export::ranges::edges_from_normal;
use crate::export::specular_table::specular_theta;

/// Largest relative standard error of a bin that is fitted: the mean of the logarithm is then 5 % low at most.
const NOISIEST: f64 = 0.3;

/// Points of two-point quadrature of Gauss and Legendre over the unit interval.
const GAUSS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];

/// A direction of light and one in which it leaves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ray {
    /// Direction towards the light.
    pub(super) wi: DVec3,
    /// Direction in which light leaves.
    pub(super) wo: DVec3,
    /// Distance of the direction in which light leaves from the specular one, both projected onto the mean plane: `|beta - beta0|`.
    pub(super) distance: f64,
}

/// A bin.
#[derive(Clone, Debug)]
pub(super) struct Point {
    /// Number of the outcome.
    pub(super) outcome: usize,
    /// Mean BSDF, 1/sr.
    pub(super) mean: f64,
    /// Its standard error, if there is one.
    pub(super) se: Option<f64>,
    /// Solid angle, weighted by the cosine.
    pub(super) projected: f64,
    /// Directions whose mean is that of the bin.
    pub(super) rays: [Ray; 4],
}

impl Point {
    /// Returns `true` if laws are fitted to it: its value is above zero and known.
    pub(super) fn is_fitted(&self) -> bool {
        let near = |se: f64| se > 0.0 && se < NOISIEST * self.mean;
        self.mean > 0.0 && self.se.is_some_and(near)
    }

    /// Mean of a law over the bin.
    pub(super) fn mean_of(&self, law: &dyn Fn(&Ray) -> f64) -> f64 {
        self.rays.iter().map(law).sum::<f64>() / self.rays.len() as f64
    }
}

/// The bins of outcomes on a side. Outcomes for which a smooth sample would send no light there are left out.
pub(super) fn points(outcomes: &[&Outcome], side: Side) -> Vec<Point> {
    let mut points = Vec::new();
    for (number, outcome) in outcomes.iter().enumerate() {
        let Some(theta) = specular_theta(&outcome.case, side) else {
            continue;
        };
        let incidence = outcome.case.light.incidence;
        let specular = -sin(theta) * from_spherical(std::f64::consts::FRAC_PI_2, incidence.phi());
        let statistics = &outcome.statistics;
        let spec = statistics.spec();
        let grid = spec.grid();
        let bins = spec.grid_entries(Component::All);
        let first = side.index() * grid.bins_per_side();
        let phi = grid.phi_edges_deg(side);
        for (ring, theta_deg) in edges_from_normal(&grid, side).into_iter().enumerate() {
            // Rings are divided evenly in projected solid angle
            let squares = theta_deg.map(|edge| sin(edge.to_radians()).powi(2));
            for sector in 0..grid.n_phi() {
                let flux = statistics.at(bins.get(first + ring * grid.n_phi() + sector));
                let edges = [phi[sector], phi[sector + 1]].map(f64::to_radians);
                let projected = 0.5 * (squares[1] - squares[0]) * (edges[1] - edges[0]);
                let ray = |k: usize| {
                    let within = |[from, to]: [f64; 2], part: f64| from + part * (to - from);
                    let sine = within(squares, GAUSS[k / 2]).sqrt();
                    let azimuth = within(edges, GAUSS[k % 2]);
                    let cosine = (1.0 - sine * sine).sqrt();
                    let plane = DVec3::new(cos(azimuth), sin(azimuth), 0.0) * sine;
                    let up = if side == Side::Reflected { 1.0 } else { -1.0 };
                    Ray {
                        wi: incidence.wi(),
                        wo: plane.with_z(up * cosine),
                        distance: plane.truncate().distance(specular.truncate()),
                    }
                };
                points.push(Point {
                    outcome: number,
                    mean: flux.mean / projected,
                    se: flux.se.map(|se| se / projected),
                    projected,
                    rays: [0, 1, 2, 3].map(ray),
                });
            }
        }
    }
    points
}
