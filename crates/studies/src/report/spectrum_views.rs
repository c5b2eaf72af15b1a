//! Spectrum views: spectra and their colours as tables, text and a figure.

use std::fmt::Write;

use asperity_plot::{Colour, Curve, CurveAxis, Curves, Figure, PlotError, Point, Style};
use asperity_simulate::{Case, CaseGroup, Outcome};
use serde_json::Value;

use super::appearance::{SampleLight, describe_appearance};
use super::colours::{SideColour, colour_table};
use super::spectrum::{
    EMISSIVITY, Quantity, Spectrum, Wavelengths, emissivity, results_of, spectra,
};
use crate::output::{Column, Table, case_columns};
use crate::report::views::{Csv, Views};

/// Returns `true` if cases differ in the wavelength: a figure of their spectra stands for those of each, unless each is compared with models.
pub(crate) fn has_spectra<'c>(cases: impl IntoIterator<Item = &'c Case>) -> bool {
    Wavelengths::of(cases).is_some_and(Wavelengths::are_several)
}

/// Adds the files of spectra to those of a study that finds `J`, where `cases` are of named materials.
pub(crate) fn add_spectra<'v, 'c, J, F>(
    views: &mut Views<'v, J>,
    cases: impl IntoIterator<Item = &'c Case>,
    figures: bool,
    outcomes: F,
) where
    J: Sync + 'v,
    F: for<'j> Fn(&'j J) -> Vec<&'j Outcome> + Copy + Send + Sync + 'v,
{
    let wavelengths = Wavelengths::of(cases);
    if !wavelengths.is_some_and(Wavelengths::are_several) {
        return;
    }
    views.csv("spectrum.csv", move |found| {
        spectrum_table(&spectra(wavelengths, outcomes(found)))
    });
    views.csv("colour.csv", move |found| {
        let spectra = spectra(wavelengths, outcomes(found));
        colour_table(spectra.iter().flat_map(SideColour::of).collect())
    });
    if figures {
        views.figure("spectrum", move |found| {
            Ok(spectrum_figure(&spectra(wavelengths, outcomes(found)))?)
        });
    }
}

/// spectrum.csv: a row per result.
fn spectrum_table<'a>(spectra: &[Spectrum<'a>]) -> Option<Csv<'a>> {
    use CaseGroup::{Layer, Light, Material, Other, Surface};
    let groups = [Surface, Material, Layer, Other, Light];
    let rows: Vec<&'a Outcome> = results_of(spectra);
    let first = &rows.first()?.case;
    let columns = case_columns(std::slice::from_ref(first), &groups, case_of);
    let table = Table::new().columns(columns);
    let table = with_quantities(table);
    Some(table.with_rows(rows))
}

/// Name, unit and description of the columns of the tables of all cases, by file.
pub(crate) fn columns_of_all<'c>(
    cases: impl IntoIterator<Item = &'c Case>,
    outcomes: &[&Outcome],
    samples: impl IntoIterator<Item = SampleLight<'c>>,
) -> Value {
    let mut views: Views<'_, &[&Outcome]> = Views::new();
    add_spectra(&mut views, cases, false, |outcomes| outcomes.to_vec());
    let mut columns = views.columns(&outcomes);
    describe_appearance(&mut columns, samples);
    columns
}

/// The spectra as text, each below its label, with notes on them; `None` without any.
pub(crate) fn spectra_text<'c>(
    cases: impl IntoIterator<Item = &'c Case>,
    outcomes: &[&Outcome],
) -> Option<String> {
    let spectra = spectra(Wavelengths::of(cases), outcomes.iter().copied());
    let mut text = String::new();
    let mut has_colour = false;
    for spectrum in &spectra {
        let rows: Vec<&Outcome> = results_of(std::slice::from_ref(spectrum));
        let table = Table::new().column(Column::new("wavelength (nm)", "", |row: &&Outcome| {
            row.case.at.wavelength_nm()
        }));
        let _ = writeln!(text, "{}", spectrum.label());
        for colour in SideColour::of(spectrum) {
            has_colour = true;
            let _ = writeln!(text, "{}", colour.text());
        }
        text += &with_quantities(table).text(&rows);
    }
    if outcomes.iter().any(|one| emissivity(one).is_some()) {
        let _ = writeln!(text, "note: {EMISSIVITY}");
    }
    if !has_colour && spectra.iter().any(Spectrum::is_visible) {
        let _ = writeln!(text, "note: {NO_COLOUR}");
    }
    (!spectra.is_empty()).then_some(text)
}

