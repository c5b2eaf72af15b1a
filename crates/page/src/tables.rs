//! Tables: the CSV files of a folder.

use serde_json::Value;

use crate::error::PageError;
use crate::folder::Folder;
use crate::words;

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

/// A table on the page.
pub(crate) struct Table {
    pub(crate) name: String,
    /// Length of the file in words.
    pub(crate) size: String,
    pub(crate) columns: Vec<Column>,
    pub(crate) csv: String,
}

/// The tables of a folder, in the order of their names.
#[derive(Default)]
pub(crate) struct Tables {
    pub(crate) shown: Vec<Table>,
    /// Names and sizes of tables that are too large for the page.
    pub(crate) left_out: Vec<String>,
}

impl Tables {
    /// The tables of a folder on a page of `share` folders.
    pub(crate) fn of(folder: &Folder, share: usize) -> Result<Self, PageError> {
        let mut tables = Self::default();
        let mut room = MAX_TABLES / share;
        for name in folder.files.iter().filter(|name| name.ends_with(".csv")) {
            let Some(csv) = folder.text(name)? else {
                continue;
            };
            let size = words::size(csv.len());
            if csv.len() > MAX_TABLE.min(room) {
                tables.left_out.push(format!("{name} ({size})"));
                continue;
            }
            room -= csv.len();
            tables.shown.push(Table {
                name: name.clone(),
                size,
                columns: columns(folder, name),
                csv,
            });
        }
        Ok(tables)
    }
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
