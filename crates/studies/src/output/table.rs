//! Tables: one definition of columns, rendered as CSV, as aligned text and as JSON.
//!
//! A [`Column`] holds its name, unit, description, text heading and format, and the function that takes its
//! value from a row. A [`Table`] is a list of columns over rows of one type. Files keep every digit; text is
//! rounded for people and broken into lines of at most 80 characters.

use asperity_surface::LengthUnit;
use std::borrow::{Borrow, Cow};

use asperity_io::CsvField;
use asperity_simulate::short;
use asperity_tally::Estimate;
use serde_json::{Map, Value, json};

use super::align::{aligned, folded};
use super::basis::EstimateWithLimit;

/// A value of a table.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    /// Missing.
    Empty,
    /// A real number.
    Number(f64),
    /// A count.
    Count(u64),
    /// Text.
    Text(Cow<'static, str>),
    /// A mean and its standard error.
    Estimate(EstimateWithLimit),
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u64> for Cell {
    fn from(value: u64) -> Self {
        Self::Count(value)
    }
}

impl From<usize> for Cell {
    fn from(value: usize) -> Self {
        Self::Count(value as u64)
    }
}

impl From<&'static str> for Cell {
    fn from(value: &'static str) -> Self {
        Self::Text(value.into())
    }
}

impl From<String> for Cell {
    fn from(value: String) -> Self {
        Self::Text(value.into())
    }
}

impl From<Estimate> for Cell {
    fn from(value: Estimate) -> Self {
        Self::Estimate(value.into())
    }
}

impl From<EstimateWithLimit> for Cell {
    fn from(value: EstimateWithLimit) -> Self {
        Self::Estimate(value)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Format of a real number in text; files keep every digit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Format {
    /// Six significant digits without trailing zeros.
    Short,
    /// A number of decimal places.
    Fixed(usize),
}

/// Contents of a column of a file: a value, or a mean followed by its standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Value,
    Estimate,
}

/// One column of a table over rows of type `R`.
pub(crate) struct Column<'a, R> {
    name: Cow<'a, str>,
    kind: Kind,
    unit: Cow<'a, str>,
    about: Cow<'a, str>,
    heading: Option<Cow<'a, str>>,
    format: Format,
    drops_if_empty: bool,
    value: Box<dyn Fn(&R) -> Cell + 'a>,
}

impl<'a, R> Column<'a, R> {
    /// A column of values. `name`: header in CSV and key in JSON; `about`: its description.
    pub(crate) fn new<C: Into<Cell>>(
        name: impl Into<Cow<'a, str>>,
        about: impl Into<Cow<'a, str>>,
        value: impl Fn(&R) -> C + 'a,
    ) -> Self {
        Self {
            name: name.into(),
            kind: Kind::Value,
            unit: Cow::Borrowed(""),
            about: about.into(),
            heading: None,
            format: Format::Short,
            drops_if_empty: false,
            value: Box::new(move |row| value(row).into()),
        }
    }

    /// A column of means with standard errors, which take the columns `name` and `name_se` of a CSV file.
    pub(crate) fn estimate<E: Into<Cell>>(
        name: impl Into<Cow<'a, str>>,
        about: impl Into<Cow<'a, str>>,
        value: impl Fn(&R) -> Option<E> + 'a,
    ) -> Self {
        Self {
            kind: Kind::Estimate,
            ..Self::new(name, about, value)
        }
    }

    /// Sets the unit, as `deg`; empty for pure numbers and text.
    pub(crate) fn unit(mut self, unit: impl Into<Cow<'a, str>>) -> Self {
        self.unit = unit.into();
        self
    }

    /// Sets a heading for text, in place of the name.
    pub(crate) fn heading(mut self, heading: impl Into<Cow<'a, str>>) -> Self {
        self.heading = Some(heading.into());
        self
    }

    /// Sets a format for text.
    pub(crate) fn format(mut self, format: Format) -> Self {
        self.format = format;
        self
    }

    /// Left out of text where all of its cells are empty or zero without an error.
    pub(crate) fn dropped_if_empty(mut self) -> Self {
        self.drops_if_empty = true;
        self
    }

    /// Returns `true` if it is left out of the text of `rows`.
    fn is_dropped(&self, rows: &[impl Borrow<R>]) -> bool {
        let is_nothing = |row: &R| match (self.value)(row) {
            Cell::Empty => true,
            Cell::Estimate(found) => found.is_nothing(),
            Cell::Number(_) | Cell::Count(_) | Cell::Text(_) => false,
        };
        self.drops_if_empty && rows.iter().all(|row| is_nothing(row.borrow()))
    }

    /// Name of the column of standard errors.
    fn se_name(&self) -> String {
        format!("{}_se", self.name)
    }

