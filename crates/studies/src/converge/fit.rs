//! Straight lines through seconds and errors on logarithmic axes.

use asperity_numerics::elementary::{exp, ln, pow};
use serde::Serialize;

/// `error = error_at_one_second * seconds^slope`, by least squares of the logarithms; of too few points there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Fit {
    /// Slope on logarithmic axes; -1/2 where samples are independent.
    pub slope: Option<f64>,
    /// Its standard error from the scatter about the line; `None` for two points, which have none.
    pub slope_se: Option<f64>,
    /// The error reached in one second.
    pub error_at_one_second: Option<f64>,
    /// Points that it rests on.
    #[serde(rename = "fitted")]
    pub points: usize,
    /// The least and the largest error among them.
    #[serde(skip)]
    pub errors: [f64; 2],
}

impl Fit {
    /// The line through `(seconds, error)`, all positive; none unless two of them differ in seconds.
    #[must_use]
    pub fn over(points: &[(f64, f64)]) -> Self {
        let n = points.len() as f64;
        let logs: Vec<(f64, f64)> = points.iter().map(|&(t, e)| (ln(t), ln(e))).collect();
        let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
        let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
        let xx: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
        if points.is_empty() || xx <= 0.0 {
            return Self::default();
        }
        let xy: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
        let slope = xy / xx;
        let residual = |(x, y): &(f64, f64)| (y - mean_y - slope * (x - mean_x)).powi(2);
        let squares: f64 = logs.iter().map(residual).sum();
        let errors = points.iter().map(|(_, error)| *error);
        Self {
            slope: Some(slope),
            slope_se: (points.len() > 2).then(|| (squares / (n - 2.0) / xx).sqrt()),
            error_at_one_second: Some(exp(mean_y - slope * mean_x)),
            points: points.len(),
            errors: [
                errors.clone().fold(f64::INFINITY, f64::min),
                errors.fold(0.0, f64::max),
            ],
        }
    }

    /// The seconds to `error`; none if errors do not fall along the line, or so slowly that seconds leave the range of numbers.
    #[must_use]
    pub fn seconds_to(&self, error: f64) -> Option<f64> {
        let slope = self.slope.filter(|slope| *slope < 0.0)?;
        let seconds = pow(error / self.error_at_one_second?, 1.0 / slope);
        seconds.is_normal().then_some(seconds)
    }

    /// Returns `true` if `error` lies beyond those measured.
    #[must_use]
    pub fn is_beyond(&self, error: f64) -> bool {
        let [least, largest] = self.errors;
        !(least..=largest).contains(&error)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points almost side by side lead to 0 or infinite seconds at a tenth and ten times their errors.
    #[test]
    fn a_line_that_hardly_falls_gives_no_seconds_out_of_range() {
        let fit = Fit::over(&[(1.0, 1e-2), (2.0, 0.9999e-2)]);
        assert!(fit.slope.unwrap() < 0.0);
        assert_eq!(fit.seconds_to(1e-1), None);
        assert_eq!(fit.seconds_to(1e-3), None);
    }

    #[test]
    fn a_line_of_slope_one_half_gives_back_slope_and_seconds() {
        // 1e-2 in one second.
        let points = [0.25, 1.0, 4.0, 64.0].map(|t: f64| (t, 1e-2 / t.sqrt()));
        let fit = Fit::over(&points);
        assert!((fit.slope.unwrap() + 0.5).abs() < 1e-14);
        assert!(fit.slope_se.unwrap() < 1e-14);
        assert_eq!(fit.points, 4);
        for (error, seconds, extrapolated) in
            [(1e-2, 1.0, false), (1e-3, 100.0, true), (1e-1, 0.01, true)]
        {
            let found = fit.seconds_to(error).unwrap();
            assert!((found / seconds - 1.0).abs() < 1e-12, "{error}");
            assert_eq!(fit.is_beyond(error), extrapolated, "{error}");
        }
    }

    #[test]
    fn the_error_of_a_slope_is_that_of_the_textbook() {
        // Errors e^0, e^-1, e^-1 at seconds e^0, e^1, e^2: slope -1/2, squares 1/6 about the line,
        // and sqrt(1/6 / 1 / 2).
        let points =
            [(0.0, 0.0), (1.0, -1.0), (2.0, -1.0)].map(|(x, y): (f64, f64)| (x.exp(), y.exp()));
        let fit = Fit::over(&points);
        assert!((fit.slope.unwrap() + 0.5).abs() < 1e-14);
        assert!((fit.slope_se.unwrap() - (1.0_f64 / 12.0).sqrt()).abs() < 1e-14);
    }

    #[test]
    fn there_is_no_line_through_one_point_and_no_end_to_one_that_rises() {
        for points in [&[][..], &[(1.0, 1e-2)], &[(1.0, 1e-2), (1.0, 2e-2)]] {
            assert_eq!(Fit::over(points), Fit::default());
        }
        let two = Fit::over(&[(1.0, 1e-2), (2.0, 2e-2)]);
        assert_eq!(two.slope_se, None);
        assert_eq!(two.seconds_to(1e-3), None);
        let level = Fit::over(&[(1.0, 1e-2), (2.0, 1e-2)]);
        assert_eq!(level.seconds_to(1e-3), None);
    }
}
