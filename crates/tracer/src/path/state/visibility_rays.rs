//! Visibility rays: rays from points of the surface towards the light, field by field.

use crate::geometry::CullingClass;
use crate::path::state::arrivals::Arrivals;
use crate::path::state::path_state::{Arrival, PathState, Region};
use crate::path::state::segments::Kept;
use crate::periodic::Heading;

/// Visibility rays of one round, field by field.
pub(crate) struct VisibilityRays<F> {
    /// Paths at the points where they start unless these are shadowed, with rays towards the light. The flux is zero where the
    /// facet faces away from it.
    pub(crate) from: Arrivals<F>,
    pub(crate) classes: Vec<CullingClass>,
    /// Rays that have to be searched.
    pub(crate) searched: Vec<u32>,
    /// Rays that reach the light.
    pub(crate) visible: Vec<u32>,
}

impl<F: Copy> Default for VisibilityRays<F> {
    fn default() -> Self {
        Self::new(Kept::NOTHING)
    }
}

impl<F: Copy> VisibilityRays<F> {
    pub(crate) fn new(kept: Kept) -> Self {
        Self {
            from: Arrivals::new(kept),
            classes: Vec::new(),
            searched: Vec::new(),
            visible: Vec::new(),
        }
    }

    /// Returns `true` if none has to be searched.
    pub(crate) fn need_no_search(&self) -> bool {
        self.searched.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.from.clear();
        self.searched.clear();
    }

    /// The light at the facet where number `i` begins.
    pub(crate) fn arrival(&self, i: usize) -> (Arrival<F>, PathState) {
        let rays = &self.from.at;
        let at = Arrival {
            region: Region::top(rays.half_space(i)),
            heading: reversed(&rays.heading(i)),
            facet: self.from.facets[i],
        };
        (at, rays.state(i))
    }
}

/// A heading in the opposite direction.
pub(crate) fn reversed(heading: &Heading) -> Heading {
    Heading {
        direction: -heading.direction,
        ..*heading
    }
}
