//! Files and folders: atomic writes, text, JSON, tables, and what the machine offers.

mod atomic;
mod csv;
mod memory;
mod open;
mod text;

pub use atomic::{
    check_output_folder, create_output_folder, remove_files, write_atomically, write_bytes,
    write_json,
};
pub use csv::{CsvField, write_csv};
pub use memory::available_memory;
pub use text::{read_json, read_text};

pub(crate) use atomic::replace;
pub(crate) use open::open;
