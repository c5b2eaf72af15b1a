//! Optical constants as CSV: `wavelength_nm,n,k`, with the unit of the wavelength in the header.

use std::ops::RangeInclusive;
use std::path::Path;

use asperity_optics::{DispersionCurve, OpticalConstants};

use super::material_record::MaterialRecord;
use crate::error::ReadProblem;
use crate::number_table::number_table_of;
use crate::text_lines::short;

/// Names of the column of wavelengths.
const WAVELENGTHS: [&str; 4] = ["wavelength", "wl", "lambda", "wvl"];

/// Units of wavelengths, with how many of them are a micrometre. Division gives the digits that the file would have in micrometres.
const UNITS: [(&str, f64); 10] = [
    ("nm", 1e3),
    ("nanometer", 1e3),
    ("nanometre", 1e3),
    ("um", 1.0),
    ("\u{b5}m", 1.0),
    ("\u{3bc}m", 1.0),
    ("micron", 1.0),
    ("micrometer", 1.0),
    ("micrometre", 1.0),
    ("angstrom", 1e4),
];

pub(super) fn parse(text: &str) -> Result<MaterialRecord, ReadProblem> {
    let table = number_table_of(Path::new(""), text.as_bytes())?;
    let (wavelength, per_micrometre) = wavelength_column(table.names())?;
    let column = |name: &str| {
        let is_name = |own: &&String| own.to_lowercase() == name;
        table
            .names()
            .iter()
            .find(is_name)
            .and_then(|own| table.column(own))
    };
    let n = column("n").ok_or_else(|| {
        let what = "it has no column n; the columns wavelength_nm, n and, if known, k are allowed";
        ReadProblem::malformed(what)
    })?;
    let wavelengths = table.column(wavelength).unwrap_or_default().iter();
    let wavelengths: Vec<f64> = wavelengths.map(|w| w / per_micrometre).collect();
    let curve = |rows: RangeInclusive<usize>, values: &[f64]| {
        let curve =
            DispersionCurve::table(wavelengths[rows.clone()].to_vec(), values[rows].to_vec());
        curve.map_err(ReadProblem::malformed)
    };
    let k = column("k").and_then(|k| Some(curve(known(k)?, k)));
    let n = DispersionCurve::table(wavelengths.clone(), n.to_vec());
    let constants = OpticalConstants::new(n.map_err(ReadProblem::malformed)?, k.transpose()?)
        .map_err(ReadProblem::malformed)?;
    Ok(MaterialRecord {
        name: String::new(),
        aliases: Vec::new(),
        record: String::new(),
        source: String::new(),
        cite: String::new(),
        doi: None,
        constants,
    })
}

/// The rows between the first and the last value; values that are empty before or after them are unknown.
fn known(values: &[f64]) -> Option<RangeInclusive<usize>> {
    let is_known = |value: &f64| !value.is_nan();
    Some(values.iter().position(is_known)?..=values.iter().rposition(is_known)?)
}

/// The column of wavelengths, and how many of its units are a micrometre.
fn wavelength_column(names: &[String]) -> Result<(&str, f64), ReadProblem> {
    for name in names {
        let lower = name.to_lowercase();
        let words: Vec<&str> = lower
            .split(|c: char| !c.is_alphanumeric())
            .filter(|word| !word.is_empty())
            .collect();
        let is_wavelength =
            |word: &str| WAVELENGTHS.contains(&word) || word == "\u{3bb}" || word == "wavelengths";
        if !words.first().is_some_and(|word| is_wavelength(word)) {
            continue;
        }
        let unit = words[1..].iter().find_map(|word| {
            let is_unit = |(unit, _): &&(&str, f64)| *unit == word.trim_end_matches('s');
            UNITS.iter().find(is_unit)
        });
        return match unit {
            Some((_, per_micrometre)) => Ok((name, *per_micrometre)),
            None => Err(ReadProblem::malformed(format_args!(
                "the column \"{}\" has no unit that is known; wavelength_nm, wavelength_um or wavelength_angstrom is allowed",
                short(name)
            ))),
        };
    }
    let what =
        "it has no column of wavelengths; wavelength_nm or wavelength_um must be in the header";
    Err(ReadProblem::malformed(what))
}
