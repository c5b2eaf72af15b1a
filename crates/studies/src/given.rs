//! Given surfaces: height maps, triangle meshes and the flat surface, read from files.

mod border;
mod comparable;
mod error;
mod reading;
mod surface;
mod writing;

pub use self::comparable::ComparedSurfaceError;
pub use self::error::{FileProblem, GivenError};
pub use self::reading::ReadHeightMap;
pub(crate) use self::reading::file_name;
pub use self::surface::{GivenShape, GivenSurface, GivenSurfaces};
pub(crate) use self::writing::write_surface;
