//! Branches: turns scattered light into the segments that leave the facets, in place.

use crate::path::state::scattered::ScatteredLight;
use crate::path::state::segments::{Segments, copy_column};
use crate::vector::Stage;

/// Makes of each segment that has arrived the reflected or the transmitted one, picked by their fractions.
pub(crate) struct PickBranches<'a> {
    pub(crate) at: &'a mut Segments,
    pub(crate) scattered: &'a ScatteredLight,
    /// Random numbers of each.
    pub(crate) pairs: &'a [[f64; 2]],
}

impl Stage for PickBranches<'_> {
    #[inline(always)]
    fn run(self) {
        let n = self.at.len;
        let ScatteredLight {
            transmitted,
            reflected,
        } = self.scattered;
        let (fraction, pairs) = (&reflected.flux[..n], &self.pairs[..n]);
        let columns = self.at.direction.iter_mut().chain(&mut self.at.light);
        let from_reflected = reflected.direction.iter().chain(&reflected.light);
        let from_transmitted = transmitted.direction.iter().chain(&transmitted.light);
        for ((column, reflected), transmitted) in columns.zip(from_reflected).zip(from_transmitted)
        {
            let column = &mut column[..n];
            let (reflected, transmitted) = (&reflected[..n], &transmitted[..n]);
            for i in 0..n {
                let is_reflected = pairs[i][0] < fraction[i];
                column[i] = if is_reflected {
                    reflected[i]
                } else {
                    transmitted[i]
                };
            }
        }
        let (side, order) = (&mut self.at.side[..n], &mut self.at.order[..n]);
        let events = &mut self.at.events[..n];
        for i in 0..n {
            let is_reflected = pairs[i][0] < fraction[i];
            let bit = transmission_bit(order[i]);
            events[i] |= if is_reflected { 0 } else { bit };
            side[i] = if is_reflected { side[i] } else { -side[i] };
            order[i] += 1;
        }
    }
}

/// Makes of each segment that has arrived the reflected one, and adds those that are transmitted.
pub(crate) struct SplitBranches<'a> {
    pub(crate) at: &'a mut Segments,
    /// Directions, and the flux of each branch.
    pub(crate) scattered: &'a ScatteredLight,
    /// Numbers of the segments of which light is transmitted.
    pub(crate) transmitted: &'a [u32],
}

impl Stage for SplitBranches<'_> {
    #[inline(always)]
    fn run(self) {
        let Self {
            at,
            scattered:
                ScatteredLight {
                    transmitted,
                    reflected,
                },
            transmitted: which,
        } = self;
        let n = at.len;
        at.copy_paths(which);
        let end = at.len;
        let columns = at.direction.iter_mut().chain(&mut at.light);
        let columns = columns.chain([&mut at.flux]);
        let from_reflected = reflected.direction.iter().chain(&reflected.light);
        let from_transmitted = transmitted.direction.iter().chain(&transmitted.light);
        let from_reflected = from_reflected.chain([&reflected.flux]);
        let from_transmitted = from_transmitted.chain([&transmitted.flux]);
        for ((column, reflected), transmitted) in columns.zip(from_reflected).zip(from_transmitted)
        {
            let (first, behind) = column[..end].split_at_mut(n);
            first.copy_from_slice(&reflected[..n]);
            copy_column(behind, &transmitted[..n], which);
        }
        let (sides, transmitted) = at.side[..end].split_at_mut(n);
        copy_column(transmitted, sides, which);
        transmitted.iter_mut().for_each(|side| *side = -*side);
        let (order, events) = (&mut at.order[..end], &mut at.events[..end]);
        for i in n..end {
            events[i] |= transmission_bit(order[i]);
        }
        order.iter_mut().for_each(|order| *order += 1);
    }
}

/// The bit of [`asperity_tally::EventPath::code`] that is set where interaction number `order` transmits.
#[inline(always)]
fn transmission_bit(order: u32) -> u32 {
    // A shift by 32 or more is by its low bits.
    if order < 32 {
        1_u32.wrapping_shl(order)
    } else {
        0
    }
}
