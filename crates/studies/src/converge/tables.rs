//! The tables of run time against error: convergence.csv and report.txt.

use asperity_surface::LengthUnit;
use std::fmt::Write;
use std::path::Path;

use asperity_io::WriteError;
use asperity_simulate::{counted, short};
use asperity_tally::Estimate;
use asperity_tracer::Branching;

use super::{
    ConvergeOutcome, ConvergedCase, Efficiency, Measurement, Method, MethodOutcome, RepeatedError,
    SecondsTo,
};
use crate::output::{Cell, Column, Table, significant, with_error, wrapped};

/// What a method is called among the methods of its case: what they have in common is left out, the
/// estimator and the sampling aside.
pub(super) fn method_name(case: &ConvergedCase, outcome: &MethodOutcome) -> String {
    let method = &outcome.method;
    let others = || case.methods.iter().map(|other| &other.method);
    let mut name = match outcome.peer_rate {
        Some(rate) => format!("a peer of {rate:e} rays/s"),
        None => {
            let branching = match others().any(|other| other.branching != method.branching) {
                true => format!(", {}", method.branching),
                false => String::new(),
            };
            format!("{}, {}{branching}", method.estimator, method.sampling)
        }
    };
    if others().any(|other| other.accelerator != method.accelerator) {
        let _ = write!(name, ", {}", method.accelerator);
    }
    if others().any(|other| other.spacing != method.spacing) {
        let _ = write!(name, ", spacing {}", method.spacing_text());
    }
    name
}

/// The tables of every case.
#[must_use]
pub fn converge_table(outcome: &ConvergeOutcome) -> String {
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
        "seconds are medians of {runs} on {} threads; in brackets the fastest and the slowest run\n",
        case.work.threads,
    );
    out.push_str(&measured(case).text(measurements(case)));
    if measurements(case).any(|row| !row.measurement.usable) {
        out.push_str("* too close to the error of the reference, and left out of the fit\n");
    }
    out.push_str(&case_notes(case));
    out.push('\n');
    out.push_str(&compared(outcome, case).text(&case.methods));
    let _ = writeln!(
        out,
        "\n~ lies beyond what was measured. In brackets: how many times longer plain random rays take to the same error{}. Efficiency: the same at equal numbers of rays.",
        which_plain(case),
    );
    if case.methods.iter().any(|method| method.peer_rate.is_some()) {
        out.push_str("The seconds of a peer are computed, rays over its rate: surfaces and search structures count as nothing. Its errors are those of plain random rays that pick, on as many surfaces.\n");
    }
    wrapped(&out)
}

/// Which plain random rays others are compared with, where there are two kinds.
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

/// What a reader should know of the measurements.
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
pub(super) struct Measured<'a> {
    method: &'a MethodOutcome,
    measurement: &'a Measurement,
    /// Whether it is the first one of its method.
    first: bool,
}

/// The measurements of a case, method by method.
fn measurements(case: &ConvergedCase) -> impl Iterator<Item = Measured<'_>> {
    case.methods.iter().flat_map(|method| {
        let measurements = method.measurements.iter().enumerate();
        measurements.map(move |(i, measurement)| Measured {
            method,
            measurement,
            first: i == 0,
        })
    })
}

/// Writes convergence.csv.
pub(super) fn write_convergence(path: &Path, case: &ConvergedCase) -> Result<(), WriteError> {
    convergence(case).write_csv(path, measurements(case))
}

/// convergence.csv: a row per method and effort.
pub(super) fn convergence(case: &ConvergedCase) -> Table<'_, Measured<'_>> {
    with_measurements(with_methods(Table::new()), case)
}

/// With the columns of the method.
fn with_methods<'a>(table: Table<'a, Measured<'a>>) -> Table<'a, Measured<'a>> {
    type Row<'a> = Measured<'a>;
    let method = |name, about, of: fn(&Method) -> String| {
        Column::new(name, about, move |row: &Row<'_>| of(&row.method.method))
    };
    table
        .column(method("estimator", "estimator", |m| {
            m.estimator.to_string()
        }))
        .column(method("sampling", "how rays are distributed", |m| {
            m.sampling.to_string()
        }))
        .column(method("branching", "branches that paths follow", |m| {
            m.branching.to_string()
        }))
        .column(Column::new(
            "peer_rate",
            "rays per second of a peer, by which seconds are computed; empty for what was timed",
            |row: &Row<'_>| row.method.peer_rate,
        ))
        .column(method("accelerator", "accelerator", |m| {
            m.accelerator.to_string()
        }))
        .column(Column::new(
            "spacing",
            "length units per sample",
            |row: &Row<'_>| {
                let [dx, dy] = row.method.method.spacing.xy().map(|spacing| spacing.0);
                if dx == dy {
                    Cell::from(dx)
                } else {
                    row.method.method.spacing_text().into()
                }
            },
        ))
}

