//! Kind: what a value is, and how its text is read.

use asperity_analysis::{FlatLayers, MODEL_NAMES};
use asperity_io::{MaterialRecord, material, materials, names_file};
use asperity_simulate::Share;
use asperity_surface::LengthUnit;
use asperity_tally::HemisphereGrid;
use serde_json::Value;

use super::film_text::{FilmText, index};
use super::layer_text::LayerText;
use super::length::Length;
use super::range::Range;
use super::spread_text::SpreadText;
use crate::settings::number::{MOST_COUNT, parse_count, parse_number, parse_seconds};

/// Kind of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Present or not; `true` or `false` in a file.
    Switch,
    /// A number, or a quotient of two such as `1/1.4`.
    Number,
    /// Such a number, or one of several names.
    NumberOrChoice(&'static [Choice]),
    /// Such a number with or without a unit of length behind it: [`Length`].
    Length,
    /// Such a number in this unit, or with another unit of length behind it.
    LengthIn(LengthUnit),
    /// A whole number of one or more, also written as `1e6`.
    Count,
    /// A count up to 4294967295.
    Order,
    /// A whole number of zero or more.
    Seed,
    /// A time: seconds, or as `10m` or `2h`.
    Duration,
    /// One of several names.
    Choice(&'static [Choice]),
    /// One of several names, or a file.
    ChoiceOrFile(&'static [Choice]),
    /// One of several names, a material by its name, or a file of one.
    ChoiceOrMaterial(&'static [Choice]),
    /// A material by its name, or a file of one.
    Material,
    /// A layer of a thin film, `MATERIAL:THICKNESS`.
    Film,
    /// A layer of a stack, `MATERIAL:THICKNESS` with further keys.
    Layer,
    /// Directions of light around one, `klems`, `CONE` or `THETAxPHI`.
    Spread,
    /// Names of models, or `none`.
    Models,
    /// The name of a model.
    Model,
    /// A file or a folder.
    Path,
    /// Two numbers along polar angle and azimuth, `THETAxPHI`.
    Grid,
    /// Such numbers, or one of several names.
    GridOrChoice(&'static [Choice]),
    /// Numbers of pixels, `COLUMNSxROWS`.
    Pixels,
    /// A share of a run, `K/N`.
    Share,
}

/// A count that settings allow unless they are for small ones alone.
const MANY: f64 = 1e6;

/// One name that a setting allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The name.
    pub name: &'static str,
    /// Its meaning.
    pub help: &'static str,
    /// An old name, which stays valid but is not shown in the help.
    pub alias: Option<&'static str>,
}

/// A choice without an old name.
pub(super) const fn choice(name: &'static str, help: &'static str) -> Choice {
    Choice {
        name,
        help,
        alias: None,
    }
}

impl Kind {
    /// The names that it allows.
    #[must_use]
    pub const fn choices(self) -> &'static [Choice] {
        match self {
            Self::Choice(choices)
            | Self::ChoiceOrFile(choices)
            | Self::ChoiceOrMaterial(choices)
            | Self::NumberOrChoice(choices)
            | Self::GridOrChoice(choices) => choices,
            _ => &[],
        }
    }

    /// Names among which a wrong one may have been meant.
    pub(super) fn known_names(self) -> Vec<&'static str> {
        let choices = self.choices().iter().map(|choice| choice.name);
        match self {
            Self::ChoiceOrMaterial(_) | Self::Material | Self::Film | Self::Layer => {
                let names = |record: &'static MaterialRecord| {
                    let aliases = record.aliases.iter().map(String::as_str);
                    std::iter::once(record.name.as_str()).chain(aliases)
                };
                choices.chain(materials().iter().flat_map(names)).collect()
            }
            _ => choices.collect(),
        }
    }

    /// Returns `true` if even steps of it may be written as `FIRST:LAST:STEP`.
    pub(super) const fn has_steps(self) -> bool {
        matches!(self, Self::Number | Self::Length | Self::LengthIn(_))
    }

    /// Returns `true` if a file writes it as text in quotes, never as a bare number.
    pub(super) const fn is_text(self) -> bool {
        !matches!(
            self,
            Self::Switch
                | Self::Number
                | Self::Length
                | Self::LengthIn(_)
                | Self::NumberOrChoice(_)
                | Self::Count
                | Self::Order
                | Self::Seed
                | Self::Duration
        )
    }

    /// The value that `text` stands for; `None` if it is invalid or out of `range`.
    pub(super) fn parse(self, text: &str, range: Range) -> Option<Value> {
        match self {
            Self::Switch => text.parse::<bool>().ok().map(Value::from),
            Self::Number => {
                let number = parse_number(text).ok()?;
                range.contains(number).then(|| Value::from(number))
            }
            Self::Length => {
                let length = Length::parse(text)?;
                let value = serde_json::to_value(length).ok()?;
                range.contains(length.number()).then_some(value)
            }
            Self::LengthIn(unit) => {
                let number = Length::parse(text)?.in_unit(unit)?;
                range.contains(number).then(|| Value::from(number))
            }
            Self::NumberOrChoice(choices) => Self::Choice(choices)
                .parse(text, range)
                .or_else(|| Self::Number.parse(text, range)),
            Self::Count => count(text)
                .filter(|count| range.contains(*count as f64))
                .map(Value::from),
            Self::Order => count(text)
                .filter(|count| *count <= u32::MAX.into())
                .map(Value::from),
            Self::Seed => text
                .replace('_', "")
                .parse::<u64>()
                .ok()
                .or_else(|| count(text))
                .map(Value::from),
            Self::Duration => parse_seconds(text).ok().map(Value::from),
            Self::Choice(choices) => choices
                .iter()
                .find(|choice| choice.name == text || choice.alias == Some(text))
                .map(|choice| Value::from(choice.name)),
            Self::Grid => grid(text).map(|grid| Value::from(grid.to_string())),
            Self::GridOrChoice(choices) => Self::Choice(choices)
                .parse(text, range)
                .or_else(|| Self::Grid.parse(text, range)),
            Self::Pixels => {
                let [columns, rows] = whole_pair(text)?;
                Some(Value::from(vec![columns, rows]))
            }
            Self::Models | Self::Model => {
                names_of_models().contains(&text).then(|| Value::from(text))
            }
            // A file has an ending, or lies in a folder
            Self::ChoiceOrFile(choices) => Self::Choice(choices)
                .parse(text, range)
                .or_else(|| is_path(text).then(|| Value::from(text))),
            Self::ChoiceOrMaterial(choices) => Self::Choice(choices)
                .parse(text, range)
                .or_else(|| Self::Material.parse(text, range)),
            Self::Material => is_material(text).then(|| Value::from(text)),
            Self::Film => {
                let film = FilmText::parse(text)?;
                is_material(&film.material).then(|| Value::from(text))
            }
            Self::Layer => {
                let layer = LayerText::parse(text)?;
                is_material(&layer.material).then(|| Value::from(text))
            }
            Self::Spread => SpreadText::parse(text).map(|_| Value::from(text)),
            Self::Path => (!text.is_empty()).then(|| Value::from(text)),
            Self::Share => text.parse::<Share>().is_ok().then(|| Value::from(text)),
        }
    }

    /// Values allowed, without examples.
    pub(super) fn allowed(self, range: Range) -> String {
        match self {
            Self::Switch => "true or false".to_owned(),
            Self::Length | Self::LengthIn(_) | Self::Number if range == Range::Any => {
                "a number".to_owned()
            }
            Self::Length | Self::LengthIn(_) | Self::Number => format!("a number {range}"),
            Self::NumberOrChoice(choices) => {
                let number = Self::Number.allowed(range);
                format!("{number}, or {}", one_of(choices, None))
            }
            Self::GridOrChoice(choices) => {
                let grid = Self::Grid.allowed(range);
                format!("{grid}, or {}", one_of(choices, None))
            }
            Self::Count if range != Range::Any => format!("a whole number {range}"),
            Self::Count => format!("a whole number of 1 or more, up to {MOST_COUNT:e}"),
            Self::Order => format!("a whole number from 1 to {}", u32::MAX),
            Self::Seed => format!("a whole number from 0 to {}", u64::MAX),
            Self::Duration => "a time above 0, in seconds or with s, m or h".to_owned(),
            Self::Choice(choices) => one_of(choices, None),
            Self::ChoiceOrFile(choices) => one_of(choices, Some("a file")),
            Self::ChoiceOrMaterial(choices) => {
                format!("{}, {MATERIALS}", one_of(choices, None))
            }
            Self::Material => MATERIALS.to_owned(),
            Self::Film => "a layer as MATERIAL:THICKNESS or INDEX:THICKNESS, from above".to_owned(),
            Self::Layer => "a layer as MATERIAL:THICKNESS or INDEX:THICKNESS, which absorption=, scattering=, g= and surface= may follow, between colons".to_owned(),
            Self::Spread => {
                "klems, the half angle of a cone below 90, or the widths of a patch as THETAxPHI".to_owned()
            }
            Self::Models => "names of models, or none".to_owned(),
            Self::Model => "the name of a model".to_owned(),
            Self::Path => "a path".to_owned(),
            Self::Grid => {
                "two whole numbers as THETAxPHI, with a product of at most 4000000".to_owned()
            }
            Self::Pixels => "two whole numbers of pixels as COLUMNSxROWS".to_owned(),
            Self::Share => format!("K/N, with K from 1 to N and N up to {}", Share::MAX),
        }
    }

    /// Values in `unit` that are allowed, as they are written on the command line.
    pub(super) fn examples(self, range: Range, unit: &str) -> Vec<&'static str> {
        let candidates: &[&str] = match self {
            Self::Number if unit == "degrees" => &["30", "42.5"],
            Self::Length => &["1.4", "2e-3", "5um"],
            Self::LengthIn(_) => &["633", "633nm", "0.633um"],
            Self::Number | Self::NumberOrChoice(_) => &["1.4", "2e-3", "1/1.4"],
            Self::Count if !range.contains(MANY) => &["4"],
            Self::Count => &["1000", "1e6"],
            Self::Duration => &["90", "10m", "2h"],
            Self::Models => &["smith"],
            Self::Grid | Self::GridOrChoice(_) => &["18x36"],
            Self::Pixels => &["640x480"],
            Self::Share => &["2/7"],
            Self::Spread => &["klems", "2.5", "10x15"],
            Self::Layer => &["1.33:50um", "1.33:50um:scattering=0.1:g=0.8"],
            Self::Film => &["MgF2:100nm", "1.38:100nm", "2.1+0.05i:20nm"],
            _ => &[],
        };
        let candidates = candidates.iter().copied();
        candidates
            .filter(|text| self.parse(text, range).is_some())
            .collect()
    }
}

