//! The files of a measurement: tables, arrays, plots, report.txt and summary.json.

use asperity_io::{ResultFolder, ResultFolderError, write_array, write_bytes, write_json};
use asperity_tally::Side;

use super::json::gonio_summary;
use super::summary::gonio_table;
use super::tables::{self, measured};
use super::{FOLDER, GonioConfig, GonioOutcome, figures};
use crate::config::error::ConfigError;
use crate::output::{Place, figure_files};
use crate::report::error::ReportError;
use crate::verify::plan::Plan;

/// Writes a measurement into `folder`: gonio.csv, in_plane.csv, bsdf.csv, bsdf.npy, bsdf_se.npy, theta_edges.npy, phi_edges.npy, plots,
/// report.txt, and, last, summary.json.
///
/// All of it depends on the directions alone, not on how many runs they took.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn gonio_report(folder: &ResultFolder, outcome: &GonioOutcome) -> Result<(), ReportError> {
    let spec = outcome.spec();
    let config = outcome.config;
    let files = config.files(outcome.plan)?;
    folder.claim_all(files.iter().map(String::as_str))?;
    let place = Place::root(folder);
    for direction in measured(outcome) {
        let name = format!("{FOLDER}/{}.csv", direction.case.direction_name());
        let table = tables::direction(direction);
        table.write_csv(&place.claim(&name)?, direction.spec.recorded_bins())?;
    }
    tables::directions(outcome).write_csv(&place.claim("gonio.csv")?, measured(outcome))?;
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

impl GonioConfig {
    /// Names of all files that a measurement of the cases of `plan` writes into its folder.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self, plan: &Plan) -> Result<Vec<String>, ConfigError> {
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
        let directions = plan.cases.iter();
        files.extend(directions.map(|case| format!("{FOLDER}/{}.csv", case.direction_name())));
        if self.output.plots {
            let [thetas, _] = self.light.angles()?;
            let names = figures::names(&plan.settings.tally, &thetas);
            let figures = names.iter().flat_map(|name| figure_files(name));
            files.extend(figures.map(|file| format!("{}/{file}", figures::PLOTS)));
        }
        Ok(files)
    }
}

/// bsdf.npy and bsdf_se.npy, `[setting][theta_i][phi_i][side][theta_o][phi_o]`, and the edges of their bins, theta_edges.npy and
/// phi_edges.npy, `[setting][theta_i][phi_i][side][edge]` in degrees. Arrays are as long as the most bins of a direction; what lies beyond
/// those of another, and what was not measured, is not a number.
fn write_arrays(place: &Place<'_>, outcome: &GonioOutcome) -> Result<(), ResultFolderError> {
    let grids = outcome.directions().map(|one| one.spec.grid());
    let rings = grids.clone().map(|grid| grid.n_theta()).max().unwrap_or(0);
    let sectors = grids.map(|grid| grid.n_phi()).max().unwrap_or(0);
    let directions = [
        outcome.settings().len(),
        outcome.thetas.len(),
        outcome.phis.len(),
        Side::BOTH.len(),
    ];
    let shape = [directions.as_slice(), &[rings, sectors]].concat();
    let all = shape.iter().product();
    let (mut means, mut errors) = (vec![f64::NAN; all], vec![f64::NAN; all]);
    let (mut theta_edges, mut phi_edges) = (Vec::new(), Vec::new());
    for (number, direction) in outcome.directions().enumerate() {
        let grid = direction.spec.grid();
        for side in Side::BOTH {
            let padded = |mut edges: Vec<f64>, count: usize| {
                edges.resize(count + 1, f64::NAN);
                edges
            };
            theta_edges.extend(padded(grid.theta_edges_deg(side), rings));
            phi_edges.extend(padded(grid.phi_edges_deg(side), sectors));
        }
        for bin in 0..grid.len() {
            let Some(bsdf) = direction.bsdf(bin) else {
                continue;
            };
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
