//! Values of both sides.

use asperity_tally::Side;
use serde::Serialize;

/// A value of each side, under its name.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct BySide<T> {
    reflected: T,
    transmitted: T,
}

impl<T> BySide<T> {
    /// The values that `of` returns.
    pub(crate) fn of(of: impl Fn(Side) -> T) -> Self {
        Self {
            reflected: of(Side::Reflected),
            transmitted: of(Side::Transmitted),
        }
    }
}
