//! Views: the files of a study, each a function of what the study found.
//!
//! The list of views is made from the configuration alone, so that the names of all files are known before a ray is traced. A view
//! that has nothing to show writes nothing.

use std::borrow::Borrow;
use std::path::Path;

use asperity_io::{
    CsvField, ResultFolder, WriteError, csv_text, printable, write_bytes, write_csv, write_json,
};
use asperity_plot::Figure;
use asperity_simulate::{Case, Observer};
use rayon::prelude::*;
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::output::{Place, Table, figure_files};
use crate::report::error::ReportError;
use crate::report::figures::save_unless;

type Records<'a> = dyn Iterator<Item = Vec<CsvField<'static>>> + 'a;

/// A table with its rows.
pub struct Csv<'a> {
    header: Vec<String>,
    records: Box<Records<'a>>,
    /// Name, unit and description of each column.
    pub(crate) description: Value,
}

impl<'a> Csv<'a> {
    /// Writes the file.
    pub(crate) fn write(self, path: &Path) -> Result<(), WriteError> {
        let names: Vec<&str> = self.header.iter().map(String::as_str).collect();
        write_csv(path, &names, self.records)
    }

    /// The rows with a header line.
    #[must_use]
    pub fn text(self) -> String {
        let names: Vec<&str> = self.header.iter().map(String::as_str).collect();
        csv_text(&names, self.records)
    }

    /// Tables of the same columns below each other, each with values of further columns, which `keys` name, in front.
    pub(crate) fn stacked(
        keys: &[&'static str],
        parts: impl IntoIterator<Item = (Vec<f64>, Self)> + 'a,
    ) -> Self {
        let mut parts = parts.into_iter().peekable();
        let first = parts.peek().map(|(_, first)| first);
        let of_keys = keys
            .iter()
            .map(|&name| json!({ "name": name, "unit": null, "description": "value of the list" }));
        let of_rows = first.and_then(|first| first.description.as_array());
        let names = keys.iter().map(|&name| name.to_owned());
        Self {
            header: names
                .chain(first.iter().flat_map(|first| first.header.clone()))
                .collect(),
            description: of_keys
                .chain(of_rows.into_iter().flatten().cloned())
                .collect(),
            records: Box::new(parts.flat_map(|(values, part)| {
                part.records.map(move |record| {
                    let values = values.iter().map(|value| CsvField::from(*value));
                    values.chain(record).collect()
                })
            })),
        }
    }
}

impl<'a, R> Table<'a, R> {
    /// The table with these rows.
    pub(crate) fn with_rows<I>(self, rows: I) -> Csv<'a>
    where
        I: IntoIterator<Item: Borrow<R>, IntoIter: 'a>,
        R: 'a,
    {
        Csv {
            header: self.header(),
            description: self.description(),
            records: Box::new(rows.into_iter().map(move |row| self.record(row.borrow()))),
        }
    }
}

/// Writes files, and returns the number of figures that the observer left no time for.
type Write<'v, J> =
    dyn Fn(&J, &Place<'_>, &dyn Observer) -> Result<usize, ReportError> + Send + Sync + 'v;
type Describe<'v, J> = dyn Fn(&J) -> Option<Value> + Send + Sync + 'v;

/// A file, or the files of a figure.
struct View<'v, J> {
    names: Vec<String>,
    write: Box<Write<'v, J>>,
    /// Columns of a table.
    columns: Option<Box<Describe<'v, J>>>,
}

/// The files of a study that finds `J`.
pub struct Views<'v, J>(Vec<View<'v, J>>);

