//! The files of a measurement: tables, arrays, plots, report.txt and summary.json.

use std::collections::HashSet;
use std::path::Path;

use asperity_io::{
    ResultFolder, ResultFolderError, names_in, write_array, write_bytes, write_json,
};
use asperity_tally::{Side, TallySpec};

use super::json::gonio_summary;
use super::plan::Plan;
use super::summary::gonio_table;
use super::tables::{self, Measured, measured};
use super::{DirectionResults, FOLDER, GonioConfig, GonioError, GonioOutcome, Sample, figures};
use crate::config::error::ConfigError;
use crate::output::{Place, figure_files, over, projected_solid_angle};
use crate::report::error::ReportError;

/// Writes a measurement into `folder`: gonio.csv, in_plane.csv, bsdf.csv, bsdf.npy, bsdf_se.npy, theta_edges.npy, phi_edges.npy, plots,
/// report.txt, and, last, summary.json.
///
/// All of it depends on the directions alone, not on how many runs they took.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn gonio_report(folder: &ResultFolder, outcome: &GonioOutcome) -> Result<(), ReportError> {
    let spec = &outcome.spec;
    let names = outcome
        .directions
        .iter()
        .map(|direction| direction.name.as_str());
    let config = &outcome.config;
    let files = files(names, spec, &outcome.thetas, config.output.plots);
    folder.claim_all(files.iter().map(String::as_str))?;
    let place = Place::root(folder);
    for Measured {
        direction, results, ..
    } in measured(outcome)
    {
        write_direction(folder, &direction.name, &direction.spec, results)?;
    }
    tables::directions(spec, outcome.unit())
        .write_csv(&place.claim("gonio.csv")?, measured(outcome))?;
    let bins = tables::in_plane_bins(outcome);
    tables::in_plane(spec).write_csv(&place.claim("in_plane.csv")?, bins)?;
    let bins = tables::direction_bins(outcome);
    tables::bsdf().write_csv(&place.claim("bsdf.csv")?, bins)?;
    write_arrays(&place, outcome)?;
    if config.output.plots {
        figures::draw(&place.join(figures::PLOTS), outcome)?;
    }
    write_bytes(place.claim("report.txt")?, gonio_table(outcome).as_bytes())?;
    write_json(place.claim("summary.json")?, &gonio_summary(outcome))?;
    Ok(())
}

/// Names of all files of a measurement of the directions of these names.
fn files<'a>(
    directions: impl Iterator<Item = &'a str>,
    spec: &TallySpec,
    thetas: &[f64],
    plots: bool,
) -> Vec<String> {
    let of_all = [
        "gonio.csv",
        "in_plane.csv",
        "bsdf.csv",
        "bsdf.npy",
        "bsdf_se.npy",
        "theta_edges.npy",
        "phi_edges.npy",
        "report.txt",
        "summary.json",
    ];
    let mut files: Vec<String> = of_all.map(str::to_owned).to_vec();
    files.extend(
        directions
            .flat_map(|name| ["json", "csv"].map(|ending| format!("{FOLDER}/{name}.{ending}"))),
    );
    if plots {
        let names = figures::names(spec, thetas);
        let figures = names.iter().flat_map(|name| figure_files(name));
        files.extend(figures.map(|file| format!("{}/{file}", figures::PLOTS)));
    }
    files
}

impl GonioConfig {
    /// Names of all files that a measurement writes into its folder.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self, sample: Option<&Sample>) -> Result<Vec<String>, ConfigError> {
        let plans = self.plans(sample)?.directions;
        let [thetas, _] = self.light.angles()?;
        let names = plans.iter().map(|plan| plan.name.as_str());
        let spec = self.ray_settings()?.tally;
        Ok(files(names, &spec, &thetas, self.output.plots))
    }
}

/// Refuses a folder with files of directions that are not among `plans`: the tables would not contain them.
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
    folder: &ResultFolder,
    name: &str,
    spec: &TallySpec,
    results: &DirectionResults,
) -> Result<(), ResultFolderError> {
    let path = folder.claim(&format!("{FOLDER}/{name}.csv"))?;
    Ok(tables::direction(spec, results).write_csv(&path, spec.recorded_bins())?)
}

/// bsdf.npy and bsdf_se.npy, `[setting][theta_i][phi_i][side][theta_o][phi_o]`, and the edges of their bins, theta_edges.npy and
/// phi_edges.npy, `[setting][theta_i][phi_i][side][edge]` in degrees. Arrays are as long as the most bins of a direction; what lies beyond
/// those of another, and what was not measured, is not a number.
fn write_arrays(place: &Place<'_>, outcome: &GonioOutcome) -> Result<(), ResultFolderError> {
    let grids = outcome.directions.iter().map(|one| one.spec.grid());
    let rings = grids.clone().map(|grid| grid.n_theta()).max().unwrap_or(0);
    let sectors = grids.map(|grid| grid.n_phi()).max().unwrap_or(0);
    let directions = [
        outcome.settings.len(),
        outcome.thetas.len(),
        outcome.phis.len(),
        Side::BOTH.len(),
    ];
    let shape = [directions.as_slice(), &[rings, sectors]].concat();
    let all = shape.iter().product();
    let (mut means, mut errors) = (vec![f64::NAN; all], vec![f64::NAN; all]);
    let (mut theta_edges, mut phi_edges) = (Vec::new(), Vec::new());
    for (number, direction) in outcome.directions.iter().enumerate() {
        let (spec, grid) = (&direction.spec, direction.spec.grid());
        for side in Side::BOTH {
            let padded = |mut edges: Vec<f64>, count: usize| {
                edges.resize(count + 1, f64::NAN);
                edges
            };
            theta_edges.extend(padded(grid.theta_edges_deg(side), rings));
            phi_edges.extend(padded(grid.phi_edges_deg(side), sectors));
        }
        let Some(results) = &direction.results else {
            continue;
        };
        for bin in 0..grid.len() {
            let Some(flux) = results.components[0].bin(spec, bin) else {
                continue;
            };
            let bsdf = over(flux, projected_solid_angle(&grid, bin));
            let (row, sector) = (bin / grid.n_phi(), bin % grid.n_phi());
            let (side, ring) = (row / grid.n_theta(), row % grid.n_theta());
            let place = ((number * Side::BOTH.len() + side) * rings + ring) * sectors + sector;
            means[place] = bsdf.mean;
            errors[place] = bsdf.se.unwrap_or(f64::NAN);
        }
    }
    write_array(place.claim("bsdf.npy")?, &shape, &means)?;
    write_array(place.claim("bsdf_se.npy")?, &shape, &errors)?;
    let edges = |name: &str, count: usize, edges: &[f64]| -> Result<(), ResultFolderError> {
        let shape = [directions.as_slice(), &[count + 1]].concat();
        Ok(write_array(place.claim(name)?, &shape, edges)?)
    };
    edges("theta_edges.npy", rings, &theta_edges)?;
    edges("phi_edges.npy", sectors, &phi_edges)
}
