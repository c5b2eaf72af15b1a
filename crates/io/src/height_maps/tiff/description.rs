//! Lengths of TIFF files that are not georeferenced: the scale that ImageJ or OME describe, and the resolution.
//!
//! ImageJ states samples per unit of length as the resolution, and the unit in the description, with a calibration
//! of the samples: `c0 + c1` times the sample. OME states the size of a sample in XML.

use std::io::{Read, Seek};

use roxmltree::Document;

use super::directory::{Directory, File, Tag};
use super::lengths::{HeightScale, Lengths};
use super::units::NamedUnit;
use crate::error::ReadProblem;
use crate::text_lines::short;

/// Longest start tag of `Pixels` that is parsed, bytes.
const MAX_TAG: usize = 1 << 12;

/// Tags in which microscopes and their programs keep a scale that is not read.
///
/// # Source
/// `TIFF.TAGS` of C. Gohlke's `tifffile.py`: `OlympusSIS`, `UIC1tag`, `CZ_SEM`, `MM_Header`, `CZ_LSMINFO`, `FEI_SFEG`, `FEI_HELIOS`,
/// `MicroManagerMetadata`.
const SCALES: [(u64, &str); 8] = [
    (33560, "Olympus"),
    (33628, "MetaMorph"),
    (34118, "Zeiss microscopes (SEM)"),
    (34361, "FluoView"),
    (34412, "Zeiss microscopes (LSM)"),
    (34680, "FEI"),
    (34682, "FEI"),
    (51123, "Micro-Manager"),
];

pub(super) fn lengths<R: Read + Seek>(
    file: &mut File<R>,
    page: &Directory,
) -> Result<Lengths, ReadProblem> {
    // ImageJ escapes the sign for micro
    let text = page.text(file, Tag::ImageDescription)?.unwrap_or_default();
    let text = text.replace("\\u00B5", "\u{b5}");
    let x = page.numbers(file, Tag::XResolution)?;
    let y = page.numbers(file, Tag::YResolution)?;
    let resolution = x.zip(y).map(|(x, y)| [x[0], y[0]]);
    let resolution = resolution.filter(|both| both.iter().all(|n| n.is_finite() && *n > 0.0));
    let mut lengths = Lengths::default();
    if text.starts_with("ImageJ=") {
        read_imagej(&mut lengths, &text, resolution)?;
    } else if let Some(tag) = start_tag(&text) {
        read_ome(&mut lengths, tag)?;
    } else if let Some(resolution) = resolution {
        let unit = page.whole(file, Tag::ResolutionUnit)?.unwrap_or(2);
        lengths.notes.extend(note_on_resolution(resolution, unit));
    }
    if lengths.spacing.is_none()
        && let Some((tag, program)) = SCALES
            .iter()
            .find(|(tag, _)| page.private_tags().any(|found| found == *tag))
    {
        lengths.notes.push(format!(
            "the scale that {program} may have written (tag {tag}) is not read"
        ));
    }
    Ok(lengths)
}

impl Lengths {
    /// Takes a spacing of `steps`, each in a unit of its name.
    fn set_spacing(&mut self, steps: [f64; 2], units: [&str; 2]) {
        if units == ["pixel"; 2] {
            return;
        }
        let [Some(x), Some(y)] = units.map(NamedUnit::parse) else {
            self.notes.push(format!(
                "the file states a spacing of {} x {} in `{}`, which is no unit of length",
                steps[0],
                steps[1],
                short(units[0])
            ));
            return;
        };
        self.unit = x.power.kept_as();
        self.heights.factor = x.convert(1.0, self.unit);
        self.spacing = Some([
            x.convert(steps[0], self.unit),
            y.convert(steps[1], self.unit),
        ]);
    }

    /// Takes the unit of heights; without one, that of the grid, by its name, is assumed.
    fn set_height_unit(&mut self, unit: Option<NamedUnit>, grid: &str) {
        match unit {
            Some(unit) => {
                if self.spacing.is_none() {
                    self.unit = unit.power.kept_as();
                }
                self.heights.factor = unit.convert(1.0, self.unit);
            }
            None if self.spacing.is_some() => self.notes.push(format!(
                "the file states no unit for its heights; `{}`, that of its grid, is assumed",
                short(grid)
            )),
            None => {}
        }
    }
}

