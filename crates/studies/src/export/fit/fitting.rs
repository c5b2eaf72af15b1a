//! Fitting: the parameters of one law from the bins of one side.

use serde_json::{Map, Value, json};

use super::laws::{Formula, Law};
use super::least_squares::{Minimum, least_squares};
use super::points::Point;

/// Relative error that laws have in any case.
const MODEL_ERROR: f64 = 0.05;

/// A law with its parameters.
pub(super) struct Fit {
    pub(super) law: Law,
    minimum: Minimum,
    /// Root mean square of the differences in the fitted bins, over their standard errors.
    rms: f64,
    /// Sum of the absolute differences of flux over all bins, over the sum of the fluxes.
    pub(super) deviation: f64,
    /// Fluxes of the law by outcome.
    pub(super) fluxes: Vec<f64>,
}

impl Law {
    /// Fits the parameters to the bins of `outcomes` outcomes; `None` where no start leads to a minimum.
    pub(super) fn fit(self, points: &[Point], outcomes: usize) -> Option<Fit> {
        let fitted: Vec<&Point> = points.iter().filter(|point| point.is_fitted()).collect();
        let weights: Vec<f64> = fitted.iter().map(|point| self.weight(point)).collect();
        let residuals = |logs: &[f64]| {
            let formula = (self.of)(logs)?;
            let all = fitted.iter().zip(&weights).map(|(point, weight)| {
                weight * self.difference(point.mean_of(&formula), point.mean)
            });
            Some(all.collect())
        };
        let minima = self.starts.iter();
        let minima = minima.filter_map(|start| least_squares(start, residuals));
        let minimum = minima.min_by(|a, b| a.sum.total_cmp(&b.sum))?;
        let formula = (self.of)(&minimum.parameters)?;
        let rms = rms(&fitted, &formula);
        let mut fluxes = vec![0.0; outcomes];
        let (mut differences, mut all) = (0.0, 0.0);
        for point in points {
            let of_law = point.mean_of(&formula);
            fluxes[point.outcome] += of_law * point.projected;
            differences += (of_law - point.mean).abs() * point.projected;
            all += point.mean * point.projected;
        }
        Some(Fit {
            minimum,
            rms,
            deviation: differences / all,
            fluxes,
            law: self,
        })
    }

    /// Difference of a law from a BSDF: of the logarithms, or where bins count by their light relative to the mean of both, which is the same
    /// near the BSDF and bounded where the law sends no light.
    fn difference(&self, law: f64, bsdf: f64) -> f64 {
        match self.by_flux {
            true => 2.0 * (law - bsdf) / (law + bsdf),
            false => (law / bsdf).max(f64::MIN_POSITIVE).ln(),
        }
    }

    /// Weight of the difference in a bin.
    fn weight(&self, point: &Point) -> f64 {
        let relative = point.se.map_or(f64::INFINITY, |se| se / point.mean);
        let by_error = 1.0 / relative.hypot(MODEL_ERROR);
        match self.by_flux {
            true => by_error * (point.mean * point.projected).sqrt(),
            false => by_error,
        }
    }
}

impl Fit {
    /// Member of the file.
    pub(super) fn json(&self) -> Value {
        let logs = &self.minimum.parameters;
        let named = || self.law.parameters.iter().zip(logs);
        let values: Map<String, Value> = named()
            .map(|((name, of), log)| ((*name).to_owned(), json!(of(*log))))
            .collect();
        let errors = self.minimum.errors.as_ref().map(|errors| {
            let all = named().zip(errors).map(|(((name, of), log), error)| {
                // To first order, by the difference over one standard error, which is kept in range
                let step = error.min(0.1);
                let slope = (of(log + step) - of(log - step)) / (2.0 * step);
                ((*name).to_owned(), json!((slope * error).abs()))
            });
            all.collect::<Map<String, Value>>()
        });
        json!({
            "formula": self.law.formula,
            "parameters": values,
            "standard_errors": errors,
            "rms_in_standard_errors": self.rms,
            "relative_deviation": self.deviation,
            "leaves_out": self.law.loses,
        })
    }
}

fn rms(fitted: &[&Point], formula: &Formula) -> f64 {
    let square = |point: &&Point| {
        let se = point.se.unwrap_or(f64::INFINITY);
        ((point.mean_of(formula) - point.mean) / se).powi(2)
    };
    (fitted.iter().map(square).sum::<f64>() / fitted.len() as f64).sqrt()
}
