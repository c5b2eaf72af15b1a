//! Deviation: the error of the bins of a run.

use serde::Serialize;

/// Fluxes of bins that others are measured against.
pub(super) struct Target {
    fluxes: Vec<f64>,
    norm: f64,
}

impl Target {
    /// `None` if there is no flux, of which no error could be a fraction.
    pub(super) fn new(fluxes: &[f64]) -> Option<Self> {
        let norm = fluxes.iter().map(|q| q * q).sum::<f64>().sqrt();
        (norm > 0.0).then(|| Self {
            fluxes: fluxes.to_vec(),
            norm,
        })
    }

    /// `sqrt(sum_b (q_b - ref_b)^2) / sqrt(sum_b ref_b^2)` of the bins `q`.
    pub(super) fn relative_rms(&self, q: &[f64]) -> f64 {
        let squares = q
            .iter()
            .zip(&self.fluxes)
            .map(|(q, reference)| (q - reference).powi(2));
        squares.sum::<f64>().sqrt() / self.norm
    }

    /// Addition expected of the standard errors of the fluxes themselves: `sqrt(sum_b se_b^2)` over
    /// the same root.
    pub(super) fn own_error(&self, standard_errors: &[f64]) -> f64 {
        standard_errors.iter().map(|se| se * se).sum::<f64>().sqrt() / self.norm
    }
}

/// An error over repeats.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RepeatedError {
    /// Root mean square over the repeats.
    pub rms: f64,
    /// Its standard error from the scatter between repeats; `None` for one repeat.
    pub se: Option<f64>,
}

impl RepeatedError {
    /// The root of the mean of the squares; its standard error is that of the mean over twice the root.
    pub(super) fn over(errors: &[f64]) -> Self {
        let n = errors.len() as f64;
        let mean = errors.iter().map(|e| e * e).sum::<f64>() / n;
        let rms = mean.sqrt();
        let squares: f64 = errors.iter().map(|e| (e * e - mean).powi(2)).sum();
        let se = (squares / (n * (n - 1.0))).sqrt();
        Self {
            rms,
            se: (errors.len() > 1).then(|| if rms > 0.0 { 0.5 * se / rms } else { 0.0 }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_fractions_of_the_root_of_the_sum_of_squares() {
        let target = Target::new(&[0.3, 0.4, 0.0]).unwrap();
        assert_eq!(target.relative_rms(&[0.3, 0.4, 0.0]), 0.0);
        // Off by 0.03 and 0.04 over 0.5.
        assert!((target.relative_rms(&[0.33, 0.4, -0.04]) - 0.1).abs() < 1e-15);
        assert!((target.own_error(&[0.003, 0.0, 0.004]) - 0.01).abs() < 1e-15);
        assert!(Target::new(&[0.0, 0.0]).is_none());
    }

    #[test]
    fn repeats_are_averaged_as_squares() {
        let error = RepeatedError::over(&[1.0, 7.0]);
        // Squares 1 and 49: mean 25, standard error of the mean 24.
        assert!((error.rms - 5.0).abs() < 1e-15);
        assert!((error.se.unwrap() - 2.4).abs() < 1e-14);
        assert_eq!(
            RepeatedError::over(&[0.5]),
            RepeatedError { rms: 0.5, se: None }
        );
        assert_eq!(RepeatedError::over(&[0.0, 0.0]).se, Some(0.0));
    }
}
