//! Appearance: what instruments near the specular direction read, from the apertures of a tally.
//!
//! Light in an aperture is taken as the part of the light of its side that falls into it, times all light of the side: scatter that both have in
//! common cancels, and a control variate of the whole counts.
//!
//! Coherent light, which rays do not have, is in every aperture about the specular directions. What is left of the light is scattered as rays are.

use asperity_optics::dielectric;
use asperity_simulate::{Case, CaseApertures, CaseGroup, Outcome, short};
use asperity_surface::LengthUnit;
use asperity_tally::{
    Aperture, Component, Entry, Estimate, Side, TallyResult, TallyStatistics, is_of_few_rays,
};
use serde_json::{Map, Value, json};

use crate::config::Coherent;
use crate::output::{
    Cell, Column, EstimateWithLimit, Table, case_columns, incidence_columns, with_error, wrapped,
};
use crate::report::flux_basis::FluxBasis;
use crate::report::views::Csv;
use crate::validity::{CoherentLight, Validity};

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
            Self::Haze => apertures.straight.filter(|_| sample.passes_on()),
            _ => apertures.clear.filter(|_| sample.passes_on()),
        };
        let parts = Parts::of(outcome, &apertures, aperture?)?;
        Some(match self {
            Self::Gloss => {
                let black = dielectric(case.light.incidence.theta().cos(), GLOSS_INDEX);
                flux(parts.flux()).times(100.0 / black.reflected)
            }
            Self::Scatter | Self::Haze => Reading {
                rays: basis.part(side, total.mean, parts.outside(None)),
                coherent: None,
                together: coherent.map(|_| parts.outside(coherent)),
            },
            Self::Clarity => {
                let all = entry(statistics, apertures.straight?)?;
                let within = Parts {
                    total: all,
                    all,
                    ..parts
                };
                let light = statistics.at(all).mean;
                if light == 0.0 {
                    return None;
                }
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
        let is_polarised = outcome.case.light.is_polarised();
        Self {
            outcome,
            phases: validity.filter(|validity| counts(validity) && !is_polarised),
        }
    }

    fn coherent(&self, side: Side) -> Option<CoherentLight> {
        self.phases?.coherent_light(&self.outcome.case, side)
    }

    /// Returns `true` if light leaves into a medium of the index that it comes from.
    fn passes_on(&self) -> bool {
        let index = self.outcome.case.index_beyond();
        index.is_some_and(|index| (index - 1.0).abs() < SAME_INDEX)
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

impl CoherentLight {
    /// A flux by rays, scaled by what is not coherent, with this light added.
    fn with_rays(self, rays: Estimate) -> Estimate {
        let rest = 1.0 - self.fraction;
        Estimate {
            mean: self.flux + rest * rays.mean,
            se: rays.se.map(|se| rest * se),
        }
    }
}

fn entry(statistics: &TallyStatistics, aperture: Aperture) -> Option<Entry> {
    let spec = statistics.spec();
    let number = spec.apertures().position(aperture)?;
    Some(spec.aperture_entries().get(number))
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

impl<'a> Parts<'a> {
    /// Light in an aperture of a result; `None` if none of its side was found, or nothing was traced.
    fn of(outcome: &'a Outcome, apertures: &CaseApertures, aperture: Aperture) -> Option<Self> {
        let statistics = &outcome.statistics;
        let side = aperture.side;
        let all = entry(statistics, apertures.all[side.index()])?;
        let is_known = outcome.deviation_bound.is_none() && statistics.at(all).mean > 0.0;
        Some(Self {
            statistics,
            total: statistics.spec().flux_entry(side, Component::All),
            all,
            part: entry(statistics, aperture)?,
        })
        .filter(|_| is_known)
    }

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

    /// Fraction of the light that is not in the aperture, which coherent light is in.
    fn outside(&self, coherent: Option<CoherentLight>) -> Estimate {
        let (rest, added) = coherent.map_or((1.0, 0.0), |one| (1.0 - one.fraction, one.flux));
        let [part, all, total] = [self.part, self.all, self.total].map(|entry| self.mean(entry));
        let fraction = part / all;
        let scattered = rest * total;
        let light = added + scattered;
        let of_total = (1.0 - fraction) * all * added / (total * light);
        let weights = [
            (self.part, -1.0),
            (self.all, fraction),
            (self.total, of_total),
        ];
        let scale = scattered / light / all;
        Estimate {
            mean: scale * (all - part),
            se: self.error(&weights).map(|se| scale * se),
        }
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

/// The quantities beyond reflectance and transmittance as text, a line each.
pub(crate) fn appearance_text(sample: SampleLight<'_>) -> String {
    let rows: Vec<Row<'_>> = rows(sample)
        .filter(|row| !row.quantity.is_total())
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let has_coherent = rows.iter().any(|row| row.reading.together.is_some());
    let rays = if has_coherent { "by rays" } else { "" };
    let table = Table::new()
        .column(Column::new("appearance", "", |row: &Row<'_>| {
            let is_coherent = row.reading.together.is_some();
            row.quantity.label(is_coherent)
        }))
        .column(Column::new(rays, "", |row: &Row<'_>| {
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
        "coherent light by the Kirchhoff approximation at {} nm{assumed}: the coherent fraction of a flat sample's light is in the specular direction, and rays are scaled by the rest. It holds for a beam that is coherent over more than the correlation length, without shadowing, where the radius of curvature is large against the wavelength (see validity), and not at grazing angles. Heights of all lateral scales count: of a measured surface, --l-filter removes waves longer than the beam is coherent over",
        short(phases.wavelength_nm)
    )))
}

/// Warning on coherent light that is requested over lengths without a unit.
pub(crate) fn coherent_warning(chosen: Option<Coherent>, unit: LengthUnit) -> Option<String> {
    let is_unknown = LengthUnit::Nanometre.conversion(unit).is_none();
    (chosen == Some(Coherent::Kirchhoff) && is_unknown).then(|| {
        "--coherent kirchhoff has no effect, since the lengths of the surface have no unit: give one by --unit, or to a file by --assume-unit"
            .to_owned()
    })
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

#[cfg(test)]
mod tests {
    use asperity_tally::{TallySpec, TallyValues};

    use super::*;

    /// Batches whose light varies, a quarter of it in a cone: what both have in common cancels, and coherent light is in the cone.
    #[test]
    fn errors_of_parts_are_of_what_the_light_does_not_share() {
        let cone = Aperture::cone(Side::Reflected, 0.3, 0.1);
        let apertures = [Aperture::whole(Side::Reflected), cone];
        let spec = TallySpec::default().with_apertures(apertures.into_iter().collect());
        let [all, part] = [0, 1].map(|i| spec.aperture_entries().get(i));
        let total = spec.flux_entry(Side::Reflected, Component::All);
        let statistics = |noise: [f64; 4]| {
            let mut statistics = TallyStatistics::new(spec);
            for (flux, noise) in [0.5, 0.7, 0.4, 0.8].into_iter().zip(noise) {
                let mut batch = TallyValues::zeros(spec);
                batch[all] = flux;
                batch[part] = 0.25 * flux + noise;
                batch[total] = 0.6;
                statistics.push(&batch);
            }
            statistics
        };
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-12;
        let exact = statistics([0.0; 4]);
        let parts = |statistics| Parts {
            statistics,
            total,
            all,
            part,
        };
        let outside = parts(&exact).outside(None);
        assert!(near(outside.mean, 0.75) && near(outside.se.unwrap(), 0.0));
        let flux = parts(&exact).flux();
        assert!(near(flux.mean, 0.15) && near(flux.se.unwrap(), 0.0));

        let noise = [0.01, -0.02, 0.015, -0.005];
        let noisy = statistics(noise);
        let squares: f64 = noise.iter().map(|one| one * one).sum();
        let se = (squares / 12.0).sqrt() / 0.6;
        assert!(near(parts(&noisy).outside(None).se.unwrap(), se));
        assert!(near(parts(&noisy).flux().se.unwrap(), 0.6 * se));
        // Half of the light of a flat sample, which is 0.6 too
        let coherent = CoherentLight {
            fraction: 0.5,
            flux: 0.3,
        };
        let outside = parts(&noisy).outside(Some(coherent));
        assert!(near(outside.mean, 0.375) && near(outside.se.unwrap(), 0.5 * se));
        let together = coherent.with_rays(parts(&noisy).flux());
        assert!(near(together.mean, 0.3 + 0.5 * 0.15));
    }
}
