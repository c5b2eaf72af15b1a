//! Every file format of the project, in and out.
//!
//! [`read_height_map`] and [`write_height_map`] choose the format by the file's ending:
//! OpenEXR, NumPy, Gwyddion Simple Field, ISO 25178-72 (X3P), TIFF, text matrices and files of instruments
//! (read only) and 16-bit PNG (written only); [`HeightMapFormat`] says what each keeps. [`read_mesh`] and [`write_mesh`]
//! do the same for triangle meshes, [`write_csv`] and [`write_json`] for results.
//!
//! Files are written aside and renamed when complete ([`write_atomically`]), so that a name holds
//! either the complete new file or the old one. [`ResultFolder`] does the same for all files of a run.
//! The bytes depend on the data alone: no time, no host, no order of hashing. Sizes in headers are checked first against the real
//! length of the file, so that no header can claim more memory than its file can fill, and every
//! error is one sentence that names the file.
//!
//! ```
//! use asperity_io::{HeightMapFormat, read_height_map, write_height_map};
//! use asperity_surface::{Border, HeightField, LengthUnit, MissingPolicy};
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("wedge.x3p");
//! let wedge = HeightField::new(vec![0.0, 1e-7, 2e-7, 0.0, 1e-7, 2e-7], [2, 3], [1e-6, 2e-6])?
//!     .with_unit(LengthUnit::Metre)
//!     .with_border(Border::Open);
//! write_height_map(&path, &wedge)?;
//!
//! let format = HeightMapFormat::from_path(&path).ok_or("unknown ending")?;
//! let read = read_height_map(&path)?.into_height_field(MissingPolicy::Refuse, Border::Mirrored)?;
//! assert_eq!(read, wedge);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod encoding;
mod endings;
mod error;
mod files;
mod formats;
mod height_maps;
mod image_layers;
mod limits;
mod materials;
mod meshes;
mod netcdf;
mod number_table;
mod part_names;
mod pictures;
mod shown;
mod tensors;
mod text_lines;

#[cfg(test)]
mod damage_tests;

pub use build::{Build, RESULTS_EPOCH};
pub use endings::{SurfaceFormat, check_ending};
pub use error::{ReadError, ReadProblem, ResultFolderError, WriteError, WriteProblem};
pub use files::{
    CsvField, FolderLock, Journal, JournalRecords, ResultFolder, available_memory,
    check_output_file, check_output_folder, create_output_folder, csv_text, exists, is_same_file,
    names_in, read_bytes, read_journal, read_text, remove_temporary_files, write_atomically,
    write_bytes, write_csv, write_json,
};
pub use formats::{HeightMapFormat, MeshFormat};
pub use height_maps::{MemoryHeightMap, read_height_map, write_array, write_height_map};
pub use image_layers::{ImageLayer, write_image_layers};
pub use materials::{MaterialLookupError, MaterialRecord, material, materials, names_file};
pub use meshes::{MeshData, MeshView, read_mesh, write_mesh};
pub use netcdf::{NetCdf, NetCdfValues, NetCdfVariable};
pub use number_table::{NumberTable, read_number_table};
pub use pictures::{Picture, PictureFormat, Pixels, write_picture_exr, write_picture_png};
pub use shown::{json_text, printable, shown, shown_path, within};
pub use tensors::{Tensor, tensor_file};
