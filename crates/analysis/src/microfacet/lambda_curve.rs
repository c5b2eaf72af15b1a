//! Lambda curve: Smith's Lambda of a mixture of Gaussian slopes along one azimuth, tabulated.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use asperity_numerics::elementary::erfc;
use asperity_numerics::elementary::{asinh, cosh, exp, sinh};

/// Steps of the table: cubic pieces err by the fourth power of a step over 384, 1e-10.
const STEPS: usize = 1024;

/// Deviations beyond which nothing of a component is left.
const REACH: f64 = 8.5;

/// `nu Lambda(nu)`, the mean excess of the slope over `nu` in deviations, and its derivative, at even steps of `asinh nu / least`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LambdaCurve {
    /// Deviation of the flattest component.
    least: f64,
    step: f64,
    /// Value, and derivative times the step, per node.
    nodes: Vec<[f64; 2]>,
}

impl LambdaCurve {
    /// Curve of components by the factor of their variance, and their weight.
    pub(crate) fn new(factors: &[[f64; 2]]) -> Self {
        let deviations = factors.iter().map(|[factor, _]| factor.sqrt());
        let (least, most) = deviations.fold((f64::INFINITY, 0.0_f64), |(least, most), d| {
            (least.min(d), most.max(d))
        });
        let step = asinh(REACH * most / least) / STEPS as f64;
        let node = |i: usize| {
            let u = step * i as f64;
            let nu = least * sinh(u);
            let sum = |term: &dyn Fn(f64) -> f64| {
                let terms = factors.iter();
                terms
                    .map(|[factor, weight]| weight * term(factor.sqrt()))
                    .sum::<f64>()
            };
            let excess = |deviation: f64| {
                let a = nu / deviation;
                deviation
                    * (exp(-0.5 * a * a) / (2.0 * PI).sqrt() - 0.5 * a * erfc(a * FRAC_1_SQRT_2))
            };
            let steeper = |deviation: f64| 0.5 * erfc(nu / deviation * FRAC_1_SQRT_2);
            let rise = -sum(&steeper) * least * cosh(u) * step;
            [sum(&excess), rise]
        };
        Self {
            least,
            step,
            nodes: (0..=STEPS).map(node).collect(),
        }
    }

    /// Lambda where the cotangent is `nu` deviations.
    pub(crate) fn at(&self, nu: f64) -> f64 {
        let place = asinh(nu / self.least) / self.step;
        let i = place as usize;
        if i >= STEPS {
            return 0.0;
        }
        let t = place - i as f64;
        let [[f0, d0], [f1, d1]] = [self.nodes[i], self.nodes[i + 1]];
        let rise = f1 - f0;
        let (square, cube) = (3.0 * rise - 2.0 * d0 - d1, d0 + d1 - 2.0 * rise);
        let excess = f0 + t * (d0 + t * (square + t * cube));
        excess.max(0.0) / nu
    }
}
