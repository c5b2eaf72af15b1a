//! Roulette: ends paths of little flux at random, without changing any mean.

use asperity_tally::{Loss, Tally};

/// Russian roulette: a path of little flux continues with a probability proportional to its flux, and then carries the
/// threshold. Flux that roulette removes or adds is tallied as truncated, zero on average.
#[derive(Clone, Copy)]
pub(crate) struct Roulette {
    pub(crate) threshold: f64,
    /// Under a control variate all first branches are traced, so that they cancel exactly.
    pub(crate) spares_first: bool,
}

impl Roulette {
    /// Returns `true` if it decides on a branch; `is_first`: the branch leaves the first interaction.
    #[inline(always)]
    pub(crate) fn decides(&self, flux: f64, is_first: bool) -> bool {
        (flux > 0.0) & (flux < self.threshold) & !(self.spares_first & is_first)
    }

    /// The flux that is left, decided by the random number `u`.
    pub(crate) fn play(&self, flux: f64, u: f64, tally: &mut Tally<'_>) -> f64 {
        if flux == 0.0 || flux >= self.threshold {
            return flux;
        }
        let kept = self.kept(flux, u);
        tally.add_loss(Loss::Truncated, flux - kept);
        kept
    }

    /// What is left of a flux below the threshold.
    pub(crate) fn kept(&self, flux: f64, u: f64) -> f64 {
        let survives = u * self.threshold < flux;
        if survives { self.threshold } else { 0.0 }
    }
}
