//! Fitting: the parameters of one law from the bins of one side.

use asperity_numerics::elementary::{hypot, ln};
use asperity_tally::Estimate;
use serde_json::{Map, Value, json};

use super::laws::{Formula, Law, Skipped};
use super::least_squares::{Minimum, least_squares};
use super::points::Point;
use crate::output::with_error;

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
    /// Fits the parameters to the bins of `outcomes` outcomes.
    pub(super) fn fit(self, points: &[Point], outcomes: usize) -> Result<Fit, Skipped> {
        let name = self.name;
        let fit = self.nearest(points, outcomes).ok_or(Skipped {
            name,
            reason: "the fit does not converge",
        })?;
        match fit.is_determined() {
            true => Ok(fit),
            false => Err(Skipped {
                name,
                reason: "these bins do not determine its parameters",
            }),
        }
    }

    fn nearest(self, points: &[Point], outcomes: usize) -> Option<Fit> {
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
            false => ln((law / bsdf).max(f64::MIN_POSITIVE)),
        }
    }

    /// Weight of the difference in a bin.
    fn weight(&self, point: &Point) -> f64 {
        let relative = point.se.map_or(f64::INFINITY, |se| se / point.mean);
        let by_error = 1.0 / hypot(relative, MODEL_ERROR);
        match self.by_flux {
            true => by_error * (point.mean * point.projected).sqrt(),
            false => by_error,
        }
    }
}

impl Fit {
    /// Names and values of the parameters, with standard errors where they are determined.
    fn parameters(&self) -> impl Iterator<Item = (&'static str, Estimate)> {
        let Minimum {
            parameters, errors, ..
        } = &self.minimum;
        let named = self.law.parameters.iter().zip(parameters).enumerate();
        named.map(move |(i, ((name, of), log))| {
            let se = errors.as_ref().map(|errors| {
                // To first order, by the difference over one standard error, which is kept in range
                let step = errors[i].min(0.1);
                ((of(log + step) - of(log - step)) / (2.0 * step) * errors[i]).abs()
            });
            let mean = of(*log);
            (*name, Estimate { mean, se })
        })
    }

    /// Returns `true` if the law has a lobe, and no parameter an error beyond its value.
    fn is_determined(&self) -> bool {
        let mut errors = self.minimum.errors.iter().flatten();
        (self.law.is_lobe)(&self.minimum.parameters) && errors.all(|error| *error < 1.0)
    }

    /// Member of the file.
    pub(super) fn json(&self) -> Value {
        let all = || {
            self.parameters()
                .map(|(name, value)| (name.to_owned(), value))
        };
        let means: Map<String, Value> = all()
            .map(|(name, value)| (name, json!(value.mean)))
            .collect();
        let errors: Option<Map<String, Value>> = all()
            .map(|(name, value)| Some((name, json!(value.se?))))
            .collect();
        json!({
            "formula": self.law.formula,
            "parameters": means,
            "standard_errors": errors,
            "rms_in_standard_errors": self.rms,
            "relative_deviation": self.deviation,
            "neglects": self.law.neglects,
        })
    }

    /// The law, its parameters and how far off it is.
    pub(super) fn sentence(&self) -> String {
        let values = self.parameters();
        let values: Vec<String> = values
            .map(|(name, value)| format!("{name} = {}", with_error(value)))
            .collect();
        format!(
            "{} with {}, relative deviation {:.2}",
            self.law.name,
            values.join(", "),
            self.deviation
        )
    }
}

fn rms(fitted: &[&Point], formula: &Formula) -> f64 {
    let square = |point: &&Point| {
        let se = point.se.unwrap_or(f64::INFINITY);
        ((point.mean_of(formula) - point.mean) / se).powi(2)
    };
    (fitted.iter().map(square).sum::<f64>() / fitted.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use asperity_tally::Side;
    use glam::DVec3;

    use super::super::laws::Fitted;
    use super::super::points::Ray;
    use super::*;

    /// Bins of a lobe about the normal.
    fn bins(lobe: impl Fn(f64) -> f64) -> Vec<Point> {
        let bin = |i: u32| {
            let distance = 0.01 * f64::from(i);
            let ray = Ray {
                wi: DVec3::Z,
                wo: DVec3::Z,
                distance,
            };
            Point {
                outcome: 0,
                mean: lobe(distance),
                se: Some(0.01 * lobe(distance)),
                projected: 0.01,
                rays: [ray; 4],
            }
        };
        (0..100).map(bin).collect()
    }

    fn fitted(points: &[Point], name: &str) -> Result<Fit, Skipped> {
        let all = Fitted {
            outcomes: &[],
            points,
            side: Side::Reflected,
        };
        let laws = [all.abg(), all.harvey_shack()];
        let law = laws.into_iter().find(|law| law.name == name);
        law.expect("a law of that name").fit(points, 1)
    }

    #[test]
    fn parameters_of_lobes_that_a_law_describes_are_found() {
        let abg = |x: f64| 0.02 / (0.004 + x.powf(2.3));
        let harvey_shack = |x: f64| 5.0 * (1.0 + (x / 0.1).powi(2)).powf(-0.9);
        let cases: [(&str, Vec<Point>, [f64; 3]); 2] = [
            ("abg", bins(abg), [0.02, 0.004, 2.3]),
            ("harvey-shack", bins(harvey_shack), [5.0, 0.1, -1.8]),
        ];
        for (name, points, expected) in cases {
            let fit = fitted(&points, name).unwrap_or_else(|skipped| panic!("{}", skipped.reason));
            for ((parameter, value), expected) in fit.parameters().zip(expected) {
                let error = value.mean / expected - 1.0;
                assert!(error.abs() < 1e-4, "{name}: {parameter} {}", value.mean);
            }
            assert!(fit.deviation < 1e-4);
        }
    }

    #[test]
    fn a_lobe_without_a_finite_peak_is_skipped() {
        // Scatter of 3 %, and no bin near enough to tell how high the peak is
        let scatter = |x: f64| 1.0 + 0.03 * (1000.0 * x).sin();
        let points = bins(|x| scatter(x) * (x + 1e-9).powf(-2.0));
        let skipped = fitted(&points[1..], "abg").err();
        let skipped = skipped.map(|skipped| skipped.reason);
        assert_eq!(skipped, Some("these bins do not determine its parameters"));
    }
}