impl<'v, J: Sync + 'v> Views<'v, J> {
    pub(crate) const fn new() -> Self {
        Self(Vec::new())
    }

    /// Adds a table.
    pub(crate) fn csv<F>(&mut self, name: impl Into<String>, table: F)
    where
        F: for<'j> Fn(&'j J) -> Option<Csv<'j>> + Copy + Send + Sync + 'v,
    {
        let name = name.into();
        let file = name.clone();
        self.0.push(View {
            names: vec![name],
            write: Box::new(move |found, place, _| {
                if let Some(csv) = table(found) {
                    csv.write(&place.claim(&file)?)?;
                }
                Ok(0)
            }),
            columns: Some(Box::new(move |found| Some(table(found)?.description))),
        });
    }

    /// Adds a text.
    pub(crate) fn text<F>(&mut self, name: impl Into<String>, text: F)
    where
        F: Fn(&J) -> Option<String> + Send + Sync + 'v,
    {
        let name = name.into();
        self.other(vec![name.clone()], move |found, place, _| {
            if let Some(text) = text(found) {
                write_bytes(place.claim(&name)?, printable(&text).as_bytes())?;
            }
            Ok(0)
        });
    }

    /// Adds a JSON document.
    pub(crate) fn json<S: Serialize>(
        &mut self,
        name: impl Into<String>,
        value: impl Fn(&J) -> Option<S> + Send + Sync + 'v,
    ) {
        let name = name.into();
        self.other(vec![name.clone()], move |found, place, _| {
            if let Some(value) = value(found) {
                write_json(place.claim(&name)?, &value)?;
            }
            Ok(0)
        });
    }

    /// Adds a figure, as SVG and PNG.
    pub(crate) fn figure(
        &mut self,
        name: impl Into<String>,
        figure: impl Fn(&J) -> Result<Option<Figure>, ReportError> + Send + Sync + 'v,
    ) {
        let name = name.into();
        self.other(
            figure_files(&name).to_vec(),
            move |found, place, observer| save_unless(observer, &[place], &name, || figure(found)),
        );
    }

    /// Adds files of another kind.
    pub(crate) fn other<F>(&mut self, names: Vec<String>, write: F)
    where
        F: Fn(&J, &Place<'_>, &dyn Observer) -> Result<usize, ReportError> + Send + Sync + 'v,
    {
        self.0.push(View {
            names,
            write: Box::new(write),
            columns: None,
        });
    }

    /// Names of all files.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        let names = self.0.iter().flat_map(|view| &view.names);
        names.cloned().collect()
    }

    /// Name, unit and description of the columns of each table.
    pub(crate) fn columns(&self, found: &J) -> Value {
        let tables = self.0.iter().filter_map(|view| {
            let columns = view.columns.as_ref()?(found)?;
            Some((view.names[0].clone(), columns))
        });
        Value::Object(tables.collect::<Map<_, _>>())
    }

    /// Writes all files into `folder`, summaries last; those of earlier runs that are not written again go. Returns the number of figures
    /// that are left out, since the run gives up before they are begun.
    ///
    /// # Errors
    /// [`ReportError`] if a file cannot be written or a figure drawn.
    pub fn write(
        &self,
        folder: &ResultFolder,
        found: &J,
        observer: &dyn Observer,
    ) -> Result<usize, ReportError> {
        let place = Place::root(folder);
        observer.begin("writing", self.0.len() as u64);
        let write = |view: &&View<'v, J>| {
            let left_out = (view.write)(found, &place, observer)?;
            observer.advance(1);
            Ok::<_, ReportError>(left_out)
        };
        let ends_with = |ending: &'static str| {
            move |view: &&View<'v, J>| view.names.iter().any(|name| name.ends_with(ending))
        };
        let (figures, others): (Vec<_>, Vec<_>) = self.0.iter().partition(ends_with(".svg"));
        let (summaries, tables): (Vec<_>, Vec<_>) =
            others.into_iter().partition(ends_with("summary.json"));
        let mut left_out = 0;
        // Tables first, which are there even if there is no time for figures
        for views in [tables, figures, summaries] {
            let written = views.par_iter().map(write);
            left_out += written.try_reduce(|| 0, |a, b| Ok(a + b))?;
        }
        observer.end();
        Ok(left_out)
    }
}

/// Folders of the files of cases, each with a slash at its end; a single case has the result folder itself.
pub(crate) fn case_folders(cases: &[Case]) -> Vec<String> {
    match cases {
        [_] => vec![String::new()],
        several => several.iter().map(|case| case.folder() + "/").collect(),
    }
}
