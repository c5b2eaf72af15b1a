//! The files of an attenuation run: tables, plots, report.txt and summary.json.

use asperity_simulate::Observer;
use std::path::Path;

use asperity_io::{
    CsvField as Field, create_output_folder, remove_files, write_bytes, write_csv, write_json,
};
use asperity_tally::Estimate;
use serde_json::{Value, json};

use super::figures;
use super::tables::attenuation_table;
use super::{AttenuationOutcome, AttenuationRow, Demarcation, VisibilityRow};
use crate::figures::save;
use crate::report::{FILES, ReportError};

/// Writes what was found into `folder`: attenuation.csv, demarcation.csv and visibility.csv where they were
/// asked for, plots, report.txt, and, last, summary.json.
///
/// # Errors
/// [`ReportError`] if a file cannot be written or a plot drawn.
pub fn attenuation_report(
    folder: &Path,
    outcome: &AttenuationOutcome,
    progress: &dyn Observer,
) -> Result<(), ReportError> {
    create_output_folder(folder)?;
    remove_files(folder, FILES)?;
    let drawn = if outcome.config.output.plots {
        figures::figures(outcome)
    } else {
        Vec::new()
    };
    progress.begin("writing", drawn.len() as u64);
    write_csv(
        folder.join("attenuation.csv"),
        &ATTENUATION,
        outcome.rows.iter().map(attenuation_fields),
    )?;
    if !outcome.demarcation.is_empty() {
        write_csv(
            folder.join("demarcation.csv"),
            &DEMARCATION,
            outcome.demarcation.iter().map(demarcation_fields),
        )?;
    }
    if !outcome.visibility.is_empty() {
        write_csv(
            folder.join("visibility.csv"),
            &VISIBILITY,
            outcome.visibility.iter().map(visibility_fields),
        )?;
    }
    for (name, curves) in drawn {
        save(&[folder], name, &curves.draw()?)?;
        progress.advance(1);
    }
    write_bytes(
        folder.join("report.txt"),
        attenuation_table(outcome).as_bytes(),
    )?;
    write_json(folder.join("summary.json"), &attenuation_summary(outcome))?;
    progress.end();
    Ok(())
}

/// The contents of summary.json.
#[must_use]
pub fn attenuation_summary(outcome: &AttenuationOutcome) -> Value {
    json!({
        "schema": 1,
        "command": "attenuation",
        "version": env!("CARGO_PKG_VERSION"),
        "seed": outcome.config.run.seed,
        "config": outcome.config,
        "mesh_slope_deficit": outcome.mesh_slope_deficit,
        "rows": outcome.rows,
        "demarcation": outcome.demarcation,
        "visibility": outcome.visibility,
        "work": outcome.work,
    })
}

const ATTENUATION: [&str; 41] = [
    "sigma",
    "theta",
    "phi",
    "view_theta",
    "view_phi",
    "lit",
    "lit_se",
    "g1",
    "g1_se",
    "g1_projected",
    "g1_projected_se",
    "lit_projected",
    "lit_projected_se",
    "smith_lit",
    "smith_g1",
    "smith_lit_as_printed",
    "v_cavity_lit",
    "v_cavity_g1",
    "local_shadow",
    "local_shadow_se",
    "distant_shadow",
    "distant_shadow_se",
    "local_mask",
    "local_mask_se",
    "distant_mask",
    "distant_mask_se",
    "g1_view",
    "g1_view_se",
    "g2",
    "g2_se",
    "smith_separable_g2",
    "smith_correlated_g2",
    "v_cavity_g2",
    "paper_g2",
    "paper_g2_se",
    "mirror_g2",
    "mirror_g2_se",
    "g1_less_smith",
    "g1_less_smith_se",
    "lit_less_smith",
    "lit_less_smith_se",
];

fn attenuation_fields(row: &AttenuationRow) -> Vec<Field<'static>> {
    let mut fields: Vec<Field<'static>> = Vec::new();
    let plain = |fields: &mut Vec<Field<'static>>, values: &[f64]| {
        fields.extend(values.iter().map(|&value| Field::from(value)));
    };
    plain(
        &mut fields,
        &[row.sigma, row.theta, row.phi, row.view_theta, row.view_phi],
    );
    for share in [row.lit, row.g1, row.g1_projected, row.lit_projected] {
        estimate(&mut fields, Some(share));
    }
    let theory = [
        row.smith_lit,
        row.smith_g1,
        row.smith_lit_as_printed,
        row.v_cavity_lit,
        row.v_cavity_g1,
    ];
    plain(&mut fields, &theory);
    for share in [
        row.local_shadow,
        row.distant_shadow,
        row.local_mask,
        row.distant_mask,
        row.g1_view,
        row.g2,
    ] {
        estimate(&mut fields, Some(share));
    }
    let theory = [
        row.smith_separable_g2,
        row.smith_correlated_g2,
        row.v_cavity_g2,
    ];
    plain(&mut fields, &theory);
    estimate(&mut fields, Some(row.paper_g2));
    estimate(&mut fields, row.mirror_g2);
    for (share, smith) in [(row.g1, row.smith_g1), (row.lit, row.smith_lit)] {
        let mean = share.mean - smith;
        estimate(&mut fields, Some(Estimate { mean, ..share }));
    }
    fields
}

const DEMARCATION: [&str; 14] = [
    "sigma",
    "first_dark",
    "first_dark_se",
    "first_dark_scaled",
    "first_dark_scaled_se",
    "first_shadowed",
    "first_shadowed_se",
    "one_percent_dark",
    "one_percent_dark_se",
    "smith_one_percent_dark",
    "one_percent_shadowed",
    "one_percent_shadowed_se",
    "smith_one_percent_shadowed",
    "paper",
];

fn demarcation_fields(row: &Demarcation) -> Vec<Field<'static>> {
    let mut fields = vec![Field::from(row.sigma)];
    estimate(&mut fields, Some(row.first_dark));
    estimate(&mut fields, Some(row.first_dark_scaled));
    estimate(&mut fields, row.first_shadowed);
    estimate(&mut fields, row.one_percent_dark);
    fields.push(row.smith_one_percent_dark.into());
    estimate(&mut fields, row.one_percent_shadowed);
    fields.push(row.smith_one_percent_shadowed.into());
    fields.push(row.paper.into());
    fields
}

const VISIBILITY: [&str; 10] = [
    "sigma",
    "theta",
    "x",
    "height_min",
    "height_max",
    "points",
    "visibility",
    "visibility_se",
    "smith",
    "xu_sun",
];

fn visibility_fields(row: &VisibilityRow) -> Vec<Field<'static>> {
    let mut fields: Vec<Field<'static>> = [
        row.sigma,
        row.theta,
        row.x,
        row.height_min,
        row.height_max,
        row.points,
    ]
    .map(Field::from)
    .to_vec();
    estimate(&mut fields, row.visibility);
    fields.push(row.smith.into());
    fields.push(row.xu_sun.into());
    fields
}

/// A mean and its error, or two empty fields.
fn estimate(fields: &mut Vec<Field<'static>>, estimate: Option<Estimate>) {
    fields.push(estimate.map(|estimate| estimate.mean).into());
    fields.push(estimate.and_then(|estimate| estimate.se).into());
}
