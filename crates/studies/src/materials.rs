//! Materials: the list of those that are known by name, and the optical constants of one against the wavelength.

use std::path::Path;

use asperity_io::{MaterialLookupError, MaterialRecord, material, materials, shown};
use asperity_optics::DispersionError;
use asperity_plot::{Colour, Curve, CurveAxis, Curves, Point, Style};
use asperity_simulate::short;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::config::values::{Number, OneOrMany};
use crate::output::{Column, Table, aligned, folded, note_lines, wrapped};
use crate::report::error::ReportError;
use crate::report::figures::write_by_ending;

/// Wavelengths at which constants are shown unless others are given, as far as the data reach, nanometres.
const VISIBLE_NM: [f64; 8] = [400.0, 450.0, 500.0, 550.0, 600.0, 650.0, 700.0, 750.0];

/// Nanometres per micrometre.
const NM: f64 = 1e3;

/// Steps between the points at which a formula is tabulated, even in the logarithm of the wavelength.
const STEPS: u32 = 400;

/// Ratio of the largest to the smallest `k` beyond which a figure has a logarithmic panel.
const DECADES: f64 = 100.0;

/// Reason for which the constants of a material are not shown.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MaterialsError {
    /// No such material, or a file that cannot be read.
    #[error(transparent)]
    Lookup(#[from] MaterialLookupError),
    /// Wavelength without data.
    #[error("{}: {error}", shown(name))]
    NoIndex {
        /// Name of the material.
        name: String,
        /// Reason.
        error: DispersionError,
    },
}

impl MaterialsError {
    /// Returns `true` if another name or wavelength would help.
    #[must_use]
    pub const fn is_usage(&self) -> bool {
        match self {
            Self::Lookup(error) => matches!(error, MaterialLookupError::Unknown(_)),
            Self::NoIndex { error, .. } => matches!(error, DispersionError::OutOfRange { .. }),
        }
    }
}

/// Configuration of `asperity materials`.
#[derive(Clone, Debug, Deserialize)]
pub struct MaterialsConfig {
    materials: Selection,
}

/// The material that is selected, all unless one is, and the wavelengths in vacuum, nanometres.
#[derive(Clone, Debug, Deserialize)]
struct Selection {
    name: Option<String>,
    wavelength: Option<OneOrMany<Number>>,
}

impl MaterialsConfig {
    /// The optical constants of the selected material; `None` if none is selected.
    ///
    /// # Errors
    /// [`MaterialsError`] if the material is unknown, its file cannot be read, or a wavelength is out of the range of its data.
    pub fn sheet(&self) -> Result<Option<MaterialSheet>, MaterialsError> {
        let Some(name) = &self.materials.name else {
            return Ok(None);
        };
        let record = material(name)?;
        let given = self.materials.wavelength.as_ref().map(OneOrMany::as_slice);
        let given = given.map(|values| values.iter().map(|value| value.0).collect::<Vec<f64>>());
        let is_given = given.is_some();
        let mut shown = given.unwrap_or_else(|| default_wavelengths(&record));
        shown.sort_by(f64::total_cmp);
        shown.dedup();
        Ok(Some(MaterialSheet {
            rows: rows(&record, shown.into_iter().map(|nm| (nm, nm / NM)))?,
            points: rows(
                &record,
                tabulated(&record)
                    .into_iter()
                    .map(|um| (nanometres(um), um)),
            )?,
            is_given,
            record,
        }))
    }
}

/// A material of the list, with ranges of the wavelength in nanometres.
#[derive(Clone, Debug, Serialize)]
pub struct ListedMaterial {
    name: &'static str,
    aliases: &'static [String],
    record: &'static str,
    source: String,
    doi: Option<&'static str>,
    n_range_nm: [f64; 2],
    k_range_nm: Option<[f64; 2]>,
}

/// All materials that are known by name.
#[must_use]
pub fn material_list() -> Vec<ListedMaterial> {
    let listed = |material: &'static MaterialRecord| ListedMaterial {
        name: &material.name,
        aliases: &material.aliases,
        record: &material.record,
        source: short_source(&material.source),
        doi: material.doi.as_deref(),
        n_range_nm: range_nm(material.constants.range()),
        k_range_nm: material.constants.extinction_range().map(range_nm),
    };
    materials().iter().map(listed).collect()
}

