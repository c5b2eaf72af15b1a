//! The files of cells, by which a map goes on where it was left.

use std::path::{Path, PathBuf};

use asperity_io::{read_text, write_json};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::MapError;
use super::cell::CellResults;
use super::config::CellPlan;

/// Folder of the files within that of the map.
const FOLDER: &str = "cells";

/// What files of cells look like; another number is another form.
const SCHEMA: u64 = 1;

/// A file of a cell.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct CellFile {
    schema: u64,
    version: String,
    case: String,
    config: Value,
    results: CellResults,
    /// Of the results, so that a number that was changed is noticed.
    checksum: String,
}

/// What is there of a cell.
pub(super) enum Stored {
    /// Nothing.
    Missing,
    /// A file that is none, or whose results are not those that were written: why.
    Damaged(String),
    /// Its results.
    Results(CellResults),
}

/// The file of a cell.
pub(super) fn path_of(folder: &Path, cell: &CellPlan) -> PathBuf {
    folder
        .join(FOLDER)
        .join(format!("{}.json", cell.case.folder()))
}

/// The folder of all files.
pub(super) fn folder_of(folder: &Path) -> PathBuf {
    folder.join(FOLDER)
}

/// Writes the results of a cell; the file is complete or not there.
pub(super) fn write(folder: &Path, cell: &CellPlan, results: &CellResults) -> Result<(), MapError> {
    let file = CellFile {
        schema: SCHEMA,
        version: env!("CARGO_PKG_VERSION").to_owned(),
        case: cell.case.to_string(),
        config: json!(cell.config),
        results: results.clone(),
        checksum: checksum(results),
    };
    Ok(write_json(path_of(folder, cell), &file)?)
}

/// Reads what is there of a cell.
///
/// # Errors
/// [`MapError::Foreign`] for the whole cell of another configuration or version, which is not ours to
/// overwrite; [`MapError::Read`] if a file cannot be read at all.
pub(super) fn read(folder: &Path, cell: &CellPlan) -> Result<Stored, MapError> {
    let path = path_of(folder, cell);
    if std::fs::symlink_metadata(&path).is_err() {
        return Ok(Stored::Missing);
    }
    let text = read_text(&path)?;
    let foreign = |what: String| {
        Err(MapError::Foreign {
            path: path.clone(),
            what,
        })
    };
    let value: Value = match serde_json::from_str(&text) {
        Ok(value) => value,
        Err(error) => return Ok(Stored::Damaged(error.to_string())),
    };
    // Another form or version may have other fields, so it is asked for these first.
    if let Some(schema) = value.get("schema").and_then(Value::as_u64)
        && schema != SCHEMA
    {
        return foreign(format!("schema {schema}, this program writes {SCHEMA}"));
    }
    if let Some(version) = value.get("version").and_then(Value::as_str)
        && version != env!("CARGO_PKG_VERSION")
    {
        let ours = env!("CARGO_PKG_VERSION");
        return foreign(format!("version {version}, this is {ours}"));
    }
    let file: CellFile = match serde_json::from_value(value) {
        Ok(file) => file,
        Err(error) => return Ok(Stored::Damaged(error.to_string())),
    };
    if checksum(&file.results) != file.checksum || !file.results.is_sound() {
        return Ok(Stored::Damaged(
            "its results are not those that were written".to_owned(),
        ));
    }
    if let Some((key, found, expected)) = first_difference(&file.config, &json!(cell.config), "") {
        return foreign(format!("{key} {found} in place of {expected}"));
    }
    let names = file.results.models.iter().map(|model| &model.name);
    if !names.eq(&cell.config.compare.models) {
        return Ok(Stored::Damaged(
            "it has other models than it says".to_owned(),
        ));
    }
    Ok(Stored::Results(file.results))
}

/// FNV-1a of 64 bits over the results as they are written.
fn checksum(results: &CellResults) -> String {
    let text = json!(results).to_string();
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

/// The first key whose value differs, with both values.
fn first_difference(
    found: &Value,
    expected: &Value,
    key: &str,
) -> Option<(String, String, String)> {
    if found == expected {
        return None;
    }
    if let (Value::Object(a), Value::Object(b)) = (found, expected) {
        let mut names: Vec<&String> = a.keys().chain(b.keys()).collect();
        names.sort();
        return names.into_iter().find_map(|name| {
            let key = if key.is_empty() {
                name.clone()
            } else {
                format!("{key}.{name}")
            };
            let of = |map: &serde_json::Map<String, Value>| {
                map.get(name).cloned().unwrap_or(Value::Null)
            };
            first_difference(&of(a), &of(b), &key)
        });
    }
    Some((key.to_owned(), found.to_string(), expected.to_string()))
}
