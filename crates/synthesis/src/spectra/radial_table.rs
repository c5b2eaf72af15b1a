//! Radial table: a measured spectrum of an isotropic surface.

use std::f64::consts::TAU;

use asperity_numerics::elementary::{exp_m1, ln, pow};
use serde::{Deserialize, Serialize};

use super::error::PsdTableError;

/// Densities at wave numbers. Between two nodes the density is a power of the wave number (a straight line on logarithmic axes), or
/// linear where one of the two is zero; below the first it is constant, beyond the last it is zero.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RadialTable {
    wave_number: Vec<f64>,
    density: Vec<f64>,
}

impl RadialTable {
    /// `wave_number`: radians per length unit, ascending, above zero, at least two; `density`: as many, none negative, not all zero.
    ///
    /// # Errors
    /// [`PsdTableError`] otherwise.
    pub fn new(wave_number: Vec<f64>, density: Vec<f64>) -> Result<Self, PsdTableError> {
        let table = Self {
            wave_number,
            density,
        };
        table.check()?;
        Ok(table)
    }

    pub(super) const fn of_checked(wave_number: Vec<f64>, density: Vec<f64>) -> Self {
        Self {
            wave_number,
            density,
        }
    }

    fn check(&self) -> Result<(), PsdTableError> {
        let (k, w) = (&self.wave_number, &self.density);
        if k.len() < 2 || k.len() != w.len() {
            return Err(PsdTableError::TooFew { rows: k.len() });
        }
        let is_ascending = k.windows(2).all(|pair| pair[0] < pair[1]);
        if !(k[0] > 0.0 && is_ascending && k[k.len() - 1].is_finite()) {
            return Err(PsdTableError::NotAscending { column: "k" });
        }
        check_densities(w)
    }

    pub(super) fn wave_numbers(&self) -> &[f64] {
        &self.wave_number
    }

    pub(super) fn first(&self) -> f64 {
        self.wave_number[0]
    }

    pub(super) fn cut_off(&self) -> f64 {
        self.wave_number[self.wave_number.len() - 1]
    }

    pub(super) fn at_square(&self, square: f64) -> f64 {
        let k = square.sqrt();
        let i = self.wave_number.partition_point(|node| *node < k);
        if i == 0 {
            return self.density[0];
        }
        if i == self.wave_number.len() {
            return 0.0;
        }
        let [k0, k1, w0, w1] = self.piece(i - 1);
        match power_between([k0, k1, w0, w1]) {
            Some(power) => w0 * pow(k / k0, power),
            None => w0 + (w1 - w0) * (k - k0) / (k1 - k0),
        }
    }

    fn piece(&self, i: usize) -> [f64; 4] {
        let (k, w) = (&self.wave_number, &self.density);
        [k[i], k[i + 1], w[i], w[i + 1]]
    }

    pub(super) fn moment(&self, power: i32, end: f64) -> f64 {
        let n = f64::from(power + 2);
        // Level below the first node
        let mut sum = self.density[0] * pow(self.first().min(end), n) / n;
        for i in 0..self.wave_number.len() - 1 {
            let [k0, k1, w0, w1] = self.piece(i);
            let stop = k1.min(end);
            if stop <= k0 {
                break;
            }
            sum += match power_between([k0, k1, w0, w1]) {
                // The integral of w0 (k / k0)^p k^(n - 1)
                Some(p) => {
                    let exponent = p + n;
                    let logarithm = ln(stop / k0);
                    let grown = match (exponent * logarithm).abs() < 1e-12 {
                        true => logarithm,
                        false => exp_m1(exponent * logarithm) / exponent,
                    };
                    w0 * pow(k0, n) * grown
                }
                None => {
                    let slope = (w1 - w0) / (k1 - k0);
                    let of = |exponent: f64| (pow(stop, exponent) - pow(k0, exponent)) / exponent;
                    (w0 - slope * k0) * of(n) + slope * of(n + 1.0)
                }
            };
        }
        TAU * sum
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            wave_number: self.wave_number.iter().map(|k| k * factor).collect(),
            density: self.density.clone(),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        self.check().is_ok()
    }
}

/// Checks that densities are finite, none is negative, and not all are zero.
pub(super) fn check_densities(densities: &[f64]) -> Result<(), PsdTableError> {
    let bad = densities.iter().find(|w| !(w.is_finite() && **w >= 0.0));
    match bad {
        Some(value) => Err(PsdTableError::BadDensity { value: *value }),
        None if densities.iter().all(|w| *w == 0.0) => Err(PsdTableError::NoPower),
        None => Ok(()),
    }
}

/// The power of the wave number between two nodes; `None` where it is linear.
fn power_between([k0, k1, w0, w1]: [f64; 4]) -> Option<f64> {
    (w0 > 0.0 && w1 > 0.0).then(|| ln(w1 / w0) / ln(k1 / k0))
}
