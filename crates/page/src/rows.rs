//! Rows: a CSV file.

/// The rows of a table, with the names of its columns.
pub(crate) struct Rows {
    names: Vec<String>,
    rows: Vec<csv::StringRecord>,
}

impl Rows {
    /// Parses a CSV file with a header line.
    pub(crate) fn read(text: &str) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let mut read = || {
            let names = reader.headers()?.iter().map(str::to_owned).collect();
            let rows = reader.records().collect::<Result<_, _>>()?;
            Ok(Self { names, rows })
        };
        read().map_err(|error: csv::Error| error.to_string())
    }

    pub(crate) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Names of the columns.
    pub(crate) fn names(&self) -> impl Iterator<Item = &str> {
        self.names.iter().map(String::as_str)
    }

    /// The fields of a column as text; `None` if the column is missing.
    pub(crate) fn texts(&self, name: &str) -> Option<Vec<&str>> {
        let place = self.names.iter().position(|column| column == name)?;
        Some(self.rows.iter().map(|row| &row[place]).collect())
    }

    /// The fields of a column as numbers, NaN for empty fields and text; `None` if the column is missing.
    pub(crate) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        let parsed = |text: &str| text.parse().unwrap_or(f64::NAN);
        Some(self.texts(name)?.into_iter().map(parsed).collect())
    }
}
