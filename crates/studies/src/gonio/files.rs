//! The files of a measurement: tables, arrays, plots, report.txt and summary.json.

use std::collections::HashSet;
use std::path::Path;

use asperity_io::{
    CsvField as Field, WriteError, create_output_folder, names_in, remove_files, write_array,
    write_bytes, write_csv, write_json,
};
use asperity_optics::{Material, PhaseFunction};
use asperity_tally::{Estimate, Layout, Side};

use super::plan::Plan;
use super::results::part_names;
use super::setting::bottom_in_words;
use super::summary::{gonio_summary, gonio_table};
use super::{Direction, DirectionResults, FOLDER, GonioError, GonioOutcome, Setting, figures};
use crate::csv::{PLACE, fields, place};
use crate::report::{FILES, ReportError};

/// Writes a measurement into `folder`: gonio.csv, in_plane.csv, bsdf.csv, bsdf.npy, bsdf_se.npy, plots, report.txt,
/// and, last, summary.json.
///
/// All of it depends on the directions alone, not on how many runs they took.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn gonio_report(folder: &Path, outcome: &GonioOutcome) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    remove_files(folder, FILES)?;
    for (direction, results) in measured(outcome) {
        write_direction(folder, &direction.name, &outcome.layout, results)?;
    }
    write_directions(folder, outcome)?;
    write_in_plane(folder, outcome)?;
    write_bsdf(folder, outcome)?;
    write_arrays(folder, outcome)?;
    figures::draw(folder, outcome)?;
    write_bytes(folder.join("report.txt"), gonio_table(outcome).as_bytes())?;
    write_json(folder.join("summary.json"), &gonio_summary(outcome))?;
    Ok(())
}

/// Refuses a folder with files of directions that are not among `plans`: the tables would tell nothing of them.
pub(super) fn refuse_unplanned(folder: &Path, plans: &[Plan]) -> Result<(), GonioError> {
    let planned: HashSet<&str> = plans.iter().map(|plan| plan.name.as_str()).collect();
    let direction = |name: &String| {
        let stem = name.strip_suffix(".json").or(name.strip_suffix(".csv"))?;
        (!planned.contains(stem)).then(|| stem.to_owned())
    };
    match names_in(folder.join(FOLDER)).iter().find_map(direction) {
        None => Ok(()),
        Some(name) => Err(GonioError::Unplanned {
            folder: folder.to_owned(),
            name,
        }),
    }
}

/// The directions that are there.
pub(super) fn measured(
    outcome: &GonioOutcome,
) -> impl Iterator<Item = (&Direction, &DirectionResults)> {
    outcome
        .directions
        .iter()
        .filter_map(|direction| Some((direction, direction.results.as_ref()?)))
}

/// Flux fraction of a bin that makes a BSDF of one: solid angle times mean |cos theta|, steradians.
pub(super) fn projected_solid_angle(layout: &Layout, bin: usize) -> f64 {
    let bin = layout.grid().bin(bin);
    bin.solid_angle * bin.mean_abs_cos()
}

/// The same of an in-plane bin.
pub(super) fn projected_in_plane(layout: &Layout, i: usize) -> f64 {
    let [a, b] = layout.in_plane_edges_deg(i).map(f64::to_radians);
    layout.in_plane_solid_angle(i) * 0.5 * (a.cos() + b.cos())
}

/// An estimate of a flux as one of a BSDF.
pub(super) fn over(estimate: Estimate, projected: f64) -> Estimate {
    Estimate {
        mean: estimate.mean / projected,
        se: estimate.se.map(|se| se / projected),
    }
}