    fn text(&self, row: &R) -> String {
        match (self.value)(row) {
            Cell::Empty => "-".to_owned(),
            Cell::Count(count) => count.to_string(),
            Cell::Text(text) => text.into_owned(),
            Cell::Estimate(estimate) => estimate.text(),
            Cell::Number(value) => match self.format {
                Format::Short => short(value),
                Format::Fixed(places) => format!("{value:.places$}"),
            },
        }
    }

    fn fields(&self, row: &R, out: &mut Vec<CsvField<'static>>) {
        match (self.kind, (self.value)(row)) {
            (Kind::Estimate, Cell::Estimate(supported)) => {
                let estimate = supported.estimate();
                out.extend([estimate.mean.into(), estimate.se.into()]);
            }
            (Kind::Estimate, _) => out.extend([CsvField::Empty, CsvField::Empty]),
            (Kind::Value, Cell::Estimate(supported)) => {
                out.push(supported.estimate().mean.into());
            }
            (Kind::Value, Cell::Empty) => out.push(CsvField::Empty),
            (Kind::Value, Cell::Number(value)) => out.push(value.into()),
            (Kind::Value, Cell::Count(count)) => out.push(count.into()),
            (Kind::Value, Cell::Text(text)) => out.push(CsvField::Text(text)),
        }
    }

    fn json(&self, row: &R) -> Value {
        match (self.value)(row) {
            Cell::Empty => Value::Null,
            Cell::Number(value) => json!(value),
            Cell::Count(count) => json!(count),
            Cell::Text(text) => json!(text),
            Cell::Estimate(estimate) => json!(estimate),
        }
    }
}

/// Columns over rows of type `R`.
///
/// ```text
/// let table = Table::new()
///     .column(Column::new("theta", "polar angle", |row: &Row| row.theta).unit("deg"))
///     .column(Column::estimate("lit", "lit fraction", |row: &Row| Some(row.lit)));
/// table.with_rows(rows)  ->  theta,lit,lit_se      table.text(rows)  ->  theta  lit
///                      30,0.98,0.002                               30     0.9800 +- 0.0020
/// ```
pub(crate) struct Table<'a, R> {
    columns: Vec<Column<'a, R>>,
    keys: usize,
}

impl<'a, R> Table<'a, R> {
    /// A table without columns.
    pub(crate) const fn new() -> Self {
        Self {
            columns: Vec::new(),
            keys: 1,
        }
    }

    /// Adds a column.
    pub(crate) fn column(mut self, column: Column<'a, R>) -> Self {
        self.columns.push(column);
        self
    }

    /// Adds columns.
    pub(crate) fn columns(mut self, columns: impl IntoIterator<Item = Column<'a, R>>) -> Self {
        self.columns.extend(columns);
        self
    }

    /// Table whose first `keys` columns, instead of one, tell rows apart: text that is broken into blocks repeats them.
    pub(crate) fn keys(mut self, keys: usize) -> Self {
        self.keys = keys;
        self
    }

    /// Names of the columns of a CSV file.
    pub(crate) fn header(&self) -> Vec<String> {
        let names = |column: &Column<'a, R>| match column.kind {
            Kind::Value => vec![column.name.to_string()],
            Kind::Estimate => vec![column.name.to_string(), column.se_name()],
        };
        self.columns.iter().flat_map(names).collect()
    }

    /// The fields of a row of a CSV file.
    pub(crate) fn record(&self, row: &R) -> Vec<CsvField<'static>> {
        let mut fields = Vec::new();
        for column in &self.columns {
            column.fields(row, &mut fields);
        }
        fields
    }

    /// Name, unit and description of each column of a CSV file, as JSON.
    pub(crate) fn description(&self) -> Value {
        let describe = |column: &Column<'a, R>| {
            let unit = Some(&column.unit).filter(|unit| !unit.is_empty());
            let entry = |name: &str, about: &str| json!({ "name": name, "unit": unit, "description": about });
            let value = entry(&column.name, &column.about);
            match column.kind {
                Kind::Value => vec![value],
                Kind::Estimate => {
                    let about = format!("standard error of {}", column.name);
                    vec![value, entry(&column.se_name(), &about)]
                }
            }
        };
        Value::Array(self.columns.iter().flat_map(describe).collect())
    }

    /// The rows as an array of JSON objects, by the names of the columns.
    pub(crate) fn json(&self, rows: impl IntoIterator<Item = impl Borrow<R>>) -> Value {
        let object = |row: &R| {
            let fields = self.columns.iter();
            let fields = fields.map(|column| (column.name.to_string(), column.json(row)));
            Value::Object(fields.collect::<Map<_, _>>())
        };
        let rows = rows.into_iter();
        Value::Array(rows.map(|row| object(row.borrow())).collect())
    }

    /// The columns of these names, in this order.
    ///
    /// # Panics
    /// If there is no column of such a name, which is an error in the program.
    pub(crate) fn select(mut self, names: &[&str]) -> Self {
        let take = |name: &&str| {
            let place = self.columns.iter().position(|column| column.name == *name);
            assert!(place.is_some(), "no column {name}");
            place.map(|place| self.columns.swap_remove(place))
        };
        self.columns = names.iter().filter_map(take).collect();
        self
    }

    /// The rows as aligned text, a line per row.
    pub(crate) fn text(&self, rows: impl IntoIterator<Item = impl Borrow<R>>) -> String {
        aligned(&self.cells(rows), self.keys)
    }

    /// The rows as aligned text, a line per row, whose last cells are broken into lines where they do not fit.
    pub(crate) fn folded_text(&self, rows: impl IntoIterator<Item = impl Borrow<R>>) -> String {
        aligned(&folded(self.cells(rows)), self.keys)
    }

    /// The rows as aligned text, a line per column.
    pub(crate) fn transposed_text(&self, rows: impl IntoIterator<Item = impl Borrow<R>>) -> String {
        let cells = self.cells(rows);
        let lines = cells.first().map_or(0, Vec::len);
        let transposed: Vec<Vec<String>> = (0..lines)
            .map(|line| cells.iter().map(|row| row[line].clone()).collect())
            .collect();
        aligned(&transposed, 1)
    }

    /// Headings, then the cells of each row.
    fn cells(&self, rows: impl IntoIterator<Item = impl Borrow<R>>) -> Vec<Vec<String>> {
        let heading = |column: &Column<'a, R>| {
            let heading = column.heading.as_ref().unwrap_or(&column.name);
            heading.to_string()
        };
        let rows: Vec<_> = rows.into_iter().collect();
        let columns = self.columns.iter();
        let columns: Vec<_> = columns.filter(|column| !column.is_dropped(&rows)).collect();
        let mut cells = vec![columns.iter().copied().map(heading).collect()];
        cells.extend(rows.iter().map(|row| {
            let texts = columns.iter().map(|column| column.text(row.borrow()));
            texts.collect::<Vec<String>>()
        }));
        cells
    }
}

