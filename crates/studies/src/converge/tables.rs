//! Run time against error as text that people read.

use asperity_simulate::short;
use std::fmt::Write;

use asperity_tally::Estimate;

use super::{
    ConvergeOutcome, ConvergedCase, Efficiency, Method, MethodOutcome, RepeatedError, SecondsTo,
};
use crate::tables::{aligned, with_error};

/// What a method is called beside the others of its case: what they have in common is left out, the
/// estimator and the sampling aside.
pub(super) fn method_name(case: &ConvergedCase, method: &Method) -> String {
    let mut name = format!("{}, {}", method.estimator, method.sampling);
    let others = || case.methods.iter().map(|other| &other.method);
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
    let mut out = String::new();
    let reference = &case.reference;
    let [x, y] = outcome.config.extent();
    let [nx, ny] = reference.size;
    let _ = writeln!(out, "{}", case.case);
    let _ = writeln!(
        out,
        "surfaces of {} x {} length units; the reference is {} of {nx} x {ny} samples with {} rays each, {} and {}, in {} s",
        short(x),
        short(y),
        reference.surfaces,
        reference.rays_a_surface,
        reference.method.estimator,
        reference.method.sampling,
        digits(reference.seconds),
    );
    let _ = write!(
        out,
        "relative error of the reference {}",
        digits(reference.error)
    );
    if let Some(error) = reference.error_exact {
        let _ = write!(
            out,
            "; against the exact fluxes it is off by {}",
            digits(error)
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
                100.0 * outcome.config.mesh_slope_deficit(method.spacing),
            );
        }
    }
    let repeats = outcome.config.converge.repeats.0;
    let plural = if repeats == 1 { "" } else { "s" };
    let _ = writeln!(
        out,
        "seconds are medians of {repeats} run{plural} on {} threads, and in brackets the fastest and the slowest\n",
        case.work.threads,
    );
    out.push_str(&aligned(&measured(case)));
    let setup = case.methods.iter().map(|method| method.setup_seconds);
    let setup = setup.fold(0.0, f64::max);
    // Plain rays have nothing to prepare; what the clock says of that is no news.
    if setup > 1e-4 {
        let _ = writeln!(
            out,
            "the mean of the control took {} s, once and not counted above",
            digits(setup)
        );
    }
    if case.work.lost != 0.0 {
        let _ = writeln!(
            out,
            "warning: {:.3e} of the flux was lost to numerical failure: do not trust these results",
            case.work.lost
        );
    }
    out.push('\n');
    out.push_str(&aligned(&compared(outcome, case)));
    let _ = writeln!(
        out,
        "\n~ lies beyond what was measured. In brackets, and as efficiency at equal rays: how many times\nlonger plain random rays take to the same error."
    );
    out
}

/// A row a method and effort.
fn measured(case: &ConvergedCase) -> Vec<Vec<String>> {
    let mut header = vec![
        "method",
        "surfaces",
        "rays each",
        "seconds",
        "relative error",
    ];
    if case.is_exact {
        header.push("against exact fluxes");
    }
    let mut rows = vec![header.into_iter().map(str::to_owned).collect::<Vec<_>>()];
    for method in &case.methods {
        for (i, m) in method.measurements.iter().enumerate() {
            let name = if i == 0 {
                method_name(case, &method.method)
            } else {
                String::new()
            };
            let mut row = vec![
                name,
                m.surfaces.to_string(),
                m.rays_a_surface.to_string(),
                format!(
                    "{} ({}-{})",
                    digits(m.seconds),
                    digits(m.seconds_min),
                    digits(m.seconds_max)
                ),
                repeated(m.error),
            ];
            row.extend(m.error_exact.map(repeated));
            if !m.usable {
                row.push("at the reference".to_owned());
            }
            rows.push(row);
        }
    }
    rows
}

/// A row a method: slope, seconds to each error, gains.
fn compared(outcome: &ConvergeOutcome, case: &ConvergedCase) -> Vec<Vec<String>> {
    let mut header = vec!["method".to_owned(), "slope".to_owned()];
    header.extend(outcome.errors.iter().map(|error| format!("s to {error:e}")));
    header.push("efficiency".to_owned());
    let mut rows = vec![header];
    for method in &case.methods {
        let mut row = vec![method_name(case, &method.method), slope(method)];
        row.extend(outcome.errors.iter().map(|&error| {
            let seconds = method.fit.and_then(|fit| fit.seconds_to(error));
            match (seconds, case.speedup(method, error)) {
                (None, _) => "-".to_owned(),
                (Some(seconds), None) => marked(seconds),
                (Some(seconds), Some(gain)) => {
                    format!("{} ({})", marked(seconds), digits(gain.seconds))
                }
            }
        }));
        row.push(match case.efficiency(method) {
            Some(Efficiency { ratio, se }) => repeated(RepeatedError { rms: ratio, se }),
            None => "-".to_owned(),
        });
        rows.push(row);
    }
    rows
}

fn slope(method: &MethodOutcome) -> String {
    match method.fit {
        Some(fit) => match fit.slope_se {
            Some(se) => format!("{:.2} +- {se:.2}", fit.slope),
            None => format!("{:.2}", fit.slope),
        },
        None => "-".to_owned(),
    }
}

/// Seconds, with a mark where they lie beyond what was measured.
fn marked(to: SecondsTo) -> String {
    let mark = if to.extrapolated { "~" } else { "" };
    format!("{mark}{}", digits(to.seconds))
}

fn repeated(error: RepeatedError) -> String {
    match error.se {
        // A root of squares that has no scatter is not thereby exact.
        None | Some(0.0) => digits(error.rms),
        se => with_error(Estimate {
            mean: error.rms,
            se,
        }),
    }
}

/// Three significant digits, with an exponent where there would be many zeros.
fn digits(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = value.abs().log10().floor() as i32;
    if (-4..6).contains(&exponent) {
        let places = (2 - exponent).max(0) as usize;
        format!("{value:.places$}")
    } else {
        format!("{value:.2e}")
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
        assert_eq!(digits(123_456.0), "123456");
        assert_eq!(digits(1.5e-5), "1.50e-5");
        assert_eq!(digits(0.0), "0");
    }
}
