//! The tables of a measurement: gonio.csv, in_plane.csv, bsdf.csv, and those of single directions.

use asperity_numerics::elementary::cos;
use asperity_simulate::CaseGroup;
use asperity_tally::{Component, Estimate, Polarimetry, Side, TallySpec};

use super::components::components;
use super::outcome::{Direction, GonioOutcome};
use super::peak::Peak;
use crate::output::{
    Column, GridBin, Table, bin_centre_columns, bin_columns, case_columns, grid_bin_columns,
    incidence_columns, over, solid_angle_column,
};
use crate::report::fluxes::{AVERAGING, Fluxes};
use crate::report::views::Csv;

/// The directions that were measured.
pub(super) fn measured<'a>(outcome: &'a GonioOutcome<'_>) -> impl Iterator<Item = Direction<'a>> {
    outcome.directions().filter(|one| one.outcome.is_some())
}

/// Flux into an in-plane bin that makes a BSDF of one: solid angle times mean |cos theta|, steradians.
pub(super) fn projected_in_plane(spec: &TallySpec, side: Side, i: usize) -> f64 {
    let filter = spec.in_plane_filter(side);
    let [a, b] = filter.theta_deg(i).map(f64::to_radians);
    filter.solid_angle(i) * 0.5 * (cos(a) + cos(b))
}

/// A column of each component of the light, all of it aside.
fn component_columns<'a, R: 'a>(
    spec: &TallySpec,
    quantity: &str,
    about: &'static str,
    value: impl Fn(&R, Component) -> Option<Estimate> + Copy + 'a,
) -> Vec<Column<'a, R>> {
    let column = |component: Component| {
        let name = format!("{quantity}_{}", component.name());
        Column::estimate(name, about, move |row: &R| value(row, component))
    };
    components(spec).skip(1).map(column).collect()
}

/// A column of what tracking polarisation changes on a side, if that is kept.
fn averaging_column<'a>(spec: &TallySpec, side: Side) -> Option<Column<'a, Direction<'a>>> {
    let is_kept = spec.polarimetry() == Polarimetry::Averaging;
    is_kept.then(|| {
        let name = format!("{side}_tracked_less_averaged");
        let difference = move |row: &Direction<'_>| row.tracked_less_averaged(side);
        Column::estimate(name, AVERAGING, difference)
    })
}

/// directions/NAME.csv: a row per bin.
pub(super) fn direction(direction: Direction<'_>) -> Csv<'_> {
    let grid = direction.spec.grid();
    let flux = move |bin: &usize, component| direction.bin(component, *bin);
    let averaging = direction.outcome.map(|found| {
        let entries = direction.spec.grid_entries(Component::All);
        Fluxes(found).averaging(move |bin: &usize| entries.get(*bin))
    });
    Table::new()
        .columns(bin_columns(grid, |bin| *bin))
        .column(solid_angle_column(grid, |bin| *bin))
        .column(Column::estimate("flux", "flux into the bin", move |bin| {
            flux(bin, Component::All)
        }))
        .column(
            Column::estimate("bsdf", "mean BSDF of the bin", move |bin: &usize| {
                direction.bsdf(*bin)
            })
            .unit("1/sr"),
        )
        .columns(component_columns(
            &direction.spec,
            "flux",
            "flux of a component of the light",
            flux,
        ))
        .columns(averaging.into_iter().flatten())
        .with_rows(direction.spec.recorded_bins())
}

/// gonio.csv: a row per direction, with its fluxes.
pub(super) fn directions<'a>(outcome: &'a GonioOutcome<'_>) -> Csv<'a> {
    type Row<'a> = Direction<'a>;
    let spec = outcome.spec();
    let groups = [
        CaseGroup::Surface,
        CaseGroup::Material,
        CaseGroup::Layer,
        CaseGroup::Other,
    ];
    let mut table = Table::new()
        .column(Column::new(
            "direction",
            "name of the direction",
            |row: &Row<'_>| row.case.direction_name(),
        ))
        .columns(incidence_columns(|row: &Row<'_>| row.case.light.incidence))
        .columns(case_columns(
            &outcome.plan.cases,
            &groups,
            |row: &Row<'_>| row.case,
        ));
    for side in spec.sides() {
        let flux = move |row: &Row<'_>, component| Some(row.flux(component, side)?.estimate());
        let name = side.to_string();
        let about = "flux of a component of the light";
        table = table
            .column(Column::estimate(
                name.clone(),
                "flux that leaves on this side",
                move |row: &Row<'_>| flux(row, Component::All),
            ))
            .columns(component_columns(spec, &name, about, flux))
            .columns(averaging_column(spec, side));
    }
    let ends = ["absorbed", "truncated", "lost"].into_iter().enumerate();
    table
        .columns(ends.map(|(i, name)| {
            let flux = move |row: &Row<'_>| Some(row.endings()?[i].estimate());
            Column::estimate(name, "flux that ends otherwise", flux)
        }))
        .column(Column::new("surfaces", "surfaces", |row: &Row<'_>| {
            row.outcome.map(|found| found.work.realisations)
        }))
        .column(Column::new(
            "rays",
            "rays over all surfaces",
            |row: &Row<'_>| row.outcome.map(|found| found.work.rays),
        ))
        .column(Column::new(
            "errors_from",
            "what the standard errors come from",
            |row: &Row<'_>| row.outcome.map(|found| found.errors_from.name()),
        ))
        .with_rows(measured(outcome))
}

/// A bin of the in-plane slice of a direction.
struct InPlaneBin<'a> {
    direction: Direction<'a>,
    side: Side,
    bin: usize,
}

/// The in-plane bins of all directions.
fn in_plane_bins<'a>(outcome: &'a GonioOutcome<'_>) -> impl Iterator<Item = InPlaneBin<'a>> {
    measured(outcome).flat_map(|direction| {
        let spec = direction.spec;
        spec.sides().flat_map(move |side| {
            (0..spec.in_plane_len()).map(move |bin| InPlaneBin {
                direction,
                side,
                bin,
            })
        })
    })
}

/// in_plane.csv: the BSDF in the plane of incidence, a row per direction, side and signed angle.
pub(super) fn in_plane<'a>(outcome: &'a GonioOutcome<'_>) -> Csv<'a> {
    type Row<'a> = InPlaneBin<'a>;
    let spec = outcome.spec();
    let bsdf = move |row: &Row<'_>, component| {
        let flux = row.direction.in_plane(component, row.side, row.bin)?;
        let projected = projected_in_plane(&row.direction.spec, row.side, row.bin);
        Some(over(flux, projected))
    };
    let edges = move |row: &Row<'_>| {
        let filter = row.direction.spec.in_plane_filter(row.side);
        filter.theta_deg(row.bin)
    };
    Table::new()
        .column(Column::new(
            "direction",
            "name of the direction",
            |row: &Row<'_>| row.direction.case.direction_name(),
        ))
        .columns(incidence_columns(|row: &Row<'_>| {
            row.direction.case.light.incidence
        }))
        .column(Column::new(
            "side",
            "side on which light leaves",
            |row: &Row<'_>| row.side.to_string(),
        ))
        .column(
            Column::new("theta_min_deg", "lower signed polar angle", move |row| {
                edges(row)[0]
            })
            .unit("deg"),
        )
        .column(
            Column::new("theta_max_deg", "upper signed polar angle", move |row| {
                edges(row)[1]
            })
            .unit("deg"),
        )
        .column(
            Column::estimate("bsdf", "mean BSDF of the bin", move |row| {
                bsdf(row, Component::All)
            })
            .unit("1/sr"),
        )
        .columns(
            component_columns(spec, "bsdf", "BSDF of a component of the light", bsdf)
                .into_iter()
                .map(|column| column.unit("1/sr")),
        )
        .with_rows(in_plane_bins(outcome))
}

