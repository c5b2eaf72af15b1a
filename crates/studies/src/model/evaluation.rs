//! Evaluation: the values of a model, as a table, text and JSON.

use std::path::Path;

use asperity_io::{WriteError, shown_path};
use serde_json::Value;

use crate::output::wrapped;
use crate::report::views::Csv;

/// A model that was evaluated.
pub trait Evaluation {
    /// A row per direction or bin.
    fn table(&self) -> Csv<'_>;

    /// `true` if the rows stand for the text unless a file holds them.
    fn is_listed(&self) -> bool {
        false
    }

    /// Writes the rows.
    ///
    /// # Errors
    /// [`WriteError`] if the file cannot be written.
    fn write_csv(&self, path: &Path) -> Result<(), WriteError> {
        self.table().write(path)
    }

    /// The rows as CSV, where they stand for the text.
    fn csv(&self) -> Option<String> {
        self.is_listed().then(|| self.table().text())
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
            let (count, kind) = self.rows();
            text.push_str(&format!("{}: {count} {kind}\n", shown_path(path)));
        }
        wrapped(&text)
    }

    /// Number and kind of rows, as in 1296 bins.
    fn rows(&self) -> (usize, &'static str);

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

/// Name, unit and description of each column of a `table`, under the name of its `file`; nothing without one.
pub(super) fn columns(table: &Csv<'_>, file: Option<&Path>) -> Value {
    let name = file.and_then(Path::file_name);
    let entry = name.map(|name| {
        let name = name.to_string_lossy().into_owned();
        (name, table.description.clone())
    });
    Value::Object(entry.into_iter().collect())
}
