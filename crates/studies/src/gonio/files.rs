//! The files of a measurement: tables, arrays, plots, report.txt and summary.json.

use asperity_io::write_array;
use asperity_tally::Side;

use super::config::GonioConfig;
use super::distinction::Distinction;
use super::emissivity::{SettingEmissivity, emissivity_figure, emissivity_table};
use super::json::gonio_summary;
use super::outcome::GonioOutcome;
use super::{figures, tables};
use crate::config::error::ConfigError;
use crate::output::{Place, figure_files};
use crate::report::appearance::appearance_table;
use crate::report::case_views::CaseViews;
use crate::report::error::ReportError;
use crate::report::spectrum_views::add_spectra;
use crate::report::views::Views;
use crate::study::Findings;
use crate::verify::plan::Plan;

/// Folder of the tables of directions.
const DIRECTIONS: &str = "directions";

/// Folder of the plots.
const PLOTS: &str = "plots/";

/// BSDF and standard errors, and the edges of their bins.
const ARRAYS: [&str; 4] = [
    "bsdf.npy",
    "bsdf_se.npy",
    "theta_edges.npy",
    "phi_edges.npy",
];

impl GonioConfig {
    /// The files of the study.
    pub(super) fn views<'a>(
        &self,
        plan: &Plan,
    ) -> Result<Views<'a, GonioOutcome<'a>>, ConfigError> {
        let mut views: Views<'a, GonioOutcome<'a>> = Views::new();
        views.csv("gonio.csv", |outcome| Some(tables::directions(outcome)));
        views.csv("in_plane.csv", |outcome| Some(tables::in_plane(outcome)));
        views.csv("bsdf.csv", |outcome| Some(tables::bsdf(outcome)));
        let polarised = CaseViews {
            figures: self.output.plots,
            ..CaseViews::of(&plan.settings.tally)
        };
        for (number, case) in plan.cases.iter().enumerate() {
            let name = format!("{DIRECTIONS}/{}.csv", case.direction_name());
            views.csv(name, move |outcome| {
                let direction = outcome.numbered(number);
                let is_measured = direction.outcome.is_some();
                is_measured.then(|| tables::direction(direction))
            });
            let within = format!("{DIRECTIONS}/{}/", case.direction_name());
            polarised.add_polarised(&mut views, &within, move |outcome| {
                outcome.shown(&outcome.numbered(number))
            });
        }
        views.other(ARRAYS.map(str::to_owned).to_vec(), |outcome, place, _| {
            write_arrays(outcome, place)?;
            Ok(0)
        });
        if self.output.plots {
            let [thetas, _] = self.angles()?;
            let names = figures::names(&plan.settings.tally, &thetas);
            let names = names.iter().flat_map(|name| figure_files(name));
            let names = names.map(|file| format!("{PLOTS}{file}"));
            views.other(names.collect(), |outcome, place, observer| {
                figures::draw(&place.join(PLOTS), outcome, observer)
            });
        }
        add_spectra(&mut views, &plan.cases, self.output.plots, |outcome| {
            outcome.directions().filter_map(|one| one.outcome).collect()
        });
        views.csv("appearance.csv", |outcome| {
            appearance_table(outcome.sample_lights())
        });
        views.csv("emissivity.csv", |outcome| {
            emissivity_table(&SettingEmissivity::of(outcome))
        });
        if self.output.plots {
            views.figure("emissivity", |outcome| {
                let common = Distinction::of(outcome.settings()).common;
                let settings = SettingEmissivity::of(outcome);
                Ok(emissivity_figure(&settings, common)?)
            });
        }
        views.text("report.txt", |outcome| Some(outcome.text()));
        views.json("summary.json", |outcome| Some(gonio_summary(outcome)));
        Ok(views)
    }
}

/// bsdf.npy and bsdf_se.npy, `[setting][theta_i][phi_i][side][theta_o][phi_o]`, and the edges of their bins, theta_edges.npy and
/// phi_edges.npy, `[setting][theta_i][phi_i][side][edge]` in degrees. Arrays are as long as the most bins of a direction; what lies beyond
/// those of another, and what was not measured, is not a number.
fn write_arrays(outcome: &GonioOutcome, place: &Place<'_>) -> Result<(), ReportError> {
    let [mean, se, theta, phi] = ARRAYS;
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
    let sides = directions.iter().product::<usize>();
    let mut theta_edges = vec![f64::NAN; sides * (rings + 1)];
    let mut phi_edges = vec![f64::NAN; sides * (sectors + 1)];
    for (number, direction) in outcome.directions().enumerate() {
        let number = outcome.place(number);
        let grid = direction.spec.grid();
        for side in Side::BOTH {
            let place = number * Side::BOTH.len() + side.index();
            let fill = |all: &mut [f64], count: usize, edges: &[f64]| {
                all[place * (count + 1)..][..edges.len()].copy_from_slice(edges);
            };
            fill(&mut theta_edges, rings, &grid.theta_edges_deg(side));
            fill(&mut phi_edges, sectors, &grid.phi_edges_deg(side));
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
    write_array(place.claim(mean)?, &shape, &means)?;
    write_array(place.claim(se)?, &shape, &errors)?;
    let edges = |name: &str, count: usize, edges: &[f64]| -> Result<(), ReportError> {
        let shape = [directions.as_slice(), &[count + 1]].concat();
        Ok(write_array(place.claim(name)?, &shape, edges)?)
    };
    edges(theta, rings, &theta_edges)?;
    edges(phi, sectors, &phi_edges)
}
