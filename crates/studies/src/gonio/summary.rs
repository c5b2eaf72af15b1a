//! A measurement in words: report.txt.

use std::collections::BTreeSet;
use std::fmt::Write;

use asperity_simulate::{Outcome, counted, short};
use asperity_tally::HemisphereGrid;

use super::distinction::{Distinction, labelled};
use super::emissivity::{SettingEmissivity, emissivity_lines};
use super::figures::quantity;
use super::outcome::{Direction, GonioOutcome};
use super::peak::Peak;
use super::tables::{measured, report};
use crate::config::lobes::BinnedLobe;
use crate::output::{Column, Table, cut_short, wrapped};
use crate::report::appearance::{appearance_columns, coherent_note, coherent_warning};
use crate::report::energies::{lost_warning, more_rays_warning};
use crate::report::headline::{errors_line, left_out, light_line};
use crate::report::spectrum::EMISSIVITY;
use crate::validity::{first_warning, note_of_several, wavelength_warnings};

/// Headline: light of all directions, the brightest of them, errors, and what is left out.
pub(super) fn headline(outcome: &GonioOutcome<'_>) -> Vec<String> {
    let found: Vec<&Outcome> = measured(outcome).filter_map(|one| one.outcome).collect();
    let mut lines: Vec<String> = light_line(&found).into_iter().collect();
    let sides = outcome.spec().sides();
    let peaks = sides.filter_map(|side| {
        let of = |one: Direction<'_>| Some((Peak::of(&one, side)?, one.case.light.incidence));
        let peaks = measured(outcome).filter_map(of);
        let (peak, light) = peaks.max_by(|(a, _), (b, _)| a.mean().total_cmp(&b.mean()))?;
        let (name, theta) = (quantity(side), short(light.theta_deg()));
        Some(format!(
            "{name} up to {} deg (light at {theta} deg), 1/sr",
            peak.text()
        ))
    });
    lines.extend(peaks);
    lines.extend(errors_line(&found));
    let validities = measured(outcome).map(|one| outcome.validity(&one));
    lines.push(left_out(&found, validities, outcome.config.run.max_order));
    lines
}

/// The summary as text: report.txt.
pub(super) fn gonio_table(outcome: &GonioOutcome) -> String {
    let mut out = String::new();
    let done = outcome.directions().len() - outcome.missing();
    let distinction = Distinction::of(outcome.settings());
    let name = outcome.sample.map(|sample| sample.name.clone());
    let head: Vec<String> = name
        .into_iter()
        .chain(Some(distinction.common.clone()).filter(|text| !text.is_empty()))
        .collect();
    let _ = writeln!(
        out,
        "virtual gonioreflectometer: {done} of {} directions; {}",
        outcome.directions().len(),
        head.join(", ")
    );
    if let Some(found) = measured(outcome).find_map(|one| one.outcome) {
        let _ = writeln!(
            out,
            "{} bins, {} and {} rays per direction; standard errors from {}",
            bins(outcome),
            counted(found.work.realisations, "surface"),
            found.work.rays,
            found.errors_from
        );
    }
    if let Some(line) = first_lines(outcome) {
        let _ = writeln!(out, "{}", wrapped(&line));
    }
    let directions: Vec<Direction<'_>> = outcome.directions().collect();
    let settings = directions.chunks(outcome.per_setting());
    for (label, directions) in distinction.labels.iter().zip(settings) {
        let _ = match label.is_empty() {
            true => writeln!(out),
            false => writeln!(out, "\n{}", labelled(&distinction.title, label)),
        };
        out.push_str(&report(outcome.spec()).keys(2).text(directions));
        out.push_str(&appearance(outcome, directions));
    }
    let emissivities = SettingEmissivity::of(outcome);
    for line in emissivity_lines(&emissivities) {
        let _ = writeln!(out, "\n{line}");
    }
    if let Some(note) = coherent_note(outcome.sample_lights()) {
        let _ = writeln!(out, "\n{note}");
    }
    if let Some(note) = validity_note(outcome) {
        let _ = writeln!(out, "\n{}", wrapped(&format!("note: {note}")));
    }
    for note in notes(outcome) {
        let _ = writeln!(out, "\nnote: {note}");
    }
    for warning in warnings(outcome) {
        let _ = writeln!(out, "\nwarning: {warning}");
    }
    wrapped(&out)
}

/// Readings of instruments near the specular direction, a row per direction; nothing without any.
fn appearance<'a>(outcome: &'a GonioOutcome<'a>, directions: &[Direction<'a>]) -> String {
    type Row<'a> = Direction<'a>;
    let samples = directions
        .iter()
        .filter_map(|one| outcome.sample_light(one));
    let has_coherent = coherent_note(samples).is_some();
    let rows = directions.iter().filter(|one| one.outcome.is_some());
    let incidence = |row: &Row<'_>| row.case.light.incidence;
    let table = Table::new()
        .column(Column::new("theta", "", move |row| {
            incidence(row).theta_deg()
        }))
        .column(Column::new("phi", "", move |row| incidence(row).phi_deg()))
        .columns(appearance_columns(has_coherent, |row: &Row<'a>| {
            outcome.sample_light(row)
        }));
    table.keys(2).text(rows)
}

