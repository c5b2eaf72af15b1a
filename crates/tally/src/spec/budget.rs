//! Energy budget: the destinations of all flux, by name.

/// Destinations of the incident flux. The five parts `reflected`, `transmitted`, `absorbed`, `truncated` and
/// `lost` add to one; the other two are parts of `truncated`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget<T> {
    /// Left on the side that the light came from.
    pub reflected: T,
    /// Left on the other side.
    pub transmitted: T,
    /// Absorbed by a conductor or a medium.
    pub absorbed: T,
    /// On paths that were ended: bounce limit, roulette bookkeeping, open border, a side that is not
    /// recorded.
    pub truncated: T,
    /// On paths that failed numerically.
    pub lost: T,
    /// The part of `truncated` that left an open patch sideways.
    pub left_patch: T,
    /// The part of `truncated` that left on a side that is not recorded, or could have left on no other.
    pub not_recorded: T,
}

impl<T: Copy> Budget<T> {
    /// The five parts that add to one.
    #[must_use]
    pub const fn parts(&self) -> [T; 5] {
        [
            self.reflected,
            self.transmitted,
            self.absorbed,
            self.truncated,
            self.lost,
        ]
    }

    /// Applies a function to every part.
    #[must_use]
    pub fn map<U>(&self, f: impl Fn(T) -> U) -> Budget<U> {
        Budget {
            reflected: f(self.reflected),
            transmitted: f(self.transmitted),
            absorbed: f(self.absorbed),
            truncated: f(self.truncated),
            lost: f(self.lost),
            left_patch: f(self.left_patch),
            not_recorded: f(self.not_recorded),
        }
    }
}

impl Budget<f64> {
    /// The sum of the five parts: one for a complete tally.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.parts().iter().sum()
    }
}
