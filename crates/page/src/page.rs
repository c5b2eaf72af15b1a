//! Page: everything that it shows, and its text.

use std::path::Path;

use askama::Template;
use asperity_io::{is_same_file, printable, shown_path};
use asperity_studies::model_list;
use serde_json::{Value, json};

use crate::cases::{Case, ENERGIES};
use crate::comparison::{self, Difference, Differences};
use crate::error::PageError;
use crate::figures::{Drawing, Figure, figures, surface};
use crate::folder::Folder;
use crate::lobes::lobes;
use crate::story::{Story, story};
use crate::tables::Tables;
use crate::words;

/// Energies of one case.
struct EnergyRow {
    case: usize,
    label: String,
    values: Vec<String>,
    /// Shares of reflected, transmitted and absorbed light.
    shares: Vec<f64>,
}

/// The test of one model.
struct VerdictRow {
    label: String,
    model: String,
    light: &'static str,
    verdict: String,
    /// Class of the verdict in the style sheet.
    class: &'static str,
    distance: String,
    noise: String,
    p: String,
}

/// Largest length of a page, in bytes, unless what it has to show at least is longer.
const MAX_LENGTH: usize = 490_000;
/// Largest length of the report of the terminal on a page of one folder, in bytes.
const MAX_REPORT: usize = 20_000;

/// Contents of the page of one folder.
struct Part {
    name: String,
    story: Story,
    energies: Vec<EnergyRow>,
    verdicts: Vec<VerdictRow>,
    /// Names and descriptions of models, with their sources.
    models: Vec<(String, String)>,
    /// Sentences on the tests of the models.
    conclusion: Vec<String>,
    figures: Vec<Figure>,
    left_out: Vec<String>,
    surface: Option<String>,
    tables: Tables,
    command_line: String,
    /// Sentence on what wrote the results.
    origin: String,
    settings: Vec<(String, String)>,
    report: Option<String>,
}

#[derive(Template)]
#[template(path = "page.html")]
struct Html<'a> {
    version: &'a str,
    heading: String,
    command: &'a str,
    story: Story,
    differences: Vec<Difference>,
    settings: Vec<(String, Vec<String>)>,
    energies: [&'static str; 5],
    lobes: Option<String>,
    /// `false` if some directions have no lobes for their size.
    is_whole: bool,
    parts: Vec<Part>,
    style: &'static str,
    lobe_script: &'static str,
    script: &'static str,
}

/// A page on one result folder, or on several that it compares.
///
/// # Examples
/// ```no_run
/// use asperity_page::Page;
///
/// let page = Page::of(&["out"])?;
/// std::fs::write("report.html", page.html()?)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Page(Vec<Folder>);

impl Page {
    /// Reads manifest and summary of result folders, at least one, of `verify`, `trace`, `gonio`, `map`, `converge`, `attenuation`, `albedo` or
    /// `inspect`.
    ///
    /// # Errors
    /// [`PageError`] if no folder is given, or one is given twice, holds no results of these commands, or has another results epoch.
    pub fn of(paths: &[impl AsRef<Path>]) -> Result<Self, PageError> {
        if paths.is_empty() {
            return Err(PageError::NoFolder);
        }
        let mut folders: Vec<Folder> = Vec::new();
        for path in paths.iter().map(AsRef::as_ref) {
            if folders
                .iter()
                .any(|folder| is_same_file(&folder.path, path))
            {
                return Err(PageError::Twice(path.to_owned()));
            }
            folders.push(Folder::open(path)?);
        }
        Ok(Self(folders))
    }

    /// Checks that writing the page to `output` would not replace a file of the results.
    ///
    /// # Errors
    /// [`PageError::Input`] if it would.
    pub fn check_output(&self, output: &Path) -> Result<(), PageError> {
        let of_folder = |folder: &Folder| {
            let mut names = folder
                .files
                .iter()
                .map(String::as_str)
                .chain(["manifest.json"]);
            names.any(|name| is_same_file(&folder.path.join(name), output))
        };
        match self.0.iter().any(of_folder) {
            true => Err(PageError::Input(output.to_owned())),
            false => Ok(()),
        }
    }

