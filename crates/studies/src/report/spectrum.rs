//! Spectrum: reflectance, transmittance, absorptance and emissivity against wavelength, and their colours.
//!
//! Kirchhoff's law makes the emissivity of an opaque body into a direction its absorptance from there: 1 less its directional-hemispherical
//! reflectance.

use std::fmt::Write;

use asperity_plot::{Colour, Curve, CurveAxis, Curves, Figure, PlotError, Point, Style};
use asperity_simulate::{Case, CaseGroup, Outcome, short};
use asperity_tally::{Component, Estimate, Side, TallyResult};
use serde_json::Value;

use super::colours::{SideColour, colour_table};
use crate::output::{Column, EstimateWithLimit, Table, case_columns};
use crate::report::flux_basis::FluxBasis;
use crate::report::views::{Csv, Views};

/// Sentence on the emissivity, for reports.
pub(crate) const EMISSIVITY: &str = "emissivity is 1 less the directional-hemispherical reflectance of an opaque body at the angle of incidence, by Kirchhoff's law";

/// A quantity of a spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Reflectance,
    Transmittance,
    Absorptance,
}

impl Quantity {
    const ALL: [Self; 3] = [Self::Reflectance, Self::Transmittance, Self::Absorptance];

    const fn name(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Transmittance => "transmittance",
            Self::Absorptance => "absorptance",
        }
    }

    const fn about(self) -> &'static str {
        match self {
            Self::Reflectance => "directional-hemispherical reflectance",
            Self::Transmittance => "directional-hemispherical transmittance",
            Self::Absorptance => "absorbed fraction of the light",
        }
    }

    /// The quantity of a result; `None` where it is not recorded.
    fn of(self, outcome: &Outcome) -> Option<EstimateWithLimit> {
        let (basis, statistics) = (FluxBasis::of(outcome), &outcome.statistics);
        let side = match self {
            Self::Reflectance => Side::Reflected,
            Self::Transmittance => Side::Transmitted,
            Self::Absorptance => return Some(basis.absorbed(statistics.budget().absorbed)),
        };
        let is_recorded = statistics.spec().records(side);
        is_recorded.then(|| basis.flux(side, statistics.flux(side, Component::All)))
    }
}

/// Returns `true` if no light comes through the body below a surface.
fn is_opaque(case: &Case) -> bool {
    match case.layer {
        Some(below) => !below.layer.transmits(),
        None => case.material.transmitting_index().is_none(),
    }
}

/// Emissivity of an opaque body, into the direction that light comes from; `None` of another, or where reflected light is not recorded.
pub(crate) fn emissivity(outcome: &Outcome) -> Option<Estimate> {
    let reflected = Quantity::Reflectance.of(outcome)?.estimate();
    is_opaque(&outcome.case).then_some(Estimate {
        mean: 1.0 - reflected.mean,
        se: reflected.se,
    })
}

/// Results that differ in the wavelength alone, in its order.
pub(crate) struct Spectrum<'a> {
    /// What they share, in words.
    label: String,
    results: Vec<(f64, &'a Outcome)>,
}

/// The spectra among results, of two wavelengths or more.
pub(crate) fn spectra<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Vec<Spectrum<'a>> {
    let mut spectra: Vec<Spectrum<'a>> = Vec::new();
    for outcome in outcomes {
        let Some(wavelength) = outcome.case.at.wavelength_nm() else {
            continue;
        };
        let label = label(&outcome.case);
        let known = spectra.iter_mut().find(|spectrum| spectrum.label == label);
        match known {
            Some(spectrum) => spectrum.results.push((wavelength, outcome)),
            None => spectra.push(Spectrum {
                label,
                results: vec![(wavelength, outcome)],
            }),
        }
    }
    spectra.retain(|spectrum| spectrum.results.len() > 1);
    for spectrum in &mut spectra {
        spectrum.results.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    }
    spectra
}

/// A case in words without its wavelength, and without the absorption of a body, which follows from that.
fn label(case: &Case) -> String {
    let mut without = case.clone();
    without.at.others.clear();
    let medium = without.layer.map(|below| below.layer.medium());
    let is_body = medium.is_some_and(|medium| medium.albedo() == 0.0);
    let parts = without.setting_parts().into_iter();
    let parts = parts.filter(|part| !(is_body && BODY.contains(&part.name.as_str())));
    let parts: Vec<String> = parts.map(|part| part.text()).collect();
    let incidence = case.light.incidence;
    let [theta, phi] = [incidence.theta_deg(), incidence.phi_deg()].map(short);
    format!("{}, theta = {theta} deg, phi = {phi} deg", parts.join(", "))
}

/// Quantities of a body that absorbs, by the names of their parts.
const BODY: [&str; 3] = ["mean free path", "albedo", "g"];

