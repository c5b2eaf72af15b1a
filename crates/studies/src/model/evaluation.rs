//! Evaluation: the values of a model, as a table, text and JSON.

use std::path::Path;

use asperity_io::WriteError;
use serde_json::Value;

use crate::output::{Table, wrapped};

/// A model that was evaluated.
pub trait Evaluation {
    /// Writes a row per direction or bin.
    ///
    /// # Errors
    /// [`WriteError`] if the file cannot be written.
    fn write_csv(&self, path: &Path) -> Result<(), WriteError>;

    /// The rows as CSV, where they stand for the text unless a file holds them.
    fn csv(&self) -> Option<String> {
        None
    }

    /// Notes as comments, and the rows as CSV, where these stand for the text.
    fn commented_csv(&self) -> Option<String> {
        let notes = self.notes().iter().map(|note| format!("# {note}\n"));
        Some(notes.collect::<String>() + &self.csv()?)
    }

    /// Description, notes and energies, with the `file` that holds the rows.
    fn report(&self, file: Option<&Path>) -> String {
        let notes = self.notes().iter().map(|note| format!("{note}\n"));
        let notes: String = notes.collect();
        let mut text = format!("{}\n{notes}{}", self.description(), self.text());
        if let Some(path) = file {
            text.push_str(&format!("{}: {}\n", path.display(), self.rows()));
        }
        wrapped(&text)
    }

    /// Number and kind of rows, as in `1296 bins`.
    fn rows(&self) -> String;

    /// Notes on the values, one sentence each.
    fn notes(&self) -> &[String] {
        &[]
    }

    /// Light that the model describes.
    fn description(&self) -> &'static str;

    /// Its energies by bins, as text; nothing of single directions.
    fn text(&self) -> String {
        String::new()
    }

    /// The model and its energies by bins as JSON, with the columns of the table under the name of its `file`;
    /// nothing of single directions.
    fn summary(&self, _file: Option<&Path>) -> Value {
        Value::Null
    }
}

/// Name, unit and description of each column of a table, under the name of its `file`; nothing without one.
pub(super) fn columns<R>(table: &Table<'_, R>, file: Option<&Path>) -> Value {
    let name = file.and_then(Path::file_name);
    let entry = name.map(|name| (name.to_string_lossy().into_owned(), table.description()));
    Value::Object(entry.into_iter().collect())
}
