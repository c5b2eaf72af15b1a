//! Matern's family of spectra, with a cut-off.

use std::f64::consts::PI;

use asperity_numerics::elementary::{exp_m1, ln_1p, pow};
use serde::{Deserialize, Serialize};

use super::error::PsdError;

/// `(1 + scale^2 kappa^2)^(-(nu + 1))` up to the cut-off: the spectrum of the autocorrelation
/// `2^(1 - nu) / Gamma(nu) (r / l)^nu K_nu(r / l)`, `l` being the scale.
///
/// For `nu = 1/2` the autocorrelation is `exp(-r / l)`; for large `nu` it tends to a Gaussian. Slope variance is finite without
/// a cut-off above `nu = 1` alone, and curvature above 2.
///
/// # Source
/// B. Matern, *Spatial Variation* (1960); M. L. Stein, *Interpolation of Spatial Data*, Springer 1999, section 2.10.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Matern {
    nu: f64,
    /// `l` in correlation lengths.
    scale: f64,
    /// Largest wave number.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut_off: Option<f64>,
}

/// Largest `nu`; a Gaussian spectrum is indistinguishable from it.
const MAX_NU: f64 = 100.0;

impl Matern {
    /// `scale`: `l`; `cut_off`: the largest wave number, needed up to `nu = 1`.
    pub(super) fn new(nu: f64, scale: f64, cut_off: Option<f64>) -> Result<Self, PsdError> {
        if !(nu > 0.0 && nu <= MAX_NU) {
            return Err(PsdError::BadParameter {
                name: "nu",
                value: nu,
                allowed: "above 0, up to 100",
            });
        }
        if nu <= 1.0 && cut_off.is_none() {
            return Err(PsdError::NoCutOff { nu });
        }
        Ok(Self { nu, scale, cut_off })
    }

    pub(super) const fn scale(&self) -> f64 {
        self.scale
    }

    pub(super) fn at_square(&self, square: f64) -> f64 {
        match self.cut_off {
            Some(cut_off) if square > cut_off * cut_off => 0.0,
            _ => {
                let base = 1.0 + self.scale * self.scale * square;
                match self.nu {
                    0.5 => (base * base.sqrt()).recip(),
                    nu => pow(base, -(nu + 1.0)),
                }
            }
        }
    }

    pub(super) fn cut_off(&self) -> f64 {
        self.cut_off.unwrap_or(f64::INFINITY)
    }

    /// With `u = scale^2 kappa^2`, the integral of `pi scale^(-2 - power) u^(power / 2) (1 + u)^(-nu - 1)`: powers of `1 + u`.
    pub(super) fn moment(&self, power: i32, end: f64) -> f64 {
        let logarithm = ln_1p((self.scale * end).powi(2));
        let integral = |exponent: f64| {
            let next = exponent + 1.0;
            match next == 0.0 {
                true => logarithm,
                false => exp_m1(next * logarithm) / next,
            }
        };
        let a = -self.nu - 1.0;
        let sum = match power {
            0 => integral(a),
            2 if self.nu <= 1.0 && end.is_infinite() => f64::INFINITY,
            2 => integral(a + 1.0) - integral(a),
            _ if self.nu <= 2.0 && end.is_infinite() => f64::INFINITY,
            _ => integral(a + 2.0) - 2.0 * integral(a + 1.0) + integral(a),
        };
        PI * sum / self.scale.powi(2 + power)
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            nu: self.nu,
            scale: self.scale / factor,
            cut_off: self.cut_off.map(|k| k * factor),
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        Self::new(self.nu, self.scale, self.cut_off).is_ok()
            && positive(self.scale)
            && self.cut_off.is_none_or(positive)
    }
}
