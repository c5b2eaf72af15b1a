//! The tables of a measurement: gonio.csv, in_plane.csv, bsdf.csv, and those of single directions.

use crate::output::unit_of_lengths;
use asperity_optics::{Incidence, ParticipatingMedium, PhaseFunction, Slab};
use asperity_surface::LengthUnit;
use asperity_tally::{Estimate, Side, TallySpec};

use super::peak::Peak;
use super::results::{MeasuredComponent, component_names};
use super::specimen::bottom_in_words;
use super::{Direction, DirectionResults, GonioOutcome, Specimen};
use crate::output::{
    Column, GridBin, Table, bin_centre_columns, bin_columns, grid_bin_columns, material_columns,
    over, projected_solid_angle, solid_angle_column,
};

/// A direction that was measured.
pub(super) struct Measured<'a> {
    pub(super) setting: &'a Specimen,
    pub(super) direction: &'a Direction,
    pub(super) results: &'a DirectionResults,
}

/// The directions that were measured.
pub(super) fn measured(outcome: &GonioOutcome) -> impl Iterator<Item = Measured<'_>> {
    outcome.directions.iter().filter_map(|direction| {
        Some(Measured {
            setting: &outcome.settings[direction.setting],
            direction,
            results: direction.results.as_ref()?,
        })
    })
}

/// Flux into an in-plane bin that makes a BSDF of one: solid angle times mean |cos theta|, steradians.
pub(super) fn projected_in_plane(spec: &TallySpec, side: Side, i: usize) -> f64 {
    let filter = spec.in_plane_filter(side);
    let [a, b] = filter.theta_deg(i).map(f64::to_radians);
    filter.solid_angle(i) * 0.5 * (a.cos() + b.cos())
}

/// A column of each component of the light, all of it aside.
fn component_columns<'a, R: 'a>(
    spec: &TallySpec,
    quantity: &str,
    about: &'static str,
    value: impl Fn(&R, usize) -> Option<Estimate> + Copy + 'a,
) -> Vec<Column<'a, R>> {
    let names = component_names(spec).into_iter().enumerate().skip(1);
    let column = |(number, component)| {
        let value = move |row: &R| value(row, number);
        Column::estimate(format!("{quantity}_{component}"), about, value)
    };
    names.map(column).collect()
}

/// The columns `theta_i_deg` and `phi_i_deg`.
fn incidence_columns<'a, R: 'a>(
    incidence: impl Fn(&R) -> Incidence + Copy + 'a,
) -> [Column<'a, R>; 2] {
    let column = |name, about, angle: fn(Incidence) -> f64| {
        Column::new(name, about, move |row: &R| angle(incidence(row))).unit("deg")
    };
    [
        column(
            "theta_i_deg",
            "polar angle of the light",
            Incidence::theta_deg,
        ),
        column("phi_i_deg", "azimuth of the light", Incidence::phi_deg),
    ]
}

/// directions/NAME.csv: a row per bin.
pub(super) fn direction<'a>(
    spec: &'a TallySpec,
    results: &'a DirectionResults,
) -> Table<'a, usize> {
    let grid = spec.grid();
    let flux =
        move |bin: &usize, component: usize| results.components.get(component)?.bin(spec, *bin);
    Table::new()
        .columns(bin_columns(grid, |bin| *bin))
        .column(solid_angle_column(grid, |bin| *bin))
        .column(Column::estimate("flux", "flux into the bin", move |bin| {
            flux(bin, 0)
        }))
        .column(
            Column::estimate("bsdf", "mean BSDF of the bin", move |bin| {
                Some(over(flux(bin, 0)?, projected_solid_angle(&grid, *bin)))
            })
            .unit("1/sr"),
        )
        .columns(component_columns(
            spec,
            "flux",
            "flux of a component of the light",
            flux,
        ))
}

