//! Draws: random words of a walk, functions of its number, its step and its purpose.

use asperity_numerics::random::threefry;

/// Bit of the number of a walk that went on from the first facet by transmission.
pub(super) const TRANSMITTED_FIRST: u64 = 1 << 47;

/// Most trials of a normal, whose number is in the bits of the counter above this one.
pub(super) const MAX_TRIALS: u64 = 0xffff;
const TRIAL_SHIFT: u32 = 48;

/// The word of the height at which a new ray meets its first facet.
#[inline(always)]
pub(super) fn of_start(key: [u64; 2], walk: u64) -> u64 {
    threefry(key, [walk | MAX_TRIALS << TRIAL_SHIFT, 0])[0]
}

/// The words of the interaction that follows `order` others.
#[inline(always)]
pub(super) fn of_interaction(key: [u64; 2], walk: u64, order: u64) -> [u64; 2] {
    threefry(key, [walk | MAX_TRIALS << TRIAL_SHIFT, order << 1 | 1])
}

/// The words of a trial of the normal of that interaction; `trial` below [`MAX_TRIALS`].
#[inline(always)]
pub(super) fn of_trial(key: [u64; 2], walk: u64, order: u64, trial: u64) -> [u64; 4] {
    let counter = walk | trial << TRIAL_SHIFT;
    let [first, second] = threefry(key, [counter, order << 1]);
    let [third, fourth] = threefry(key, [counter, order << 1 | 1]);
    [first, second, third, fourth]
}
