//! Appearance: what instruments near the specular direction read, from the apertures of a tally.
//!
//! Coherent light, which rays do not have, is in every aperture about the specular directions. What is left of the light is scattered as rays are.

use asperity_numerics::elementary::cos;
use asperity_optics::dielectric;
use asperity_simulate::{Case, CaseApertures, CaseGroup, Outcome, short};
use asperity_surface::LengthUnit;
use asperity_tally::{Component, Estimate, Side, TallyResult};
use serde_json::{Map, Value, json};

use crate::config::Coherent;
use crate::output::{
    Cell, Column, EstimateWithLimit, Table, case_columns, fitted, incidence_columns, significant,
    with_error, wrapped,
};
use crate::report::aperture_light::{Parts, entry};
use crate::report::flux_basis::FluxBasis;
use crate::report::views::Csv;
use crate::validity::{CoherentLight, Validity};

/// Index of the black glass of ISO 2813, a mirror of which has a gloss of 100.
const GLOSS_INDEX: f64 = 1.567;

/// Quantity that an instrument reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Reflectance,
    Specular,
    Scatter,
    Gloss,
    Transmittance,
    Straight,
    Haze,
    Clarity,
}

impl Quantity {
    const ALL: [Self; 8] = [
        Self::Reflectance,
        Self::Specular,
        Self::Scatter,
        Self::Gloss,
        Self::Transmittance,
        Self::Straight,
        Self::Haze,
        Self::Clarity,
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Specular => "specular_reflectance",
            Self::Scatter => "tis",
            Self::Gloss => "gloss",
            Self::Transmittance => "transmittance",
            Self::Straight => "straight_transmittance",
            Self::Haze => "haze",
            Self::Clarity => "clarity",
        }
    }

    /// Name in text; `has_coherent`: coherent light is added.
    const fn label(self, has_coherent: bool) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Specular => "specular (2 deg)",
            Self::Scatter => "TIS (beyond 2 deg)",
            Self::Gloss if has_coherent => "gloss (GU)",
            Self::Gloss => "gloss (GU, by rays alone)",
            Self::Transmittance => "transmittance",
            Self::Straight => "straight (2.5 deg)",
            Self::Haze => "haze",
            Self::Clarity => "clarity",
        }
    }

    const fn side(self) -> Side {
        match self {
            Self::Reflectance | Self::Specular | Self::Scatter | Self::Gloss => Side::Reflected,
            _ => Side::Transmitted,
        }
    }

    /// Returns `true` of all light of a side.
    const fn is_total(self) -> bool {
        matches!(self, Self::Reflectance | Self::Transmittance)
    }

    /// The quantity of a sample; `None` where it is not defined, not recorded, or no light of its side was found.
    fn of(self, sample: &SampleLight<'_>) -> Option<Reading> {
        let (outcome, side) = (sample.outcome, self.side());
        let (case, statistics) = (&outcome.case, &outcome.statistics);
        let (basis, apertures) = (FluxBasis::of(outcome), CaseApertures::of(case));
        let total = statistics.flux(side, Component::All);
        if !statistics.spec().records(side) || self != Self::Reflectance && total.mean == 0.0 {
            return None;
        }
        let coherent = sample.coherent(side);
        let flux = |flux: Estimate| Reading {
            rays: basis.flux(side, flux),
            coherent: coherent.map(|one| one.flux),
            together: coherent.map(|one| one.with_rays(flux)),
        };
        if self.is_total() {
            return Some(flux(total));
        }
        let aperture = match self {
            Self::Specular | Self::Scatter => Some(apertures.specular),
            Self::Gloss => apertures.gloss.filter(|_| !case.light.is_polarised()),
            Self::Straight => apertures.straight,
            Self::Haze => apertures.straight.filter(|_| case.passes_on()),
            _ => apertures.clear.filter(|_| case.passes_on()),
        };
        let parts = Parts::of(outcome, &apertures, aperture?)?;
        Some(match self {
            Self::Gloss => {
                let black = dielectric(cos(case.light.incidence.theta()), GLOSS_INDEX);
                flux(parts.flux()).times(100.0 / black.reflected)
            }
            Self::Scatter | Self::Haze => Reading {
                rays: basis.part(side, total.mean, parts.outside(None)),
                coherent: None,
                together: coherent.map(|_| parts.outside(coherent)),
            },
            Self::Clarity => {
                let all = entry(statistics, apertures.straight?)?;
                let within = parts.within(all)?;
                let light = statistics.at(all).mean;
                let clarity = |coherent| {
                    let ring = within.outside(coherent);
                    Estimate {
                        mean: 1.0 - 2.0 * ring.mean,
                        se: ring.se.map(|se| 2.0 * se),
                    }
                };
                Reading {
                    rays: basis.part(side, 0.5 * light, clarity(None)),
                    coherent: None,
                    together: coherent.map(|_| clarity(coherent)),
                }
            }
            _ => flux(parts.flux()),
        })
    }
}

