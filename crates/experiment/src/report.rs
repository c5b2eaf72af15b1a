//! The files of a run: summary.json, tables of numbers, the report, and plots.

use std::path::Path;

use asperity_io::{
    CsvField as Field, WriteError, create_output_folder, write_bytes, write_csv, write_json,
};
use asperity_plot::PlotError;
use asperity_tally::{BatchStatistics, Estimate, Layout, OrderClass, Share, Side};
use serde_json::{Value, json};

use crate::figures::{self, Light};
use crate::progress::Progress;
use crate::summary::Summary;
use crate::tables::{case_table, conclusion, verdict_word, verify_table};
use crate::trace::TraceOutcome;
use crate::verify::{CaseOutcome, ModelOutcome, VerifyError, VerifyOutcome};

/// Why results are not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The surface of a plot cannot be drawn again.
    #[error(transparent)]
    Surface(#[from] Box<VerifyError>),
    /// A plot cannot be drawn.
    #[error("a plot could not be drawn: {0}")]
    Plot(#[from] PlotError),
}

/// Writes what light did on one surface into `folder`: histogram.csv, theta.csv, in_plane.csv, plots
/// and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn trace_report(
    folder: &Path,
    outcome: &TraceOutcome,
    layout: &Layout,
    summary: &Summary,
    plots: Option<&figures::Surroundings<'_>>,
) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    write_tables(folder, layout, &outcome.statistics, &[])?;
    if let Some(surroundings) = plots {
        let light = surroundings.light;
        figures::height_map(folder, surroundings.field, &surroundings.name)?;
        figures::lobes_and_curves(folder, light, layout, &outcome.statistics, &[])?;
    }
    write_json(folder.join("summary.json"), summary)?;
    Ok(())
}

/// Writes a verification into `folder`: the files of every case, in folders of their own where there
/// are several, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn verify_report(
    folder: &Path,
    outcome: &VerifyOutcome,
    progress: &dyn Progress,
) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    progress.begin("writing", outcome.cases.len() as u64);
    let config = serde_json::to_value(&outcome.config).unwrap_or(Value::Null);
    let mut summaries = Vec::new();
    for case in &outcome.cases {
        let (place, name) = if outcome.cases.len() == 1 {
            (folder.to_owned(), None)
        } else {
            (folder.join(case.case.folder()), Some(case.case.folder()))
        };
        create_output_folder(&place)?;
        write_tables(&place, &outcome.layout, &case.statistics, &case.models)?;
        write_comparison(&place, outcome, case)?;
        if outcome.config.output.plots {
            let first = outcome.config.first_surface(&case.case).map_err(Box::new)?;
            let name = format!("First of {} surfaces", case.work.realisations);
            figures::height_map(&place, &first, &name)?;
            let light = Light::of_case(&case.case);
            let layout = &outcome.layout;
            figures::lobes_and_curves(&place, &light, layout, &case.statistics, &case.models)?;
        }
        write_bytes(
            place.join("report.txt"),
            case_table(outcome, case).as_bytes(),
        )?;
        let summary = case_summary(outcome, case, config.clone());
        if let Some(name) = name {
            write_json(place.join("summary.json"), &summary)?;
            summaries.push(json!({
                "folder": name,
                "case": case.case,
                "comparison": comparison_json(&outcome.layout, case),
            }));
        } else {
            write_json(place.join("summary.json"), &summary)?;
        }
        progress.advance(1);
    }
    if outcome.cases.len() > 1 {
        write_bytes(folder.join("report.txt"), verify_table(outcome).as_bytes())?;
        let summary = json!({
            "schema": 1,
            "command": "verify",
            "version": env!("CARGO_PKG_VERSION"),
            "seed": outcome.config.run.seed,
            "config": config,
            "cases": summaries,
            "seconds": outcome.seconds,
        });
        write_json(folder.join("summary.json"), &summary)?;
    }
    progress.end();
    Ok(())
}

/// The summary of one case.
pub(crate) fn case_summary(outcome: &VerifyOutcome, case: &CaseOutcome, config: Value) -> Summary {
    let config = json!({ "verify": config, "case": case.case });
    Summary::new(
        "verify",
        config,
        outcome.config.run.seed,
        case.errors_from,
        (&outcome.layout, &case.statistics),
        case.work.clone(),
    )
    .with_comparison(comparison_json(&outcome.layout, case))
}