/// directions/NAME.csv: a row a bin.
pub(super) fn write_direction(
    folder: &Path,
    name: &str,
    layout: &Layout,
    results: &DirectionResults,
) -> Result<(), WriteError> {
    let mut header: Vec<String> = PLACE.map(str::to_owned).to_vec();
    header.extend(["solid_angle_sr", "flux", "flux_se", "bsdf", "bsdf_se"].map(str::to_owned));
    header.extend(part_columns(layout, "flux"));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let grid = layout.grid();
    let rows = layout.asked_bins().map(|bin| {
        let mut row = place(&grid, bin);
        row.push(grid.bin(bin).solid_angle.into());
        for (number, part) in results.parts.iter().enumerate() {
            let Some(flux) = part.bin(layout, bin) else {
                continue;
            };
            row.extend(fields(flux));
            if number == 0 {
                row.extend(fields(over(flux, projected_solid_angle(layout, bin))));
            }
        }
        row
    });
    write_csv(
        folder.join(FOLDER).join(format!("{name}.csv")),
        &header,
        rows,
    )
}

/// Names of the columns of the parts of the light, without all of it.
fn part_columns(layout: &Layout, quantity: &str) -> Vec<String> {
    part_names(layout)[1..]
        .iter()
        .flat_map(|part| {
            [
                format!("{quantity}_{part}"),
                format!("{quantity}_{part}_se"),
            ]
        })
        .collect()
}

/// Columns that say what was measured from where.
const SETTING: [&str; 12] = [
    "theta_i_deg",
    "phi_i_deg",
    "s",
    "material",
    "eta",
    "kappa",
    "mean_free_path",
    "albedo",
    "phase",
    "g",
    "thickness",
    "bottom",
];

fn setting_fields(setting: &Setting, direction: &Direction) -> Vec<Field<'static>> {
    let (kind, eta, kappa) = match setting.material {
        Material::Dielectric { eta } => ("dielectric", Some(eta), None),
        Material::Conductor { eta, kappa } => ("conductor", Some(eta), Some(kappa)),
        _ => ("mirror", None, None),
    };
    let medium = setting.layer.map(|layer| layer.medium());
    let slab = setting.layer.and_then(|layer| layer.end());
    vec![
        direction.incidence.theta_deg().into(),
        direction.incidence.phi_deg().into(),
        setting.smoothness.into(),
        kind.into(),
        eta.into(),
        kappa.into(),
        // That of a clear medium is infinite, which no field holds.
        medium
            .map(|m| m.mean_free_path())
            .filter(|path| path.is_finite())
            .into(),
        medium.map(|m| m.albedo()).into(),
        medium.map(|m| phase_name(m.phase())).into(),
        medium.map(|m| m.phase().mean_cosine()).into(),
        slab.map(|slab| slab.thickness).into(),
        slab.map(|slab| bottom_in_words(slab.bottom)).into(),
    ]
}

const fn phase_name(phase: PhaseFunction) -> &'static str {
    match phase {
        PhaseFunction::Isotropic => "isotropic",
        PhaseFunction::Rayleigh => "rayleigh",
        _ => "henyey-greenstein",
    }
}

/// gonio.csv: a row a direction, with its fluxes.
fn write_directions(folder: &Path, outcome: &GonioOutcome) -> Result<(), WriteError> {
    let layout = &outcome.layout;
    let mut header = vec!["direction".to_owned()];
    header.extend(SETTING.map(str::to_owned));
    for side in layout.sides() {
        header.extend([side.to_string(), format!("{side}_se")]);
        header.extend(part_columns(layout, &side.to_string()));
    }
    for part in ["absorbed", "truncated", "lost"] {
        header.extend([part.to_owned(), format!("{part}_se")]);
    }
    header.extend(["surfaces", "rays", "errors_from"].map(str::to_owned));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let rows = measured(outcome).map(|(direction, results)| {
        let mut row: Vec<Field<'_>> = vec![direction.name.clone().into()];
        row.extend(setting_fields(
            &outcome.settings[direction.setting],
            direction,
        ));
        for side in layout.sides() {
            let fluxes = results.parts.iter().filter_map(|p| p.side(layout, side));
            row.extend(fluxes.flat_map(fields));
        }
        row.extend((0..3).flat_map(|i| fields(results.budget.estimate(i))));
        row.extend([
            results.surfaces.into(),
            results.rays.into(),
            results.errors_from.as_str().into(),
        ]);
        row
    });
    write_csv(folder.join("gonio.csv"), &header, rows)
}

