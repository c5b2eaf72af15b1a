//! The tables of run time against error: convergence.csv and report.txt.

use asperity_surface::LengthUnit;
use std::fmt::{Display, Write};

use asperity_simulate::{counted, short};
use asperity_tally::Estimate;
use asperity_tracer::Branching;

use super::{
    ConvergeOutcome, ConvergedCase, Measurement, Method, MethodOutcome, RepeatedError, SecondsTo,
};
use crate::output::{
    Cell, Column, Table, fitted, percent, range, significant, with_error, wrapped,
};

/// Headline: the method with the least error after one second, by case, and the error of the reference.
pub(super) fn headline(cases: &[ConvergedCase<'_>]) -> Vec<String> {
    let best = |case: &ConvergedCase<'_>| {
        let at =
            |method: &MethodOutcome| Some((method.fit.error_at_one_second?, method.name.clone()));
        let methods = case.methods.iter().filter_map(at);
        methods.min_by(|(a, _), (b, _)| a.total_cmp(b))
    };
    let found: Vec<(f64, String)> = cases.iter().filter_map(best).collect();
    let mut names: Vec<&String> = found.iter().map(|(_, name)| name).collect();
    names.sort();
    names.dedup();
    let parts: Vec<String> = names
        .into_iter()
        .map(|name| {
            let of_name = found.iter().filter(|(_, other)| other == name);
            let mut errors = of_name.clone().map(|(error, _)| percent(*error));
            match (cases.len(), of_name.count()) {
                (1, _) => format!("{name}, {}", errors.next_back().unwrap_or_default()),
                (_, count) => format!("{name} in {count} of {} cases", cases.len()),
            }
        })
        .collect();
    let mut lines = Vec::new();
    if !parts.is_empty() {
        lines.push(fitted("least error after one second: ", &parts, ""));
    }
    let errors = range(cases.iter().map(|case| 100.0 * case.reference.error));
    lines.extend(errors.map(|[_, most]| {
        format!("errors are root mean squares over the bins; the reference has up to {most} %")
    }));
    lines
}

/// The tables of every case.
pub(super) fn converge_table(outcome: &ConvergeOutcome) -> String {
    outcome
        .cases
        .iter()
        .map(|case| format!("{}\n", case_table(outcome, case)))
        .collect()
}

/// The tables of one case: what was measured, and the seconds to each error.
pub(super) fn case_table(outcome: &ConvergeOutcome, case: &ConvergedCase) -> String {
    let mut out = case_head(outcome, case);
    let runs = counted(outcome.config.converge.repeats.0, "run");
    let _ = writeln!(
        out,
        "seconds are medians of {runs} on {}; in brackets the fastest and the slowest run\n",
        counted(case.work.threads as u64, "thread"),
    );
    out.push_str(&measured(case).text(rows(case)));
    if rows(case).any(|row| !row.measurement.usable) {
        out.push_str("* too close to the error of the reference, and left out of the fit\n");
    }
    out.push_str(&case_notes(case));
    out.push('\n');
    out.push_str(&compared(outcome).text(&case.methods));
    let _ = writeln!(
        out,
        "\n~ lies beyond what was measured. In brackets: how many times longer plain random rays take to the same error{}. Efficiency: the same at equal numbers of rays.",
        which_plain(case),
    );
    if case
        .methods
        .iter()
        .any(|method| method.method.peer_rate.is_some())
    {
        out.push_str("The seconds of a peer are computed, rays over its rate: surfaces and search structures count as nothing. Its errors are those of plain random rays that pick, on as many surfaces.\n");
    }
    wrapped(&out)
}

/// Plain random rays that others are compared with, where there are two kinds.
fn which_plain(case: &ConvergedCase) -> &'static str {
    let all = || case.methods.iter().map(|other| &other.method);
    let of = |branching| all().any(|m| m.is_plain_and_random() && m.branching == branching);
    match (of(Branching::Split), of(Branching::Pick)) {
        (true, true) => ", following both branches",
        _ => "",
    }
}

