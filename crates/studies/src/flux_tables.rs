//! The tables of the fluxes of one case: histogram.csv, theta.csv, in_plane.csv and comparison.csv.

use std::path::Path;

use asperity_io::WriteError;
use asperity_simulate::{ErrorBudget, Errors};
use asperity_tally::{BatchStatistics, Estimate, History, Layout, OrderClass, Share, Side};

use crate::models::ModelOutcome;
use crate::output::{
    Column, Table, bin_columns, over, projected_solid_angle, ray_count, solid_angle_column,
};
use crate::part::Part;
use crate::verify::CaseOutcome;

/// The fluxes of one case with their errors.
#[derive(Clone, Copy)]
pub(crate) struct Fluxes<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) statistics: &'a BatchStatistics,
    pub(crate) errors: &'a ErrorBudget,
    /// Incident rays.
    pub(crate) rays: u64,
}

/// Writes histogram.csv, theta.csv and in_plane.csv.
pub(crate) fn write_fluxes(
    folder: &Path,
    fluxes: Fluxes<'_>,
    models: &[ModelOutcome],
) -> Result<(), WriteError> {
    let layout = fluxes.layout;
    histogram(fluxes).write_csv(&folder.join("histogram.csv"), layout.asked_bins())?;
    let rings = layout.grid().n_theta();
    theta(fluxes).write_csv(&folder.join("theta.csv"), places(layout, rings))?;
    let profile = places(layout, layout.in_plane_len());
    in_plane(fluxes, models).write_csv(&folder.join("in_plane.csv"), profile)
}

/// A ring of polar angle, or a bin of the in-plane slice, of one side.
struct Place {
    side: Side,
    index: usize,
}

/// All places of each side, `count` of them.
fn places(layout: &Layout, count: usize) -> impl Iterator<Item = Place> {
    let of_side = move |side| (0..count).map(move |index| Place { side, index });
    layout.sides().flat_map(of_side)
}

impl<'a> Fluxes<'a> {
    /// A column of an entry of the layout, by row.
    fn column<R: 'a>(
        self,
        name: impl Into<std::borrow::Cow<'a, str>>,
        about: &'static str,
        entry: impl Fn(&R) -> usize + 'a,
    ) -> Column<'a, R> {
        let estimate = move |row: &R| Some(self.statistics.estimate(entry(row)));
        Column::estimate(name, about, estimate)
    }

    /// Columns of light that a medium scattered never, once and more often; none without a medium.
    fn histories<R: 'a>(
        self,
        entry: impl Fn(History, &R) -> usize + Copy + 'a,
    ) -> impl Iterator<Item = Column<'a, R>> {
        let all = History::ALL.into_iter();
        let recorded = all.filter(move |_| self.layout.has_histories());
        recorded.map(move |history| {
            let about = match history {
                History::Unscattered => "flux of light that was never scattered inside the medium",
                History::Once => "flux of light that was scattered inside the medium once",
                History::More => "flux of light that was scattered inside the medium more often",
            };
            let name = format!("flux_{}", history.name());
            self.column(name, about, move |row| entry(history, row))
        })
    }

    /// Columns of light by its order of scattering at the surface.
    fn orders<R: 'a>(
        self,
        entry: impl Fn(OrderClass, &R) -> usize + Copy + 'a,
    ) -> impl Iterator<Item = Column<'a, R>> {
        let names = ["order_1", "order_2", "order_3", "order_4_and_above"];
        let classes = OrderClass::ALL.into_iter().zip(names);
        classes.map(move |(class, name)| {
            let about = "flux of light that met the surface as often";
            self.column(format!("flux_{name}"), about, move |row| entry(class, row))
        })
    }

    /// Columns that tell where the error of `flux` comes from.
    fn errors<R: 'a>(self, entry: impl Fn(&R) -> usize + Copy + 'a) -> [Column<'a, R>; 3] {
        let column = |name, about, of: fn(Errors) -> Option<f64>| {
            let value = move |row: &R| of(self.errors.errors(entry(row)));
            Column::new(name, about, value)
        };
        [
            column("flux_se_rays", "its error by the number of rays", |e| {
                e.rays
            }),
            column(
                "flux_se_surfaces",
                "its error by the number of surfaces",
                |e| e.surfaces,
            ),
            column(
                "flux_mesh",
                "what the spacing of the mesh adds to it",
                |e| e.mesh,
            ),
        ]
    }
}

