//! Spectrum mismatch: deviation of transformed heights from the spectrum requested.

/// Deviation of transformed heights from the spectrum requested, if no Gaussian surface turns into it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpectrumMismatch {
    /// Largest difference of the autocorrelation reached from that requested, over the variance.
    pub autocorrelation: f64,
    /// Slope variances reached along x and y between neighbouring samples, over those requested, less 1.
    pub slope_variance: [f64; 2],
}

impl SpectrumMismatch {
    /// Largest deviation that is not refused.
    const MAX: Self = Self {
        autocorrelation: 0.01,
        slope_variance: [0.05; 2],
    };

    /// Returns `true` if the deviation exceeds [`Self::MAX`].
    pub(crate) fn is_refused(self) -> bool {
        let slopes = self
            .slope_variance
            .into_iter()
            .zip(Self::MAX.slope_variance);
        self.autocorrelation > Self::MAX.autocorrelation
            || slopes.into_iter().any(|(off, max)| off.abs() > max)
    }
}
