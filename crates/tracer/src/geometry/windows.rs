//! Windows: bounds over blocks that follow one another, also beyond the border of the tile.

use asperity_surface::Border;

/// Bounds of a block that can be joined with those of others.
pub(super) trait Joined: Copy {
    /// Bounds assumed beyond an open border, wider than those of any block.
    const BEYOND: Self;
    /// Bounds of two blocks together.
    fn joined(self, other: Self) -> Self;
    /// Bounds of the image of a block, mirrored along x (axis 0) or y.
    fn mirrored(self, axis: usize) -> Self;
}

impl Joined for u16 {
    const BEYOND: Self = Self::MAX;

    #[inline(always)]
    fn joined(self, other: Self) -> Self {
        self.max(other)
    }

    fn mirrored(self, _axis: usize) -> Self {
        self
    }
}

/// The blocks of a tile, `[columns, rows]`, of which the last along an axis may not be `whole`.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub(super) size: [usize; 2],
    pub(super) whole: [bool; 2],
    pub(super) border: Border,
}

impl Layout {
    /// Joins each block with all those within `count` sides of a block after it along an axis, forward or backward: a
    /// sliding-window maximum. Row by row.
    pub(super) fn windows<T: Joined>(
        &self,
        blocks: &[T],
        axis: usize,
        backward: bool,
        count: usize,
    ) -> Vec<T> {
        let [columns, rows] = self.size;
        // A block at the border that is not whole is narrower, and its own mirror image follows it: others are needed in their place.
        let count = count
            + match self.border {
                _ if self.whole[axis] => 0,
                Border::Open | Border::Periodic => 1,
                Border::Mirrored => 2,
            };
        let (lines, stride) = if axis == 0 { (rows, 1) } else { (1, columns) };
        let length = self.size[axis];
        let steps: Vec<_> = (0..length + count)
            .map(|step| self.block(axis, backward, step))
            .collect();
        let mut all = vec![T::BEYOND; blocks.len()];
        let mut walk = Vec::new();
        for line in 0..lines {
            let first = line * columns;
            walk.clear();
            for step in &steps {
                match *step {
                    None => walk.extend(std::iter::repeat_n(T::BEYOND, stride)),
                    Some((i, is_image)) => {
                        let of = &blocks[first + i * stride..][..stride];
                        if is_image {
                            walk.extend(of.iter().map(|block| block.mirrored(axis)));
                        } else {
                            walk.extend_from_slice(of);
                        }
                    }
                }
            }
            join_windows(&mut walk, stride, count + 1);
            for step in 0..length {
                let i = if backward { length - 1 - step } else { step };
                all[first + i * stride..][..stride]
                    .copy_from_slice(&walk[step * stride..][..stride]);
            }
        }
        all
    }

    /// The block that a walk along an axis comes to after some steps, and whether as a mirror image.
    fn block(&self, axis: usize, backward: bool, step: usize) -> Option<(usize, bool)> {
        let n = self.size[axis];
        let (i, is_image) = match self.border {
            Border::Open if step >= n => return None,
            Border::Open | Border::Periodic => (step % n, false),
            Border::Mirrored if step % (2 * n) < n => (step % (2 * n), false),
            Border::Mirrored => (2 * n - 1 - step % (2 * n), true),
        };
        Some((if backward { n - 1 - i } else { i }, is_image))
    }
}

/// Joins each element of `stride` entries with those after it, `width` in all; those at the end have fewer.
fn join_windows<T: Joined>(entries: &mut [T], stride: usize, width: usize) {
    let mut join = |shift: usize| {
        for i in 0..entries.len().saturating_sub(shift * stride) {
            entries[i] = entries[i].joined(entries[i + shift * stride]);
        }
    };
    let mut done = 1;
    while 2 * done <= width {
        join(done);
        done *= 2;
    }
    if done < width {
        join(width - done);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_join_what_lies_ahead_of_each_block_as_a_walk_does() {
        let size = [5, 4];
        let blocks: Vec<u16> = (0..20).map(|i| (i * 7919 % 101) as u16).collect();
        for border in [Border::Periodic, Border::Mirrored, Border::Open] {
            for whole in [[true; 2], [false; 2], [true, false]] {
                let layout = Layout {
                    size,
                    whole,
                    border,
                };
                for (axis, backward, count) in [
                    (0, false, 1),
                    (0, true, 2),
                    (1, false, 7),
                    (1, true, 16),
                    (0, false, 32),
                ] {
                    let found = layout.windows(&blocks, axis, backward, count);
                    let more = match border {
                        _ if whole[axis] => 0,
                        Border::Mirrored => 2,
                        Border::Open | Border::Periodic => 1,
                    };
                    for (number, &found) in found.iter().enumerate() {
                        let at = [number % size[0], number / size[0]];
                        let n = size[axis] as isize;
                        let largest = (0..=(count + more) as isize).map(|step| {
                            let i = at[axis] as isize + if backward { -step } else { step };
                            let i = match border {
                                Border::Open if i < 0 || i >= n => return u16::MAX,
                                Border::Open | Border::Periodic => i.rem_euclid(n),
                                Border::Mirrored => {
                                    let i = i.rem_euclid(2 * n);
                                    i.min(2 * n - 1 - i)
                                }
                            };
                            let mut place = at;
                            place[axis] = i as usize;
                            blocks[place[1] * size[0] + place[0]]
                        });
                        assert_eq!(Some(found), largest.max(), "{border:?} {axis} {at:?}");
                    }
                }
            }
        }
    }
}
