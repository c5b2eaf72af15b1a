//! Branches: makes of all light that facets have scattered the segments that leave them, in place.

use super::scatter::ScatteredLight;
use super::segments::{Segments, copy_column};
use crate::vector::Stage;

/// Makes of each segment that has arrived the reflected or the transmitted one, picked by their shares.
pub(super) struct PickBranches<'a> {
    pub(super) at: &'a mut Segments,
    pub(super) scattered: &'a ScatteredLight,
    /// Random numbers of each.
    pub(super) pairs: &'a [[f64; 2]],
}

impl Stage for PickBranches<'_> {
    #[inline(always)]
    fn run(self) {
        let n = self.at.len;
        let ScatteredLight {
            reflected, wo, wt, ..
        } = self.scattered;
        let (reflected, pairs) = (&reflected[..n], &self.pairs[..n]);
        for axis in 0..3 {
            let (wo, wt) = (&wo[axis][..n], &wt[axis][..n]);
            let direction = &mut self.at.direction[axis][..n];
            for i in 0..n {
                let is_reflected = pairs[i][0] < reflected[i];
                direction[i] = if is_reflected { wo[i] } else { wt[i] };
            }
        }
        let [reflected_light, transmitted_light] = &self.scattered.light;
        let columns = reflected_light.iter().zip(transmitted_light);
        for (number, (reflected_light, transmitted_light)) in self.at.light.iter_mut().zip(columns)
        {
            let number = &mut number[..n];
            let (reflected_light, transmitted_light) =
                (&reflected_light[..n], &transmitted_light[..n]);
            for i in 0..n {
                let is_reflected = pairs[i][0] < reflected[i];
                number[i] = if is_reflected {
                    reflected_light[i]
                } else {
                    transmitted_light[i]
                };
            }
        }
        let (side, order) = (&mut self.at.side[..n], &mut self.at.order[..n]);
        let events = &mut self.at.events[..n];
        for i in 0..n {
            let is_reflected = pairs[i][0] < reflected[i];
            let bit = transmission_bit(order[i]);
            events[i] |= if is_reflected { 0 } else { bit };
            side[i] = if is_reflected { side[i] } else { -side[i] };
            order[i] += 1;
        }
    }
}

/// Makes of each segment that has arrived the reflected one, and adds those that are transmitted.
pub(super) struct SplitBranches<'a> {
    pub(super) at: &'a mut Segments,
    /// Directions, and the flux of each branch.
    pub(super) scattered: &'a ScatteredLight,
    /// Numbers of the segments of which light is transmitted.
    pub(super) transmitted: &'a [u32],
}

impl Stage for SplitBranches<'_> {
    #[inline(always)]
    fn run(self) {
        let Self {
            at,
            scattered,
            transmitted: which,
        } = self;
        let n = at.len;
        at.copy_paths(which);
        let end = at.len;
        for axis in 0..3 {
            let (reflected, transmitted) = at.direction[axis][..end].split_at_mut(n);
            reflected.copy_from_slice(&scattered.wo[axis][..n]);
            copy_column(transmitted, &scattered.wt[axis][..n], which);
        }
        let [reflected_light, transmitted_light] = &scattered.light;
        let columns = reflected_light.iter().zip(transmitted_light);
        for (number, (reflected_light, transmitted_light)) in at.light.iter_mut().zip(columns) {
            let (reflected, transmitted) = number[..end].split_at_mut(n);
            reflected.copy_from_slice(&reflected_light[..n]);
            copy_column(transmitted, &transmitted_light[..n], which);
        }
        let (fluxes, transmitted) = at.flux[..end].split_at_mut(n);
        fluxes.copy_from_slice(&scattered.reflected[..n]);
        copy_column(transmitted, &scattered.transmitted[..n], which);
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

/// What is set in [`asperity_tally::EventPath::code`] where interaction number `order` transmits.
#[inline(always)]
fn transmission_bit(order: u32) -> u32 {
    // A shift by 32 or more is by its low bits.
    if order < 32 {
        1_u32.wrapping_shl(order)
    } else {
        0
    }
}
