//! Recipes: descriptions of random surfaces, and the record of how one was drawn.

mod drawn_moments;
mod height_distribution;
mod height_table;
mod heights;
mod johnson;
mod provenance;
mod structured;
mod student;
mod surface_recipe;

pub(crate) use self::drawn_moments::DrawnMoments;
pub use self::height_distribution::HeightDistribution;
pub use self::height_table::{HeightTable, HeightTableError};
pub use self::heights::TransformedHeights;
pub use self::johnson::{Johnson, JohnsonError, JohnsonFamily};
pub use self::provenance::Provenance;
pub use self::structured::{MeasuredStructure, StructuredSurface};
pub(crate) use self::student::FLOOR;
pub use self::student::StudentSlopes;
pub use self::surface_recipe::{ErodedSurface, SurfaceRecipe};
