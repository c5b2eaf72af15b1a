//! Morton order: positions of the plane in an order that keeps neighbours together.

use std::ops::Range;

/// `[column, row]` of all positions of a square, along a Morton (Z) curve.
pub(crate) struct MortonSquare {
    side: u32,
    codes: Range<u64>,
}

impl MortonSquare {
    /// A square of `side` by `side`, from position number `first` on.
    pub(crate) fn new(side: u32, first: u32) -> Self {
        let padded = side.next_power_of_two();
        let end = u64::from(padded).pow(2);
        // Go down to ever smaller quarters, past those that come before the position
        let [mut column, mut row] = [0, 0];
        let mut before = u64::from(first);
        let mut code = 0;
        let mut size = padded;
        while size > 1 {
            size /= 2;
            for quarter in 0..4 {
                let [x, y] = [column + size * (quarter & 1), row + size * (quarter >> 1)];
                let inside = |low: u32| u64::from(side.saturating_sub(low).min(size));
                let positions = inside(x) * inside(y);
                if before < positions || quarter == 3 {
                    [column, row] = [x, y];
                    code += u64::from(quarter) * u64::from(size).pow(2);
                    break;
                }
                before -= positions;
            }
        }
        Self {
            side,
            codes: (code + before).min(end)..end,
        }
    }
}

impl Iterator for MortonSquare {
    type Item = [u32; 2];

    #[inline]
    fn next(&mut self) -> Option<[u32; 2]> {
        let side = self.side;
        self.codes
            .by_ref()
            .map(morton_position)
            .find(|[column, row]| *column < side && *row < side)
    }
}

/// `[column, row]` of the position that is number `code` along the curve.
pub(crate) fn morton_position(code: u64) -> [u32; 2] {
    [even_bits(code), even_bits(code >> 1)]
}

/// The number along the curve of the position at `[column, row]`.
pub(crate) fn morton_code([column, row]: [u32; 2]) -> u64 {
    at_even_bits(column) | at_even_bits(row) << 1
}

/// The bits of `x`, moved apart to even digits.
fn at_even_bits(x: u32) -> u64 {
    let mut code = u64::from(x);
    code = (code | code << 16) & 0x0000_ffff_0000_ffff;
    code = (code | code << 8) & 0x00ff_00ff_00ff_00ff;
    code = (code | code << 4) & 0x0f0f_0f0f_0f0f_0f0f;
    code = (code | code << 2) & 0x3333_3333_3333_3333;
    (code | code << 1) & 0x5555_5555_5555_5555
}

/// The bits of `code` at even digits, moved together.
fn even_bits(code: u64) -> u32 {
    let mut x = code & 0x5555_5555_5555_5555;
    x = (x | x >> 1) & 0x3333_3333_3333_3333;
    x = (x | x >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    x = (x | x >> 4) & 0x00ff_00ff_00ff_00ff;
    x = (x | x >> 8) & 0x0000_ffff_0000_ffff;
    x = (x | x >> 16) & 0x0000_0000_ffff_ffff;
    x as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_position_comes_once_and_quarters_come_whole() {
        for side in [1, 2, 5, 8, 13] {
            let mut positions: Vec<_> = MortonSquare::new(side, 0).collect();
            assert_eq!(positions.len(), (side * side) as usize);
            positions.sort_unstable();
            positions.dedup();
            assert_eq!(positions.len(), (side * side) as usize);
        }
        let quarter: Vec<_> = MortonSquare::new(8, 0).take(16).collect();
        assert!(quarter.iter().all(|[x, y]| *x < 4 && *y < 4));
    }

    #[test]
    fn any_position_can_be_the_first() {
        for side in [1, 2, 5, 8, 13] {
            let positions: Vec<_> = MortonSquare::new(side, 0).collect();
            for first in 0..=side * side {
                let from: Vec<_> = MortonSquare::new(side, first).collect();
                assert_eq!(from, positions[first as usize..], "{first} of {side}");
            }
        }
    }

    #[test]
    fn codes_and_positions_belong_together() {
        for (code, position) in (0..).zip(MortonSquare::new(16, 0)) {
            assert_eq!(morton_code(position), code);
        }
        for position in [[u32::MAX, 0], [0, u32::MAX], [0x1234_5678, 0x9abc_def0]] {
            assert_eq!(morton_position(morton_code(position)), position);
        }
    }
}
