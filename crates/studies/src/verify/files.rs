//! The files of a verification.

use asperity_simulate::{Case, Observer, SimulateError, SurfaceSource, counted};
use asperity_synthesis::SynthesisError;
use serde_json::{Value, json};

use super::case_report::{case_table, warnings};
use super::outcome::VerifyOutcome;
use crate::comparison::json::ComparisonJson;
use crate::comparison::judgement::Judgement;
use crate::config::VerifyConfig;
use crate::config::error::ConfigError;
use crate::output::{CaseInFolder, Head, Place, SummaryOfCases, figure_files};
use crate::report::appearance::{appearance_json, appearance_table, describe_appearance};
use crate::report::case_views::CaseViews;
use crate::report::config_json::config_json;
use crate::report::error::ReportError;
use crate::report::figures;
use crate::report::headline::with_tables;
use crate::report::shown_case::ShownCase;
use crate::report::spectrum_views::{add_spectra, columns_of_all, has_spectra};
use crate::report::summary::Summary;
use crate::report::views::{Views, case_folders};
use crate::study::Findings;

impl VerifyConfig {
    /// The files of every case, in folders of their own where there are several, with a report and a summary of all.
    pub(super) fn views<'a>(
        &self,
        cases: &[Case],
    ) -> Result<Views<'a, VerifyOutcome<'a>>, ConfigError> {
        let spec = self.ray_settings()?.tally;
        let compared = !self.compare.models.is_empty();
        let of_case = CaseViews {
            spec: &spec,
            compared,
            figures: self.output.plots && (compared || !has_spectra(cases)),
        };
        let mut views: Views<'a, VerifyOutcome<'a>> = Views::new();
        let folders = case_folders(cases);
        for (number, folder) in folders.iter().enumerate() {
            of_case.add(&mut views, folder, move |outcome| {
                Some(outcome.shown(outcome.case(number)?))
            });
            views.text(format!("{folder}report.txt"), move |outcome| {
                Some(outcome.case_text(outcome.case(number)?))
            });
            if cases.len() > 1 {
                views.json(format!("{folder}summary.json"), move |outcome| {
                    Some(case_summary(outcome, outcome.case(number)?))
                });
            }
        }
        if self.output.plots {
            let map = |folder| figure_files("height_map").map(|file| format!("{folder}{file}"));
            let names = folders.iter().flat_map(map).collect();
            views.other(names, move |outcome, root, observer| {
                height_maps(outcome, root, &folders, observer)
            });
        }
        if cases.len() > 1 {
            views.text("report.txt", |outcome| Some(outcome.text()));
        }
        add_spectra(&mut views, cases, self.output.plots, |outcome| {
            outcome.outcomes()
        });
        views.csv("appearance.csv", |outcome| {
            appearance_table(outcome.sample_lights())
        });
        views.json("summary.json", |outcome| Some(verify_summary(outcome)));
        Ok(views)
    }
}

/// Draws the first surface of every case until the run gives up: once for those that share it, and one after the other, since
/// memory may hold no more. Returns the number of figures that are left out.
fn height_maps(
    outcome: &VerifyOutcome,
    root: &Place<'_>,
    folders: &[String],
    observer: &dyn Observer,
) -> Result<usize, ReportError> {
    let gives_up = || observer.gives_up_first();
    let mut left_out = 0;
    let cases: Vec<(&Judgement<'_>, Place<'_>)> = outcome
        .cases
        .iter()
        .map(|case| (case, root.join(&folders[case.outcome.number])))
        .collect();
    for sharing in cases.chunk_by(|(a, _), (b, _)| a.outcome.case.surface == b.outcome.case.surface)
    {
        let found = sharing[0].0.outcome;
        let SurfaceSource::Random(surfaces) = &found.case.surface else {
            continue;
        };
        let seed = outcome.config.run.seed;
        let first = match surfaces.heights(seed, 0, &gives_up) {
            Err(SynthesisError::GivenUp) => {
                left_out += sharing.len();
                continue;
            }
            first => first.map_err(SimulateError::from)?,
        };
        let name = match found.work.realisations {
            0 => format!("One such surface, seed {seed}"),
            n => format!("First of {} of seed {seed}", counted(n, "surface")),
        };
        let finer = first.shape()[1] / found.case.surface.size().map_or(1, |[nx, _]| nx.max(1));
        let name = if finer > 1 {
            format!("{name}, {finer} × {finer} samples per smooth cell")
        } else {
            name
        };
        let places: Vec<&Place<'_>> = sharing.iter().map(|(_, place)| place).collect();
        figures::height_map(&places, &first, &name)?;
    }
    Ok(left_out)
}

impl VerifyOutcome<'_> {
    /// The case of that number; `None` if an interrupt came before it.
    fn case(&self, number: usize) -> Option<&Judgement<'_>> {
        let mut cases = self.cases.iter();
        cases.find(|case| case.outcome.number == number)
    }

    /// Headline and tables of a case: report.txt.
    fn case_text(&self, case: &Judgement<'_>) -> String {
        let headline = self.headline_of(std::slice::from_ref(case));
        with_tables(&headline, &case_table(self, case))
    }

    /// A case as its tables and figures show it.
    fn shown<'b>(&self, case: &'b Judgement<'b>) -> ShownCase<'b> {
        ShownCase {
            outcome: case.outcome,
            judgement: Some(case),
            surfaces: None,
            seed: self.config.run.seed,
            max_order: self.config.run.max_order,
        }
    }
}

/// The contents of summary.json of a verification: that of its case, or, of several, a list of all
/// with their folders.
pub(super) fn verify_summary(outcome: &VerifyOutcome) -> Value {
    if let ([case], false) = (outcome.cases.as_slice(), outcome.several()) {
        return json!(case_summary(outcome, case));
    }
    let cases = outcome.cases.iter().map(|case| CaseInFolder {
        folder: case.outcome.case.folder(),
        summary: case_summary(outcome, case),
    });
    json!(SummaryOfCases {
        head: Head::of("verify"),
        seed: outcome.config.run.seed,
        config: config(outcome),
        headline: outcome.headline(),
        cases: cases.collect(),
        columns: columns_of_all(
            &outcome.plan.cases,
            &outcome.outcomes(),
            outcome.sample_lights()
        ),
        seconds: outcome.seconds,
    })
}

/// The summary of one case.
fn case_summary(outcome: &VerifyOutcome, case: &Judgement<'_>) -> Summary {
    let config = json!({ "verify": config(outcome), "case": case.outcome.case.summary_json() });
    let tables = CaseViews {
        spec: case.spec(),
        compared: !case.models.is_empty(),
        figures: false,
    };
    let mut summary = Summary::new("verify", config, case.outcome, outcome.stopping(case));
    summary.headline = outcome.headline_of(std::slice::from_ref(case));
    summary.comparison = Some(json!(ComparisonJson::of(case)));
    summary.columns = tables.columns(outcome.shown(case));
    describe_appearance(&mut summary.columns, [outcome.sample_light(case)]);
    summary.appearance = appearance_json(outcome.sample_light(case));
    summary.lobes = case.lobes();
    summary.warnings = warnings(outcome, case);
    summary.validity = outcome.validity(case);
    summary
}

/// The configuration that was run.
fn config(outcome: &VerifyOutcome) -> Value {
    config_json(outcome.config, &outcome.config.run, &[])
}
