//! The tables of the fluxes of one case: histogram.csv, theta.csv, in_plane.csv and comparison.csv.

use asperity_numerics::elementary::hypot;
use asperity_simulate::Outcome;
use asperity_tally::{
    Component, Estimate, Side, TallyResult, TallySpec, TallyStatistics, is_of_few_rays,
};

use crate::comparison::compared::{COMPARED, key};
use crate::comparison::judgement::Judgement;
use crate::comparison::models::ModelOutcome;
use crate::output::{
    Column, Table, bin_columns, over, projected_solid_angle, ray_count, solid_angle_column,
};
use crate::report::fluxes::Fluxes;
use crate::report::views::Csv;

/// A ring of polar angle, or a bin of the in-plane slice, of one side.
struct AngularBin {
    side: Side,
    index: usize,
}

/// All places of each side, as many as `count` tells.
fn places<'a>(
    spec: &TallySpec,
    count: impl Fn(Side) -> usize + 'a,
) -> impl Iterator<Item = AngularBin> + 'a {
    let of_side = move |side| (0..count(side)).map(move |index| AngularBin { side, index });
    spec.sides().flat_map(of_side)
}

/// histogram.csv: a row per bin.
pub(crate) fn histogram(outcome: &Outcome) -> Csv<'_> {
    let fluxes = Fluxes(outcome);
    let statistics = &outcome.statistics;
    let (spec, rays) = (statistics.spec(), outcome.work.rays);
    let grid = spec.grid();
    let entry = move |component| move |bin: &usize| spec.grid_entries(component).get(*bin);
    let total = move |bin: &usize| statistics.at(entry(Component::All)(bin));
    let hits = move |bin: &usize| statistics.means().grid_hits(Component::All, *bin) * rays as f64;
    Table::new()
        .columns(bin_columns(grid, |bin| *bin))
        .column(solid_angle_column(grid, |bin| *bin))
        .column(fluxes.column("flux", "flux into the bin", entry(Component::All)))
        .column(
            Column::new("intensity", "flux over solid angle", move |bin: &usize| {
                total(bin).mean / grid.bin(*bin).solid_angle
            })
            .unit("1/sr"),
        )
        .column(
            Column::estimate("bsdf", "mean BSDF of the bin", move |bin: &usize| {
                Some(over(total(bin), projected_solid_angle(&grid, *bin)))
            })
            .unit("1/sr"),
        )
        .column(Column::new(
            "rays",
            "rays that the bin rests on; where bins are folded, those of its mirror image too",
            move |bin: &usize| ray_count(hits(bin)),
        ))
        .column(Column::new(
            "few_rays",
            "yes where the relative error of the flux is that of fewer than 20 rays, or larger",
            move |bin: &usize| yes_or_no(is_of_few_rays(total(bin))),
        ))
        .columns(fluxes.components(&Component::SURFACE, move |c, bin| entry(c)(bin)))
        .columns(fluxes.components(spec.components(), move |c, bin| entry(c)(bin)))
        .columns(fluxes.averaging(entry(Component::All)))
        .columns(fluxes.errors(entry(Component::All)))
        .with_rows(spec.recorded_bins())
}

/// Description of a column of yes or no.
const fn yes_or_no(is_so: bool) -> &'static str {
    match is_so {
        true => "yes",
        false => "no",
    }
}

/// theta.csv: a row per side and ring of polar angle.
pub(crate) fn theta(outcome: &Outcome) -> Csv<'_> {
    let (fluxes, spec) = (Fluxes(outcome), outcome.statistics.spec());
    let edges = move |ring: &AngularBin| spec.ring_filter(ring.side).theta_deg(ring.index);
    let entry =
        move |class| move |ring: &AngularBin| spec.ring_entries(ring.side, class).get(ring.index);
    Table::new()
        .column(side_column())
        .column(
            Column::new(
                "theta_min_deg",
                "lower polar angle",
                move |ring: &AngularBin| edges(ring)[0],
            )
            .unit("deg"),
        )
        .column(
            Column::new(
                "theta_max_deg",
                "upper polar angle",
                move |ring: &AngularBin| edges(ring)[1],
            )
            .unit("deg"),
        )
        .column(fluxes.column("flux", "flux into the ring", entry(Component::All)))
        .columns(fluxes.components(&Component::ORDERS, move |c, ring| entry(c)(ring)))
        .columns(fluxes.components(spec.components(), move |c, ring| entry(c)(ring)))
        .columns(fluxes.averaging(entry(Component::All)))
        .columns(fluxes.errors(entry(Component::All)))
        .column(fluxes.few_samples(move |c, ring| entry(c)(ring)))
        .with_rows(places(spec, |side| spec.ring_filter(side).len()))
}

fn side_column<'a>() -> Column<'a, AngularBin> {
    Column::new(
        "side",
        "side on which light leaves",
        |place: &AngularBin| place.side.to_string(),
    )
}