/// The surfaces of a case, its reference and how its meshes differ from the surface.
fn case_head(outcome: &ConvergeOutcome, case: &ConvergedCase) -> String {
    let mut out = String::new();
    let reference = &case.reference;
    let [x, y] = outcome.config.extent();
    let [nx, ny] = reference.size;
    let _ = writeln!(out, "{}", case.case.label());
    let _ = writeln!(
        out,
        "surfaces of {} x {}{}; reference: {} surfaces of {nx} x {ny} samples with {} rays each, {} and {}, in {} s",
        short(x),
        short(y),
        match case.case.at.unit {
            LengthUnit::Arbitrary => " length units",
            unit => unit.suffix(),
        },
        reference.surfaces,
        reference.rays_per_surface,
        reference.method.estimator,
        reference.method.sampling,
        significant(reference.seconds),
    );
    let _ = write!(
        out,
        "relative error of the reference {}",
        significant(reference.error)
    );
    if let Some(error) = reference.error_exact {
        let _ = write!(
            out,
            "; against the exact fluxes it is off by {}",
            significant(error)
        );
    }
    out.push('\n');
    let mut last = None;
    for method in case.methods.iter().map(|method| &method.method) {
        if last.replace(method.spacing) != Some(method.spacing) {
            let _ = writeln!(
                out,
                "at spacing {} the slope variance of the mesh is {:.2} % below that of the continuous surface",
                method.spacing_text(),
                100.0
                    * outcome
                        .config
                        .surface
                        .facet_slope_deficit(method.spacing.xy().map(|d| d.0)),
            );
        }
    }
    out
}

/// Notes on the measurements for the reader.
fn case_notes(case: &ConvergedCase) -> String {
    let mut out = String::new();
    let setup = case.methods.iter().map(|method| method.setup_seconds);
    let setup = setup.fold(0.0, f64::max);
    // Plain rays have nothing to prepare; what the clock says of that is no news.
    if setup > 1e-4 {
        let _ = writeln!(
            out,
            "the mean of the control variate took {} s, once and not counted above",
            significant(setup)
        );
    }
    if case.work.lost != 0.0 {
        let _ = writeln!(
            out,
            "warning: {:.3e} of the flux was lost to numerical failure: do not trust these results",
            case.work.lost
        );
    }
    out
}

/// A measurement of one method of a case.
pub(super) struct Row<'a> {
    method: &'a MethodOutcome,
    measurement: &'a Measurement,
    /// `true` if it is the first one of its method.
    is_first: bool,
}

/// The measurements of a case, method by method.
pub(super) fn rows<'a>(case: &'a ConvergedCase<'_>) -> impl Iterator<Item = Row<'a>> {
    case.methods.iter().flat_map(|method| {
        let measurements = method.measurements.iter().enumerate();
        measurements.map(move |(i, measurement)| Row {
            method,
            measurement,
            is_first: i == 0,
        })
    })
}

/// convergence.csv: a row per method and effort.
pub(super) fn convergence<'a>(case: &'a ConvergedCase<'_>) -> Table<'a, Row<'a>> {
    let text = |name, about, of: fn(&Method) -> &dyn Display| {
        Column::new(name, about, move |row: &Row<'_>| {
            of(&row.method.method).to_string()
        })
    };
    let column = |name, about, of: fn(&Method, &Measurement) -> Cell| {
        Column::new(name, about, move |row: &Row<'_>| {
            of(&row.method.method, row.measurement)
        })
    };
    let reference_error = move |_: &Row<'_>| case.reference.error;
    Table::new().columns([
        text("estimator", "estimator", |of| &of.estimator),
        text("sampling", "how rays are distributed", |of| &of.sampling),
        text("branching", "branches that paths follow", |of| {
            &of.branching
        }),
        column(
            "peer_rate",
            "rays per second of a peer, by which seconds are computed; empty for what was timed",
            |of, _| of.peer_rate.into(),
        ),
        text("accelerator", "accelerator", |of| &of.accelerator),
        column("spacing", "length units per sample", |of, _| {
            match of.spacing.xy() {
                [dx, dy] if dx == dy => dx.0.into(),
                _ => of.spacing_text().into(),
            }
        }),
        column("rays_per_surface", "rays per surface", |_, m| {
            m.rays_per_surface.into()
        }),
        column("surfaces", "surfaces", |_, m| m.surfaces.into()),
        column(
            "repeats",
            "runs of which the medians and errors are",
            |_, m| m.repeats.into(),
        ),
        column("seconds", "median run time", |_, m| m.seconds.into()).unit("s"),
        column("seconds_min", "shortest run time", |_, m| {
            m.seconds_min.into()
        })
        .unit("s"),
        column("seconds_max", "longest run time", |_, m| {
            m.seconds_max.into()
        })
        .unit("s"),
        column("error", "relative error against the reference", |_, m| {
            m.error.rms.into()
        }),
        column("error_se", "its standard error", |_, m| m.error.se.into()),
        Column::new(
            "reference_error",
            "relative error of the reference",
            reference_error,
        ),
        column(
            "error_exact",
            "relative error against the exact fluxes",
            |_, m| m.error_exact.map(|error| error.rms).into(),
        ),
        column(
            "energy_error",
            "deviation of the total energy from one",
            |_, m| m.energy_error.into(),
        ),
        column(
            "usable",
            "1 if the error is well above that of the reference",
            |_, m| u64::from(m.usable).into(),
        ),
    ])
}