/// Results of a case, with what is known of its coherent light.
#[derive(Clone, Copy)]
pub(crate) struct SampleLight<'a> {
    outcome: &'a Outcome,
    /// Phases of its light; `None` where rays are taken alone.
    phases: Option<Validity>,
}

impl<'a> SampleLight<'a> {
    /// The results of a case. `validity`: where the unit of lengths is known; coherent light counts where a wavelength is given too, unless
    /// `chosen` says otherwise.
    pub(crate) fn new(
        outcome: &'a Outcome,
        validity: Option<Validity>,
        chosen: Option<Coherent>,
    ) -> Self {
        let counts = |validity: &Validity| match chosen {
            Some(chosen) => chosen == Coherent::Kirchhoff,
            None => !validity.wavelength_is_assumed,
        };
        let light = &outcome.case.light;
        let is_one_wave = !light.is_polarised() && light.spread.is_none();
        Self {
            outcome,
            phases: validity.filter(|validity| counts(validity) && is_one_wave),
        }
    }

    fn coherent(&self, side: Side) -> Option<CoherentLight> {
        self.phases?.coherent_light(&self.outcome.case, side)
    }
}

/// A reading: by rays, and with coherent light.
struct Reading {
    rays: EstimateWithLimit,
    /// Coherent light of a flux.
    coherent: Option<f64>,
    together: Option<Estimate>,
}

impl Reading {
    /// The reading in another unit, of which `factor` make one.
    fn times(self, factor: f64) -> Self {
        let scaled = |one: Estimate| EstimateWithLimit::from(one).times(factor).estimate();
        Self {
            rays: self.rays.times(factor),
            coherent: self.coherent.map(|one| factor * one),
            together: self.together.map(scaled),
        }
    }

    /// The reading that stands for the sample.
    fn best(&self) -> EstimateWithLimit {
        self.together.map_or(self.rays, EstimateWithLimit::from)
    }
}

/// One quantity of one sample.
struct Row<'a> {
    sample: SampleLight<'a>,
    quantity: Quantity,
    reading: Reading,
}

fn rows(sample: SampleLight<'_>) -> impl Iterator<Item = Row<'_>> {
    Quantity::ALL.into_iter().filter_map(move |quantity| {
        Some(Row {
            sample,
            quantity,
            reading: quantity.of(&sample)?,
        })
    })
}

fn case_of<'r>(row: &'r Row<'_>) -> &'r Case {
    &row.sample.outcome.case
}

/// Description of the quantities in files.
const ABOUT: &str = "reflectance and transmittance are directional-hemispherical; specular_reflectance: within 2 deg of the mirror direction; tis: part of reflected light beyond; gloss: of ISO 2813, in gloss units; straight_transmittance: within 2.5 deg of light that passes a flat sample; haze: part of transmitted light beyond; clarity: light within 0.5 deg less that from there to 2.5 deg, over their sum";

/// Columns of the readings in files.
fn reading_columns<'a>() -> [Column<'a, Row<'a>>; 4] {
    [
        Column::new("quantity", ABOUT, |row: &Row<'a>| row.quantity.name()),
        Column::estimate("by_rays", "value by rays alone", |row: &Row<'a>| {
            Some(row.reading.rays)
        }),
        Column::new(
            "coherent",
            "coherent light, by the Kirchhoff approximation: the coherent fraction of the light of a flat sample",
            |row: &Row<'a>| row.reading.coherent,
        ),
        Column::estimate(
            "together",
            "value with coherent light, rays being scaled by the fraction that is not coherent",
            |row: &Row<'a>| row.reading.together,
        ),
    ]
}

/// appearance.csv: a row per case and quantity; `None` without results.
pub(crate) fn appearance_table<'a>(
    samples: impl IntoIterator<Item = SampleLight<'a>>,
) -> Option<Csv<'a>> {
    use CaseGroup::{Layer, Material, Other, Surface};
    let rows: Vec<Row<'a>> = samples.into_iter().flat_map(rows).collect();
    let first = std::slice::from_ref(&rows.first()?.sample.outcome.case);
    let groups = [Surface, Material, Layer, Other];
    let incidence = |row: &Row<'a>| row.sample.outcome.case.light.incidence;
    let table = Table::new()
        .columns(case_columns(first, &groups, case_of))
        .columns(incidence_columns(incidence))
        .columns(reading_columns());
    Some(table.with_rows(rows))
}

/// Adds name, unit and description of its columns.
pub(crate) fn describe_appearance<'a>(
    columns: &mut Value,
    samples: impl IntoIterator<Item = SampleLight<'a>>,
) {
    if let Some(table) = appearance_table(samples) {
        columns["appearance.csv"] = table.description;
    }
}

/// The quantities of a sample as JSON, by name.
pub(crate) fn appearance_json(sample: SampleLight<'_>) -> Map<String, Value> {
    let members = rows(sample).map(|row| {
        let Reading {
            rays,
            coherent,
            together,
        } = row.reading;
        let mut value = json!(rays);
        if let Some(together) = together {
            value["coherent"] = json!(coherent);
            value["together"] = json!(together);
        }
        (row.quantity.name().to_owned(), value)
    });
    members.collect()
}

