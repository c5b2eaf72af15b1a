//! Slope mixture: slopes that are Gaussian with a covariance that differs from position to position.

use asperity_numerics::elementary::{exp, ln};
use asperity_numerics::quadrature::gauss_rule;

/// Component of a slope mixture: relative slope variance of some positions, and their fraction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlopeComponent {
    /// Fraction of positions, over all components 1.
    pub weight: f64,
    /// Factor of [`SlopeMixture::covariance`] there.
    pub factor: f64,
}

/// The distribution of slopes at a point of random surfaces, as a mixture of Gaussian distributions whose covariances are multiples of one.
///
/// A height that is a function `T(g)` of a Gaussian surface has the slope `T'(g)` times that of `g`. Height and slope of `g` at a
/// point are independent, so that slopes are Gaussian for a given `g`, with `T'(g)^2` times the covariance. The distribution of
/// that factor is replaced by the nodes of its Gauss rule over its logarithm.
///
/// # Examples
/// ```
/// use asperity_synthesis::{FieldSynthesis, Psd, Resolution, StudentSlopes};
///
/// let recipe = StudentSlopes::new(Psd::gaussian(0.5, 4.0)?, 4.0)?.into();
/// let synthesis = FieldSynthesis::new(recipe, [128, 128], [1.0, 1.0], Resolution::Facets)?;
/// let mixture = synthesis.slope_mixture().expect("known of GGX slopes");
/// let all: f64 = mixture.components().iter().map(|one| one.weight).sum();
/// assert!((all - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeMixture {
    covariance: [f64; 3],
    components: Vec<SlopeComponent>,
}

/// Most components: fluxes into bins are off by less than 1e-6 of the incident flux.
const MAX_COMPONENTS: usize = 24;

/// Least slope variance of a component, over the mean: that of a surface of 0.1 % of its slopes, which is flat to any bin.
const LEAST: f64 = 1e-6;

impl SlopeMixture {
    /// Gaussian slopes.
    pub(crate) fn gaussian(covariance: [f64; 3]) -> Self {
        Self {
            covariance,
            components: vec![SlopeComponent {
                weight: 1.0,
                factor: 1.0,
            }],
        }
    }

    /// `factors`: pairs of a factor of `covariance` and its weight.
    pub(crate) fn scaled(covariance: [f64; 3], factors: &[[f64; 2]]) -> Self {
        let total: f64 = factors.iter().map(|[_, weight]| weight).sum();
        let mean = factors.iter().map(|[f, w]| f * w).sum::<f64>() / total;
        let logarithm = |factor: f64| ln(factor.max(LEAST * mean));
        let logarithms = factors.iter().map(|[factor, _]| logarithm(*factor));
        let (low, high) = logarithms.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        });
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        // Factors that are equal to rounding are one
        let half = half.max(1e-9);
        let measure: Vec<[f64; 2]> = factors
            .iter()
            .map(|[factor, weight]| [(logarithm(*factor) - middle) / half, *weight])
            .collect();
        let components = gauss_rule(&measure, MAX_COMPONENTS)
            .into_iter()
            .map(|[x, weight]| SlopeComponent {
                weight,
                factor: exp(middle + half * x),
            });
        Self {
            covariance,
            components: components.collect(),
        }
    }

    /// Covariance `[xx, xy, yy]`, dimensionless, that components have a multiple of.
    #[must_use]
    pub const fn covariance(&self) -> [f64; 3] {
        self.covariance
    }

    /// Its components, from the flattest to the steepest.
    #[must_use]
    pub fn components(&self) -> &[SlopeComponent] {
        &self.components
    }
}
