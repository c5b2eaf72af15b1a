//! The files of traced surfaces: tables of fluxes, plots and summary.json.

use asperity_io::{ResultFolder, write_json};
use serde_json::Value;

use super::TraceOutcome;
use crate::config::error::ConfigError;
use crate::config::trace::TraceConfig;
use crate::output::Place;
use crate::report::error::ReportError;
use crate::report::figures::{self, PlottedCase};
use crate::report::files::{TABLES, plot_files};
use crate::report::flux_tables::{FluxTables, comparison_columns, write_comparison};
use crate::report::fluxes::Fluxes;
use crate::report::polarised::polarised_tables;
use crate::report::polarised_figures::draw_polarised;
use crate::report::summary::Summary;

impl TraceConfig {
    /// Names of all files that are written.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is out of range or two contradict each other.
    pub fn files(&self) -> Result<Vec<String>, ConfigError> {
        let mut names = TABLES.map(str::to_owned).to_vec();
        let polarised = polarised_tables(&self.ray_settings()?.tally);
        names.extend(polarised.iter().copied().map(str::to_owned));
        names.push("summary.json".to_owned());
        if !self.compare.models.is_empty() {
            names.push("comparison.csv".to_owned());
        }
        if self.output.plots {
            names.extend(plot_files(&self.ray_settings()?.tally));
        }
        Ok(names)
    }
}

/// Writes what light did on the surfaces into `folder`: histogram.csv, theta.csv, in_plane.csv, comparison.csv if it is compared
/// with models, plots and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn trace_report(folder: &ResultFolder, outcome: &TraceOutcome) -> Result<(), ReportError> {
    let names = outcome.plan.config.files()?;
    folder.claim_all(names.iter().map(String::as_str))?;
    let place = Place::root(folder);
    let draw = || match outcome.plan.config.output.plots {
        true => draw(&place, outcome),
        false => Ok(()),
    };
    let tables = || -> Result<(), ReportError> {
        tables(outcome).write(&place)?;
        match &outcome.comparison {
            Some(comparison) => write_comparison(&place, comparison.compared()),
            None => Ok(()),
        }
    };
    let (tables, plots) = rayon::join(tables, draw);
    tables?;
    plots?;
    Ok(write_json(
        place.claim("summary.json")?,
        &trace_summary(outcome),
    )?)
}

/// The tables of fluxes.
fn tables<'a>(outcome: &'a TraceOutcome<'_>) -> FluxTables<'a> {
    let found = outcome.outcome;
    FluxTables {
        fluxes: Fluxes {
            spec: outcome.spec(),
            statistics: &found.statistics,
            errors: &found.errors,
            rays: found.work.rays,
        },
        models: outcome.models(),
    }
}

/// Draws the height map, of the first surface if it has one, the curves of the light, and its Mueller matrices if they are kept.
fn draw(place: &Place<'_>, outcome: &TraceOutcome) -> Result<(), ReportError> {
    let case = &outcome.outcome.case;
    let light = PlottedCase {
        case,
        max_order: outcome.plan.config.run.max_order,
    };
    let map = || match case.surface.heights() {
        Some(field) => figures::height_map(&[place], &field, &outcome.plan.first),
        None => Ok(()),
    };
    let statistics = &outcome.outcome.statistics;
    let models = outcome.models();
    let lobes = || figures::lobes_and_curves(place, &light, outcome.spec(), statistics, models);
    let polarised = || draw_polarised(place, &light, statistics);
    let (map, (lobes, polarised)) = rayon::join(map, || rayon::join(lobes, polarised));
    map.and(lobes).and(polarised)
}

/// The contents of summary.json.
#[must_use]
pub fn trace_summary(outcome: &TraceOutcome) -> Summary {
    let found = outcome.outcome;
    let config: Value = outcome.plan.described.clone();
    let mut columns = tables(outcome).columns();
    let comparison = outcome.comparison.as_ref();
    if let Some(of_comparison) = comparison.and_then(|c| comparison_columns(c.compared())) {
        columns["comparison.csv"] = of_comparison;
    }
    let summary = Summary::new("trace", config, found);
    let summary = match comparison {
        Some(comparison) => summary.with_comparison(comparison.to_json()),
        None => summary,
    };
    summary
        .with_columns(columns)
        .with_lobes(outcome.lobes())
        .with_warnings(outcome.warnings())
        .with_stopping(outcome.stopping().cloned())
        .with_validity(outcome.plan.validity)
}
