//! Light paths on explicit surfaces.
//!
//! A [`Surface`] is a height field seen as the triangles that are traced: cell `(ix, iy)` split
//! along the diagonal from its corner `(ix, iy)` to `(ix + 1, iy + 1)`; a [`SmoothSurface`] is a bicubic B-spline, whose curved
//! cells are traced as they are; a [`MeshSurface`] is any triangles, also with overhangs. An [`Accelerator`] finds where a ray meets one tile of it, [`traverse`] takes
//! rays across periodic, mirrored and open borders without copying geometry, and a [`Tracer`] follows light from
//! interaction to interaction and hands what leaves to a tally.
//!
//! # Where to find what
//! | folder | what |
//! |---|---|
//! | `reference` | one path at a time, on one page: start reading here |
//! | `geometry` | input: height fields and meshes as triangles |
//! | `accelerators` | search: where a ray meets one tile |
//! | `periodic` | search: from tile to tile |
//! | `interaction` | physics: scattering at a facet, the layer below a surface |
//! | `path` | engine: many paths at a time |
//! | `sampling` | where paths start |
//! | `visibility` | visibility rays, horizons, light beams |
//! | `engine` | the seam: what a second engine implements |
//!
//! # Why no epsilon is needed
//! A ray above the surface can only pass a facet downwards, a ray below only upwards. The
//! intersection test checks just that: the signed height above the facet falls along the ray and
//! is negative where the ray leaves the facet's footprint. The facet that was just left is never
//! hit again, and since neighbouring facets share the heights of their common edge, no ray slips
//! between them. Over a curved cell the signed height is a polynomial of degree six, and its first change of
//! sign counts; the root at which a ray begins is divided out.

mod accelerators;
mod engine;
mod geometry;
mod interaction;
mod path;
mod periodic;
mod random;
mod ray;
mod reference;
mod sampling;
mod settings;
mod vector;
mod visibility;

pub use accelerators::accelerator::{Accelerator, BuildError, SearchedSurface};
pub use accelerators::brute_force::BruteForce;
pub use accelerators::chooser::BuildAccelerator;
pub use accelerators::flat::Flat;
pub use accelerators::kind::AcceleratorKind;
pub use accelerators::mesh_bvh::MeshBvh;
pub use accelerators::pyramid::{Pyramid, PyramidTable};
pub use engine::{BatchTracer, CpuEngine, Engine, PreparedSurface, TracedPaths};
pub use geometry::export::{MeshError, TriangleMesh};
pub use geometry::height_field::{Facet, Surface};
pub use geometry::horizon_bounds::HorizonTable;
pub use geometry::mesh::{MeshSurface, MeshSurfaceError, Repairs};
pub use geometry::shape::Shape;
pub use geometry::smooth::{SmoothCell, SmoothSurface};
pub use geometry::{CullingClass, Escape, Geometry, Nearby, Triangles};
pub use interaction::stack::{DEFAULT_MAX_SCATTERINGS, TracedLayerError, TracedStack};
pub use interaction::unshadowed::{
    sum_over_facets, sum_over_facets_of_conductors, unshadowed_fluxes,
};
pub use path::{
    AbsorbedCells, Beam, GivenRays, Illumination, MAX_CONDUCTORS, Starts, Tracer, Window, Work,
};
pub use periodic::{
    Heading, MAX_TILES, MAX_TILES_AT_45_DEGREES, TraversalEnd, TraversalResult, can_traverse,
    tiles_crossed, traverse,
};
pub use random::PathStream;
pub use ray::{HalfSpace, Hit, Query, RayBatch, RayColumns, TileRay};
pub use reference::{
    CameraContribution, FlightSearch, PathEnd, PathIntegrator, PathResult, SunContribution,
    Sunlight,
};
pub use sampling::{BatchedRays, Sampling};
pub use settings::{Branching, PathSettings, PathSettingsError, Polarisation};
pub use vector::Instructions;
pub use visibility::horizon::{Horizon, HorizonError, Horizons};
pub use visibility::light_beams::LightBeams;
pub use visibility::rays::{Visibility, VisibilityRay, trace_visibility};