/// Adds the files of spectra to those of a study that finds `J`, where `cases` are of named materials.
pub(crate) fn add_spectra<'v, J, F>(
    views: &mut Views<'v, J>,
    cases: &[Case],
    figures: bool,
    outcomes: F,
) where
    J: Sync + 'v,
    F: for<'j> Fn(&'j J) -> Vec<&'j Outcome> + Copy + Send + Sync + 'v,
{
    if cases.iter().all(|case| case.at.wavelength_nm().is_none()) {
        return;
    }
    views.csv("spectrum.csv", move |found| {
        spectrum_table(&spectra(outcomes(found)))
    });
    views.csv("colour.csv", move |found| {
        let spectra = spectra(outcomes(found));
        colour_table(spectra.iter().flat_map(SideColour::of).collect())
    });
    if figures {
        views.figure("spectrum", move |found| {
            Ok(spectrum_figure(&spectra(outcomes(found)))?)
        });
    }
}

/// spectrum.csv: a row per result.
fn spectrum_table<'a>(spectra: &[Spectrum<'a>]) -> Option<Csv<'a>> {
    use CaseGroup::{Layer, Light, Material, Other, Surface};
    let groups = [Surface, Material, Layer, Other, Light];
    let rows: Vec<&'a Outcome> = rows(spectra);
    let first = &rows.first()?.case;
    let columns = case_columns(std::slice::from_ref(first), &groups, case_of);
    let table = Table::new().columns(columns);
    let table = with_quantities(table);
    Some(table.with_rows(rows))
}

/// Name, unit and description of the columns of spectrum.csv; `None` where there is no spectrum.
pub(crate) fn spectrum_columns<'a>(
    outcomes: impl IntoIterator<Item = &'a Outcome>,
) -> Option<Value> {
    spectrum_table(&spectra(outcomes)).map(|table| table.description)
}

/// The same of colour.csv.
pub(crate) fn colour_columns<'a>(outcomes: impl IntoIterator<Item = &'a Outcome>) -> Option<Value> {
    let spectra = spectra(outcomes);
    let colours = spectra.iter().flat_map(SideColour::of).collect();
    colour_table(colours).map(|table| table.description)
}

/// The spectra as text, each with a line of what its results share.
pub(crate) fn spectra_text(spectra: &[Spectrum<'_>]) -> String {
    let mut text = String::new();
    for spectrum in spectra {
        let rows: Vec<&Outcome> = rows(std::slice::from_ref(spectrum));
        let table = Table::new().column(Column::new("wavelength (nm)", "", |row: &&Outcome| {
            row.case.at.wavelength_nm()
        }));
        let _ = writeln!(text, "{}", spectrum.label);
        text += &with_quantities(table).text(&rows);
        for colour in SideColour::of(spectrum) {
            let _ = writeln!(text, "{}", colour.text());
        }
    }
    text
}

fn case_of<'r>(row: &'r &Outcome) -> &'r Case {
    &row.case
}

fn rows<'a>(spectra: &[Spectrum<'a>]) -> Vec<&'a Outcome> {
    let results = spectra.iter().flat_map(|spectrum| &spectrum.results);
    results.map(|(_, outcome)| *outcome).collect()
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

/// The figure of spectra.
///
/// # Errors
/// [`PlotError`] if it cannot be drawn.
fn spectrum_figure(spectra: &[Spectrum<'_>]) -> Result<Option<Figure>, PlotError> {
    let is_alone = spectra.len() == 1;
    let mut curves = Vec::new();
    for (number, spectrum) in spectra.iter().enumerate() {
        for (which, quantity) in Quantity::ALL.into_iter().enumerate() {
            let points: Vec<Point> = spectrum.points(quantity);
            if points.iter().all(|point| point.y == 0.0) {
                continue;
            }
            curves.push(Curve {
                name: match is_alone {
                    true => quantity.name().to_owned(),
                    false => format!("{}, {}", quantity.name(), spectrum.label),
                },
                colour: Colour::Nth(if is_alone { which } else { number }),
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
    let colours = spectra.iter().flat_map(SideColour::of);
    curves.extend(colours.filter(SideColour::is_of_srgb).map(|one| Curve {
        name: match is_alone {
            true => format!("{} under D65, {}", one.side, one.hex()),
            false => format!("{} under D65, {}: {}", one.side, one.hex(), one.label),
        },
        colour: Colour::Rgb(one.rgb()),
        style: Style::Swatch,
        points: Vec::new(),
    }));
    let figure = Curves {
        title: "Directional-hemispherical spectrum".to_owned(),
        subtitle: match spectra {
            [one] => one.label.clone(),
            _ => String::new(),
        },
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

impl Spectrum<'_> {
    /// What its results share, in words.
    pub(crate) fn label(&self) -> &str {
        &self.label
    }

    /// Wavelengths, and the flux that leaves on `side`, where it is recorded.
    pub(crate) fn side(&self, side: Side) -> impl Iterator<Item = (f64, Estimate)> {
        let quantity = match side {
            Side::Reflected => Quantity::Reflectance,
            Side::Transmitted => Quantity::Transmittance,
        };
        let results = self.results.iter();
        results.filter_map(move |(wavelength, outcome)| {
            Some((*wavelength, quantity.of(outcome)?.estimate()))
        })
    }

    /// Points of a quantity; none where it is not recorded.
    fn points(&self, quantity: Quantity) -> Vec<Point> {
        let points = self.results.iter().filter_map(|(wavelength, outcome)| {
            let Estimate { mean, se } = quantity.of(outcome)?.estimate();
            Some(Point {
                se,
                ..Point::exact(*wavelength, mean)
            })
        });
        points.collect()
    }
}
