//! Tables: the CSV files of a folder.

use serde_json::Value;

use crate::error::PageError;
use crate::folder::Folder;

/// Length of the largest table that a page holds, in bytes.
const MAX_TABLE: usize = 40_000;
/// Largest length of all tables of a page, in bytes.
const MAX_TABLES: usize = 60_000;

/// A column of a table.
pub(crate) struct Column {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) about: String,
}

/// A table as the page shows it.
pub(crate) struct Table {
    pub(crate) name: String,
    /// Length of the file.
    pub(crate) bytes: usize,
    pub(crate) columns: Vec<Column>,
    /// The file, unless it is too large for the page.
    pub(crate) csv: Option<String>,
}

/// All tables of a folder, in the order of their names. `share`: number of folders on the page.
pub(crate) fn tables(folder: &Folder, share: usize) -> Result<Vec<Table>, PageError> {
    let mut found = Vec::new();
    let mut sum = 0;
    for name in folder.files.iter().filter(|name| name.ends_with(".csv")) {
        let Some(text) = folder.text(name)? else {
            continue;
        };
        let bytes = text.len();
        let fits = bytes <= MAX_TABLE && sum + bytes <= MAX_TABLES / share;
        sum += if fits { bytes } else { 0 };
        found.push(Table {
            columns: columns(folder, name),
            name: name.clone(),
            bytes,
            csv: fits.then_some(text),
        });
    }
    Ok(found)
}

/// Columns of a table, as the summary of the folder, or of its case, describes them.
fn columns(folder: &Folder, name: &str) -> Vec<Column> {
    let (folder_of, file) = name.rsplit_once('/').unwrap_or(("", name));
    let of_case = folder.summary["cases"].as_array().into_iter().flatten();
    let of_case = of_case.filter(|case| case["folder"] == folder_of);
    let mut described = of_case
        .map(|case| &case["summary"]["columns"][file])
        .chain([
            &folder.summary["columns"][name],
            &folder.summary["columns"][format!("{folder_of}/*.csv")],
        ]);
    let described = described.find_map(Value::as_array);
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let columns = described.into_iter().flatten();
    columns
        .map(|column| Column {
            name: text(&column["name"]),
            unit: text(&column["unit"]),
            about: text(&column["description"]),
        })
        .collect()
}