/// The list as a table for people, at most 80 characters wide.
#[must_use]
pub fn material_list_text(list: &[ListedMaterial]) -> String {
    let range = |[first, last]: [f64; 2]| format!("{}-{}", first.ceil(), last.floor());
    let about = "wavelengths at which it is known, whole nanometres";
    let table = Table::new()
        .column(Column::new("name", "name", |row: &&ListedMaterial| {
            row.name
        }))
        .column(
            Column::new("n (nm)", about, move |row: &&ListedMaterial| {
                range(row.n_range_nm)
            })
            .unit("nm"),
        )
        .column(
            Column::new("k (nm)", about, move |row: &&ListedMaterial| {
                row.k_range_nm.map(range)
            })
            .unit("nm"),
        )
        .column(Column::new(
            "source",
            "first author and year",
            |row: &&ListedMaterial| row.source.clone(),
        ))
        .column(Column::new(
            "other names",
            "names that are understood as well",
            |row: &&ListedMaterial| row.aliases.join(", "),
        ));
    let note = "-: k is unknown, which is not zero. `asperity materials NAME` shows n and k.";
    format!("{}\n{}\n", table.folded_text(list), wrapped(note))
}

/// Optical constants at one wavelength.
#[derive(Clone, Copy, Debug)]
struct Row {
    wavelength_nm: f64,
    n: f64,
    k: Option<f64>,
}

/// A material with its optical constants: at the wavelengths that are shown, and at all points of its data.
#[derive(Clone, Debug)]
pub struct MaterialSheet {
    record: MaterialRecord,
    rows: Vec<Row>,
    points: Vec<Row>,
    /// `true` if the wavelengths of `rows` were given.
    is_given: bool,
}

