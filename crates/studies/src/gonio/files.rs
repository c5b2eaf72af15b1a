//! The files of a measurement: tables, arrays, plots, report.txt and summary.json.

use std::collections::HashSet;
use std::path::Path;

use asperity_io::{
    WriteError, create_output_folder, names_in, remove_files, write_array, write_bytes, write_json,
};
use asperity_tally::{Side, TallySpec};

use super::plan::Plan;
use super::summary::{gonio_summary, gonio_table};
use super::tables::{self, Measured, measured};
use super::{DirectionResults, FOLDER, GonioError, GonioOutcome, figures};
use crate::output::{over, projected_solid_angle};
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
    let spec = &outcome.spec;
    for Measured {
        direction, results, ..
    } in measured(outcome)
    {
        write_direction(folder, &direction.name, spec, results)?;
    }
    tables::directions(spec).write_csv(&folder.join("gonio.csv"), measured(outcome))?;
    let bins = tables::in_plane_bins(outcome);
    tables::in_plane(spec).write_csv(&folder.join("in_plane.csv"), bins)?;
    let bins = tables::direction_bins(outcome);
    tables::bsdf(spec).write_csv(&folder.join("bsdf.csv"), bins)?;
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

/// directions/NAME.csv.
pub(super) fn write_direction(
    folder: &Path,
    name: &str,
    spec: &TallySpec,
    results: &DirectionResults,
) -> Result<(), WriteError> {
    let path = folder.join(FOLDER).join(format!("{name}.csv"));
    tables::direction(spec, results).write_csv(&path, spec.recorded_bins())
}

/// bsdf.npy and bsdf_se.npy: `[setting][theta_i][phi_i][side][theta_o][phi_o]`, not a number where there is nothing.
fn write_arrays(folder: &Path, outcome: &GonioOutcome) -> Result<(), WriteError> {
    let spec = &outcome.spec;
    let grid = spec.grid();
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
            let flux = results.and_then(|results| results.parts[0].bin(spec, bin));
            let bsdf = flux.map(|flux| over(flux, projected_solid_angle(&grid, bin)));
            means.push(bsdf.map_or(f64::NAN, |bsdf| bsdf.mean));
            errors.push(bsdf.and_then(|bsdf| bsdf.se).unwrap_or(f64::NAN));
        }
    }
    write_array(folder.join("bsdf.npy"), &shape, &means)?;
    write_array(folder.join("bsdf_se.npy"), &shape, &errors)
}