/// gonio.csv: a row per direction, with its fluxes.
pub(super) fn directions(spec: &TallySpec, unit: LengthUnit) -> Table<'_, Measured<'_>> {
    let name = |row: &Measured<'_>| row.direction.name.clone();
    let mut table = Table::new()
        .column(Column::new("direction", "name of the direction", name))
        .columns(incidence_columns(|row: &Measured<'_>| {
            row.direction.incidence
        }))
        .columns(setting_columns(unit));
    for side in spec.sides() {
        let flux = move |row: &Measured<'_>, component: usize| {
            row.results.components.get(component)?.side(spec, side)
        };
        let all = move |row: &Measured<'_>| flux(row, 0);
        table = table
            .column(Column::estimate(
                side.to_string(),
                "flux that leaves on this side",
                all,
            ))
            .columns(component_columns(
                spec,
                &side.to_string(),
                "flux of a component of the light",
                flux,
            ));
    }
    let ends = ["absorbed", "truncated", "lost"].into_iter().enumerate();
    table
        .columns(ends.map(|(i, name)| {
            let flux = move |row: &Measured<'_>| Some(row.results.budget.estimate(i));
            Column::estimate(name, "flux that ends otherwise", flux)
        }))
        .column(Column::new("surfaces", "surfaces", |row: &Measured<'_>| {
            row.results.surfaces
        }))
        .column(Column::new(
            "rays",
            "rays over all surfaces",
            |row: &Measured<'_>| row.results.rays,
        ))
        .column(Column::new(
            "errors_from",
            "what the standard errors come from",
            |row: &Measured<'_>| row.results.errors_from.clone(),
        ))
}

/// What light falls on: smoothness, material and medium.
fn setting_columns<'a>(unit: LengthUnit) -> Vec<Column<'a, Measured<'a>>> {
    type Row<'a> = Measured<'a>;
    fn medium(row: &Row<'_>) -> Option<ParticipatingMedium> {
        row.setting.layer.map(|layer| layer.medium())
    }
    fn slab(row: &Row<'_>) -> Option<Slab> {
        row.setting.layer.and_then(|layer| layer.end())
    }
    // That of a clear medium is infinite, which no field holds.
    let mean_free_path = |row: &Row<'_>| {
        let path = medium(row).map(|medium| medium.mean_free_path());
        path.filter(|path| path.is_finite())
    };
    let mut columns = vec![Column::new(
        "s",
        "smoothness tau / sigma",
        |row: &Row<'_>| row.setting.smoothness,
    )];
    columns.extend(material_columns(|row: &Row<'_>| row.setting.material));
    columns.extend([
        Column::new(
            "mean_free_path",
            "mean free path in the medium",
            mean_free_path,
        )
        .unit(unit_of_lengths(unit)),
        Column::new("albedo", "single-scattering albedo", |row: &Row<'_>| {
            medium(row).map(|medium| medium.albedo())
        }),
        Column::new("phase", "phase function", |row: &Row<'_>| {
            medium(row).map(|medium| phase_name(medium.phase()))
        }),
        Column::new("g", "mean cosine of the phase function", |row: &Row<'_>| {
            medium(row).map(|medium| medium.phase().mean_cosine())
        }),
        Column::new("thickness", "thickness of the layer", |row: &Row<'_>| {
            slab(row).map(|slab| slab.thickness)
        })
        .unit(unit_of_lengths(unit)),
        Column::new("bottom", "what the layer ends on", |row: &Row<'_>| {
            slab(row).map(|slab| bottom_in_words(slab.bottom))
        }),
    ]);
    columns
}

const fn phase_name(phase: PhaseFunction) -> &'static str {
    match phase {
        PhaseFunction::Isotropic => "isotropic",
        PhaseFunction::Rayleigh => "rayleigh",
        _ => "henyey-greenstein",
    }
}

/// A bin of the in-plane slice of a direction.
pub(super) struct InPlaneBin<'a> {
    measured: Measured<'a>,
    side: Side,
    bin: usize,
}

/// The in-plane bins of all directions.
pub(super) fn in_plane_bins(outcome: &GonioOutcome) -> impl Iterator<Item = InPlaneBin<'_>> {
    measured(outcome).flat_map(
        move |Measured {
                  setting,
                  direction,
                  results,
              }| {
            let spec = &direction.spec;
            spec.sides().flat_map(move |side| {
                (0..spec.in_plane_filter(side).len()).map(move |bin| InPlaneBin {
                    measured: Measured {
                        setting,
                        direction,
                        results,
                    },
                    side,
                    bin,
                })
            })
        },
    )
}