    /// The page as HTML. Equal results give equal bytes.
    ///
    /// # Errors
    /// [`PageError`] if a file of the results cannot be read or is damaged.
    pub fn html(&self) -> Result<String, PageError> {
        let share = self.0.len();
        let names = self.names();
        let cases: Vec<Vec<Case>> = self.0.iter().map(Case::all).collect();
        let firsts: Vec<usize> = cases
            .iter()
            .scan(0, |next, cases| {
                Some(std::mem::replace(next, *next + cases.len()))
            })
            .collect();
        let folders = || self.0.iter().zip(&cases).zip(&firsts);
        let mut parts = Vec::new();
        let mut all_lobes = Vec::new();
        let mut is_whole = true;
        for (((folder, cases), &first), name) in folders().zip(&names) {
            parts.push(Part::of(folder, name, cases, first, share)?);
            let found = lobes(folder, cases, first, share)?;
            all_lobes.extend(found.lobes);
            is_whole &= found.is_whole;
        }
        let data = json!({ "cases": described(&names, &cases), "lobes": all_lobes });
        let mut html = Html {
            version: env!("CARGO_PKG_VERSION"),
            heading: self.heading(&names, &cases[0]),
            command: match share {
                1 => self.0[0].command(),
                _ => "report",
            },
            story: Vec::new(),
            differences: Vec::new(),
            settings: Vec::new(),
            energies: ENERGIES,
            // A script ends at the first "</", also within a string.
            lobes: (!all_lobes.is_empty()).then(|| data.to_string().replace('<', "\\u003c")),
            is_whole,
            style: include_str!("../templates/style.css"),
            lobe_script: include_str!("../templates/lobe.js"),
            script: include_str!("../templates/page.js"),
            parts,
        };
        if share > 1 {
            let found = comparison::differences(&cases);
            let settings: Vec<&[(String, String)]> = html
                .parts
                .iter()
                .map(|part| part.settings.as_slice())
                .collect();
            html.settings = comparison::settings(&settings);
            html.story = together(&found);
            html.differences = found.rows;
        } else {
            html.story.clone_from(&html.parts[0].story);
        }
        // Figures have the room that is left.
        let room = MAX_LENGTH.saturating_sub(html.render()?.len()) / share;
        for (i, ((folder, cases), &first)) in folders().enumerate() {
            let part = &mut html.parts[i];
            let found = figures(folder, cases, first, room, part.surface.is_some())?;
            (part.figures, part.left_out) = (found.figures, found.left_out);
        }
        Ok(html.render()?)
    }

    /// Names of the folders: the last part of their paths, or the whole path where that is the same for two.
    fn names(&self) -> Vec<String> {
        let names: Vec<String> = self.0.iter().map(Folder::name).collect();
        let is_shared = |name: &String| names.iter().filter(|other| *other == name).count() > 1;
        let named = |(folder, name): (&Folder, &String)| match is_shared(name) {
            true => shown_path(&folder.path),
            false => name.clone(),
        };
        self.0.iter().zip(&names).map(named).collect()
    }

    fn heading(&self, names: &[String], cases: &[Case]) -> String {
        match (names, cases) {
            ([_], [one]) if !one.label.is_empty() => one.label.clone(),
            _ => words::listed(names),
        }
    }
}

/// The cases of all folders as the scripts read them.
fn described(names: &[String], cases: &[Vec<Case>]) -> Vec<Value> {
    let of_part = |(part, (name, cases)): (usize, (&String, &Vec<Case>))| {
        let named = |label: &str| match names.len() {
            1 => label.to_owned(),
            _ => format!("{name}: {label}"),
        };
        let described = cases.iter().map(|case| {
            json!({
                "label": named(&case.label),
                "group": named(&case.group),
                "setting": case.group,
                "angle": case.angle(),
                "theta": case.theta,
                "phi": case.phi,
                "part": part,
            })
        });
        described.collect::<Vec<Value>>()
    };
    names
        .iter()
        .zip(cases)
        .enumerate()
        .flat_map(of_part)
        .collect()
}

/// The story of several folders.
fn together(found: &Differences) -> Story {
    let z = |row: &Difference| row.z.map_or(0.0, f64::abs);
    let largest = found.rows.iter().max_by(|a, b| z(a).total_cmp(&z(b)));
    let mut answers = Vec::new();
    match largest {
        None => answers.push("They have no cases in common whose energies could be compared; each folder is described below.".to_owned()),
        Some(row) if z(row) < 3.0 => answers.push("No energy differs by 3 standard errors or more.".to_owned()),
        Some(row) => answers.push(format!(
            "The most significant difference is that of {} light ({}): {}, {} standard errors.",
            row.quantity, row.case, row.difference, row.z_text()
        )),
    }
    if found.unmatched > 0 && found.cases > 0 {
        answers.push(format!(
            "{} compared; {} not in all folders.",
            words::counted(found.cases as u64, "case"),
            found.unmatched
        ));
    }
    let sure = match largest {
        Some(_) => "Differences have the standard errors of both results, taken as independent.",
        None => "What is known of each folder stands in its part of the page.",
    };
    vec![("Summary", answers), ("Notes", vec![sure.to_owned()])]
}

impl Part {
    /// The part of a folder without its figures, whose cases are numbered from `first`, on a page of `share` folders.
    fn of(
        folder: &Folder,
        name: &str,
        cases: &[Case],
        first: usize,
        share: usize,
    ) -> Result<Self, PageError> {
        let verdicts: Vec<VerdictRow> = cases.iter().flat_map(verdict_rows).collect();
        let report = folder.text("report.txt")?;
        Ok(Self {
            name: name.to_owned(),
            story: story(folder, cases),
            energies: (first..)
                .zip(cases)
                .map(|(number, case)| energy_row(number, case))
                .collect(),
            models: described_models(&verdicts),
            conclusion: conclusion(cases),
            verdicts,
            figures: Vec::new(),
            left_out: Vec::new(),
            surface: surface(folder)?,
            tables: Tables::of(folder, share)?,
            command_line: command_line(folder),
            origin: origin(folder),
            settings: settings_of(folder),
            report: report.filter(|text| text.len() <= MAX_REPORT / share),
        })
    }
}

