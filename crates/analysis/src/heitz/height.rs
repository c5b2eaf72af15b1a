//! Heights on the Smith microsurface, and flights between them.

/// The height of a ray as the logarithm of `C1`, the share of the surface that lies below it: from above
/// minus infinity, deep below, to zero, above all. The distribution of heights does not matter beyond
/// `C1`.
///
/// The logarithm tells heights apart near both ends, where `C1` itself would round to zero or to one;
/// it is never zero but for light that comes in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Height(f64);

impl Height {
    /// Above all facets.
    pub(super) const ABOVE_ALL: Self = Self(0.0);

    /// Where a ray that travels down the direction of that `lambda` meets a facet: it always does.
    ///
    /// `u` in (0, 1) is uniform. The free path gives `C1' = C1 / (1 - u)^(1 / Lambda)` with
    /// `Lambda = -1 - lambda` downwards.
    ///
    /// # Source
    /// Heitz et al. 2016, Sec. 4.
    pub(super) fn descended(self, lambda: f64, u: f64) -> Self {
        Self::of(self.0 + u.ln() / (1.0 + lambda))
    }

    /// The probabilities that a ray which travels up the direction of that `lambda` escapes, `C1^lambda`,
    /// and that it does not, each to its own relative accuracy.
    ///
    /// # Source
    /// Heitz et al. 2016, Sec. 4.
    pub(super) fn escape(self, lambda: f64) -> (f64, f64) {
        let exponent = lambda * self.0;
        (exponent.exp(), -exponent.exp_m1())
    }

    /// Where a ray that travels up the direction of that `lambda`, and does *not* escape, meets a facet.
    ///
    /// `u` in (0, 1) is uniform; `blocked` is the second probability of [`Self::escape`], above zero.
    pub(super) fn ascended(self, lambda: f64, blocked: f64, u: f64) -> Self {
        Self::of(self.0 - (-u * blocked).ln_1p() / lambda)
    }

    /// The same place for a ray behind the surface, where up is down: `1 - C1`.
    pub(super) fn seen_from_behind(self) -> Self {
        // Each form keeps its digits where the other loses them.
        Self::of(if self.0 > -std::f64::consts::LN_2 {
            (-self.0.exp_m1()).ln()
        } else {
            (-self.0.exp()).ln_1p()
        })
    }

    fn of(log_share: f64) -> Self {
        Self(log_share.min(-f64::MIN_POSITIVE))
    }

    #[cfg(test)]
    pub(super) fn share_below(self) -> f64 {
        self.0.exp()
    }
}
