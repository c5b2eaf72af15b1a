//! Sum: surfaces of several scales that are independent of each other.

use serde::{Deserialize, Serialize};

use super::Psd;
use super::axes::Axes;
use super::error::PsdError;
use asperity_numerics::root;

/// The sum of spectra: the surface is the sum of independent ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SumPsd {
    parts: Vec<Psd>,
    /// 1/e correlation lengths along the axes of the first anisotropic part.
    axes: Axes,
    /// 1/e correlation lengths along x and y.
    along: [f64; 2],
}

impl SumPsd {
    /// The sum of at least one spectrum.
    pub(super) fn new(first: Psd, second: Psd) -> Self {
        let parts = vec![first, second];
        let anisotropic = parts.iter().find_map(Psd::anisotropy);
        let azimuth = anisotropic.map_or(0.0, |[_, azimuth]| azimuth);
        let mut sum = Self {
            parts,
            axes: Axes::isotropic(1.0),
            along: [1.0; 2],
        };
        let (sin, cos) = azimuth.sin_cos();
        let first = sum.lag_along(cos, sin);
        sum.axes = match anisotropic {
            None => Axes::isotropic(first),
            Some(_) => Axes::new(first, sum.lag_along(-sin, cos), azimuth),
        };
        sum.along = match anisotropic {
            None => [first; 2],
            Some(_) => [sum.lag_along(1.0, 0.0), sum.lag_along(0.0, 1.0)],
        };
        sum
    }

    /// All parts scaled alike.
    pub(super) fn with_sigma(self, sigma: f64) -> Result<Self, PsdError> {
        let scale = sigma / self.root_sum(Psd::sigma);
        let parts = self.parts.into_iter().map(|part| {
            let own = part.sigma();
            part.with_sigma(scale * own)
        });
        Ok(Self {
            parts: parts.collect::<Result<_, _>>()?,
            ..self
        })
    }

    /// As [`Psd::mark`], of the first part that has one.
    pub(super) fn mark(&self) -> Option<u32> {
        self.parts.iter().find_map(Psd::mark)
    }

    pub(super) fn parts(&self) -> &[Psd] {
        &self.parts
    }

    pub(super) const fn axes(&self) -> &Axes {
        &self.axes
    }

    pub(super) const fn axis_lengths(&self) -> [f64; 2] {
        self.along
    }

    /// The root of the sum of squares of a number that each part has.
    pub(super) fn root_sum(&self, of: impl Fn(&Psd) -> f64) -> f64 {
        self.parts
            .iter()
            .map(|part| of(part).powi(2))
            .sum::<f64>()
            .sqrt()
    }

    /// The larger of what parts have along each axis.
    pub(super) fn largest(&self, of: impl Fn(&Psd) -> [f64; 2]) -> [f64; 2] {
        let each = self.parts.iter().map(of);
        each.fold([0.0; 2], |[x, y], [a, b]| [x.max(a), y.max(b)])
    }

    pub(super) fn autocorrelation(&self, x: f64, y: f64) -> f64 {
        self.parts
            .iter()
            .map(|part| part.autocorrelation(x, y))
            .sum()
    }

    pub(super) fn slope_covariance(&self) -> [f64; 3] {
        let each = self.parts.iter().map(Psd::slope_covariance);
        each.fold([0.0; 3], |sum, term| [0, 1, 2].map(|i| sum[i] + term[i]))
    }

    fn lag_along(&self, cos: f64, sin: f64) -> f64 {
        let variance = self.autocorrelation(0.0, 0.0);
        let below = |r: f64| self.autocorrelation(r * cos, r * sin) / variance - (-1.0_f64).exp();
        // Between the shortest and the longest of the parts, whose sum is on either side of 1/e there
        let lags = self.parts.iter().map(|part| {
            let [x, y] = part.axis_correlation_lengths();
            (x.min(y), x.max(y))
        });
        let (low, high) = lags.fold((f64::INFINITY, 0.0_f64), |(low, high), (a, b)| {
            (low.min(0.5 * a), high.max(2.0 * b))
        });
        let mut low = low;
        while below(1.2 * low) > 0.0 && low < high {
            low *= 1.2;
        }
        root(below, low, 1.2 * low)
    }

    pub(super) fn converted(&self, convert: &dyn Fn(f64) -> f64) -> Self {
        Self {
            parts: self
                .parts
                .iter()
                .map(|part| part.converted(convert))
                .collect(),
            axes: self.axes.converted(convert),
            along: self.along.map(convert),
        }
    }

    /// With one level of parts alone, so that a file cannot nest them without end.
    pub(super) fn is_valid(&self) -> bool {
        let is_part = |part: &Psd| !matches!(part, Psd::Sum(_)) && part.is_valid();
        self.axes.is_valid()
            && self.along.iter().all(|x| x.is_finite() && *x > 0.0)
            && !self.parts.is_empty()
            && self.parts.iter().all(is_part)
    }
}
