//! Records of the refractiveindex.info database: YAML with references and contributions to `n` and `k`.
//!
//! Contributions are formulas 1 to 9 and tables `nk`, `n` and `k`; where several give the same quantity, the last one counts.
//! The database is described in M. N. Polyanskiy, Scientific Data 11, 94 (2024), <https://doi.org/10.1038/s41597-023-02898-2>.

use asperity_optics::{DispersionCurve, OpticalConstants};
use serde::Deserialize;

use super::material_record::MaterialRecord;
use crate::error::ReadProblem;
use crate::text_lines::short;

/// Most contributions of a record.
const MAX_CONTRIBUTIONS: usize = 100;

/// Content of a record. The keys `NAME`, `ALIASES`, `RECORD`, `DOI` and `CITE` are those of the embedded files.
#[derive(Deserialize)]
#[serde(rename_all = "UPPERCASE")]
struct Content {
    #[serde(default)]
    name: String,
    #[serde(default)]
    aliases: Vec<String>,
    #[serde(default)]
    record: String,
    doi: Option<String>,
    #[serde(default)]
    cite: String,
    #[serde(default)]
    references: String,
    data: Vec<Contribution>,
}

#[derive(Deserialize)]
struct Contribution {
    #[serde(rename = "type")]
    kind: String,
    #[serde(alias = "range")]
    wavelength_range: Option<String>,
    coefficients: Option<String>,
    data: Option<String>,
}

pub(super) fn parse(text: &str) -> Result<MaterialRecord, ReadProblem> {
    let content: Content = serde_saphyr::from_str(text).map_err(|error| {
        let said = error.without_snippet().to_string();
        ReadProblem::malformed(
            said.lines()
                .next()
                .unwrap_or_default()
                .trim_end_matches('.'),
        )
    })?;
    if content.data.len() > MAX_CONTRIBUTIONS {
        let what = format!("DATA has over {MAX_CONTRIBUTIONS} contributions");
        return Err(ReadProblem::malformed(what));
    }
    let (mut n, mut k) = (None, None);
    for contribution in &content.data {
        contribution.read(&mut n, &mut k)?;
    }
    let n = n.ok_or_else(|| ReadProblem::malformed("it has no refractive index n"))?;
    let constants = OpticalConstants::new(n, k).map_err(ReadProblem::malformed)?;
    let source = without_tags(&content.references);
    Ok(MaterialRecord {
        name: content.name,
        aliases: content.aliases,
        record: content.record,
        doi: content.doi.or_else(|| doi_in(&content.references)),
        cite: content.cite,
        source,
        constants,
    })
}

impl Contribution {
    fn read(
        &self,
        n: &mut Option<DispersionCurve>,
        k: &mut Option<DispersionCurve>,
    ) -> Result<(), ReadProblem> {
        let words: Vec<&str> = self.kind.split_whitespace().collect();
        match words.as_slice() {
            ["formula", number] => *n = Some(self.formula(number)?),
            ["tabulated", "nk"] => {
                let [w, first, second] = self.columns()?;
                *n = Some(curve(w.clone(), first)?);
                *k = Some(curve(w, second)?);
            }
            ["tabulated", "n"] => {
                let [w, values] = self.columns()?;
                *n = Some(curve(w, values)?);
            }
            ["tabulated", "k"] => {
                let [w, values] = self.columns()?;
                *k = Some(curve(w, values)?);
            }
            _ => return Err(self.unknown_type()),
        }
        Ok(())
    }

    fn unknown_type(&self) -> ReadProblem {
        ReadProblem::malformed(format_args!(
            "the type \"{}\" of data is unknown; \"formula 1\" to \"formula 9\", \"tabulated nk\", \"tabulated n\" and \"tabulated k\" are allowed",
            short(&self.kind)
        ))
    }

    fn formula(&self, number: &str) -> Result<DispersionCurve, ReadProblem> {
        let missing = |what| ReadProblem::malformed(format_args!("a formula has no {what}"));
        let range = self.wavelength_range.as_deref();
        let range = numbers(range.ok_or_else(|| missing("wavelength_range"))?)?;
        let &[first, last] = range.as_slice() else {
            let what = "wavelength_range must have two numbers, micrometres";
            return Err(ReadProblem::malformed(what));
        };
        let coefficients = self.coefficients.as_deref();
        let coefficients = numbers(coefficients.ok_or_else(|| missing("coefficients"))?)?;
        let number = number.parse().map_err(|_| self.unknown_type())?;
        DispersionCurve::formula(number, coefficients, [first, last])
            .map_err(ReadProblem::malformed)
    }

    /// The columns of a table, one row per line, sorted by wavelength. Of several rows of one wavelength the first counts.
    fn columns<const N: usize>(&self) -> Result<[Vec<f64>; N], ReadProblem> {
        let missing = || ReadProblem::malformed("a table has no data");
        let text = self.data.as_deref().ok_or_else(missing)?;
        let mut rows = Vec::new();
        for line in text.lines().filter(|line| !line.trim().is_empty()) {
            let row = numbers(line)?;
            let row = <[f64; N]>::try_from(row).map_err(|row| {
                ReadProblem::malformed(format_args!(
                    "the row \"{}\" of {} has {} numbers; {N} are allowed",
                    short(line),
                    short(&self.kind),
                    row.len()
                ))
            })?;
            rows.push(row);
        }
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        rows.dedup_by(|later, first| later[0] == first[0]);
        Ok(std::array::from_fn(|i| {
            rows.iter().map(|row| row[i]).collect()
        }))
    }
}

fn curve(wavelengths: Vec<f64>, values: Vec<f64>) -> Result<DispersionCurve, ReadProblem> {
    DispersionCurve::table(wavelengths, values).map_err(ReadProblem::malformed)
}

/// Numbers that blanks separate.
fn numbers(text: &str) -> Result<Vec<f64>, ReadProblem> {
    let number = |word: &str| {
        let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| {
            ReadProblem::malformed(format_args!("\"{}\" is no finite number", short(word)))
        })
    };
    text.split_whitespace().map(number).collect()
}

/// A reference without the tags of HTML.
fn without_tags(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('<') {
        plain.push_str(before);
        match after.split_once('>') {
            Some((tag, after))
                if tag.starts_with(|c: char| c.is_ascii_alphabetic() || c == '/') =>
            {
                rest = after
            }
            _ => {
                plain.push('<');
                rest = after;
            }
        }
    }
    plain.push_str(rest);
    let lines = plain.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join("\n")
}

/// The first DOI of a reference that links to it.
fn doi_in(text: &str) -> Option<String> {
    let (_, after) = text.split_once("doi.org/")?;
    let end = after
        .find(['"', '<', '>', ' ', '\n'])
        .unwrap_or(after.len());
    after.starts_with("10.").then(|| after[..end].to_owned())
}
