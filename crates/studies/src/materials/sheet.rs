//! Sheet of one material: its source, ranges and constants as text, JSON, CSV and a figure.

use std::path::Path;

use asperity_io::MaterialRecord;
use asperity_optics::DispersionCurve;
use asperity_simulate::short;
use serde_json::{Value, json};

use super::constants::{Row, range_nm};
use super::figure::figure;
use crate::output::{Column, Table, aligned, folded, note_lines};
use crate::report::error::ReportError;
use crate::report::figures::write_by_ending;

/// A material with its optical constants: at the wavelengths that are shown, and at all points of its data.
#[derive(Clone, Debug)]
pub struct MaterialSheet {
    pub(super) record: MaterialRecord,
    pub(super) rows: Vec<Row>,
    pub(super) points: Vec<Row>,
    /// `true` if the wavelengths of `rows` were given.
    pub(super) is_given: bool,
}

impl MaterialSheet {
    /// Name, source and range of the material, and a table of its constants, as text.
    #[must_use]
    pub fn text(&self) -> String {
        let record = &self.record;
        let range = |curve: &DispersionCurve| {
            let [first, last] = range_nm(curve).map(short);
            format!("{first} to {last} nm")
        };
        let (n, k) = (record.constants.n(), record.constants.k());
        let facts = [
            ("name", record.name.clone()),
            ("other names", record.aliases.join(", ")),
            ("record", record.record.clone()),
            ("source", record.source.replace('\n', " ")),
            ("DOI", record.doi.clone().unwrap_or_default()),
            ("n", range(n)),
            ("k", k.map_or_else(|| "unknown".to_owned(), range)),
        ];
        let facts = facts.into_iter().filter(|(_, value)| !value.is_empty());
        let facts = facts.map(|(name, value)| vec![name.to_owned(), value]);
        let facts = aligned(&folded(facts.collect()), 1);
        let unknown = self.rows.iter().filter(|row| row.k.is_none()).count();
        let note = (unknown > 0).then(|| {
            let count = self.rows.len();
            format!("k is unknown at {unknown} of {count} wavelengths, which is not zero")
        });
        format!(
            "{facts}\n{}{}",
            table().text(&self.rows),
            note_lines(note.as_ref())
        )
    }

    /// JSON form of what the text states.
    #[must_use]
    pub fn json(&self) -> Value {
        let record = &self.record;
        json!({
            "name": record.name,
            "aliases": record.aliases,
            "record": record.record,
            "source": record.source,
            "doi": record.doi,
            "n_range_nm": range_nm(record.constants.n()),
            "k_range_nm": record.constants.k().map(range_nm),
            "columns": table().description(),
            "constants": table().json(&self.rows),
        })
    }

    /// Writes the constants as CSV, at the given wavelengths or all points of the data. Of a material without any `k` there it has no
    /// column of `k`.
    ///
    /// # Errors
    /// [`ReportError`] if the file cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<(), ReportError> {
        let rows = match self.is_given {
            true => &self.rows,
            false => &self.points,
        };
        let table = match rows.iter().any(|row| row.k.is_some()) {
            true => table(),
            false => table().select(&["wavelength_nm", "n"]),
        };
        Ok(table.with_rows(rows).write(path)?)
    }

    /// Draws `n` and `k` over all wavelengths of the data, as SVG or PNG by the ending of `path`.
    ///
    /// # Errors
    /// [`ReportError`] if the file cannot be written or the figure drawn.
    pub fn draw(&self, path: &Path) -> Result<(), ReportError> {
        write_by_ending(path, &figure(&self.record, &self.points).draw()?)
    }
}

/// The columns of optical constants.
fn table() -> Table<'static, Row> {
    Table::new()
        .column(
            Column::new("wavelength_nm", "wavelength in vacuum", |row: &Row| {
                row.wavelength_nm
            })
            .unit("nm"),
        )
        .column(Column::new("n", "refractive index", |row: &Row| row.n))
        .column(Column::new("k", "extinction coefficient", |row: &Row| {
            row.k
        }))
}