/// in_plane.csv: the BSDF in the plane of incidence, a row a direction, side and signed angle.
fn write_in_plane(folder: &Path, outcome: &GonioOutcome) -> Result<(), WriteError> {
    let layout = &outcome.layout;
    let mut header: Vec<String> = [
        "direction",
        "theta_i_deg",
        "phi_i_deg",
        "side",
        "theta_min_deg",
        "theta_max_deg",
        "bsdf",
        "bsdf_se",
    ]
    .map(str::to_owned)
    .to_vec();
    header.extend(part_columns(layout, "bsdf"));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let rows = measured(outcome).flat_map(|(direction, results)| {
        layout.sides().flat_map(move |side| {
            (0..layout.in_plane_len()).map(move |i| {
                let [from, to] = layout.in_plane_edges_deg(i);
                let mut row: Vec<Field<'_>> = vec![
                    direction.name.as_str().into(),
                    direction.incidence.theta_deg().into(),
                    direction.incidence.phi_deg().into(),
                    side.to_string().into(),
                    from.into(),
                    to.into(),
                ];
                let projected = projected_in_plane(layout, i);
                let fluxes = results.parts.iter();
                let fluxes = fluxes.filter_map(|p| p.in_plane(layout, side, i));
                row.extend(fluxes.flat_map(|flux| fields(over(flux, projected))));
                row
            })
        })
    });
    write_csv(folder.join("in_plane.csv"), &header, rows)
}

/// bsdf.csv: all directions of light and of bins in one table, for renderers.
fn write_bsdf(folder: &Path, outcome: &GonioOutcome) -> Result<(), WriteError> {
    let layout = &outcome.layout;
    let grid = layout.grid();
    let mut header = vec!["setting", "theta_i_deg", "phi_i_deg"];
    header.extend(PLACE);
    header.extend(["theta_o_deg", "phi_o_deg", "bsdf", "bsdf_se"]);
    let rows = measured(outcome).flat_map(|(direction, results)| {
        layout.asked_bins().filter_map(move |bin| {
            let flux = results.parts[0].bin(layout, bin)?;
            let mut row: Vec<Field<'_>> = vec![
                direction.setting.into(),
                direction.incidence.theta_deg().into(),
                direction.incidence.phi_deg().into(),
            ];
            row.extend(place(&grid, bin));
            let side = grid.bin(bin).side;
            let (theta, phi) = (grid.theta_edges_deg(side), grid.phi_edges_deg());
            let (ring, sector) = ((bin / grid.n_phi()) % grid.n_theta(), bin % grid.n_phi());
            row.extend([
                (0.5 * (theta[ring] + theta[ring + 1])).into(),
                (0.5 * (phi[sector] + phi[sector + 1])).into(),
            ]);
            row.extend(fields(over(flux, projected_solid_angle(layout, bin))));
            Some(row)
        })
    });
    write_csv(folder.join("bsdf.csv"), &header, rows)
}

/// bsdf.npy and bsdf_se.npy: `[setting][theta_i][phi_i][side][theta_o][phi_o]`, not a number where there is nothing.
fn write_arrays(folder: &Path, outcome: &GonioOutcome) -> Result<(), WriteError> {
    let layout = &outcome.layout;
    let grid = layout.grid();
    let shape = [
        outcome.settings.len(),
        outcome.thetas.len(),
        outcome.phis.len(),
        Side::BOTH.len(),
        grid.n_theta(),
        grid.n_phi(),
    ];
    let (mut means, mut errors) = (Vec::new(), Vec::new());
    for direction in &outcome.directions {
        for bin in 0..grid.len() {
            let results = direction.results.as_ref();
            let flux = results.and_then(|results| results.parts[0].bin(layout, bin));
            let bsdf = flux.map(|flux| over(flux, projected_solid_angle(layout, bin)));
            means.push(bsdf.map_or(f64::NAN, |bsdf| bsdf.mean));
            errors.push(bsdf.and_then(|bsdf| bsdf.se).unwrap_or(f64::NAN));
        }
    }
    write_array(folder.join("bsdf.npy"), &shape, &means)?;
    write_array(folder.join("bsdf_se.npy"), &shape, &errors)
}