/// histogram.csv: a row per bin.
fn histogram(fluxes: Fluxes<'_>) -> Table<'_, usize> {
    let Fluxes {
        layout,
        statistics,
        rays,
        ..
    } = fluxes;
    let grid = layout.grid();
    let entry = move |share| move |bin: &usize| layout.bins(share).start + bin;
    let total = move |bin: &usize| statistics.estimate(entry(Share::Total)(bin));
    let hits = move |bin: &usize| {
        let of = |share| statistics.means()[layout.hits(share).start + bin];
        let hits: f64 = [Share::Single, Share::Multiple].map(of).iter().sum();
        ray_count(hits * rays as f64)
    };
    Table::new()
        .columns(bin_columns(grid, |bin| *bin))
        .column(solid_angle_column(grid, |bin| *bin))
        .column(fluxes.column("flux", "flux into the bin", entry(Share::Total)))
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
        .column(Column::new("rays", "rays found in the bin", hits))
        .column(fluxes.column(
            "flux_single",
            "flux of light that met the surface once",
            entry(Share::Single),
        ))
        .column(fluxes.column(
            "flux_multiple",
            "flux of light that met the surface more often",
            entry(Share::Multiple),
        ))
        .columns(fluxes.histories(move |history, bin| layout.history_bins(history).start + bin))
        .columns(fluxes.errors(entry(Share::Total)))
}

/// theta.csv: a row per side and ring of polar angle.
fn theta(fluxes: Fluxes<'_>) -> Table<'_, Place> {
    let layout = fluxes.layout;
    let edges = Side::BOTH.map(|side| layout.grid().theta_edges_deg(side));
    let upper = edges.clone();
    let entry = move |class| move |ring: &Place| layout.rings(ring.side, class).start + ring.index;
    Table::new()
        .column(side_column())
        .column(
            Column::new("theta_min_deg", "lower polar angle", move |ring: &Place| {
                edges[ring.side.index()][ring.index]
            })
            .unit("deg"),
        )
        .column(
            Column::new("theta_max_deg", "upper polar angle", move |ring: &Place| {
                upper[ring.side.index()][ring.index + 1]
            })
            .unit("deg"),
        )
        .column(fluxes.column("flux", "flux into the ring", entry(OrderClass::All)))
        .columns(fluxes.orders(move |class, ring: &Place| entry(class)(ring)))
        .columns(fluxes.histories(move |history, ring: &Place| {
            layout.history_rings(ring.side, history).start + ring.index
        }))
        .columns(fluxes.errors(entry(OrderClass::All)))
}

fn side_column<'a>() -> Column<'a, Place> {
    Column::new("side", "side on which light leaves", |place: &Place| {
        place.side.to_string()
    })
}

/// in_plane.csv: a row per side and bin of the in-plane slice.
fn in_plane<'a>(fluxes: Fluxes<'a>, models: &'a [ModelOutcome]) -> Table<'a, Place> {
    let layout = fluxes.layout;
    let entry =
        move |class| move |place: &Place| layout.in_plane(place.side, class).start + place.index;
    let all = entry(OrderClass::All);
    let solid_angle = move |place: &Place| layout.in_plane_solid_angle(place.index);
    let edges = move |place: &Place| layout.in_plane_edges_deg(place.index);
    let intensity = move |statistics: &BatchStatistics, place: &Place| -> Estimate {
        over(statistics.estimate(all(place)), solid_angle(place))
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
                move |place: &Place| Some(intensity(fluxes.statistics, place)),
            )
            .unit("1/sr"),
        )
        .columns(fluxes.orders(move |class, place: &Place| entry(class)(place)))
        .columns(fluxes.histories(move |history, place: &Place| {
            layout.history_in_plane(place.side, history).start + place.index
        }))
        .columns(models.iter().map(move |model| {
            let name = format!("intensity_{}", column_name(model));
            let about = "flux over solid angle that the model expects";
            let expected = move |place: &Place| intensity(model.expectation.statistics(), place);
            let column = if model.expectation.is_exact() {
                Column::new(name, about, move |place| expected(place).mean)
            } else {
                Column::estimate(name, about, move |place| Some(expected(place)))
            };
            column.unit("1/sr")
        }))
        .columns(fluxes.errors(all))
}

/// The name of a model within those of columns.
fn column_name(model: &ModelOutcome) -> String {
    model.model.name().replace('-', "_")
}

/// Writes comparison.csv, unless there is no model.
pub(crate) fn write_comparison(
    folder: &Path,
    layout: &Layout,
    case: &CaseOutcome,
) -> Result<(), WriteError> {
    if case.models.is_empty() {
        return Ok(());
    }
    let table = comparison(layout, case);
    table.write_csv(&folder.join("comparison.csv"), layout.asked_bins())
}

/// comparison.csv: bin by bin, each part of the explicit light beside the models that describe it.
fn comparison<'a>(layout: &'a Layout, case: &'a CaseOutcome) -> Table<'a, usize> {
    let shown = |part: &Part| match part {
        Part::Inside(_) => layout.has_histories(),
        // Beside a medium, models say nothing of what the surface does alone.
        Part::Orders(share) => *share == Share::Total || !layout.has_histories(),
    };
    let first = layout.asked_bins().start;
    let mut table = Table::new().columns(bin_columns(layout.grid(), |bin| *bin));
    for part in Part::COMPARED.into_iter().filter(shown) {
        let start = part.bins(layout).start;
        let flux = move |bin: &usize| Some(case.statistics.estimate(start + bin));
        let name = format!("flux_{}", part.key());
        table = table.column(Column::estimate(name, "explicit flux into the bin", flux));
        let of_part = match part {
            Part::Orders(Share::Single) => String::new(),
            _ => format!("{}_", part.key()),
        };
        let claimed = case.models.iter().filter(|model| model.describes(part));
        for (model, compared) in claimed.filter_map(|m| Some((m, m.compared(part)?))) {
            let bins = &compared.comparison.bins;
            let name = |what| format!("{what}_{of_part}{}", column_name(model));
            let flux = move |bin: &usize| bins[bin - first].model;
            let z = move |bin: &usize| bins[bin - first].z;
            let tested = move |bin: &usize| u64::from(bins[bin - first].tested);
            table = table
                .column(Column::new(
                    name("flux"),
                    "flux that the model expects",
                    flux,
                ))
                .column(Column::new(
                    name("z"),
                    "their difference in standard errors",
                    z,
                ))
                .column(Column::new(
                    name("tested"),
                    "1 if the bin enters the test",
                    tested,
                ));
        }
    }
    table
}
