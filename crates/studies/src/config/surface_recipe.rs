//! `[surface]`: what random surfaces are drawn by.

use asperity_synthesis::{Johnson, Psd, StudentSlopes, SurfaceRecipe, TransformedHeights};

use super::surface::{MAX_SMOOTHNESS, SlopesName, SurfaceConfig};
use super::surface_choices::{SpectrumChoice, SpectrumName};
use super::surface_error::SurfaceError;
use crate::config::error::ConfigError;

/// Returns a value that the chosen spectrum or slopes need.
fn needed<T>(value: Option<T>, name: &'static str) -> Result<T, SurfaceError> {
    value.ok_or(SurfaceError::Missing(name))
}

impl SurfaceConfig {
    /// The smoothness and what surfaces are drawn by, of a configuration without lists.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is missing or out of range.
    pub fn recipe(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        self.check_azimuth()?;
        if self.structure.structure.is_some() {
            return self.structured();
        }
        if self.slopes == SlopesName::Ggx {
            return self.student();
        }
        self.transformed_spectrum()
    }

    /// Surfaces of a spectrum, Gaussian or with other heights.
    pub(super) fn transformed_spectrum(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let unit = self.unit_psd()?;
        let [tau, _] = unit.correlation_lengths();
        let (smoothness, sigma) = self.smoothness_and_sigma(tau)?;
        let psd = match unit {
            Psd::Gaussian(_) => {
                let tau_y = self.tau_y.map_or(tau, |t| t.0);
                let azimuth = self.azimuth.0.to_radians();
                Psd::anisotropic_gaussian(sigma, tau, tau_y, azimuth).map_err(SurfaceError::from)?
            }
            other => self.turned(other.with_sigma(sigma).map_err(SurfaceError::from)?)?,
        };
        let Some(second) = self.second()? else {
            return Ok((smoothness, self.transformed(psd)?));
        };
        let sum = psd.plus(second);
        let [tau, _] = sum.correlation_lengths();
        Ok((tau / sum.sigma(), self.transformed(sum)?))
    }

    /// The smoothness and the root mean square height of surfaces of the correlation length `tau`: one is given and the other follows, or
    /// both follow from the file of the spectrum.
    fn smoothness_and_sigma(&self, tau: f64) -> Result<(f64, f64), ConfigError> {
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
            _ => return Err(SurfaceError::Missing("smoothness").into()),
        };
        let ratio = self.tau_y.map_or(1.0, |tau_y| tau_y.0 / tau);
        let smoother = smoothness * ratio.max(1.0);
        if smoother > MAX_SMOOTHNESS {
            return Err(SurfaceError::TooSmooth(smoother).into());
        }
        if !(smoothness.is_finite() && smoothness > 0.0) {
            return Err(SurfaceError::BadSmoothness(smoothness).into());
        }
        Ok((smoothness, sigma))
    }

    /// Surfaces of a spectrum with the skewness and kurtosis requested, if any are.
    fn transformed(&self, psd: Psd) -> Result<SurfaceRecipe, SurfaceError> {
        let has_moments = self.skewness.is_some() || self.kurtosis.is_some();
        if let Some(heights) = &self.files.heights {
            return Ok(TransformedHeights::of(psd, heights.clone()).into());
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
    pub(super) fn unit_psd(&self) -> Result<Psd, SurfaceError> {
        match self.psd {
            SpectrumChoice::Named(name) => self.named_psd(name),
            SpectrumChoice::File(_) => match &self.files.psd {
                Some(psd) => Ok(psd.clone().with_sigma(1.0)?),
                None => Err(SurfaceError::UnreadSpectrum),
            },
        }
    }

    /// A spectrum that has a name, of root mean square height 1.
    fn named_psd(&self, name: SpectrumName) -> Result<Psd, SurfaceError> {
        let tau = || Ok::<_, SurfaceError>(needed(self.tau, "tau")?.0);
        Ok(match name {
            SpectrumName::Gaussian => Psd::gaussian(1.0, tau()?)?,
            SpectrumName::Exponential => {
                Psd::exponential(1.0, tau()?, needed(self.cut_off, "cut_off")?.0)?
            }
            SpectrumName::Matern => {
                let nu = needed(self.nu, "nu")?.0;
                let cut_off = self.cut_off.map(|cut_off| cut_off.0);
                Psd::matern(1.0, tau()?, nu, cut_off)?
            }
            SpectrumName::PowerLaw => {
                let hurst = needed(self.hurst, "hurst")?.0;
                let roll_off = needed(self.roll_off, "roll_off")?.0;
                Psd::power_law(1.0, hurst, roll_off, needed(self.cut_off, "cut_off")?.0)?
            }
        })
    }

    /// The spectrum with its second axis.
    pub(super) fn turned(&self, psd: Psd) -> Result<Psd, SurfaceError> {
        match self.tau_y {
            Some(tau_y) => Ok(psd.stretched(tau_y.0, self.azimuth.0.to_radians())?),
            None => Ok(psd),
        }
    }

    /// The second scale, if there is one.
    fn second(&self) -> Result<Option<Psd>, SurfaceError> {
        match (self.second_sigma, self.second_tau) {
            (Some(sigma), Some(tau)) => Ok(Some(Psd::gaussian(sigma.0, tau.0)?)),
            _ => Ok(None),
        }
    }

    /// Surfaces of GGX slopes.
    fn student(&self) -> Result<(f64, SurfaceRecipe), ConfigError> {
        let alpha = needed(self.ggx_alpha.as_ref(), "ggx_alpha")?.one("ggx_alpha")?;
        let unit = self.turned(self.unit_psd()?)?;
        // alpha^2 is twice the slope variance along the first axis
        let [tau, _] = unit.correlation_lengths();
        let along = self.unit_psd()?.slope_covariance()[0];
        let sigma = alpha.0 / (2.0 * along).sqrt();
        let base = unit.with_sigma(sigma).map_err(SurfaceError::from)?;
        let student = StudentSlopes::new(base, self.amplitude_ratio());
        let recipe: SurfaceRecipe = student.map_err(SurfaceError::from)?.into();
        Ok((tau / recipe.sigma(), recipe))
    }

    /// Refuses an azimuth where nothing has a direction that it would turn.
    fn check_azimuth(&self) -> Result<(), SurfaceError> {
        let azimuth = self.azimuth.0;
        let has_direction = self.tau_y.is_some() || self.structure.has_direction();
        match azimuth != 0.0 && !has_direction {
            true => Err(SurfaceError::NoDirection { azimuth }),
            false => Ok(()),
        }
    }
}
