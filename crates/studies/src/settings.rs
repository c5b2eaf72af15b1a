//! Settings: one definition per setting, from which everything else follows.
//!
//! A [`Setting`] says the section and key in a configuration file, the flag on the command line, the kind of value,
//! unit, default, allowed range and help text, and which commands have it. The tables in `definitions/` are the only
//! place where these stand. From them follow the flags and their help, the keys of a configuration, the error
//! sentences, and the reference page `docs/reference/settings/`.
//!
//! A [`Document`] holds the values of one run in three layers: defaults, then the file, then the flags. Each value
//! keeps where it was given, so that an error can name it. [`Document::read`] turns the document into a typed
//! configuration.
//!
//! To add a setting: add one entry to a table in `definitions/` and one field of the same name to the typed
//! configuration that uses it.

mod command;
mod definitions;
mod document;
mod entry;
mod error;
mod file;
pub(crate) mod film_text;
mod flags;
mod group;
mod input_files;
mod kind;
pub(crate) mod layer_text;
mod length;
pub(crate) mod number;
mod presets;
mod range;
mod reference;
mod refusals;
mod repeat;
mod request;
mod setting;
pub(crate) mod spread_text;
mod suggestion;
mod value_text;

pub use command::{Command, Commands};
pub use definitions::{SECTIONS, Section, settings_of};
pub use document::{Document, defaults};
pub use error::{Given, Place, SettingError};
pub use flags::commands_with_flag;
pub(crate) use input_files::LIKE;
pub use kind::{Choice, Kind};
pub use length::Length;
pub use range::Range;
pub use reference::{ReferencePage, reference_pages};
pub use setting::{Arity, Flag, Setting};
pub use suggestion::{known_names, roughness_hint, suggestion};

#[cfg(test)]
mod tests;