/// Materials in a sentence on what is allowed.
const MATERIALS: &str = "a material that `asperity materials` lists, a file .yml or .csv of one, or an index such as 1.52";

/// Returns `true` if a text names a material or a file of one, or is an index.
fn is_material(text: &str) -> bool {
    index(text).is_some() || names_file(text) || material(text).is_ok()
}

/// Returns `true` if a text is a file and no name: it has an ending, or lies in a folder.
fn is_path(text: &str) -> bool {
    text.contains(['.', '/', '\\', ':'])
}

/// Names of all models: of surfaces, and of layers.
pub(super) fn names_of_models() -> Vec<&'static str> {
    [MODEL_NAMES, &FlatLayers::NAMES].concat()
}

/// Examples in a sentence: `, such as a, b or c`; nothing without any.
pub(super) fn such_as(examples: &[&str]) -> String {
    match examples {
        [] => String::new(),
        examples => format!(", such as {}", joined_by_or(examples)),
    }
}

/// Names of choices in a sentence: `a, b or c`.
fn one_of(choices: &[Choice], further: Option<&str>) -> String {
    let mut names: Vec<&str> = choices.iter().map(|choice| choice.name).collect();
    names.extend(further);
    joined_by_or(&names)
}

/// Names in a sentence: `a, b or c`.
pub(super) fn joined_by_or(names: &[&str]) -> String {
    match names.split_last() {
        Some((last, [])) => (*last).to_owned(),
        Some((last, rest)) => format!("{} or {last}", rest.join(", ")),
        None => String::new(),
    }
}

fn count(text: &str) -> Option<u64> {
    parse_count(text).ok()
}

/// Two whole numbers, written as `AxB` or `A,B`.
fn whole_pair(text: &str) -> Option<[u64; 2]> {
    let (first, second) = text.split_once(['x', 'X', ','])?;
    Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
}

fn grid(text: &str) -> Option<HemisphereGrid> {
    let [theta, phi] = whole_pair(text)?;
    HemisphereGrid::new(theta.try_into().ok()?, phi.try_into().ok()?).ok()
}
