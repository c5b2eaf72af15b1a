//! The files of traced surfaces.

use super::absorbed::{add_absorbed_map, describe_absorbed_map};
use super::comparison::TraceComparison;
use super::light_paths::{paths_figure, paths_table};
use super::outcome::TraceOutcome;
use super::plan::TraceStudy;
use crate::config::error::ConfigError;
use crate::config::trace::TraceConfig;
use crate::report::case_views::CaseViews;
use crate::report::figures::height_map_figure;
use crate::report::shown_case::ShownCase;
use crate::report::summary::Summary;
use crate::report::views::Views;

impl TraceConfig {
    /// The files of traced surfaces.
    pub(super) fn views<'a>(&self) -> Result<Views<'a, TraceOutcome<'a>>, ConfigError> {
        let of_case = CaseViews {
            spec: &self.ray_settings()?.tally,
            compared: !self.compare.models.is_empty(),
            figures: self.output.plots,
        };
        let mut views: Views<'a, TraceOutcome<'a>> = Views::new();
        of_case.add(&mut views, "", |outcome| Some(outcome.shown()));
        if self.output.plots {
            views.figure("height_map", |outcome| {
                // That of the first surface.
                let field = outcome.outcome.case.surface.heights();
                let TraceStudy {
                    first, y_is_north, ..
                } = outcome.study;
                let figure = field.map(|field| height_map_figure(&field, first, *y_is_north));
                Ok(figure.transpose()?)
            });
        }
        if self.output.paths.is_some() {
            views.csv("paths.csv", |outcome| paths_table(outcome));
            if self.output.plots {
                views.figure("paths", |outcome| Ok(paths_figure(outcome)?));
            }
        }
        if self.output.absorbed_map {
            add_absorbed_map(&mut views, self.output.plots);
        }
        views.json("summary.json", |outcome| Some(trace_summary(outcome)));
        Ok(views)
    }
}

impl TraceOutcome<'_> {
    /// The surface as its tables and figures show it.
    fn shown(&self) -> ShownCase<'_> {
        ShownCase {
            outcome: self.outcome,
            judgement: self.comparison.as_ref().map(|of| &of.judgement),
            surfaces: Some(&self.study.name),
            seed: self.study.settings.seed,
            max_order: self.study.config.run.max_order,
        }
    }
}

/// The contents of summary.json.
pub(super) fn trace_summary(outcome: &TraceOutcome) -> Summary {
    let config = outcome.study.described.clone();
    let tables = CaseViews {
        spec: outcome.spec(),
        compared: outcome.comparison.is_some(),
        figures: false,
    };
    let mut summary = Summary::new("trace", config, outcome.outcome, outcome.stopping());
    summary.comparison = outcome.comparison.as_ref().map(TraceComparison::to_json);
    summary.columns = tables.columns(outcome.shown());
    if let Some(paths) = paths_table(outcome) {
        summary.columns["paths.csv"] = paths.description;
    }
    if outcome.absorbed.is_some() {
        describe_absorbed_map(&mut summary.columns);
    }
    summary.lobes = outcome.lobes();
    summary.warnings = outcome.warnings();
    summary.validity = outcome.study.validity;
    summary
}