/// The unit of a column of lengths; `length` where units are arbitrary.
pub(crate) const fn unit_of_lengths(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Arbitrary => "length",
        unit => unit.symbol(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Row {
        theta: f64,
        lit: Option<Estimate>,
        surfaces: u64,
    }

    fn rows() -> Vec<Row> {
        let lit = Estimate {
            mean: 0.981_234_5,
            se: Some(0.0021),
        };
        let row = |theta, lit, surfaces| Row {
            theta,
            lit,
            surfaces,
        };
        vec![row(30.0, Some(lit), 12), row(60.5, None, 3)]
    }

    fn table() -> Table<'static, Row> {
        Table::new()
            .column(Column::new("theta", "", |row: &Row| row.theta).unit("deg"))
            .column(Column::estimate("lit", "", |row: &Row| row.lit))
            .column(Column::new("surfaces", "", |row: &Row| row.surfaces).heading("n"))
    }

    #[test]
    fn csv_text_and_json_follow_from_one_definition() {
        let header = table().header();
        let names: Vec<&str> = header.iter().map(String::as_str).collect();
        let records = rows().into_iter().map(|row| table().record(&row));
        assert_eq!(
            asperity_io::csv_text(&names, records),
            "theta,lit,lit_se,surfaces\n30,0.9812345,0.0021,12\n60.5,,,3\n"
        );
        assert_eq!(
            table().text(rows()),
            "theta  lit               n\n30     0.9812 +- 0.0021  12\n60.5   -                 3\n"
        );
        assert_eq!(
            table().json(rows()),
            json!([
                {"theta": 30.0, "lit": {"mean": 0.981_234_5, "se": 0.0021}, "surfaces": 12},
                {"theta": 60.5, "lit": null, "surfaces": 3},
            ])
        );
    }

    #[test]
    fn columns_in_which_nothing_is_are_left_out_of_text_if_they_say_so() {
        let estimate = |mean, se| Some(Estimate { mean, se: Some(se) });
        let text = |of: [f64; 2]| {
            let value = move |row: &f64| estimate(*row, 0.1 * row);
            let column = Column::estimate("absorbed", "", value).dropped_if_empty();
            let table = Table::new().column(Column::new("n", "", |row: &f64| *row));
            let table = table.column(column);
            table.text(of)
        };
        assert_eq!(text([0.0, 0.0]), "n\n0\n0\n");
        assert_eq!(
            text([0.0, 1.0]),
            "n  absorbed\n0  0 (no scatter)\n1  1.00 +- 0.10\n"
        );
    }

    #[test]
    fn text_shows_the_selected_columns_and_turns_them_into_lines() {
        let text = table().select(&["surfaces", "theta"]).text(rows());
        assert_eq!(text, "n   theta\n12  30\n3   60.5\n");
        let text = table()
            .select(&["theta", "surfaces"])
            .transposed_text(rows());
        assert_eq!(text, "theta  30  60.5\nn      12  3\n");
    }
}
