//! A ray along one axis of the tile, and the lines between cells that it crosses.

use std::ops::Range;

use super::block::SQUARE;

/// A ray along one axis.
#[derive(Clone, Copy)]
pub(super) struct Axis {
    pub(super) origin: f64,
    pub(super) rate: f64,
    inverse: f64,
    /// By how much edges are moved where rounding must not matter.
    widening: f64,
    /// More than rounding moves a crossing in the ray parameter.
    pub(super) doubt: f64,
}

impl Axis {
    pub(super) fn new(origin: f64, rate: f64, widening: f64) -> Self {
        // So slow that it gets nowhere, and that its inverse overflows.
        let rate = if rate.abs() < 1e-200 { 0.0 } else { rate };
        let inverse = 1.0 / rate;
        let doubt = if rate == 0.0 {
            0.0
        } else {
            4.0 * widening * inverse.abs()
        };
        Self {
            origin,
            rate,
            inverse,
            widening,
            doubt,
        }
    }

    pub(super) fn at(&self, t: f64) -> f64 {
        self.origin + self.rate * t
    }

    /// Ray parameter at which the ray crosses a line; never if it goes along it, on this side of it.
    fn crossing(&self, line: f64) -> f64 {
        (line - self.origin) * self.inverse
    }

    /// Interval of the ray parameter over some cells.
    pub(super) fn across(&self, cells: &Range<usize>) -> [f64; 2] {
        if self.rate == 0.0 {
            return self.widely_across(cells);
        }
        let [a, b] = [cells.start, cells.end].map(|line| self.crossing(line as f64));
        if a < b { [a, b] } else { [b, a] }
    }

    /// The same with edges moved outwards.
    pub(super) fn widely_across(&self, cells: &Range<usize>) -> [f64; 2] {
        let low = cells.start as f64 - self.widening - self.origin;
        let high = cells.end as f64 + self.widening - self.origin;
        if self.rate == 0.0 {
            if low <= 0.0 && high >= 0.0 {
                [f64::MIN, f64::MAX]
            } else {
                [f64::MAX, f64::MIN]
            }
        } else {
            let (a, b) = (low * self.inverse, high * self.inverse);
            if a < b { [a, b] } else { [b, a] }
        }
    }

    /// Those of `cells` that the ray is over in an interval of its parameter, edges moved outwards.
    pub(super) fn over(&self, cells: &Range<usize>, [enter, leave]: [f64; 2]) -> Range<usize> {
        if enter > leave {
            return cells.start..cells.start;
        }
        let (a, b) = if self.rate == 0.0 {
            (self.origin, self.origin)
        } else {
            (self.at(enter), self.at(leave))
        };
        // Conversion saturates, and what is below zero becomes zero.
        let low = (a.min(b) - self.widening) as usize;
        let high = (a.max(b) + self.widening) as usize;
        low.max(cells.start)..high.saturating_add(1).min(cells.end)
    }

    /// The cell that the ray is over at `t`, known to `doubt`, and whether a line between cells is
    /// nearer than rounding can tell.
    #[inline(always)]
    pub(super) fn cell_at(&self, t: f64, doubt: f64) -> (usize, bool) {
        let place = self.at(t);
        let cell = place as i64;
        let within = place - cell as f64;
        let near = self.widening + doubt * self.rate.abs();
        (
            cell.max(0) as usize,
            (within < near) | (within > 1.0 - near),
        )
    }
}

/// The squares of some side that a ray passes along one axis, one after the other.
pub(super) struct Steps<'a> {
    axis: &'a Axis,
    /// Number of the square.
    pub(super) index: usize,
    /// To the number of the next.
    step: usize,
    /// The line to the next.
    line: f64,
    /// From there to the line after.
    side: f64,
    /// Ray parameter at which the ray crosses it.
    pub(super) next: f64,
}

impl<'a> Steps<'a> {
    pub(super) fn new(axis: &'a Axis, index: usize, side: usize) -> Self {
        let forward = axis.rate >= 0.0;
        let line = ((index + usize::from(forward)) * side) as f64;
        let (step, side) = if forward {
            (1, side as f64)
        } else {
            (usize::MAX, -(side as f64))
        };
        Self {
            axis,
            index,
            step,
            line,
            side,
            next: axis.crossing(line),
        }
    }

    /// Cells of the square along this axis, of `cells` in the block.
    pub(super) fn cells(&self, cells: &Range<usize>) -> Range<usize> {
        let start = self.index * SQUARE;
        start..(start + SQUARE).min(cells.end)
    }

    /// Goes on to the next square if `goes`, without a branch: along which axis a ray goes on, nobody
    /// can predict.
    pub(super) fn go_on_if(&mut self, goes: bool) {
        self.index = self.index.wrapping_add(if goes { self.step } else { 0 });
        self.line += if goes { self.side } else { 0.0 };
        self.next = self.axis.crossing(self.line);
    }
}
