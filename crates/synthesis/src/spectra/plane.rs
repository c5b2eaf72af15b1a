//! Plane table: a measured spectrum over the wave vector.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{atan2, cos, sin_cos};
use serde::{Deserialize, Serialize};

use super::axes::Axes;
use super::error::PsdTableError;
use super::error::{PsdError, positive};
use super::projection::Projection;
use super::radial_table::check_densities;

/// Densities on a grid of wave vectors, bilinear between them and zero beyond.
///
/// A spectrum is the same at `k` and `-k`. Where the grid has both, their mean is taken; a grid of `ky >= 0` alone stands for both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PlanePsd {
    /// Root mean square height, length units.
    sigma: f64,
    /// 1/e correlation lengths along the axes of least and largest slope variance.
    axes: Axes,
    /// 1/e correlation lengths along x and y.
    along: [f64; 2],
    kx: Vec<f64>,
    ky: Vec<f64>,
    /// Rows of equal `ky`, on any scale.
    density: Vec<f64>,
    /// Integral of the density over all wave vectors.
    total: f64,
    /// Spacing along x and y of the surface that it was measured on, which resolves all that is known of it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sampled: Option<[f64; 2]>,
}

/// Nodes and weights of the Gauss-Legendre rule of 3 points between 0 and 1.
const RULE: [[f64; 2]; 3] = [
    [0.112_701_665_379_258_31, 5.0 / 18.0],
    [0.5, 4.0 / 9.0],
    [0.887_298_334_620_741_7, 5.0 / 18.0],
];

impl PlanePsd {
    /// `kx`, `ky`: radians per length unit, ascending; `density`: rows of equal `ky`. Without `sigma`, the root mean square height
    /// is that of the table.
    pub(super) fn new(
        kx: Vec<f64>,
        ky: Vec<f64>,
        density: Vec<f64>,
        sigma: Option<f64>,
    ) -> Result<Self, PsdError> {
        let mut psd = Self {
            sigma: 1.0,
            axes: Axes::isotropic(1.0),
            along: [1.0; 2],
            kx,
            ky,
            density,
            total: 1.0,
            sampled: None,
        };
        psd.check_table()?;
        psd.total = psd.integral(|_, _| 1.0);
        if psd.total <= 0.0 {
            return Err(PsdTableError::NoPower.into());
        }
        psd.sigma = sigma.unwrap_or_else(|| psd.total.sqrt());
        positive("sigma", psd.sigma)?;
        let [xx, xy, yy] = psd.slope_covariance();
        // The axis of least slope variance is that of the longest correlation
        let azimuth = 0.5 * atan2(2.0 * xy, xx - yy) + std::f64::consts::FRAC_PI_2;
        let (sin, cos) = sin_cos(azimuth);
        let directions = [[cos, sin], [-sin, cos], [1.0, 0.0], [0.0, 1.0]];
        let lags = directions.map(|along| psd.projection(along).one_over_e_lag());
        psd.axes = Axes::new(lags[0], lags[1], azimuth);
        psd.along = [lags[2], lags[3]];
        Ok(psd)
    }

    /// Returns the spectrum as one measured on a grid of this spacing along x and y.
    pub(super) fn sampled_at(self, spacing: [f64; 2]) -> Self {
        let sampled = Some(spacing);
        Self { sampled, ..self }
    }

    /// Mark of [`Psd::mark`](super::psd::Psd): the mean square gradient of the table.
    pub(super) fn mark(&self) -> u32 {
        let gradient = self.integral(|kx, ky| kx * kx + ky * ky);
        (gradient as f32).to_bits()
    }

    pub(super) const fn sampled(&self) -> Option<[f64; 2]> {
        self.sampled
    }

    fn check_table(&self) -> Result<(), PsdTableError> {
        for (column, k) in [("kx", &self.kx), ("ky", &self.ky)] {
            if k.len() < 2 {
                return Err(PsdTableError::TooFew { rows: k.len() });
            }
            if !(k.windows(2).all(|pair| pair[0] < pair[1]) && k.iter().all(|k| k.is_finite())) {
                return Err(PsdTableError::NotAscending { column });
            }
        }
        let expected = self.kx.len() * self.ky.len();
        if self.density.len() != expected {
            let found = self.density.len();
            return Err(PsdTableError::WrongCount { found, expected });
        }
        check_densities(&self.density)
    }

    /// `true` if the grid is the half plane that stands for both.
    fn is_half(&self) -> bool {
        self.ky[0] >= 0.0
    }

    /// `W`, with the scale of `sigma`.
    pub(super) fn density(&self, kx: f64, ky: f64) -> f64 {
        self.sigma * self.sigma / self.total * self.symmetric(kx, ky)
    }

    /// The density of the table, the same at `k` and `-k`.
    fn symmetric(&self, kx: f64, ky: f64) -> f64 {
        if self.is_half() && ky != 0.0 {
            let sign = ky.signum();
            return self.bilinear(sign * kx, sign * ky);
        }
        0.5 * (self.bilinear(kx, ky) + self.bilinear(-kx, -ky))
    }

