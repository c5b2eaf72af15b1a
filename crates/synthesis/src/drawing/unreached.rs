//! Unreached: what surfaces of a recipe miss of the spectrum requested.

/// By how much transformed heights miss the spectrum requested, since no Gaussian surface turns into it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unreached {
    /// Largest difference of the autocorrelation reached from that requested, over the variance.
    pub autocorrelation: f64,
    /// Slope variances reached along x and y between neighbouring samples, over those requested, less 1.
    pub slope_variance: [f64; 2],
}

impl Unreached {
    /// The most that is not refused.
    const MOST: Self = Self {
        autocorrelation: 0.01,
        slope_variance: [0.05; 2],
    };

    /// Whether it is more than that.
    pub(crate) fn is_refused(self) -> bool {
        let slopes = self
            .slope_variance
            .into_iter()
            .zip(Self::MOST.slope_variance);
        self.autocorrelation > Self::MOST.autocorrelation
            || slopes.into_iter().any(|(off, most)| off.abs() > most)
    }
}