impl MaterialSheet {
    /// Name, source and range of the material, and a table of its constants, as text.
    #[must_use]
    pub fn text(&self) -> String {
        let record = &self.record;
        let range = |range: [f64; 2]| {
            let [first, last] = range_nm(range).map(short);
            format!("{first} to {last} nm")
        };
        let k = record.constants.extinction_range();
        let facts = [
            ("name", record.name.clone()),
            ("other names", record.aliases.join(", ")),
            ("record", record.record.clone()),
            ("source", record.source.replace('\n', " ")),
            ("DOI", record.doi.clone().unwrap_or_default()),
            ("n", range(record.constants.range())),
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

    /// JSON form of the list or of the constants.
    #[must_use]
    pub fn json(&self) -> Value {
        let record = &self.record;
        json!({
            "name": record.name,
            "aliases": record.aliases,
            "record": record.record,
            "source": record.source,
            "doi": record.doi,
            "n_range_nm": range_nm(record.constants.range()),
            "k_range_nm": record.constants.extinction_range().map(range_nm),
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
        write_by_ending(path, &self.figure().draw()?)
    }

    fn figure(&self) -> Curves {
        let points = |value: fn(&Row) -> Option<f64>| -> Vec<Point> {
            let rows = self.points.iter();
            rows.filter_map(|row| Some(Point::exact(row.wavelength_nm, value(row)?)))
                .collect()
        };
        let [n, k] = [points(|row| Some(row.n)), points(|row| row.k)];
        let positive = || k.iter().map(|point| point.y).filter(|k| *k > 0.0);
        let [least, most] = [positive().reduce(f64::min), positive().reduce(f64::max)];
        let spans_decades = most > least.map(|least| DECADES * least);
        let notes = match k.is_empty() {
            true => vec!["k is unknown.".to_owned()],
            false => Vec::new(),
        };
        let curves = [("n", n), ("k", k)].into_iter().enumerate();
        let curves = curves.filter(|(_, (_, points))| !points.is_empty());
        let axis = |label: &str| CurveAxis {
            label: label.to_owned(),
            range: None,
        };
        Curves {
            title: format!("Optical constants of {}", self.record.name),
            subtitle: short_source(&self.record.source),
            x: axis("wavelength (nm)"),
            y: axis("n, k"),
            log_from: least.filter(|_| spans_decades),
            curves: curves
                .map(|(number, (name, points))| Curve {
                    name: name.to_owned(),
                    colour: Colour::Nth(number),
                    style: Style::Line(number),
                    points,
                })
                .collect(),
            notes,
        }
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

/// Constants at wavelengths, each in nanometres and, to the digit of the data, in micrometres.
fn rows(
    record: &MaterialRecord,
    wavelengths: impl Iterator<Item = (f64, f64)>,
) -> Result<Vec<Row>, MaterialsError> {
    let row = |(wavelength_nm, micrometres)| {
        let index = record.constants.at(micrometres);
        let index = index.map_err(|error| MaterialsError::NoIndex {
            name: record.name.clone(),
            error,
        })?;
        Ok(Row {
            wavelength_nm,
            n: index.n,
            k: index.k,
        })
    };
    wavelengths.map(row).collect()
}

/// Visible wavelengths within the data, or as many from end to end where none or one is, nanometres.
fn default_wavelengths(record: &MaterialRecord) -> Vec<f64> {
    let [first, last] = range_nm(record.constants.range());
    let is_known = |nm: &f64| (first..=last).contains(nm);
    let visible: Vec<f64> = VISIBLE_NM.into_iter().filter(is_known).collect();
    if visible.len() > 1 || first == last {
        return if visible.is_empty() {
            vec![first]
        } else {
            visible
        };
    }
    let steps = VISIBLE_NM.len() - 1;
    let at = |i: usize| match i == steps {
        true => last,
        false => first + (last - first) * i as f64 / steps as f64,
    };
    (0..=steps).map(at).collect()
}

/// All wavelengths of the tables of a record, and those at which its formula is tabulated, micrometres, ascending.
fn tabulated(record: &MaterialRecord) -> Vec<f64> {
    let n = record.constants.n();
    let [first, last] = n.range();
    let at = |i: u32| match i {
        0 => first,
        STEPS => last,
        i => first * (last / first).powf(f64::from(i) / f64::from(STEPS)),
    };
    let mut points: Vec<f64> = match n.formula_number() {
        Some(_) => (0..=STEPS).map(at).collect(),
        None => n.points().to_vec(),
    };
    let of_k = record.constants.k().map_or(&[][..], |k| k.points());
    let within = of_k.iter().filter(|point| (first..=last).contains(*point));
    points.extend(within);
    points.sort_by(f64::total_cmp);
    points.dedup();
    points
}

fn range_nm(micrometres: [f64; 2]) -> [f64; 2] {
    micrometres.map(nanometres)
}

/// A wavelength in nanometres, without the digits that the conversion from micrometres rounds.
fn nanometres(micrometres: f64) -> f64 {
    const DIGITS: f64 = 1e9;
    let nm = micrometres * NM;
    let rounded = (nm * DIGITS).round() / DIGITS;
    match (rounded - nm).abs() <= 4.0 * f64::EPSILON * nm {
        true => rounded,
        false => nm,
    }
}

/// First author and year of the first reference, as in `Johnson 1972`.
fn short_source(source: &str) -> String {
    let first = source.split("\n2)").next().unwrap_or_default();
    let line = first.lines().next().unwrap_or_default();
    let authors = line.trim_start_matches("1)").trim();
    let author = authors.split([',', '\n']).next().unwrap_or_default();
    let author = author.split(" and ").next().unwrap_or_default();
    // Initials stand before the name of a person
    let name = match authors.contains(['.', ',']) {
        true => author.trim_end_matches('.').rsplit(' ').next(),
        false => author.split(' ').next(),
    };
    let words = || first.split(|c: char| c.is_whitespace() || ",;".contains(c));
    let bracketed = words().filter_map(|word| word.strip_prefix('(')?.strip_suffix(')'));
    let plain = words().map(|word| word.trim_end_matches('.'));
    let is_year = |word: &&str| {
        word.len() == 4
            && word
                .parse::<u32>()
                .is_ok_and(|year| (1800..2100).contains(&year))
    };
    let year = bracketed.chain(plain).find(is_year);
    let parts = [name, year].into_iter().flatten();
    parts.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sources_are_an_author_and_a_year() {
        for (source, expected) in [
            (
                "P. B. Johnson and R. W. Christy.\nMetals.\nPhys. Rev. B 6, 4370-4379 (1972)",
                "Johnson 1972",
            ),
            (
                "Björn Karlsson, Carl G. Ribbing.\nSteel (1982)",
                "Karlsson 1982",
            ),
            (
                "1) J. Pflüger, J. Fink.\nAcademic Press, 1991. pp. 293-310\n2) J. Fink (1984)",
                "Pflüger 1991",
            ),
            ("SCHOTT Zemax catalog 2017-01-20b", "SCHOTT"),
            ("", ""),
        ] {
            assert_eq!(short_source(source), expected);
        }
        for listed in material_list() {
            assert!(listed.source.len() > 2, "{listed:?}");
        }
    }

    #[test]
    fn nanometres_keep_the_digits_of_micrometres() {
        for (um, nm) in [
            (0.2096, 209.6),
            (0.2098, 209.8),
            (1.937, 1937.0),
            (0.123_456_789_012_3, 123.456_789_012_3),
        ] {
            assert_eq!(nanometres(um), nm);
        }
        for record in materials() {
            for um in tabulated(record) {
                let nm = nanometres(um);
                assert!(record.constants.at(nm / NM).is_ok(), "{} {nm}", record.name);
            }
        }
    }

    #[test]
    fn data_outside_the_visible_are_shown_from_end_to_end() {
        let constants = |range| {
            let n = asperity_optics::DispersionCurve::formula(5, vec![1.5], range).unwrap();
            MaterialRecord {
                constants: asperity_optics::OpticalConstants::new(n, None).unwrap(),
                ..materials()[0].clone()
            }
        };
        let found = default_wavelengths(&constants([1.0, 8.0]));
        assert_eq!(found[..2], [1000.0, 2000.0]);
        assert_eq!(found.last(), Some(&8000.0));
        assert_eq!(default_wavelengths(&constants([0.55, 0.55])), [550.0]);
        assert_eq!(
            default_wavelengths(&constants([0.45, 0.6])),
            [450.0, 500.0, 550.0, 600.0]
        );
        assert_eq!(tabulated(&constants([0.45, 0.6])).len(), 401);
    }
}