    fn bilinear(&self, kx: f64, ky: f64) -> f64 {
        let (Some((i, u)), Some((j, v))) = (place(&self.kx, kx), place(&self.ky, ky)) else {
            return 0.0;
        };
        let at = |i: usize, j: usize| self.density[j * self.kx.len() + i];
        let row = |j: usize| at(i, j) + u * (at(i + 1, j) - at(i, j));
        row(j) + v * (row(j + 1) - row(j))
    }

    /// Integral of the density of the table times an even function of the wave vector.
    fn integral(&self, weight: impl Fn(f64, f64) -> f64) -> f64 {
        let mut sum = 0.0;
        self.for_each_node(|kx, ky, power| sum += power * weight(kx, ky));
        sum
    }

    /// Hands on the wave vectors of a quadrature over the table, and the integral of the density about each.
    fn for_each_node(&self, mut each: impl FnMut(f64, f64, f64)) {
        let sides = if self.is_half() { 2.0 } else { 1.0 };
        let columns = self.kx.len();
        for (j, rows) in self.ky.windows(2).enumerate() {
            let [low, high] = [j, j + 1].map(|j| &self.density[j * columns..][..columns]);
            for (i, pair) in self.kx.windows(2).enumerate() {
                let (dx, dy) = (pair[1] - pair[0], rows[1] - rows[0]);
                for [v, wv] in RULE {
                    let [west, east] = [i, i + 1].map(|i| low[i] + v * (high[i] - low[i]));
                    for [u, wu] in RULE {
                        let density = west + u * (east - west);
                        let power = sides * wu * wv * dx * dy * density;
                        each(pair[0] + u * dx, rows[0] + v * dy, power);
                    }
                }
            }
        }
    }

    /// The power by the wave number along a direction.
    fn projection(&self, along: [f64; 2]) -> Projection {
        Projection::of(along, self.reach(), |each| self.for_each_node(each))
    }

    pub(super) fn with_sigma(self, sigma: f64) -> Self {
        Self { sigma, ..self }
    }

    pub(super) const fn sigma(&self) -> f64 {
        self.sigma
    }

    pub(super) const fn axes(&self) -> &Axes {
        &self.axes
    }

    pub(super) const fn axis_lengths(&self) -> [f64; 2] {
        self.along
    }

    pub(super) fn reach(&self) -> [f64; 2] {
        [&self.kx, &self.ky].map(|k| k[0].abs().max(k[k.len() - 1].abs()))
    }

    pub(super) fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        let mean = self.integral(|kx, ky| cos(kx * x + ky * y)) / self.total;
        self.sigma * self.sigma * mean
    }

    pub(super) fn slope_covariance(&self) -> [f64; 3] {
        let scale = self.sigma * self.sigma / self.total;
        [
            scale * self.integral(|kx, _| kx * kx),
            scale * self.integral(|kx, ky| kx * ky),
            scale * self.integral(|_, ky| ky * ky),
        ]
    }

    pub(super) fn curvature(&self) -> f64 {
        let along = [
            self.integral(|kx, _| kx.powi(4)),
            self.integral(|_, ky| ky.powi(4)),
        ];
        self.sigma * (along[0].max(along[1]) / self.total).sqrt()
    }

    /// Wavelengths along x and y below which waves hold `fraction` of the slope variance along that axis.
    pub(super) fn wavelengths_holding(&self, fraction: f64) -> [f64; 2] {
        [[1.0, 0.0], [0.0, 1.0]].map(|axis| self.projection(axis).wavelength_holding(fraction))
    }

    /// Correlation area; see [`Psd::correlation_area`](super::psd::Psd::correlation_area).
    pub(super) fn correlation_area(&self) -> f64 {
        let square = self.integral(|kx, ky| self.symmetric(kx, ky));
        2.0 * TAU * TAU * square / (self.total * self.total)
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        let waves = |k: &[f64]| k.iter().map(|k| k / convert(1.0)).collect();
        Self {
            sigma: convert(self.sigma),
            axes: self.axes.converted(convert),
            along: self.along.map(convert),
            kx: waves(&self.kx),
            ky: waves(&self.ky),
            density: self.density.clone(),
            total: self.total / (convert(1.0) * convert(1.0)),
            sampled: self.sampled.map(|spacing| spacing.map(convert)),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        let numbers = [self.sigma, self.total, self.along[0], self.along[1]];
        self.check_table().is_ok()
            && self.axes.is_valid()
            && numbers.iter().all(|x| x.is_finite() && *x > 0.0)
    }
}

/// The interval of ascending nodes in which `k` lies, and how far along it; `None` beyond them.
pub(super) fn place(nodes: &[f64], k: f64) -> Option<(usize, f64)> {
    if !(k >= nodes[0] && k <= nodes[nodes.len() - 1]) {
        return None;
    }
    let i = nodes
        .partition_point(|node| *node <= k)
        .clamp(1, nodes.len() - 1)
        - 1;
    Some((i, (k - nodes[i]) / (nodes[i + 1] - nodes[i])))
}