/// Verdicts, p values and distances of one case.
pub(crate) fn comparison_json(layout: &Layout, case: &CaseOutcome) -> Value {
    let models: Vec<Value> = case
        .models
        .iter()
        .map(|model| {
            let against = |comparison: &asperity_analysis::Comparison| {
                let distance = &comparison.total_variation;
                let test = comparison.test.as_ref().ok();
                json!({
                    "total_variation": distance.observed,
                    "total_variation_noise": distance.noise,
                    "total_variation_noise_95": distance.noise_95,
                    "bins_tested": comparison.bins.iter().filter(|bin| bin.tested).count(),
                    "p": test.map(|t| t.p),
                    "scales": test.map(|t| &t.scales),
                    "least_p": test.map(|t| t.min_p),
                    "sign_flips": test.map(|t| t.flips),
                })
            };
            json!({
                "model": model.model.name(),
                "reflected": model.energy.reflected,
                "transmitted": model.energy.transmitted,
                "verdict": verdict_word(&model.verdict),
                "single": against(&model.single),
                "total": against(&model.total),
            })
        })
        .collect();
    json!({ "level": case.level, "models": models, "conclusion": conclusion(layout, case) })
}

/// histogram.csv, theta.csv and in_plane.csv.
fn write_tables(
    folder: &Path,
    layout: &Layout,
    statistics: &BatchStatistics,
    models: &[ModelOutcome],
) -> Result<(), WriteError> {
    write_histogram(folder, layout, statistics)?;
    write_theta(folder, layout, statistics)?;
    write_in_plane(folder, layout, statistics, models)
}

/// A mean and its error as two fields.
fn fields(estimate: Estimate) -> [Field<'static>; 2] {
    [estimate.mean.into(), estimate.se.into()]
}

fn write_histogram(
    folder: &Path,
    layout: &Layout,
    statistics: &BatchStatistics,
) -> Result<(), WriteError> {
    let header = [
        "side",
        "theta_min_deg",
        "theta_max_deg",
        "phi_min_deg",
        "phi_max_deg",
        "solid_angle_sr",
        "flux",
        "flux_se",
        "intensity",
        "bsdf",
        "bsdf_se",
        "rays",
        "flux_single",
        "flux_single_se",
        "flux_multiple",
        "flux_multiple_se",
    ];
    let grid = layout.grid();
    let batches = statistics.batches() as f64;
    let phi_edges = grid.phi_edges_deg();
    let rows = grid.bins().enumerate().map(|(i, bin)| {
        let edges = grid.theta_edges_deg(bin.side);
        let ring = (i / grid.n_phi()) % grid.n_theta();
        let sector = i % grid.n_phi();
        let [single, multiple, total] =
            Share::ALL.map(|share| statistics.estimate(layout.bins(share).start + i));
        let hits: f64 = [Share::Single, Share::Multiple]
            .map(|share| statistics.means()[layout.hits(share).start + i])
            .iter()
            .sum();
        let projected = bin.solid_angle * bin.mean_abs_cos();
        let mut row: Vec<Field<'_>> = vec![
            bin.side.to_string().into(),
            edges[ring].into(),
            edges[ring + 1].into(),
            phi_edges[sector].into(),
            phi_edges[sector + 1].into(),
            bin.solid_angle.into(),
            total.mean.into(),
            total.se.into(),
            (total.mean / bin.solid_angle).into(),
            (total.mean / projected).into(),
            total.se.map(|se| se / projected).into(),
            // The mean number of rays in a batch, times the number of batches, a ray.
            (hits * batches).into(),
        ];
        row.extend(fields(single));
        row.extend(fields(multiple));
        row
    });
    write_csv(folder.join("histogram.csv"), &header, rows)
}

fn order_header() -> Vec<String> {
    ["order_1", "order_2", "order_3", "order_4_and_above"]
        .iter()
        .flat_map(|name| [format!("flux_{name}"), format!("flux_{name}_se")])
        .collect()
}

