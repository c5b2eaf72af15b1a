//! Radial profile: how a power spectral density falls with the wave number, in units of the correlation length.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::matern::Matern;
use super::power_law::PowerLaw;
use super::radial_table::RadialTable;
use asperity_numerics::elementary::{exp, j0, ln};
use asperity_numerics::quadrature::gauss_legendre;
use asperity_numerics::root;

/// Decay of a power spectral density with the wave number `kappa`, which is `k` in units of one over the correlation length.
///
/// The density is not normalised; [`Profile::moment`] is the measure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub(crate) enum Profile {
    /// Matern's family, of which the exponential autocorrelation is one.
    Matern(Matern),
    /// Self-affine: a power of the wave number between a roll-off and a cut-off.
    PowerLaw(PowerLaw),
    /// A table of wave numbers and densities.
    Table(RadialTable),
}

/// Panels of a quadrature with a cut-off, at most, besides one for each kink.
const MAX_PANELS: usize = 20_000;

/// Without a cut-off: up to wave numbers of some thousand over the lag.
const OPEN_PANELS: usize = 2000;

/// Wave numbers beyond hold nothing that counts.
const LARGEST: f64 = 1e100;

/// Panels of that quadrature per factor of e of the wave number.
const PANELS_PER_E: f64 = 3.0;

impl Profile {
    /// The density at the square of the wave number, on a scale of its own.
    pub(crate) fn at_square(&self, square: f64) -> f64 {
        match self {
            Self::Matern(matern) => matern.at_square(square),
            Self::PowerLaw(power) => power.at_square(square),
            Self::Table(table) => table.at_square(square),
        }
    }

    /// Wave number beyond which the density is zero; infinite without a cut-off.
    pub(crate) fn cut_off(&self) -> f64 {
        match self {
            Self::Matern(matern) => matern.cut_off(),
            Self::PowerLaw(power) => power.cut_off(),
            Self::Table(table) => table.cut_off(),
        }
    }

    /// Integral of `2 pi kappa^(1 + power)` times the density over wave numbers up to `end`, for a `power` of 0, 2 or 4; infinite
    /// where it does not converge.
    pub(crate) fn moment(&self, power: i32, end: f64) -> f64 {
        let end = end.min(self.cut_off());
        match self {
            Self::Matern(matern) => matern.moment(power, end),
            Self::PowerLaw(law) => law.moment(power, end),
            Self::Table(table) => table.moment(power, end),
        }
    }

    /// Moment over all wave numbers.
    pub(crate) fn total(&self, power: i32) -> f64 {
        self.moment(power, f64::INFINITY)
    }

    /// A wave number below which the density is nearly constant.
    fn level_below(&self) -> f64 {
        match self {
            Self::Matern(matern) => 0.1 / matern.scale(),
            Self::PowerLaw(power) => power.roll_off(),
            Self::Table(table) => table.first(),
        }
    }

    /// Wave number beyond which waves hold `fraction` of the slope variance.
    pub(crate) fn holding(&self, fraction: f64) -> f64 {
        let all = self.total(2);
        let share = |logarithm: f64| self.moment(2, exp(logarithm)) / all - (1.0 - fraction);
        let low = ln(self.level_below()) - 5.0;
        let high = match self.cut_off() {
            end if end.is_finite() => ln(end),
            _ => low + 700.0,
        };
        exp(root(share, low, high))
    }

    /// The normalised autocorrelation at the lag `r` in correlation lengths: the integral of `2 pi kappa J_0(kappa r)` times the
    /// density, over that without `J_0`.
    ///
    /// Panels are short against the wave number and against the oscillation; what lies beyond the last one cancels itself.
    pub(crate) fn autocorrelation(&self, r: f64) -> f64 {
        if r == 0.0 {
            return 1.0;
        }
        let integrand = |k: f64| TAU * k * self.at_square(k * k) * j0(k * r);
        self.integral(&integrand, 1.5 / r) / self.total(0)
    }

    /// Integral of `2 pi kappa` times the square of the density.
    pub(crate) fn square_integral(&self) -> f64 {
        let integrand = |k: f64| TAU * k * self.at_square(k * k).powi(2);
        self.integral(&integrand, f64::INFINITY)
    }

    /// Integral over all wave numbers, by panels no longer than `longest`.
    fn integral(&self, integrand: &dyn Fn(f64) -> f64, longest: f64) -> f64 {
        let (end, breaks) = (self.cut_off(), self.breaks());
        let most = match end.is_finite() {
            true => MAX_PANELS + breaks.len(),
            false => OPEN_PANELS,
        };
        let mut ahead = breaks.iter().copied().peekable();
        let (mut start, mut sum) = (0.0, 0.0);
        for _ in 0..most {
            while ahead.next_if(|kink| *kink <= start).is_some() {}
            let step = start.max(self.level_below()) / PANELS_PER_E;
            let kink = ahead.peek().copied().unwrap_or(end);
            let stop = (start + step.min(longest)).min(end).min(kink);
            if start >= end || stop > LARGEST {
                break;
            }
            sum += gauss_legendre(integrand, start, stop);
            start = stop;
        }
        sum
    }

    /// Wave numbers at which the density has a kink.
    fn breaks(&self) -> Vec<f64> {
        match self {
            Self::Matern(_) => Vec::new(),
            Self::PowerLaw(power) => vec![power.roll_off()],
            Self::Table(table) => table.wave_numbers().to_vec(),
        }
    }

    /// The lag at which the autocorrelation first falls to 1/e, of a profile with a cut-off.
    pub(crate) fn one_over_e_lag(&self) -> f64 {
        let below = |r: f64| self.autocorrelation(r) - exp(-1.0_f64);
        // Waves of half a radian at most have not turned far
        let mut low = 0.5 / self.cut_off();
        while below(1.2 * low) > 0.0 {
            low *= 1.2;
        }
        root(below, low, 1.2 * low)
    }

    /// Returns the profile with wave numbers multiplied by `factor`.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Matern(matern) => Self::Matern(matern.scaled(factor)),
            Self::PowerLaw(power) => Self::PowerLaw(power.scaled(factor)),
            Self::Table(table) => Self::Table(table.scaled(factor)),
        }
    }

    /// Returns `true` if its numbers are in range.
    pub(crate) fn is_valid(&self) -> bool {
        match self {
            Self::Matern(matern) => matern.is_valid(),
            Self::PowerLaw(power) => power.is_valid(),
            Self::Table(table) => table.is_valid(),
        }
    }
}