fn energy_row(number: usize, case: &Case) -> EnergyRow {
    let value = |name: &&str| words::estimate_or_dash(&case.energy[*name]);
    let share = |name: &&str| case.energy[*name]["mean"].as_f64().unwrap_or(0.0).max(0.0);
    EnergyRow {
        case: number,
        label: case.label.clone(),
        values: ENERGIES.iter().map(value).collect(),
        shares: ENERGIES[..3]
            .iter()
            .map(share)
            .map(|share| (share * 1e4).round() / 1e4)
            .collect(),
    }
}

/// Sentences of the test of the only case.
fn conclusion(cases: &[Case]) -> Vec<String> {
    let [case] = cases else {
        return Vec::new();
    };
    let text = case.summary["comparison"]["conclusion"].as_str();
    let sentences = text.into_iter().flat_map(|text| text.split(". "));
    sentences.map(words::sentence).collect()
}

fn verdict_rows(case: &Case) -> Vec<VerdictRow> {
    let verdicts = case.verdicts().into_iter();
    verdicts
        .map(|one| VerdictRow {
            label: case.label.clone(),
            model: one.model,
            light: one.light,
            distance: words::two_digits(one.distance),
            noise: words::two_digits(one.noise),
            p: match one.p {
                Some(p) if p < 0.005 => "< 0.005".to_owned(),
                Some(p) => format!("{p:.2}"),
                None => "–".to_owned(),
            },
            class: match one.verdict.as_str() {
                "rejected" => "bad",
                "not rejected" => "good",
                _ => "open",
            },
            verdict: one.verdict,
        })
        .collect()
}

/// Names of the models of verdicts, with what `model --list` says of them.
fn described_models(verdicts: &[VerdictRow]) -> Vec<(String, String)> {
    let listed = model_list().unwrap_or_default();
    let listed = listed.iter().map(|model| json!(model));
    let is_used = |model: &Value| {
        verdicts
            .iter()
            .any(|row| model["name"] == row.model.as_str())
    };
    let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    listed
        .filter(is_used)
        .map(|model| {
            (
                text(&model["name"]),
                format!(
                    "{}; {}",
                    text(&model["description"]),
                    text(&model["valid_range"])
                ),
            )
        })
        .collect()
}

/// The command that made the results, as it was given.
fn command_line(folder: &Folder) -> String {
    let quoted = |word: String| {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
        match !word.is_empty() && word.chars().all(is_plain) {
            true => word,
            false => format!("'{}'", word.replace('\'', "'\\''")),
        }
    };
    let words = words::texts(&folder.manifest["arguments"]);
    let words: Vec<String> = words.into_iter().map(quoted).collect();
    match words.is_empty() {
        true => String::new(),
        false => printable(&format!("asperity {}", words.join(" "))).into_owned(),
    }
}

fn origin(folder: &Folder) -> String {
    let text = |key: &str| match &folder.manifest[key] {
        Value::String(text) => text.clone(),
        value => value.to_string(),
    };
    let seed = &folder.summary["seed"];
    let seed = if seed.is_null() {
        String::new()
    } else {
        format!(", seed {seed}")
    };
    format!(
        "Results in {} of asperity {}, commit {}, results epoch {}{seed}.",
        shown_path(&folder.path),
        text("version"),
        text("commit"),
        text("results_epoch"),
    )
}

/// Settings of the run. Of a run with a single case, further values of that case follow.
fn settings_of(folder: &Folder) -> Vec<(String, String)> {
    let config = &folder.summary["config"];
    let case = &config["case"];
    let mut settings = Vec::new();
    if case.is_null() {
        flatten(config, "", &mut settings);
        return settings;
    }
    flatten(&config[folder.command()], "", &mut settings);
    let mut of_case = Vec::new();
    flatten(case, "", &mut of_case);
    of_case.retain(|(key, _)| settings.iter().all(|(known, _)| known != key));
    settings.extend(of_case);
    settings
}

/// All values of a configuration with their keys, as in `run.rays`.
fn flatten(value: &Value, key: &str, into: &mut Vec<(String, String)>) {
    let joined = |name: &str| {
        if key.is_empty() {
            name.to_owned()
        } else {
            format!("{key}.{name}")
        }
    };
    match value {
        Value::Object(map) => map
            .iter()
            .for_each(|(name, value)| flatten(value, &joined(name), into)),
        Value::Null => {}
        Value::String(text) => into.push((key.to_owned(), text.clone())),
        Value::Array(values) if values.iter().all(|value| !value.is_object()) => {
            let texts = values.iter().map(|value| {
                value
                    .as_str()
                    .map_or_else(|| value.to_string(), str::to_owned)
            });
            into.push((key.to_owned(), texts.collect::<Vec<_>>().join(", ")));
        }
        value => into.push((key.to_owned(), value.to_string())),
    }
}
