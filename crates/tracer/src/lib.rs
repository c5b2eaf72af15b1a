//! Light paths on explicit surfaces.
//!
//! A [`Surface`] is a height field seen as the triangles that are traced: cell `(ix, iy)` split
//! along the diagonal from its corner `(ix, iy)` to `(ix + 1, iy + 1)`; a [`MeshSurface`] is any
//! triangles, also with overhangs. An [`Accelerator`] finds
//! where a ray meets one tile of it; [`border`] carries rays across periodic, mirrored and open
//! borders without copying geometry; [`Tracer`] follows light from interaction to interaction and
//! hands what leaves to a record.
//!
//! # Why no epsilon is needed
//! A ray above the surface can only pass a facet downwards, a ray below only upwards. The
//! intersection test asks for just that: the signed height above the facet falls along the ray and
//! is negative where the ray leaves the facet's footprint. The facet that was just left is never
//! hit again, and since neighbouring facets share the heights of their common edge, no ray slips
//! between them.

mod accelerator;
mod accelerators;
mod beam;
pub mod border;
mod cell;
mod facet_sum;
mod geometry;
mod horizon;
mod mesh;
mod mesh_surface;
mod morton;
mod path;
mod path_settings;
mod ray;
mod relief;
mod sampling;
mod scatter;
mod sight;
mod steepness;
mod substrate;
mod sunbeams;
mod surface;
mod walk;

pub use accelerator::{Accelerator, AcceleratorKind, BuildError, Query};
pub use accelerators::brute_force::BruteForce;
pub use accelerators::flat::Flat;
pub use accelerators::mesh_bvh::MeshBvh;
pub use accelerators::pyramid::{Instructions, Pyramid};
pub use accelerators::tile_bvh::TileBvh;
pub use facet_sum::{sum_over_facets, unshadowed_fluxes};
pub use geometry::{Escape, Geometry, Nearby};
pub use horizon::{Horizon, HorizonError, Horizons};
pub use mesh::{MeshError, TriangleMesh};
pub use mesh_surface::{MeshSurface, MeshSurfaceError, Repairs};
pub use path::{Illumination, Starts, Tracer, Work};
pub use path_settings::{Branching, PathSettings, PathSettingsError};
pub use ray::{HalfSpace, Hit, TileRay};
pub use sampling::Sampling;
pub use sight::{Visibility, VisibilityRay, trace_visibility};
pub use substrate::{BottomShape, TracedLayer, TracedLayerError};
pub use sunbeams::LightBeams;
pub use surface::{Facet, Surface};
pub use walk::{
    BeamContribution, CameraContribution, FlightSearch, PathEnd, PathIntegrator, PathResult,
};
