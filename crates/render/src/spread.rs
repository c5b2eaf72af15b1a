//! Spread: a sequence that fills the unit square evenly.

/// Point `k` of a sequence that fills the unit square evenly from its beginning, moved by `shift`.
///
/// # Source
/// Roberts 2018, "The unreasonable effectiveness of quasirandom sequences": the lattice of the plastic
/// number.
pub(crate) fn spread(k: u64, shift: [f64; 2]) -> [f64; 2] {
    const STEPS: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_2];
    [0, 1].map(|axis| (shift[axis] + k as f64 * STEPS[axis]).fract())
}
