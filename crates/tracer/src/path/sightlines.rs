//! Sightlines: lines of sight from points of the surface towards the light, field by field.

use super::segments::{Kept, Segments};
use super::state::{Arrival, PathState, Region};
use crate::geometry::Outlook;
use crate::periodic::Heading;

/// Lines of sight of one round, field by field.
pub(super) struct Sightlines<F> {
    /// Rays towards the light, with what the paths carry that start where these begin.
    pub(super) rays: Segments,
    /// The facets there.
    pub(super) facets: Vec<F>,
    pub(super) outlooks: Vec<Outlook>,
    /// Those that have to be searched.
    pub(super) searched: Vec<u32>,
}

impl<F> Default for Sightlines<F> {
    fn default() -> Self {
        Self::new(Kept::NOTHING)
    }
}

impl<F> Sightlines<F> {
    pub(super) fn new(kept: Kept) -> Self {
        Self {
            rays: Segments::new(kept),
            facets: Vec::new(),
            outlooks: Vec::new(),
            searched: Vec::new(),
        }
    }

    /// Whether none has to be searched.
    pub(super) fn need_no_search(&self) -> bool {
        self.searched.is_empty()
    }

    pub(super) fn clear(&mut self) {
        self.rays.len = 0;
        self.facets.clear();
        self.searched.clear();
    }
}

impl<F: Copy> Sightlines<F> {
    /// Adds the one from light that is at its facet, `state` being what it carries.
    pub(super) fn push(&mut self, at: &Arrival<F>, state: &PathState) {
        let towards_light = turned_round(&at.heading);
        self.rays.push(&towards_light, at.region.half_space, state);
        self.facets.push(at.facet);
    }

    /// The light at the facet where number `i` begins.
    pub(super) fn arrival(&self, i: usize) -> (Arrival<F>, PathState) {
        let at = Arrival {
            region: Region::top(self.rays.half_space(i)),
            heading: turned_round(&self.rays.heading(i)),
            facet: self.facets[i],
        };
        (at, self.rays.state(i))
    }
}

/// The other way.
pub(super) fn turned_round(heading: &Heading) -> Heading {
    Heading {
        direction: -heading.direction,
        ..*heading
    }
}
