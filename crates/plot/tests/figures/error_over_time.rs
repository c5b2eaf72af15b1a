//! Errors over run time.

use asperity_plot::{ErrorOverTime, PowerLaw, TimedError, TimedMethod};

use crate::{assert_has, render};

/// A method that reaches `error` in one second, with runs of so many seconds.
fn timed(name: &str, error: f64, seconds: &[f64]) -> TimedMethod {
    let (family, variant) = name.split_once(", ").unwrap_or((name, ""));
    TimedMethod {
        name: name.into(),
        family: family.into(),
        variant: variant.into(),
        runs: seconds
            .iter()
            .map(|&seconds| TimedError {
                seconds,
                seconds_range: [0.9 * seconds, 1.5 * seconds],
                error: error / seconds.sqrt(),
                se: Some(0.1 * error / seconds.sqrt()),
                fitted: true,
            })
            .collect(),
        fit: Some(PowerLaw {
            slope: -0.5,
            slope_se: Some(0.021),
            error_at_one_second: error,
        }),
    }
}

fn over_time(methods: Vec<TimedMethod>, reference_error: Option<f64>) -> ErrorOverTime {
    ErrorOverTime {
        title: "Run time against error: s = 3".into(),
        subtitle: "2 threads".into(),
        methods,
        reference_error,
    }
}

pub(crate) fn sample() -> ErrorOverTime {
    over_time(
        vec![timed("plain, random", 1e-2, &[0.02, 0.3, 4.0])],
        Some(1e-4),
    )
}

#[test]
fn errors_over_time_say_what_they_show() {
    let mut methods = Vec::new();
    for (estimator, error) in [("plain", 1e-2), ("controlled", 3e-4)] {
        for sampling in ["random", "stratified", "quasi-random"] {
            methods.push(timed(
                &format!("{estimator}, {sampling}"),
                error,
                &[0.02, 0.3, 4.0],
            ));
        }
    }
    methods[5].runs[2].fitted = false;
    methods[4].fit = None;
    let texts = render(&over_time(methods.clone(), Some(1e-4)).draw().unwrap());
    assert_has(
        &texts,
        &[
            "Run time against error: s = 3",
            "2 threads",
            "run time (seconds)",
            "relative root-mean-square error over bins",
            "plain, random: slope −0.50 ± 0.02",
            "controlled, stratified: no fit",
            "error of the reference itself",
            "Hollow: at the reference, not fitted.",
            "10⁻⁴",
            "10⁻¹",
        ],
    );
    // A reference far below the runs is neither drawn nor in the legend.
    let texts = render(&over_time(methods, Some(1e-7)).draw().unwrap());
    assert!(!texts.contains("error of the reference"));
    // Forty methods make the legend longer than the panel; all of them are in the figure.
    let many = (0..40).map(|i| timed(&format!("method {i}, variant {i}"), 1e-2, &[1.0]));
    let texts = render(&over_time(many.collect(), None).draw().unwrap());
    assert_has(&texts, &["method 39, variant 39"]);
    assert!(!texts.contains("reference") && !texts.contains("Hollow"));
}

#[test]
fn errors_over_time_survive_degenerate_runs_and_refuse_bad_ones() {
    for (error, seconds, reference) in [
        (1e-2, vec![1.0], Some(0.0)),
        (1e-2, vec![1.0, 1.0], Some(1e-9)),
        (1e100, vec![1e-300, 1e300], None),
        (1e-300, vec![1e-9, 2e-9], Some(1e-300)),
    ] {
        let figure = over_time(vec![timed("plain", error, &seconds)], reference);
        assert_has(&render(&figure.draw().unwrap()), &["plain"]);
    }
    let with = |change: fn(&mut TimedMethod)| {
        let mut method = timed("plain", 1e-2, &[1.0, 2.0]);
        change(&mut method);
        over_time(vec![method], None).draw()
    };
    // A run without error has no place; another one has.
    assert!(with(|method| method.runs[0].error = 0.0).is_ok());
    let error = with(|method| method.runs[1].seconds = 0.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "seconds of method \"plain\" must be above zero, value 1 is 0"
    );
    for refused in [
        with(|method| method.runs[0].error = -1.0),
        with(|method| method.runs[0].se = Some(-1.0)),
        with(|method| method.runs[0].seconds_range = [-1.0, 1.0]),
        with(|method| method.runs[0].error = f64::NAN),
        with(|method| method.fit.as_mut().unwrap().slope = f64::INFINITY),
        with(|method| method.fit.as_mut().unwrap().error_at_one_second = 0.0),
        over_time(vec![timed("plain", 1e-2, &[1.0])], Some(f64::NAN)).draw(),
        with(|method| method.runs.clear()),
        over_time(vec![], Some(1e-3)).draw(),
    ] {
        assert!(refused.is_err());
    }
}
