//! Ground: what a survey needs of a surface, of flat and of smooth cells alike.

use asperity_optics::Incidence;
use asperity_tracer::{BuildAccelerator, VisibilityRay};

/// A point of the surface with a ray along its normal.
pub(super) struct Point<F> {
    /// The facet, or the smooth cell, that it lies on.
    pub(super) facet: F,
    pub(super) ray: VisibilityRay,
    pub(super) is_sample: bool,
}

/// A surface that is surveyed: where its points are, and how they see.
pub(super) trait Ground: BuildAccelerator {
    /// Cells `[columns, rows]`.
    fn cells(&self) -> [usize; 2];

    /// Point `number`, by two uniform numbers, the larger one first: points `2 i` and `2 i + 1` are in the lower and in the upper
    /// triangle of cell `i`, evenly over the mean plane.
    fn point(&self, number: usize, place: [f64; 2]) -> Point<Self::Facet>;

    /// The first corner of a cell as light from the direction `along`, in tile coordinates of the mean plane, meets it.
    fn sample(&self, cell: [usize; 2], along: [f64; 2]) -> Point<Self::Facet>;

    /// The visibility ray of a point along a direction that it faces and that is not vertical.
    fn ray_along(&self, point: &Point<Self::Facet>, direction: &Incidence) -> VisibilityRay;
}
