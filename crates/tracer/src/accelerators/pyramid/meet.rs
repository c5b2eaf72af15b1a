//! Meet: finds the points at which rays pass through the surface in the cells that they hit, in f64.

use super::rays::{Answer, Answers};
use crate::geometry::grid::Grid;
use crate::ray::{Hit, RayColumns};
use crate::vector::Stage;

/// Finds the hits of those `answers` that name cells.
pub(super) struct Meet<'a, S: Grid> {
    pub(super) surface: &'a S,
    pub(super) rays: RayColumns<'a>,
    /// The numbers of those that were searched; answers and hits count these.
    pub(super) which: &'a [u32],
    pub(super) answers: &'a Answers,
    /// Gets the hits that are certain.
    pub(super) hits: &'a mut [Option<Hit<S::Facet>>],
    /// Gets the other rays, but for those that meet nothing.
    pub(super) open: &'a mut Vec<usize>,
}

/// Rays of a block.
const BLOCK: usize = 64;

impl<S: Grid> Stage for Meet<'_, S> {
    #[inline(always)]
    fn run(self) {
        let mut met = [(0, [0; 2]); BLOCK];
        let mut places = [0; BLOCK];
        let mut next = 0;
        while next < self.answers.len() {
            let mut n = 0;
            while n < BLOCK && next < self.answers.len() {
                match self.answers.get(next) {
                    (place, Answer::Cell(cell)) => {
                        (met[n], places[n]) = ((self.which[place], cell), place);
                        self.surface.prefetch(cell);
                        n += 1;
                    }
                    (place, Answer::Doubtful) => self.open.push(place),
                    (_, Answer::Nothing) => {}
                }
                next += 1;
            }
            let mut found = [None; BLOCK];
            let (met, found) = (&met[..n], &mut found[..n]);
            self.surface.pass_cells(self.rays, met, found);
            for (hit, &place) in found.iter().zip(&places) {
                self.hits[place] = *hit;
                if hit.is_none() {
                    self.open.push(place);
                }
            }
        }
    }
}