/// in_plane.csv: a row per side and bin of the in-plane slice.
pub(crate) fn in_plane<'a>(outcome: &'a Outcome, models: &'a [ModelOutcome]) -> Csv<'a> {
    let (fluxes, spec) = (Fluxes(outcome), outcome.statistics.spec());
    let entry = move |class| {
        move |place: &AngularBin| spec.in_plane_entries(place.side, class).get(place.index)
    };
    let all = entry(Component::All);
    let filter = move |place: &AngularBin| spec.in_plane_filter(place.side);
    let solid_angle = move |place: &AngularBin| filter(place).solid_angle(place.index);
    let edges = move |place: &AngularBin| filter(place).theta_deg(place.index);
    let intensity = move |statistics: &TallyStatistics, place: &AngularBin| -> Estimate {
        over(statistics.at(all(place)), solid_angle(place))
    };
    Table::new()
        .column(side_column())
        .column(
            Column::new("theta_min_deg", "lower signed polar angle", move |place| {
                edges(place)[0]
            })
            .unit("deg"),
        )
        .column(
            Column::new("theta_max_deg", "upper signed polar angle", move |place| {
                edges(place)[1]
            })
            .unit("deg"),
        )
        .column(Column::new("solid_angle_sr", "solid angle of the bin", solid_angle).unit("sr"))
        .column(fluxes.column("flux", "flux into the bin", all))
        .column(
            Column::estimate(
                "intensity",
                "flux over solid angle",
                move |place: &AngularBin| Some(intensity(&outcome.statistics, place)),
            )
            .unit("1/sr"),
        )
        .columns(fluxes.components(&Component::ORDERS, move |c, place| entry(c)(place)))
        .columns(fluxes.components(spec.components(), move |c, place| entry(c)(place)))
        .columns(models.iter().map(move |model| {
            let name = format!("intensity_{}", column_name(model));
            let about = "flux over solid angle that the model expects";
            let expected =
                move |place: &AngularBin| intensity(model.expectation.statistics(), place);
            let column = if model.expectation.is_exact() {
                Column::new(name, about, move |place| expected(place).mean)
            } else {
                Column::estimate(name, about, move |place| Some(expected(place)))
            };
            column.unit("1/sr")
        }))
        .columns(fluxes.averaging(all))
        .columns(fluxes.errors(all))
        .column(fluxes.few_samples(move |c, place| entry(c)(place)))
        .with_rows(places(spec, |side| spec.in_plane_filter(side).len()))
}

/// A difference over its standard error; infinite if that is zero, and `None` if both are.
fn z_score(difference: f64, standard_error: f64) -> Option<f64> {
    (difference != 0.0 || standard_error > 0.0).then(|| difference / standard_error)
}

/// The name of a model within those of columns.
fn column_name(model: &ModelOutcome) -> String {
    model.model.name().replace('-', "_")
}

/// comparison.csv: bin by bin, each component of the explicit light next to the models that describe it.
pub(crate) fn comparison<'a>(case: &'a Judgement<'_>) -> Csv<'a> {
    let spec = case.spec();
    // With a medium, no model describes what the surface does alone.
    let shown = |c: &Component| *c == Component::All || c.is_of_medium() == spec.has_medium();
    let first = spec.recorded_bins().start;
    let mut table = Table::new().columns(bin_columns(spec.grid(), |bin| *bin));
    for component in COMPARED.into_iter().filter(shown) {
        let entries = spec.grid_entries(component);
        let flux = move |bin: &usize| Some(case.outcome.statistics.at(entries.get(*bin)));
        let name = format!("flux_{}", key(component));
        table = table.column(Column::estimate(name, "explicit flux into the bin", flux));
        let of_component = match component {
            Component::Single => String::new(),
            _ => format!("{}_", key(component)),
        };
        let claimed = case
            .models
            .iter()
            .filter(|model| model.describes(component));
        for (model, compared) in claimed.filter_map(|m| Some((m, m.compared(component)?))) {
            let bins = &compared.comparison.bins;
            let name = |what| format!("{what}_{of_component}{}", column_name(model));
            let of_model = move |bin: &usize| Estimate {
                mean: bins[bin - first].model,
                ..model.expectation.statistics().at(entries.get(*bin))
            };
            let is_exact = model.expectation.is_exact();
            let z = move |bin: &usize| {
                let (found, of_model) = (flux(bin)?, of_model(bin));
                let noise = if is_exact { 0.0 } else { of_model.se? };
                z_score(found.mean - of_model.mean, hypot(found.se?, noise))
            };
            let about = "flux that the model expects";
            let expected = match is_exact {
                true => Column::new(name("flux"), about, move |bin| of_model(bin).mean),
                false => Column::estimate(name("flux"), about, move |bin| Some(of_model(bin))),
            };
            let tested = move |bin: &usize| u64::from(bins[bin - first].tested);
            table = table
                .column(expected)
                .column(Column::new(
                    name("z"),
                    "their difference over the root of the sum of the squares of their standard errors",
                    z,
                ))
                .column(Column::new(
                    name("tested"),
                    "1 if the bin enters the test",
                    tested,
                ));
        }
    }
    table.with_rows(spec.recorded_bins())
}
