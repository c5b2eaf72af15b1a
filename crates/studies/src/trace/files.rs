//! The files of traced surfaces.

use asperity_simulate::Case;
use serde_json::{Value, json};

use super::absorbed::{add_absorbed_map, describe_absorbed_map};
use super::comparison::TraceComparison;
use super::light_paths::{paths_figure, paths_table};
use super::outcome::{TraceOutcome, TraceOutcomes, headline_of};
use super::plan::PlannedTrace;
use crate::config::error::ConfigError;
use crate::config::trace::TraceConfig;
use crate::output::{CaseInFolder, Head, SummaryOfCases};
use crate::report::appearance::{appearance_json, appearance_table, describe_appearance};
use crate::report::case_views::CaseViews;
use crate::report::config_json::config_json;
use crate::report::figures::height_map_figure;
use crate::report::shown_case::ShownCase;
use crate::report::spectrum_views::{add_spectra, columns_of_all, has_spectra};
use crate::report::summary::Summary;
use crate::report::views::{Views, case_folders};
use crate::study::Findings;

impl TraceConfig {
    /// The files of traced surfaces.
    pub(super) fn views<'a>(
        &self,
        cases: &[Case],
    ) -> Result<Views<'a, TraceOutcomes<'a>>, ConfigError> {
        let compared = !self.compare.models.is_empty();
        let of_case = CaseViews {
            spec: &self.ray_settings()?.tally,
            compared,
            figures: self.output.plots && (compared || !has_spectra(cases)),
        };
        let mut views: Views<'a, TraceOutcomes<'a>> = Views::new();
        for (number, folder) in case_folders(cases).iter().enumerate() {
            of_case.add(&mut views, folder, move |found| {
                Some(found.case(number)?.shown())
            });
            if self.output.paths.is_some() {
                views.csv(format!("{folder}paths.csv"), move |found| {
                    paths_table(found.case(number)?)
                });
                if self.output.plots {
                    views.figure(format!("{folder}paths"), move |found| {
                        let one = found.case(number);
                        Ok(one.map_or(Ok(None), paths_figure)?)
                    });
                }
            }
            if cases.len() > 1 {
                views.json(format!("{folder}summary.json"), move |found| {
                    Some(trace_summary(found.case(number)?))
                });
            }
        }
        if self.output.plots {
            views.figure("height_map", |found| {
                // That of the first surface.
                let one = &found.each[0];
                let field = one.outcome.case.surface.heights();
                let PlannedTrace {
                    first, y_is_north, ..
                } = one.study;
                let figure = field.map(|field| height_map_figure(&field, first, *y_is_north));
                Ok(figure.transpose()?)
            });
        }
        if self.output.absorbed_map {
            for (number, folder) in case_folders(cases).iter().enumerate() {
                add_absorbed_map(&mut views, folder, number, self.output.plots);
            }
        }
        add_spectra(&mut views, cases, self.output.plots, |found| {
            found.outcomes()
        });
        views.csv("appearance.csv", |found| {
            appearance_table(found.sample_lights())
        });
        views.text("report.txt", |found| Some(found.text()));
        views.json("summary.json", |found| Some(traces_summary(found)));
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

/// The contents of summary.json: those of the case, or, of several, a list of all with their folders.
pub(super) fn traces_summary(found: &TraceOutcomes) -> Value {
    if let ([one], 1) = (found.each.as_slice(), found.planned.len()) {
        return json!(trace_summary(one));
    }
    let cases = found.each.iter().map(|one| CaseInFolder {
        folder: one.outcome.case.folder(),
        summary: trace_summary(one),
    });
    let config = &found.each[0].study.config;
    json!(SummaryOfCases {
        head: Head::of("trace"),
        seed: config.run.seed,
        config: config_json(config, &config.run, &[]),
        headline: found.headline(),
        cases: cases.collect(),
        columns: columns_of_all(found.planned, &found.outcomes(), found.sample_lights()),
        seconds: found.seconds,
    })
}

/// The contents of summary.json of one case.
fn trace_summary(outcome: &TraceOutcome) -> Summary {
    let config = outcome.study.described.clone();
    let tables = CaseViews {
        spec: outcome.spec(),
        compared: outcome.comparison.is_some(),
        figures: false,
    };
    let mut summary = Summary::new("trace", config, outcome.outcome, outcome.stopping());
    summary.headline = headline_of(std::slice::from_ref(outcome));
    summary.comparison = outcome.comparison.as_ref().map(TraceComparison::to_json);
    summary.columns = tables.columns(outcome.shown());
    describe_appearance(&mut summary.columns, [outcome.sample_light()]);
    summary.appearance = appearance_json(outcome.sample_light());
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