/// With the columns of effort, run time and error.
fn with_measurements<'a>(
    table: Table<'a, Measured<'a>>,
    case: &'a ConvergedCase,
) -> Table<'a, Measured<'a>> {
    type Row<'a> = Measured<'a>;
    let count = |name, about, of: fn(&Measurement) -> u64| {
        Column::new(name, about, move |row: &Row<'_>| of(row.measurement))
    };
    let number = |name, about, of: fn(&Measurement) -> Option<f64>| {
        Column::new(name, about, move |row: &Row<'_>| of(row.measurement))
    };
    table
        .column(count("rays_a_surface", "rays per surface", |m| {
            m.rays_per_surface
        }))
        .column(count("surfaces", "surfaces", |m| m.surfaces))
        .column(count(
            "repeats",
            "runs of which the medians and errors are",
            |m| m.repeats,
        ))
        .column(number("seconds", "median run time", |m| Some(m.seconds)).unit("s"))
        .column(number("seconds_min", "shortest run time", |m| Some(m.seconds_min)).unit("s"))
        .column(number("seconds_max", "longest run time", |m| Some(m.seconds_max)).unit("s"))
        .column(number(
            "error",
            "relative error against the reference",
            |m| Some(m.error.rms),
        ))
        .column(number("error_se", "its standard error", |m| m.error.se))
        .column(Column::new(
            "reference_error",
            "relative error of the reference",
            |_: &Row<'_>| case.reference.error,
        ))
        .column(number(
            "error_exact",
            "relative error against the exact fluxes",
            |m| Some(m.error_exact?.rms),
        ))
        .column(number(
            "energy_error",
            "deviation of the total energy from one",
            |m| m.energy_error,
        ))
        .column(count(
            "usable",
            "1 if the error is well above that of the reference",
            |m| m.usable.into(),
        ))
}

/// A row per method and effort, for report.txt.
fn measured(case: &ConvergedCase) -> Table<'_, Measured<'_>> {
    type Row<'a> = Measured<'a>;
    let seconds = |row: &Row<'_>| {
        let m = row.measurement;
        let [median, least, most] = [m.seconds, m.seconds_min, m.seconds_max].map(significant);
        match row.method.peer_rate {
            Some(_) => median,
            None => format!("{median} ({least}-{most})"),
        }
    };
    let table = Table::new()
        .column(Column::new("method", "", |row: &Row<'_>| match row.first {
            true => method_name(case, row.method),
            false => String::new(),
        }))
        .column(Column::new("surfaces", "", |row: &Row<'_>| {
            row.measurement.surfaces
        }))
        .column(Column::new("rays each", "", |row: &Row<'_>| {
            row.measurement.rays_per_surface
        }))
        .column(Column::new("seconds", "", seconds))
        .column(Column::new("relative error", "", |row: &Row<'_>| {
            let mark = if row.measurement.usable { "" } else { " *" };
            format!("{}{mark}", repeated(row.measurement.error))
        }));
    if !case.is_exact {
        return table;
    }
    table.column(Column::new("against exact fluxes", "", |row: &Row<'_>| {
        row.measurement.error_exact.map(repeated)
    }))
}

/// A row per method: slope, seconds to each error, gains.
fn compared<'a>(outcome: &'a ConvergeOutcome, case: &'a ConvergedCase) -> Table<'a, MethodOutcome> {
    let name = |method: &MethodOutcome| method_name(case, method);
    let seconds_to = |&error: &f64| {
        let seconds = move |method: &MethodOutcome| {
            let seconds = marked(method.fit?.seconds_to(error)?);
            Some(match case.speedup(method, error) {
                None => seconds,
                Some(gain) => format!("{seconds} ({})", significant(gain.seconds)),
            })
        };
        Column::new(format!("s to {error:e}"), "", seconds)
    };
    Table::new()
        .column(Column::new("method", "", name))
        .column(Column::new("slope", "", slope))
        .columns(outcome.errors.iter().map(seconds_to))
        .column(Column::new("efficiency", "", |method: &MethodOutcome| {
            let Efficiency { ratio, se } = case.efficiency(method)?;
            Some(repeated(RepeatedError { rms: ratio, se }))
        }))
}

fn slope(method: &MethodOutcome) -> Option<String> {
    let fit = method.fit?;
    Some(match fit.slope_se {
        Some(se) => format!("{:.2} +- {se:.2}", fit.slope),
        None => format!("{:.2}", fit.slope),
    })
}

/// Seconds, with a mark where they lie beyond what was measured.
fn marked(to: SecondsTo) -> String {
    let mark = if to.extrapolated { "~" } else { "" };
    format!("{mark}{}", significant(to.seconds))
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
            marked(SecondsTo {
                seconds,
                extrapolated,
            })
        };
        assert_eq!(to(1.2345, false), "1.23");
        assert_eq!(to(1.2345e7, true), "~1.23e7");
        assert_eq!(to(0.012_345, true), "~0.0123");
    }
}