/// The first direction with much coherent light, and the number of others.
fn first_lines(outcome: &GonioOutcome) -> Option<String> {
    let warnings = measured(outcome).filter_map(|direction| {
        let validity = outcome.validity(&direction)?;
        let line = validity.first_lines(direction.statistics()?)?;
        Some((direction.case.direction_name(), line))
    });
    first_warning(warnings, "directions")
}

/// Validity of geometric optics, for the direction where lengths are shortest against the wavelength.
fn validity_note(outcome: &GonioOutcome) -> Option<String> {
    let known = outcome.directions().filter_map(|direction| {
        let validity = outcome.validity(&direction)?;
        Some((direction.case.direction_name(), validity))
    });
    note_of_several(&known.collect::<Vec<_>>(), "directions")
}

/// Numbers of bins of a side: of all directions, or of that with the fewest and of that with the most.
fn bins(outcome: &GonioOutcome) -> String {
    let grids = outcome.directions().map(|one| one.spec.grid());
    let fewest = grids.clone().min_by_key(HemisphereGrid::len);
    let most = grids.max_by_key(HemisphereGrid::len);
    match (fewest, most) {
        (Some(fewest), Some(most)) if fewest.len() != most.len() => format!("{fewest} to {most}"),
        (one, _) => one.unwrap_or_default().to_string(),
    }
}

/// Notes on the surface, one sentence each.
pub(super) fn notes(outcome: &GonioOutcome) -> Vec<String> {
    let mut notes = match outcome.sample {
        Some(sample) => sample.warnings.clone(),
        None if outcome.config.run.target_error.is_none()
            && outcome.config.run.realisations.0 == 1 =>
        {
            vec![
                "one surface: errors hold for this surface, not for the ensemble it comes from"
                    .to_owned(),
            ]
        }
        None => Vec::new(),
    };
    if outcome.sample.is_some() && outcome.config.any_azimuth() {
        notes.push(
            "light falls from random azimuths, so that results are means over all directions of the surface; --light-azimuth fixed keeps them apart".to_owned(),
        );
    }
    if outcome.sample.is_none() {
        notes.extend(outcome.config.surface.erosion_notes());
    }
    let wavelength = outcome.config.light.wavelength_nm();
    let is_named = outcome.config.material.media().is_some();
    notes.extend(wavelength_warnings(wavelength, is_named, outcome.unit()));
    let chosen = outcome.config.output.coherent;
    let case = outcome.plan.cases.first();
    notes.extend(case.and_then(|case| coherent_warning(chosen, case)));
    if !SettingEmissivity::of(outcome).is_empty() {
        notes.push(EMISSIVITY.to_owned());
    }
    notes
}

/// Warnings on the results.
pub(super) fn warnings(outcome: &GonioOutcome) -> Vec<String> {
    let mut warnings = Vec::new();
    if outcome.missing() > 0 {
        warnings.push(format!(
            "{} of {} directions are missing; the same command resumes",
            outcome.missing(),
            outcome.directions().len()
        ));
    }
    let all = outcome.directions().len();
    warnings.extend(cut_short(outcome.found.cut_short(), all, "directions"));
    let found = || measured(outcome).filter_map(|one| one.outcome);
    let most = found().map(|one| one.work.rays).max().unwrap_or(0);
    warnings.extend(more_rays_warning(&outcome.config.run, most));
    let of_meshes: BTreeSet<&str> = found()
        .filter_map(|one| one.errors.mesh_warning())
        .collect();
    warnings.extend(of_meshes.into_iter().map(str::to_owned));
    if outcome.config.any_azimuth() && outcome.phis.len() > 1 {
        warnings.push(
            "the azimuth of the light is random, so all directions of one polar angle give the same result; give one phi"
                .to_owned(),
        );
    }
    for direction in measured(outcome) {
        let lost = direction.statistics().and_then(lost_warning);
        let name = direction.case.direction_name();
        warnings.extend(lost.map(|warning| format!("{name}: {warning}")));
    }
    warnings.extend(narrow_lobes(outcome));
    warnings
}

/// Warning on lobes narrower than their bins: the first such direction, and the number of others.
fn narrow_lobes(outcome: &GonioOutcome) -> Option<String> {
    let mut narrow = outcome.directions().filter_map(|direction| {
        let warning = direction.lobes().iter().find_map(BinnedLobe::warning)?;
        Some(format!("{}: {warning}", direction.case.direction_name()))
    });
    let first = narrow.next()?;
    Some(match narrow.count() {
        0 => first,
        others => format!("{first}; the same in {others} other directions"),
    })
}