/// The quantities as text, a line each; reflectance and transmittance where coherent light changes them.
pub(crate) fn appearance_text(sample: SampleLight<'_>) -> String {
    let is_shown = |row: &Row<'_>| !row.quantity.is_total() || row.reading.together.is_some();
    let rows: Vec<Row<'_>> = rows(sample).filter(is_shown).collect();
    if rows.is_empty() {
        return String::new();
    }
    let has_coherent = rows.iter().any(|row| row.reading.together.is_some());
    let table = Table::new()
        .column(Column::new("appearance", "", |row: &Row<'_>| {
            let is_coherent = row.reading.together.is_some();
            row.quantity.label(is_coherent)
        }))
        .column(Column::new("by rays", "", |row: &Row<'_>| {
            row.reading.rays.text()
        }));
    let coherent = has_coherent.then(|| {
        [
            Column::new("coherent", "", |row: &Row<'_>| {
                Cell::from(row.reading.coherent.map(|one| short(in_three(one))))
            }),
            Column::new("together", "", |row: &Row<'_>| {
                Cell::from(row.reading.together.map(with_error))
            }),
        ]
    });
    let note = coherent_note([sample]).map_or_else(String::new, |note| note + "\n");
    table.columns(coherent.into_iter().flatten()).text(rows) + &note
}

/// Relative difference of readings below which a headline tells one of them.
const SAME: f64 = 0.01;

/// Haze, clarity and gloss in a line, as far as they are defined; `None` without haze.
pub(crate) fn appearance_line(sample: SampleLight<'_>) -> Option<String> {
    Quantity::Haze.of(&sample)?;
    let reading = |quantity: Quantity| {
        let reading = quantity.of(&sample)?;
        let (name, rays) = (quantity.name(), reading.rays.estimate().mean);
        let best = reading.best().estimate().mean;
        let other = match (best - rays).abs() <= SAME * rays.abs() {
            true => String::new(),
            false => format!(" ({} by rays alone; uncertain)", significant(rays)),
        };
        Some(format!("{name} {}{other}", significant(best)))
    };
    let all = [Quantity::Haze, Quantity::Clarity, Quantity::Gloss];
    let parts: Vec<String> = all.into_iter().filter_map(reading).collect();
    Some(fitted("", &parts, ""))
}

/// A number to three digits.
fn in_three(number: f64) -> f64 {
    format!("{number:.2e}").parse().unwrap_or(number)
}

/// Note on coherent light, if it is added to any reading of these samples.
pub(crate) fn coherent_note<'a>(
    samples: impl IntoIterator<Item = SampleLight<'a>>,
) -> Option<String> {
    let mut samples = samples.into_iter();
    let phases = samples.find_map(|sample| {
        let is_added = Side::BOTH
            .into_iter()
            .any(|side| sample.coherent(side).is_some());
        sample.phases.filter(|_| is_added)
    })?;
    let assumed = match phases.wavelength_is_assumed {
        true => ", assumed without --wavelength",
        false => "",
    };
    Some(wrapped(&format!(
        "coherent light by the Kirchhoff approximation at {} nm{assumed}: the coherent fraction of a flat sample's light is in the specular direction, and rays are scaled by the rest. It holds for a beam that is coherent over more than the correlation length, without shadowing, where the radius of curvature is large against the wavelength (see validity), and not at grazing angles. Both sides are taken apart, and need not add up to what rays conserve. Light that layers reflect, and light behind several layers, stays by rays. Heights of all lateral scales count: of a measured surface, --l-filter removes roughness longer than the coherence width of the beam. appearance.csv has rays and coherent light apart",
        short(phases.wavelength_nm)
    )))
}

/// Warning on coherent light that is requested where none is added.
pub(crate) fn coherent_warning(chosen: Option<Coherent>, case: &Case) -> Option<String> {
    let reason = if LengthUnit::Nanometre.conversion(case.at.unit).is_none() {
        "the lengths of the surface have no unit: give one by --unit, or to a file by --assume-unit"
    } else if case.light.is_polarised() {
        "the light is polarised"
    } else if case.light.spread.is_some() {
        "the light comes from many directions"
    } else {
        return None;
    };
    let is_chosen = chosen == Some(Coherent::Kirchhoff);
    is_chosen.then(|| format!("--coherent kirchhoff has no effect, since {reason}"))
}

/// Columns of a table of text with a row per case, next to those that tell cases apart.
pub(crate) fn appearance_columns<'a, R: 'a>(
    has_coherent: bool,
    sample: impl Fn(&R) -> Option<SampleLight<'a>> + Copy + 'a,
) -> impl Iterator<Item = Column<'a, R>> {
    let narrow = Quantity::ALL.into_iter();
    let narrow = narrow.filter(|quantity| !quantity.is_total());
    narrow.map(move |quantity| {
        let value = move |row: &R| Some(quantity.of(&sample(row)?)?.best());
        Column::estimate(quantity.label(has_coherent), "", value).dropped_if_empty()
    })
}