fn write_theta(
    folder: &Path,
    layout: &Layout,
    statistics: &BatchStatistics,
) -> Result<(), WriteError> {
    let orders = order_header();
    let mut header = vec!["side", "theta_min_deg", "theta_max_deg", "flux", "flux_se"];
    header.extend(orders.iter().map(String::as_str));
    let mut rows = Vec::new();
    for side in Side::BOTH {
        let edges = layout.grid().theta_edges_deg(side);
        for ring in 0..layout.grid().n_theta() {
            let of = |class| statistics.estimate(layout.rings(side, class).start + ring);
            let mut row: Vec<Field<'_>> = vec![
                side.to_string().into(),
                edges[ring].into(),
                edges[ring + 1].into(),
            ];
            row.extend(fields(of(OrderClass::All)));
            row.extend(
                OrderClass::ALL[..4]
                    .iter()
                    .flat_map(|&class| fields(of(class))),
            );
            rows.push(row);
        }
    }
    write_csv(folder.join("theta.csv"), &header, rows)
}

fn write_in_plane(
    folder: &Path,
    layout: &Layout,
    statistics: &BatchStatistics,
    models: &[ModelOutcome],
) -> Result<(), WriteError> {
    let orders = order_header();
    let of_models: Vec<String> = models
        .iter()
        .map(|m| format!("intensity_{}", m.model.name().replace('-', "_")))
        .collect();
    let mut header = vec![
        "side",
        "theta_min_deg",
        "theta_max_deg",
        "solid_angle_sr",
        "flux",
        "flux_se",
        "intensity",
        "intensity_se",
    ];
    header.extend(orders.iter().chain(&of_models).map(String::as_str));
    let mut rows = Vec::new();
    for side in Side::BOTH {
        for i in 0..layout.in_plane_len() {
            let of = |class| statistics.estimate(layout.in_plane(side, class).start + i);
            let [from, to] = layout.in_plane_edges_deg(i);
            let solid_angle = layout.in_plane_solid_angle(i);
            let all = of(OrderClass::All);
            let mut row: Vec<Field<'_>> = vec![
                side.to_string().into(),
                from.into(),
                to.into(),
                solid_angle.into(),
            ];
            row.extend(fields(all));
            row.push((all.mean / solid_angle).into());
            row.push(all.se.map(|se| se / solid_angle).into());
            row.extend(
                OrderClass::ALL[..4]
                    .iter()
                    .flat_map(|&class| fields(of(class))),
            );
            row.extend(
                models
                    .iter()
                    .map(|m| Field::from(m.in_plane[side.index()][i] / solid_angle)),
            );
            rows.push(row);
        }
    }
    write_csv(folder.join("in_plane.csv"), &header, rows)
}

/// comparison.csv: bin by bin, explicit single scattering beside every model.
fn write_comparison(
    folder: &Path,
    outcome: &VerifyOutcome,
    case: &CaseOutcome,
) -> Result<(), WriteError> {
    if case.models.is_empty() {
        return Ok(());
    }
    let of_models: Vec<String> = case
        .models
        .iter()
        .flat_map(|m| {
            let name = m.model.name().replace('-', "_");
            [format!("flux_{name}"), format!("z_{name}")]
        })
        .collect();
    let mut header = vec![
        "side",
        "theta_min_deg",
        "theta_max_deg",
        "phi_min_deg",
        "phi_max_deg",
        "tested",
        "flux_single",
        "flux_single_se",
    ];
    header.extend(of_models.iter().map(String::as_str));
    let grid = outcome.layout.grid();
    let start = outcome.layout.bins(Share::Single).start;
    let phi_edges = grid.phi_edges_deg();
    let rows = (0..grid.len()).map(|i| {
        let side = grid.bin(i).side;
        let edges = grid.theta_edges_deg(side);
        let ring = (i / grid.n_phi()) % grid.n_theta();
        let sector = i % grid.n_phi();
        let tested = case.models[0].single.bins[i].tested;
        let mut row: Vec<Field<'_>> = vec![
            side.to_string().into(),
            edges[ring].into(),
            edges[ring + 1].into(),
            phi_edges[sector].into(),
            phi_edges[sector + 1].into(),
            u64::from(tested).into(),
        ];
        row.extend(fields(case.statistics.estimate(start + i)));
        for model in &case.models {
            let bin = &model.single.bins[i];
            row.push(bin.model.into());
            row.push(bin.z.into());
        }
        row
    });
    write_csv(folder.join("comparison.csv"), &header, rows)
}