fn read_imagej(
    lengths: &mut Lengths,
    text: &str,
    resolution: Option<[f64; 2]>,
) -> Result<(), ReadProblem> {
    let value = |key: &str| {
        let mut lines = text.lines().filter_map(|line| line.split_once('='));
        lines.find_map(|(of, value)| (of == key).then_some(value.trim()))
    };
    if let (Some(resolution), Some(unit)) = (resolution, value("unit")) {
        let steps = resolution.map(|per_unit| 1.0 / per_unit);
        lengths.set_spacing(steps, [unit, value("yunit").unwrap_or(unit)]);
    }
    let unit = match value("vunit") {
        None | Some("" | "Gray Value") => None,
        Some(name) => Some(NamedUnit::parse(name).ok_or_else(|| {
            ReadProblem::unsupported(format_args!(
                "the unit of its heights is `{}`, but a unit of length is needed",
                short(name)
            ))
        })?),
    };
    lengths.set_height_unit(unit, value("unit").unwrap_or_default());
    match value("cf") {
        None => {}
        Some("0") => {
            let number = |key| {
                let number = value(key).and_then(|text| text.parse().ok());
                number.filter(|n: &f64| n.is_finite()).ok_or_else(|| {
                    ReadProblem::malformed(format_args!("its calibration by ImageJ lacks {key}"))
                })
            };
            lengths.heights = HeightScale {
                offset: number("c0")?,
                scale: number("c1")?,
                ..lengths.heights
            };
        }
        Some(other) => {
            return Err(ReadProblem::unsupported(format_args!(
                "its calibration by ImageJ has the function {}, but 0, a straight line, is read alone",
                short(other)
            )));
        }
    }
    Ok(())
}

/// The attributes in the start tag of the first `Pixels` of OME's XML.
fn start_tag(text: &str) -> Option<&str> {
    let is_ome = text.contains("<OME") || text.contains(":OME");
    let mut places = text.match_indices("Pixels").map(|(at, name)| {
        let before = &text[..at];
        (before.ends_with(['<', ':']), &text[at + name.len()..])
    });
    let (_, rest) =
        places.find(|(is_tag, rest)| *is_tag && rest.starts_with(char::is_whitespace))?;
    let end = rest.find('>')?;
    (is_ome && end <= MAX_TAG).then(|| rest[..end].trim_end_matches('/'))
}

fn read_ome(lengths: &mut Lengths, tag: &str) -> Result<(), ReadProblem> {
    let malformed = |what: &dyn std::fmt::Display| {
        ReadProblem::malformed(format_args!("its OME metadata: {what}"))
    };
    let element = format!("<Pixels {tag}/>");
    let document = Document::parse(&element).map_err(|error| malformed(&error))?;
    let attribute = |name: &str| document.root_element().attribute(name);
    let size = |name: &str| {
        let parse = |text: &str| {
            let number = text.trim().parse().ok();
            let number = number.filter(|n: &f64| n.is_finite() && *n > 0.0);
            number.ok_or_else(|| malformed(&format_args!("{name} is `{}`", short(text))))
        };
        attribute(name).map(parse).transpose()
    };
    let sizes = [size("PhysicalSizeX")?, size("PhysicalSizeY")?];
    let unit = |name| attribute(name).unwrap_or("\u{b5}m");
    let units = [unit("PhysicalSizeXUnit"), unit("PhysicalSizeYUnit")];
    if let Some(k) = sizes.iter().position(Option::is_some) {
        let one = (sizes[k].unwrap_or_default(), units[k]);
        let [(x, x_unit), (y, y_unit)] =
            [0, 1].map(|axis| sizes[axis].map_or(one, |size| (size, units[axis])));
        if sizes.contains(&None) {
            lengths.notes.push(format!(
                "the file states a spacing along {} alone: it is taken for both axes",
                ["x", "y"][k]
            ));
        }
        let units = [x_unit, y_unit];
        lengths.set_spacing([x, y], units);
        lengths.set_height_unit(None, units[0]);
    }
    Ok(())
}

/// Note on a resolution, unless it is that of a program that knew none.
fn note_on_resolution([x, y]: [f64; 2], unit: u64) -> Option<String> {
    let (name, micrometres) = match unit {
        2 => ("inch", 25400.0),
        3 => ("cm", 10000.0),
        _ => ("unit", 1.0),
    };
    let [dx, dy] = [x, y].map(|per_unit| (micrometres / per_unit * 1e3).round() / 1e3);
    let symbol = if micrometres > 1.0 { " um" } else { "" };
    (!symbol.is_empty() || [x, y] != [1.0; 2]).then(|| {
        format!(
            "the file has a resolution of {x} x {y} samples per {name}, which many programs write \
             without a measurement: it is not taken for a spacing, which would be {dx} x {dy}{symbol}"
        )
    })
}
