//! `[surface]`: what random surfaces are drawn by.

use asperity_surface::{Johnson, Psd, StudentSlopes, SurfaceRecipe, TransformedHeights};

use super::surface::{MAX_SMOOTHNESS, SlopesName, SurfaceConfig};
use super::surface_choices::{SpectrumChoice, SpectrumName};
use crate::config::error::ConfigError;

/// Correlation length of the amplitude of GGX slopes over that of the surface, unless given.
const AMPLITUDE_RATIO: f64 = 8.0;

fn refused<T>(text: impl Into<String>) -> Result<T, ConfigError> {
    Err(ConfigError::Contradiction(text.into()))
}

/// A value that a choice needs.
fn needed(value: Option<f64>, flag: &str, choice: &str) -> Result<f64, ConfigError> {
    value.map_or_else(|| refused(format!("{choice} needs --{flag}")), Ok)
}

impl SurfaceConfig {
    /// The smoothness and what surfaces are drawn by, of a configuration without lists.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is missing or out of range.
    pub fn recipe(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        self.check_choices()?;
        self.structure.check()?;
        if self.structure.structure.is_some() {
            return self.structured();
        }
        if self.slopes == SlopesName::Ggx {
            return self.student();
        }
        let unit = self.unit_psd()?;
        let [tau, _] = unit.correlation_lengths();
        let (smoothness, sigma) = match (&self.smoothness, &self.sigma) {
            (Some(smoothness), None) => {
                let smoothness = smoothness.one("smoothness")?.0;
                (smoothness, tau / smoothness)
            }
            (None, Some(sigma)) => {
                let sigma = sigma.one("sigma")?.0;
                (tau / sigma, sigma)
            }
            (None, None) if let Some(psd) = &self.files.psd => (tau / psd.sigma(), psd.sigma()),
            _ => return refused("give either smoothness or sigma: smoothness = tau / sigma"),
        };
        let ratio = self.tau_y.map_or(1.0, |tau_y| tau_y.0 / tau);
        let smoother = smoothness * ratio.max(1.0);
        if smoother > MAX_SMOOTHNESS {
            return Err(ConfigError::TooSmooth(smoother));
        }
        if !(smoothness.is_finite() && smoothness > 0.0) {
            return refused(format!(
                "smoothness is {smoothness}; tau / sigma must be positive and finite"
            ));
        }
        let azimuth = self.azimuth.0.to_radians();
        let psd = match unit {
            Psd::Gaussian(_) => {
                let tau_y = self.tau_y.map_or(tau, |t| t.0);
                Psd::anisotropic_gaussian(sigma, tau, tau_y, azimuth)?
            }
            other => self.turned(other.with_sigma(sigma)?)?,
        };
        let Some(second) = self.second()? else {
            return Ok((smoothness, self.transformed(psd)?));
        };
        let sum = psd.plus(second);
        let [tau, _] = sum.correlation_lengths();
        Ok((tau / sum.sigma(), self.transformed(sum)?))
    }

    /// Surfaces of a spectrum with the skewness and kurtosis requested, if any are.
    fn transformed(&self, psd: Psd) -> Result<SurfaceRecipe, ConfigError> {
        let has_moments = self.skewness.is_some() || self.kurtosis.is_some();
        if let Some(heights) = &self.files.heights {
            return match has_moments {
                true => refused("give either heights or skewness and kurtosis"),
                false => Ok(TransformedHeights::of(psd, heights.clone()).into()),
            };
        }
        if !has_moments {
            return Ok(psd.into());
        }
        let skewness = self.skewness.map_or(0.0, |skewness| skewness.0);
        let lognormal = Johnson::lognormal_kurtosis(skewness);
        let kurtosis = self.kurtosis.map_or(lognormal, |kurtosis| kurtosis.0);
        Ok(TransformedHeights::new(psd, skewness, kurtosis)?.into())
    }

