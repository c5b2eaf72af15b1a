//! Files and folders: atomic writes, text, JSON, tables, and folders of results.

mod atomic;
mod csv;
mod fingerprint;
mod folder;
mod journal;
mod lock;
mod made_folders;
mod manifest;
mod memory;
mod mounts;
mod open;
mod parts;
mod result_folder;
mod same_file;
mod text;

pub use atomic::{write_atomically, write_bytes, write_json};
pub use csv::{CsvField, csv_text, write_csv};
pub use folder::{check_output_file, check_output_folder, create_output_folder, exists, names_in};
pub use journal::{Journal, JournalRecords, read_journal};
pub use lock::FolderLock;
pub use memory::available_memory;
pub use parts::remove_temporary_files;
pub use result_folder::ResultFolder;
pub use same_file::is_same_file;
#[cfg(test)]
pub(crate) use text::read_json;
pub use text::{read_bytes, read_text};

pub(crate) use atomic::{replace, replace_alone};
pub(crate) use fingerprint::hex;
pub(crate) use open::open;