/// Sentence on visible spectra without a colour.
const NO_COLOUR: &str = "colours need wavelengths from 400 to 700 nm, in steps of at most 20 nm";

fn case_of<'r>(row: &'r &Outcome) -> &'r Case {
    &row.case
}

/// The columns of a spectrum.
fn with_quantities<'t, 'a: 't>(mut table: Table<'t, &'a Outcome>) -> Table<'t, &'a Outcome> {
    for quantity in Quantity::ALL {
        let value = move |row: &&'a Outcome| quantity.of(row);
        let column = Column::estimate(quantity.name(), quantity.about(), value);
        table = table.column(column.dropped_if_empty());
    }
    let about = "of an opaque body: 1 less its directional-hemispherical reflectance";
    let value = |row: &&'a Outcome| emissivity(row);
    table.column(Column::estimate("emissivity", about, value).dropped_if_empty())
}

/// Points of a curve up to which each has a marker.
const MAX_MARKERS: usize = 60;

/// Spectra up to which each has a colour of its own; more of them take theirs from a ramp.
const MAX_COLOURS: usize = 7;

/// The figure of spectra. Of several the absorptance is left out.
///
/// # Errors
/// [`PlotError`] if it cannot be drawn.
fn spectrum_figure(spectra: &[Spectrum<'_>]) -> Result<Option<Figure>, PlotError> {
    let is_alone = spectra.len() == 1;
    let place = |number: usize| number as f64 / (spectra.len() - 1).max(1) as f64;
    let quantities = match is_alone {
        true => &Quantity::ALL[..],
        false => &[Quantity::Reflectance, Quantity::Transmittance],
    };
    let mut curves = Vec::new();
    for (number, spectrum) in spectra.iter().enumerate() {
        for (which, quantity) in quantities.iter().enumerate() {
            let points = spectrum.values(*quantity).map(|(wavelength, value)| Point {
                se: value.se,
                ..Point::exact(wavelength, value.mean)
            });
            let points: Vec<Point> = points.collect();
            if points.iter().all(|point| point.y == 0.0) {
                continue;
            }
            curves.push(Curve {
                name: match is_alone {
                    true => quantity.name().to_owned(),
                    false => {
                        format!(
                            "{}, {}",
                            quantity.name(),
                            spectrum.label_beside(spectra, false)
                        )
                    }
                },
                colour: match (is_alone, spectra.len() > MAX_COLOURS) {
                    (true, _) => Colour::Nth(which),
                    (false, false) => Colour::Nth(number),
                    (false, true) => Colour::Ramp(place(number)),
                },
                style: match points.len() > MAX_MARKERS {
                    true => Style::Band(which),
                    false => Style::Joined(which),
                },
                points,
            });
        }
    }
    if curves.is_empty() {
        return Ok(None);
    }
    for spectrum in spectra {
        let colours = SideColour::of(spectrum).into_iter();
        curves.extend(colours.filter(SideColour::has_srgb).map(|one| Curve {
            name: match is_alone {
                true => format!("{} under D65, 2 degrees, {}", one.side, one.hex()),
                false => format!("{}, {}", one.hex(), spectrum.label_beside(spectra, false)),
            },
            colour: Colour::Rgb(one.rgb()),
            style: Style::Swatch,
            points: Vec::new(),
        }));
    }
    let figure = Curves {
        title: "Directional-hemispherical spectrum".to_owned(),
        subtitle: spectra[0].label_beside(spectra, true),
        x: CurveAxis {
            label: "wavelength in vacuum (nm)".to_owned(),
            range: None,
        },
        y: CurveAxis {
            label: "fraction of the incident light".to_owned(),
            range: Some([0.0, 1.0]),
        },
        log_from: None,
        curves,
        notes: Vec::new(),
    };
    figure.draw().map(Some)
}