    /// The spectrum of root mean square height 1, along one axis.
    pub(super) fn unit_psd(&self) -> Result<Psd, ConfigError> {
        let number = |value: Option<super::values::Number>| value.map(|number| number.0);
        let tau = || match self.tau {
            Some(tau) => Ok(tau.0),
            None => refused("tau is missing"),
        };
        let cut_off = number(self.cut_off);
        let SpectrumChoice::Named(name) = self.psd else {
            return match &self.files.psd {
                Some(_) if self.tau.is_some() || self.tau_y.is_some() => refused(
                    "the correlation length of a spectrum from a file is its own; leave out tau and tau_y",
                ),
                Some(psd) => Ok(psd.clone().with_sigma(1.0)?),
                None => refused("the file of the spectrum has not been read"),
            };
        };
        Ok(match name {
            SpectrumName::Gaussian => Psd::gaussian(1.0, tau()?)?,
            SpectrumName::Exponential => {
                let cut_off = needed(cut_off, "cut-off", "--psd exponential")?;
                Psd::exponential(1.0, tau()?, cut_off)?
            }
            SpectrumName::Matern => {
                let nu = needed(number(self.nu), "nu", "--psd matern")?;
                Psd::matern(1.0, tau()?, nu, cut_off)?
            }
            SpectrumName::PowerLaw => {
                if self.tau.is_some() {
                    return refused(
                        "the correlation length of a power law follows from --hurst, --roll-off and --cut-off; leave out tau",
                    );
                }
                let choice = "--psd power-law";
                let hurst = needed(number(self.hurst), "hurst", choice)?;
                let roll_off = needed(number(self.roll_off), "roll-off", choice)?;
                Psd::power_law(1.0, hurst, roll_off, needed(cut_off, "cut-off", choice)?)?
            }
        })
    }

    /// The spectrum with its second axis.
    pub(super) fn turned(&self, psd: Psd) -> Result<Psd, ConfigError> {
        match self.tau_y {
            Some(tau_y) => Ok(psd.stretched(tau_y.0, self.azimuth.0.to_radians())?),
            None => Ok(psd),
        }
    }

    /// The second scale, if there is one.
    fn second(&self) -> Result<Option<Psd>, ConfigError> {
        match (self.second_sigma, self.second_tau) {
            (None, None) => Ok(None),
            (Some(sigma), Some(tau)) => Ok(Some(Psd::gaussian(sigma.0, tau.0)?)),
            _ => refused("a second scale needs both --second-sigma and --second-tau"),
        }
    }

    /// Surfaces of GGX slopes.
    fn student(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let Some(alpha) = self.ggx_alpha else {
            return refused("--slopes ggx needs --ggx-alpha, in place of smoothness and sigma");
        };
        if self.second()?.is_some() {
            return refused(
                "--slopes ggx has no second scale; leave out --second-sigma and --second-tau",
            );
        }
        if self.skewness.is_some() || self.kurtosis.is_some() {
            return refused(
                "--slopes ggx decides the heights as well; leave out --skewness and --kurtosis",
            );
        }
        let unit = self.turned(self.unit_psd()?)?;
        // alpha^2 is twice the slope variance along the first axis
        let [tau, _] = unit.correlation_lengths();
        let along = self.unit_psd()?.slope_covariance()[0];
        let base = unit.with_sigma(alpha.0 / (2.0 * along).sqrt())?;
        let ratio = self
            .amplitude_ratio
            .map_or(AMPLITUDE_RATIO, |ratio| ratio.0);
        let recipe: SurfaceRecipe = StudentSlopes::new(base, ratio)?.into();
        Ok((tau / recipe.sigma(), recipe))
    }

    /// Refuses parameters that no choice takes.
    fn check_choices(&self) -> Result<(), ConfigError> {
        use SpectrumName::{Exponential, Matern, PowerLaw};
        let taken = [
            ("nu", self.nu.is_some(), &[Matern][..]),
            ("hurst", self.hurst.is_some(), &[PowerLaw]),
            ("roll-off", self.roll_off.is_some(), &[PowerLaw]),
            (
                "cut-off",
                self.cut_off.is_some(),
                &[Exponential, Matern, PowerLaw],
            ),
        ];
        for (flag, given, psds) in taken {
            if given && !psds.iter().any(|psd| self.psd == *psd) {
                let names: Vec<&str> = psds.iter().map(|psd| psd.name()).collect();
                let psd = self.psd.name();
                return refused(format!(
                    "--{flag} is for --psd {}; the spectrum is {psd}",
                    names.join(", ")
                ));
            }
        }
        let of_ggx = self.ggx_alpha.is_some() || self.amplitude_ratio.is_some();
        match self.slopes {
            SlopesName::Gaussian if of_ggx => {
                refused("--ggx-alpha and --amplitude-ratio are for --slopes ggx")
            }
            _ => Ok(()),
        }
    }
}
