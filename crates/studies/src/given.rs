//! Given surfaces: height maps, triangle meshes and the flat surface, read from files.

mod border;
mod error;
mod reading;
mod surface;
mod writing;

pub use self::error::{FileProblem, GivenError};
pub use self::reading::{ReadHeightMap, file_name};
pub use self::surface::{GivenShape, GivenSurface, GivenSurfaces};
pub use self::writing::{check_height_map_ending, write_surface};
