//! Sightlines: lines of sight from points of the surface towards the light, field by field.

use super::arrivals::{Arrivals, Take};
use super::segments::Kept;
use super::state::{Arrival, PathState, Region};
use crate::geometry::Outlook;
use crate::periodic::Heading;
use crate::vector::Stage;

/// Lines of sight of one round, field by field.
pub(super) struct Sightlines<F> {
    /// Paths at the points where they start if these are lit, with rays towards the light; the flux is zero where the facet faces
    /// away from it.
    pub(super) from: Arrivals<F>,
    pub(super) outlooks: Vec<Outlook>,
    /// Those that have to be searched.
    pub(super) searched: Vec<u32>,
    /// Those that see the light.
    pub(super) lit: Vec<u32>,
}

impl<F: Copy> Default for Sightlines<F> {
    fn default() -> Self {
        Self::new(Kept::NOTHING)
    }
}

impl<F: Copy> Sightlines<F> {
    pub(super) fn new(kept: Kept) -> Self {
        Self {
            from: Arrivals::new(kept),
            outlooks: Vec::new(),
            searched: Vec::new(),
            lit: Vec::new(),
        }
    }

    /// Whether none has to be searched.
    pub(super) fn need_no_search(&self) -> bool {
        self.searched.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.from.clear();
        self.searched.clear();
    }

    /// The light at the facet where number `i` begins.
    pub(super) fn arrival(&self, i: usize) -> (Arrival<F>, PathState) {
        let rays = &self.from.at;
        let at = Arrival {
            region: Region::top(rays.half_space(i)),
            heading: turned_round(&rays.heading(i)),
            facet: self.from.facets[i],
        };
        (at, rays.state(i))
    }
}

/// Starts the paths whose visibility rays are not blocked.
pub(super) struct TakeLit<'a, F> {
    pub(super) lines: &'a Sightlines<F>,
    pub(super) arrivals: &'a mut Arrivals<F>,
}

impl<F: Copy> Stage for TakeLit<'_, F> {
    #[inline(always)]
    fn run(self) {
        let Sightlines { from, lit, .. } = self.lines;
        let first = self.arrivals.len();
        Take {
            segments: &from.at,
            which: lit,
            arrivals: self.arrivals,
        }
        .run();
        let Arrivals { at, facets, ts, .. } = self.arrivals;
        facets.extend(lit.iter().map(|&i| from.facets[i as usize]));
        ts.resize(facets.len(), 0.0);
        // The light comes the other way
        for column in &mut at.direction {
            for d in &mut column[first..at.len] {
                *d = -*d;
            }
        }
    }
}

/// The other way.
pub(super) fn turned_round(heading: &Heading) -> Heading {
    Heading {
        direction: -heading.direction,
        ..*heading
    }
}
