//! Appearance: what instruments near the specular direction read, from the apertures of a tally.
//!
//! Light in an aperture is taken as the part of the light of its side that falls into it, times all light of the side: scatter that both have in
//! common cancels, and a control variate of the whole counts.

use asperity_optics::dielectric;
use asperity_simulate::{CLEAR_DEG, Case, CaseApertures, CaseGroup, Outcome, STRAIGHT_DEG};
use asperity_tally::{
    Aperture, Component, Entry, Estimate, Side, TallyResult, TallyStatistics, is_of_few_rays,
};
use serde_json::{Map, Value};

use crate::output::{Column, EstimateWithLimit, Table, case_columns, incidence_columns};
use crate::report::flux_basis::FluxBasis;
use crate::report::views::Csv;

/// Index of the black glass of ISO 2813, a mirror of which has a gloss of 100.
const GLOSS_INDEX: f64 = 1.567;

/// Largest difference of the index behind a sample from that in front of it where light is said to pass it.
const SAME_INDEX: f64 = 1e-9;

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

    /// Name in text.
    const fn label(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Specular => "reflected within 2 deg",
            Self::Scatter => "TIS beyond 2 deg",
            Self::Gloss => "gloss (GU, by rays alone)",
            Self::Transmittance => "transmittance",
            Self::Straight => "transmitted within 2.5 deg",
            Self::Haze => "haze",
            Self::Clarity => "clarity",
        }
    }

    /// The quantity of a result; `None` where it is not defined, not recorded, or no light of its side was found.
    fn of(self, outcome: &Outcome) -> Option<EstimateWithLimit> {
        let case = &outcome.case;
        let (basis, apertures) = (FluxBasis::of(outcome), CaseApertures::of(case));
        let side = match self {
            Self::Reflectance | Self::Specular | Self::Scatter | Self::Gloss => Side::Reflected,
            _ => Side::Transmitted,
        };
        let statistics = &outcome.statistics;
        let passes = || {
            let index = case.index_beyond();
            index.is_some_and(|index| (index - 1.0).abs() < SAME_INDEX)
        };
        let total = statistics.flux(side, Component::All);
        if !statistics.spec().records(side) || self != Self::Reflectance && total.mean == 0.0 {
            return None;
        }
        // Nothing is known of apertures where nothing was traced.
        let light = |aperture: Option<Aperture>| {
            let entry = entry(statistics, aperture?)?;
            let all = entry_of_side(statistics, &apertures, side)?;
            let is_traced = outcome.deviation_bound.is_none();
            is_traced.then_some(Parts {
                statistics,
                all,
                total: statistics.spec().flux_entry(side, Component::All),
                part: entry,
            })
        };
        let part_of =
            |weight: f64, estimate: Estimate| basis.part(side, weight * total.mean, estimate);
        match self {
            Self::Reflectance | Self::Transmittance => Some(basis.flux(side, total)),
            Self::Specular => Some(basis.flux(side, light(Some(apertures.specular))?.flux())),
            Self::Straight => Some(basis.flux(side, light(apertures.straight)?.flux())),
            Self::Scatter => Some(part_of(1.0, light(Some(apertures.specular))?.outside())),
            Self::Haze if passes() => Some(part_of(1.0, light(apertures.straight)?.outside())),
            Self::Clarity if passes() => {
                let whole = entry(statistics, apertures.straight?)?;
                let centre = light(apertures.clear)?;
                let of_whole = Parts {
                    all: whole,
                    ..centre
                };
                let found = of_whole.outside_of_aperture()?;
                let estimate = Estimate {
                    mean: 1.0 - 2.0 * found.mean,
                    se: found.se.map(|se| 2.0 * se),
                };
                let light = statistics.at(whole).mean;
                Some(basis.part(side, 0.5 * light, estimate))
            }
            Self::Gloss if !case.light.is_polarised() => {
                let flux = basis.flux(side, light(apertures.gloss)?.flux());
                let black = dielectric(case.light.incidence.theta().cos(), GLOSS_INDEX);
                Some(flux.times(100.0 / black.reflected))
            }
            Self::Gloss | Self::Haze | Self::Clarity => None,
        }
    }
}

fn entry(statistics: &TallyStatistics, aperture: Aperture) -> Option<Entry> {
    let spec = statistics.spec();
    let number = spec.apertures().position(aperture)?;
    Some(spec.aperture_entries().get(number))
}

/// Entry of all light of a side, as apertures count it; `None` if none was found.
fn entry_of_side(
    statistics: &TallyStatistics,
    apertures: &CaseApertures,
    side: Side,
) -> Option<Entry> {
    entry(statistics, apertures.all[side.index()]).filter(|all| statistics.at(*all).mean > 0.0)
}

/// Light in an aperture, next to that which it is a part of.
#[derive(Clone, Copy)]
struct Parts<'a> {
    statistics: &'a TallyStatistics,
    /// Flux of the side.
    total: Entry,
    /// The same, as apertures count it, or that of a wider aperture.
    all: Entry,
    part: Entry,
}