/// in_plane.csv: the BSDF in the plane of incidence, a row per direction, side and signed angle.
pub(super) fn in_plane(spec: &TallySpec) -> Table<'_, InPlaneBin<'_>> {
    type Row<'a> = InPlaneBin<'a>;
    let bsdf = move |row: &Row<'_>, component: usize| {
        let component: &MeasuredComponent = row.measured.results.components.get(component)?;
        let spec = &row.measured.direction.spec;
        let flux = component.in_plane(spec, row.side, row.bin)?;
        Some(over(flux, projected_in_plane(spec, row.side, row.bin)))
    };
    let edges = move |row: &Row<'_>| {
        let filter = row.measured.direction.spec.in_plane_filter(row.side);
        filter.theta_deg(row.bin)
    };
    Table::new()
        .column(Column::new(
            "direction",
            "name of the direction",
            |row: &Row<'_>| row.measured.direction.name.clone(),
        ))
        .columns(incidence_columns(|row: &Row<'_>| {
            row.measured.direction.incidence
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
            Column::estimate("bsdf", "mean BSDF of the bin", move |row| bsdf(row, 0)).unit("1/sr"),
        )
        .columns(component_columns(
            spec,
            "bsdf",
            "BSDF of a component of the light",
            bsdf,
        ))
}

/// A bin of a direction.
pub(super) struct DirectionBin<'a> {
    direction: &'a Direction,
    results: &'a DirectionResults,
    bin: usize,
}

/// The bins of all directions.
pub(super) fn direction_bins(outcome: &GonioOutcome) -> impl Iterator<Item = DirectionBin<'_>> {
    measured(outcome).flat_map(
        |Measured {
             direction, results, ..
         }| {
            direction.spec.recorded_bins().map(move |bin| DirectionBin {
                direction,
                results,
                bin,
            })
        },
    )
}

/// bsdf.csv: all directions of light and of bins in one table, for renderers.
pub(super) fn bsdf<'a>() -> Table<'a, DirectionBin<'a>> {
    type Row<'a> = DirectionBin<'a>;
    let bsdf = move |row: &Row<'_>| {
        let spec = &row.direction.spec;
        let flux = row.results.components[0].bin(spec, row.bin)?;
        Some(over(flux, projected_solid_angle(&spec.grid(), row.bin)))
    };
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
        .columns(incidence_columns(|row: &Row<'_>| row.direction.incidence))
        .columns(grid_bin_columns(bin))
        .columns(bin_centre_columns(bin))
        .column(Column::estimate("bsdf", "mean BSDF of the bin", bsdf).unit("1/sr"))
}

/// report.txt: a row per direction of a setting. Parts of the transmitted light are in gonio.csv.
pub(super) fn report(spec: &TallySpec) -> Table<'_, Direction> {
    let flux = move |side: Side, component: usize| {
        move |row: &Direction| row.results.as_ref()?.flux(spec, component, side)
    };
    let mut table = Table::new()
        .column(Column::new("theta", "", |row: &Direction| {
            row.incidence.theta_deg()
        }))
        .column(Column::new("phi", "", |row: &Direction| {
            row.incidence.phi_deg()
        }));
    for side in spec.sides() {
        let shown = match side {
            Side::Reflected => usize::MAX,
            Side::Transmitted => 1,
        };
        let components = component_names(spec).into_iter().enumerate().take(shown);
        table = table.columns(components.map(|(component, name)| {
            let name = if component == 0 {
                side.to_string()
            } else {
                name.to_string()
            };
            Column::estimate(name, "", flux(side, component))
        }));
    }
    for side in spec.sides() {
        let name = match side {
            Side::Reflected => "BRDF peak (1/sr)",
            Side::Transmitted => "BTDF peak (1/sr)",
        };
        let bsdf = move |row: &Direction| Some(Peak::of(row, side)?.bsdf);
        let place = move |row: &Direction| Some(Peak::of(row, side)?.place());
        table = table
            .column(Column::estimate(name, "", bsdf))
            .column(Column::new("at theta, phi", "", place));
    }
    let ends = ["absorbed", "truncated"].into_iter().enumerate();
    table.columns(ends.map(|(i, name)| {
        Column::estimate(name, "", move |row: &Direction| {
            Some(row.results.as_ref()?.endings()[i])
        })
    }))
}