/// A bin of a direction.
struct DirectionBin<'a> {
    direction: Direction<'a>,
    bin: usize,
}

/// The bins of all directions.
fn direction_bins<'a>(outcome: &'a GonioOutcome<'_>) -> impl Iterator<Item = DirectionBin<'a>> {
    measured(outcome).flat_map(|direction| {
        let bins = direction.spec.recorded_bins();
        bins.map(move |bin| DirectionBin { direction, bin })
    })
}

/// bsdf.csv: all directions of light and of bins in one table, for renderers.
pub(super) fn bsdf<'a>(outcome: &'a GonioOutcome<'_>) -> Csv<'a> {
    type Row<'a> = DirectionBin<'a>;
    let bsdf = |row: &Row<'_>| row.direction.bsdf(row.bin);
    let bin = |row: &Row<'_>| GridBin {
        grid: row.direction.spec.grid(),
        number: row.bin,
    };
    Table::new()
        .column(Column::new(
            "setting",
            "number of the setting",
            |row: &Row<'_>| row.direction.setting,
        ))
        .columns(incidence_columns(|row: &Row<'_>| {
            row.direction.case.light.incidence
        }))
        .columns(grid_bin_columns(bin))
        .columns(bin_centre_columns(bin))
        .column(Column::estimate("bsdf", "mean BSDF of the bin", bsdf).unit("1/sr"))
        .with_rows(direction_bins(outcome))
}

/// report.txt: a row per direction of a setting. Parts of the transmitted light are in gonio.csv. Of both sides, that without any light is
/// left out, and so are other ends of light that no light has.
pub(super) fn report(spec: &TallySpec) -> Table<'_, Direction<'_>> {
    type Row<'a> = Direction<'a>;
    let incidence = |row: &Row<'_>| row.case.light.incidence;
    let mut table = Table::new()
        .column(Column::new("theta", "", move |row| {
            incidence(row).theta_deg()
        }))
        .column(Column::new("phi", "", move |row| incidence(row).phi_deg()));
    for side in spec.sides() {
        let shown = match side {
            Side::Reflected => usize::MAX,
            Side::Transmitted => 1,
        };
        table = table.columns(components(spec).take(shown).map(|component| {
            let name = match component {
                Component::All => side.to_string(),
                component => component.name().into_owned(),
            };
            let flux = move |row: &Row<'_>| row.flux(component, side);
            let column = Column::estimate(name, "", flux);
            match side {
                Side::Transmitted if spec.records(Side::Reflected) => column.dropped_if_empty(),
                _ => column,
            }
        }));
        table = table.columns(averaging_column(spec, side));
    }
    let ends = ["absorbed", "truncated"].into_iter().enumerate();
    table = table.columns(ends.map(|(i, name)| {
        let end = move |row: &Row<'_>| Some(row.endings()?[i]);
        Column::estimate(name, "", end).dropped_if_empty()
    }));
    table.columns(spec.sides().map(|side| {
        let name = match side {
            Side::Reflected => "BRDF peak (1/sr) at theta, phi",
            Side::Transmitted => "BTDF peak (1/sr) at theta, phi",
        };
        let peak = move |row: &Row<'_>| Some(Peak::of(row, side)?.text());
        Column::new(name, "", peak).dropped_if_empty()
    }))
}