impl Parts<'_> {
    fn mean(&self, entry: Entry) -> f64 {
        self.statistics.at(entry).mean
    }

    fn fraction(&self) -> f64 {
        self.mean(self.part) / self.mean(self.all)
    }

    /// Standard error of a sum of entries with these weights.
    fn error(&self, weights: &[(Entry, f64)]) -> Option<f64> {
        let mut square = 0.0;
        for &(a, weight) in weights {
            for &(b, other) in weights {
                square += weight * other * self.statistics.covariance(a, b)?;
            }
        }
        Some(square.max(0.0).sqrt())
    }

    /// Flux into the aperture: its part of all light, times that, with the error of a product of means to first order.
    fn flux(&self) -> Estimate {
        let fraction = self.fraction();
        let scale = self.mean(self.total) / self.mean(self.all);
        let of_total = self.mean(self.part) / self.mean(self.total);
        let weights = [
            (self.part, 1.0),
            (self.all, -fraction),
            (self.total, of_total),
        ];
        // Few rays have at least the error of one more.
        let own = self.statistics.at(self.part);
        let least = own.se.filter(|_| is_of_few_rays(own)).unwrap_or(0.0);
        Estimate {
            mean: fraction * self.mean(self.total),
            se: self.error(&weights).map(|se| scale * se.max(least)),
        }
    }

    /// Fraction of the light that is not in the aperture.
    fn outside(&self) -> Estimate {
        let all = self.mean(self.all);
        let weights = [(self.part, 1.0), (self.all, -self.fraction())];
        Estimate {
            mean: (all - self.mean(self.part)) / all,
            se: self.error(&weights).map(|se| se / all),
        }
    }

    /// The same within a wider aperture; `None` if no light was found there.
    fn outside_of_aperture(&self) -> Option<Estimate> {
        (self.mean(self.all) > 0.0).then(|| self.outside())
    }
}

/// One quantity of one result.
struct Row<'a> {
    outcome: &'a Outcome,
    quantity: Quantity,
    value: EstimateWithLimit,
}

fn rows<'a>(outcome: &'a Outcome) -> impl Iterator<Item = Row<'a>> {
    Quantity::ALL.into_iter().filter_map(move |quantity| {
        let value = quantity.of(outcome)?;
        Some(Row {
            outcome,
            quantity,
            value,
        })
    })
}

fn case_of<'r>(row: &'r Row<'_>) -> &'r Case {
    &row.outcome.case
}

/// appearance.csv: a row per case and quantity; `None` without results.
pub(crate) fn appearance_table<'a>(
    outcomes: impl IntoIterator<Item = &'a Outcome>,
) -> Option<Csv<'a>> {
    use CaseGroup::{Layer, Material, Other, Surface};
    let rows: Vec<Row<'a>> = outcomes.into_iter().flat_map(rows).collect();
    let first = std::slice::from_ref(&rows.first()?.outcome.case);
    let groups = [Surface, Material, Layer, Other];
    let about = format!(
        "reflectance and transmittance are directional-hemispherical; specular_reflectance: within 2 deg of the mirror direction; tis: part of reflected light beyond; gloss: of ISO 2813, in gloss units, by rays alone, without interference; straight_transmittance: within {STRAIGHT_DEG} deg of light that passes a flat sample; haze: part of transmitted light beyond; clarity: light within {CLEAR_DEG} deg less that from there to {STRAIGHT_DEG} deg, over their sum"
    );
    let table = Table::new()
        .columns(case_columns(first, &groups, case_of))
        .columns(incidence_columns(|row: &Row<'a>| {
            row.outcome.case.light.incidence
        }))
        .column(Column::new("quantity", about, |row: &Row<'a>| {
            row.quantity.name()
        }))
        .column(Column::estimate("value", "its value", |row: &Row<'a>| {
            Some(row.value)
        }));
    Some(table.with_rows(rows))
}

/// Adds name, unit and description of its columns.
pub(crate) fn describe_appearance<'a>(
    columns: &mut Value,
    outcomes: impl IntoIterator<Item = &'a Outcome>,
) {
    if let Some(table) = appearance_table(outcomes) {
        columns["appearance.csv"] = table.description;
    }
}

/// The quantities of a result as JSON, by name.
pub(crate) fn appearance_json(outcome: &Outcome) -> Map<String, Value> {
    let members = rows(outcome).map(|row| {
        let name = row.quantity.name().to_owned();
        (name, serde_json::json!(row.value))
    });
    members.collect()
}

/// The quantities beyond reflectance and transmittance as text, a line each.
pub(crate) fn appearance_text(outcome: &Outcome) -> String {
    let is_total = |row: &Row<'_>| {
        matches!(
            row.quantity,
            Quantity::Reflectance | Quantity::Transmittance
        )
    };
    let rows: Vec<Row<'_>> = rows(outcome).filter(|row| !is_total(row)).collect();
    let table = Table::new()
        .column(Column::new("appearance", "", |row: &Row<'_>| {
            row.quantity.label()
        }))
        .column(Column::new("", "", |row: &Row<'_>| row.value.text()));
    match rows.is_empty() {
        true => String::new(),
        false => table.text(rows),
    }
}

/// Columns of a table of text with a row per case, next to those that tell cases apart.
pub(crate) fn appearance_columns<'a, R: 'a>(
    outcome: impl Fn(&R) -> Option<&'a Outcome> + Copy + 'a,
) -> impl Iterator<Item = Column<'a, R>> {
    let narrow = Quantity::ALL
        .into_iter()
        .filter(|quantity| !matches!(quantity, Quantity::Reflectance | Quantity::Transmittance));
    narrow.map(move |quantity| {
        let value = move |row: &R| quantity.of(outcome(row)?);
        Column::estimate(quantity.label(), "", value).dropped_if_empty()
    })
}