/// A row per method and effort, for report.txt.
fn measured<'a>(case: &ConvergedCase<'_>) -> Table<'a, Row<'a>> {
    let column = |name, of: fn(&Row<'_>) -> Cell| Column::new(name, "", of);
    let table = Table::new().columns([
        column("method", |row| match row.is_first {
            true => row.method.name.clone().into(),
            false => "".into(),
        }),
        column("surfaces", |row| row.measurement.surfaces.into()),
        column("rays each", |row| row.measurement.rays_per_surface.into()),
        column("seconds", |row| {
            let m = row.measurement;
            let [median, least, most] = [m.seconds, m.seconds_min, m.seconds_max].map(significant);
            match row.method.method.peer_rate {
                Some(_) => median.into(),
                None => format!("{median} ({least}-{most})").into(),
            }
        }),
        column("relative error", |row| {
            let mark = if row.measurement.usable { "" } else { " *" };
            format!("{}{mark}", repeated(row.measurement.error)).into()
        }),
    ]);
    let exact = || {
        column("against exact fluxes", |row| {
            row.measurement.error_exact.map(repeated).into()
        })
    };
    table.columns(case.is_exact.then(exact))
}

/// A row per method: slope, seconds to each error, gains.
fn compared<'a>(outcome: &'a ConvergeOutcome<'_>) -> Table<'a, MethodOutcome> {
    let seconds_to = |(i, error): (usize, &f64)| {
        Column::new(
            format!("s to {error:e}"),
            "",
            move |method: &MethodOutcome| marked(&method.seconds_to[i]),
        )
    };
    Table::new()
        .column(Column::new("method", "", |method: &MethodOutcome| {
            method.name.clone()
        }))
        .column(Column::new("slope", "", slope))
        .columns(outcome.plan.errors.iter().enumerate().map(seconds_to))
        .column(Column::new("efficiency", "", |method: &MethodOutcome| {
            let efficiency = method.efficiency?;
            Some(repeated(RepeatedError {
                rms: efficiency.ratio,
                se: efficiency.se,
            }))
        }))
}

fn slope(method: &MethodOutcome) -> Option<String> {
    let slope = format!("{:.2}", method.fit.slope?);
    Some(match method.fit.slope_se {
        Some(se) => format!("{slope} +- {se:.2}"),
        None => slope,
    })
}

/// Seconds, with a mark where they lie beyond what was measured, and in brackets what plain random rays take over that.
fn marked(to: &SecondsTo) -> Option<String> {
    let mark = if to.extrapolated == Some(true) {
        "~"
    } else {
        ""
    };
    let seconds = format!("{mark}{}", significant(to.seconds?));
    Some(match to.plain_random_over_this {
        Some(gain) => format!("{seconds} ({})", significant(gain)),
        None => seconds,
    })
}

fn repeated(error: RepeatedError) -> String {
    match error.se {
        // A root of squares that has no scatter is not thereby exact.
        None | Some(0.0) => significant(error.rms),
        se => with_error(Estimate {
            mean: error.rms,
            se,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_beyond_what_was_measured_are_marked() {
        let to = |seconds, extrapolated| {
            let to = SecondsTo {
                error: 1e-3,
                seconds: Some(seconds),
                extrapolated: Some(extrapolated),
                plain_random_over_this: None,
            };
            marked(&to).unwrap()
        };
        assert_eq!(to(1.2345, false), "1.23");
        assert_eq!(to(1.2345e7, true), "~1.23e7");
        assert_eq!(to(0.012_345, true), "~0.0123");
    }
}
