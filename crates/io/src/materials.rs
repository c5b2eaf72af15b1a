//! Optical constants of materials: the embedded ones by name, and files of users.
//!
//! Embedded are records of the refractiveindex.info database, which is in the public domain (CC0 1.0), one file per material in
//! `crates/io/materials/`. Each holds its name, aliases, the record that it comes from, references and data.

mod csv;
mod embedded;
mod material_record;
mod record;

use std::path::Path;

use crate::error::{ReadError, ReadProblem};
use crate::files::open;
use crate::limits::guarded;
use crate::shown::shown;

pub use material_record::MaterialRecord;

/// Most bytes of a file of optical constants; the largest record of the database has under 1 MB.
const MAX_BYTES: u64 = 16 << 20;

/// Error of a lookup of a material by name or file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialLookupError {
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// No embedded material has this name.
    #[error("unknown material `{}`; a name from `asperity materials` or a file .yml, .yaml or .csv is allowed", shown(.0))]
    Unknown(String),
}

/// All embedded materials, in the order of the list.
#[must_use]
pub fn materials() -> &'static [MaterialRecord] {
    embedded::all()
}

/// The material of a name or a file.
///
/// A word with a path separator or one of the endings `.yml`, `.yaml` and `.csv` names a file, any other an embedded material. Case,
/// spaces and punctuation of names do not count. Files `.yml` and `.yaml` are records of refractiveindex.info; files `.csv` have the columns
/// `wavelength`, with its unit in the header, `n`, and, if known, `k`.
///
/// # Examples
/// ```
/// let gold = asperity_io::material("gold")?;
/// let index = gold.constants.at(0.55)?;
/// assert!((index.n - 0.424149).abs() < 1e-6);
/// assert!((index.k.unwrap() - 2.472051).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MaterialLookupError`] if no material has this name, or the file cannot be read or is no such file.
pub fn material(name_or_path: &str) -> Result<MaterialRecord, MaterialLookupError> {
    if names_file(name_or_path) {
        return Ok(read_material(Path::new(name_or_path))?);
    }
    let wanted = plain(name_or_path);
    let found = materials()
        .iter()
        .find(|material| names(material).any(|name| plain(name) == wanted));
    let unknown = || MaterialLookupError::Unknown(name_or_path.to_owned());
    found.cloned().ok_or_else(unknown)
}

/// Returns `true` if a word names a file of optical constants, not an embedded material.
#[must_use]
pub fn names_file(word: &str) -> bool {
    word.contains(std::path::is_separator) || format_of(Path::new(word)).is_some()
}

/// Format of a file of optical constants.
#[derive(Clone, Copy)]
enum Format {
    Record,
    Csv,
}

fn format_of(path: &Path) -> Option<Format> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    match ending.as_str() {
        "yml" | "yaml" => Some(Format::Record),
        "csv" => Some(Format::Csv),
        _ => None,
    }
}

fn read_material(path: &Path) -> Result<MaterialRecord, ReadError> {
    let format = format_of(path).ok_or_else(|| {
        let allowed = "files of optical constants end in .yml, .yaml or .csv".to_owned();
        ReadProblem::ending(path, allowed).at(path)
    })?;
    let name = match format {
        Format::Record => "record of refractiveindex.info",
        Format::Csv => "table of optical constants",
    };
    let read = || {
        let length = open(path)?.1;
        if length > MAX_BYTES {
            return Err(ReadProblem::malformed(format_args!(
                "it has {length} bytes; at most {MAX_BYTES} are allowed"
            )));
        }
        let text = crate::files::read_text(path).map_err(|error| error.problem)?;
        material_of(&text, format)
    };
    let mut material = read().map_err(|problem| problem.in_format(path, name))?;
    if material.name.is_empty() {
        let stem = path.file_stem().unwrap_or_default();
        material.name = stem.to_string_lossy().into_owned();
    }
    Ok(material)
}

fn material_of(text: &str, format: Format) -> Result<MaterialRecord, ReadProblem> {
    let text = text.trim_start_matches('\u{feff}');
    let is_control = |c: char| c.is_control() && !matches!(c, '\n' | '\r' | '\t');
    if text.contains(is_control) {
        let what = "it is not text: it holds control characters";
        return Err(ReadProblem::unsupported(what));
    }
    match format {
        Format::Record => guarded(|| record::parse(text))
            .unwrap_or_else(|| Err(ReadProblem::malformed("its content is damaged"))),
        Format::Csv => csv::parse(text),
    }
}

/// Name and aliases of a material.
fn names(material: &MaterialRecord) -> impl Iterator<Item = &str> {
    let aliases = material.aliases.iter().map(String::as_str);
    std::iter::once(material.name.as_str()).chain(aliases)
}

/// A name without case, spaces and punctuation.
fn plain(name: &str) -> String {
    let kept = name.chars().filter(|c| c.is_alphanumeric());
    kept.flat_map(char::to_lowercase).collect()
}

#[cfg(test)]
mod tests;
