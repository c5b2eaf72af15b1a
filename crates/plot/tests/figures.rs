//! Every figure, for ordinary, degenerate and bad input, as a caller sees it.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail like the tests themselves"
)]

use asperity_plot::{
    ErrorOverTime, Figure, HeightMapFigure, InPlaneCurves, PlotError, PolarLobes, PowerLaw, Sample,
    Series, Side, Sides, TimedError, TimedMethod,
};

/// Renders both ways, checks that both are well-formed and of the promised size, and returns the SVG's texts.
fn render(figure: &Figure) -> String {
    let svg = figure.svg().unwrap();
    let png = figure.png().unwrap();
    assert!(svg.len() < 2_000_000, "SVG of {} bytes", svg.len());

    let (width, height) = figure.size();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let root = document.root_element();
    assert_eq!(root.attribute("width"), Some(width.to_string().as_str()));
    assert_eq!(root.attribute("height"), Some(height.to_string().as_str()));

    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    let mut reader = png::Decoder::new(std::io::Cursor::new(&png))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (2 * width, 2 * height));
    assert!(pixels.iter().any(|p| *p < 100), "an empty picture");

    // No text may leave the figure by its anchor, in units of a tenth of a pixel.
    let texts = document.descendants().filter(|n| n.has_tag_name("text"));
    let texts: Vec<String> = texts
        .map(|node| {
            let at = |name| node.attribute(name).unwrap().parse::<i64>().unwrap();
            assert!((0..=i64::from(width) * 10).contains(&at("x")));
            assert!((0..=i64::from(height) * 10).contains(&at("y")));
            node.text().unwrap().trim().to_owned()
        })
        .collect();
    texts.join("\n")
}

fn assert_has(texts: &str, wanted: &[&str]) {
    for text in wanted {
        assert!(texts.contains(text), "no \"{text}\" in:\n{texts}");
    }
}

/// A lobe with a reproducible ripple in place of noise.
fn lobe(peak: f64, width: f64, se: Option<f64>, step: usize) -> Vec<Sample> {
    (-90..=90)
        .step_by(step)
        .map(|t| {
            let theta_deg = f64::from(t);
            let ripple = se.unwrap_or(0.0) * (37.0 * theta_deg).sin();
            let value = peak * (-((theta_deg - 20.0) / width).powi(2)).exp() + ripple;
            Sample {
                theta_deg,
                value,
                se,
            }
        })
        .collect()
}

fn both_sides(peak: f64) -> Vec<Series> {
    let mut series = Vec::new();
    for (side, peak) in [(Side::Reflected, 0.03 * peak), (Side::Transmitted, peak)] {
        series.push(
            Series::explicit("explicit", side, lobe(peak, 15.0, Some(0.02 * peak), 2))
                .with_bin_width(2.0),
        );
        series.push(Series::model(
            "Smith & co <1>",
            side,
            lobe(peak, 16.0, None, 1),
        ));
        series.push(Series::model(
            "Xu-Sun",
            side,
            lobe(0.9 * peak, 15.0, None, 1),
        ));
    }
    series
}

fn polar(series: Vec<Series>, sides: Sides) -> PolarLobes {
    PolarLobes {
        title: "Lobes".into(),
        subtitle: "n = 1.4, s = 3".into(),
        theta_i_deg: 30.0,
        sides,
        flat_reflection_deg: Some(30.0),
        flat_refraction_deg: Some(20.9),
        series,
    }
}

fn curves(series: Vec<Series>) -> InPlaneCurves {
    InPlaneCurves {
        title: "Curves".into(),
        subtitle: "n = 1.4, s = 3".into(),
        side: Side::Transmitted,
        flat_direction_deg: Some(20.9),
        series,
    }
}

fn map(heights: &[f64], shape: [usize; 2], spacing: f64) -> HeightMapFigure<'_> {
    HeightMapFigure {
        title: "Surface".into(),
        subtitle: "sigma = 1 um".into(),
        heights,
        shape,
        spacing: [spacing, spacing],
        unit: "m".into(),
    }
}

fn waves(ny: usize, nx: usize, amplitude: f64) -> Vec<f64> {
    (0..ny * nx)
        .map(|i| {
            let (y, x) = ((i / nx) as f64, (i % nx) as f64);
            amplitude * ((0.31 * x).sin() + (0.17 * y + 0.05 * x).cos())
        })
        .collect()
}

#[test]
fn polar_lobes_say_what_they_show() {
    let texts = render(&polar(both_sides(2.0), Sides::Both).draw().unwrap());
    assert_has(
        &texts,
        &[
            "Lobes",
            "n = 1.4, s = 3",
            "reflected, enlarged 25 times",
            "transmitted",
            "−60°",
            "f |cos θₒ| (1/sr)",
            "explicit",
            "Smith & co <1>",
            "Xu-Sun",
            "incident light, θᵢ = 30°",
            "flat surface",
            "standard error",
        ],
    );
    let reflected = render(&polar(both_sides(2.0), Sides::Reflected).draw().unwrap());
    assert!(!reflected.contains("transmitted") && !reflected.contains("enlarged"));
    let transmitted = render(&polar(both_sides(2.0), Sides::Transmitted).draw().unwrap());
    assert!(transmitted.contains("transmitted") && !transmitted.contains("reflected"));
}

#[test]
fn in_plane_curves_say_what_they_show() {
    let texts = render(&curves(both_sides(2.0)).draw().unwrap());
    assert_has(
        &texts,
        &[
            "f |cos θₒ| (1/sr)",
            "θₒ from the downward normal, forward positive (degrees)",
            "residual z",
            "10⁻¹",
            "−30",
            "explicit",
            "Smith & co <1>",
            "direction of refraction at a flat surface",
            "width of a bin",
        ],
    );
    let models: Vec<Series> = both_sides(2.0).split_off(4);
    assert!(!render(&curves(models).draw().unwrap()).contains("residual"));
}

#[test]
fn equal_input_gives_equal_bytes() {
    let heights = waves(20, 30, 1e-6);
    let draw = || {
        [
            polar(both_sides(2.0), Sides::Both).draw().unwrap(),
            curves(both_sides(2.0)).draw().unwrap(),
            map(&heights, [20, 30], 1e-6).draw().unwrap(),
        ]
    };
    for (a, b) in draw().iter().zip(&draw()) {
        assert_eq!(a.svg().unwrap(), b.svg().unwrap());
        assert_eq!(a.png().unwrap(), b.png().unwrap());
    }
}

#[test]
fn a_narrow_lobe_fills_the_linear_panel() {
    let fine = (0..=600)
        .map(|i| {
            let theta = 17.0 + 0.01 * f64::from(i);
            Sample::exact(theta, 900.0 * (-((theta - 20.0) / 0.5).powi(2)).exp())
        })
        .collect();
    let series = vec![Series::model("narrow", Side::Transmitted, fine)];
    let texts = render(&curves(series).draw().unwrap());
    // Ticks of the linear panel and of the logarithmic one.
    assert!(texts.lines().any(|t| t == "20") && texts.lines().any(|t| t == "−90"));
}

#[test]
fn lobes_and_curves_survive_degenerate_series() {
    let sample = |theta_deg, value, se| Sample {
        theta_deg,
        value,
        se,
    };
    let flat = |value: f64, se| -> Vec<Sample> {
        (-9..=9)
            .map(|t| sample(10.0 * f64::from(t), value, se))
            .collect()
    };
    let cases: Vec<(&str, Vec<Sample>)> = vec![
        ("one point", vec![sample(12.0, 0.3, Some(0.1))]),
        ("one zero", vec![sample(0.0, 0.0, None)]),
        ("all zero", flat(0.0, None)),
        ("all zero with errors", flat(0.0, Some(0.0))),
        ("zero within large errors", flat(0.0, Some(1e3))),
        ("all negative", flat(-1e-3, Some(2e-3))),
        ("tiny", lobe(1e-12, 20.0, Some(1e-14), 2)),
        ("huge", lobe(1e9, 20.0, Some(1e8), 2)),
        ("smallest number", flat(5e-324, Some(5e-324))),
        ("largest number", flat(f64::MAX, Some(f64::MAX))),
        (
            "error out of proportion",
            vec![sample(3.0, 1.0, Some(1e30)), sample(5.0, 0.5, None)],
        ),
        (
            "same angle twice",
            vec![sample(3.0, 1.0, None), sample(3.0, 2.0, None)],
        ),
        (
            "grazing",
            vec![sample(-90.0, 1.0, None), sample(90.0, 2.0, None)],
        ),
    ];
    for (name, samples) in cases {
        let series = vec![
            Series::explicit(name, Side::Transmitted, samples.clone()).with_bin_width(2.0),
            Series::model("model", Side::Transmitted, samples),
            Series::model("empty", Side::Transmitted, vec![]),
        ];
        assert_has(
            &render(&curves(series.clone()).draw().unwrap()),
            &[name, "empty"],
        );
        let figure = polar(series, Sides::Both);
        assert_has(&render(&figure.draw().unwrap()), &[name]);
    }
}

#[test]
fn twenty_long_names_fit_into_the_legend() {
    let name = |i: i32| format!("model {i} with a name so long that it needs more lines than one");
    let series: Vec<Series> = (0..20)
        .map(|i| Series::model(name(i), Side::Transmitted, lobe(1.0, 10.0, None, 5)))
        .collect();
    assert_has(
        &render(&curves(series.clone()).draw().unwrap()),
        &["model 19"],
    );
    let figure = polar(series, Sides::Transmitted);
    assert_has(&render(&figure.draw().unwrap()), &["model 19"]);
}

#[test]
fn height_maps_choose_units_and_tell_the_truth_about_heights() {
    let heights = waves(64, 96, 1e-6);
    let n = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / n;
    let rms = 1e6 * (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / n).sqrt();
    let texts = render(&map(&heights, [64, 96], 2.5e-6).draw().unwrap());
    assert_has(
        &texts,
        &[
            "Surface",
            "x (µm)",
            "y (µm)",
            "height (µm)",
            "96 × 64 samples",
            &format!("rms height {rms:.3}"),
            "100",
        ],
    );
    let arbitrary = HeightMapFigure {
        unit: "1".into(),
        ..map(&heights, [64, 96], 0.1)
    };
    let texts = render(&arbitrary.draw().unwrap());
    assert_has(&texts, &["x (arb. units)", "height (10⁻⁶ arb. units)"]);
}

#[test]
fn large_height_maps_stay_small() {
    // White noise from a linear congruential generator compresses worst.
    let mut state = 1u32;
    let heights: Vec<f64> = (0..1300 * 1300)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8)
        })
        .collect();
    let svg = map(&heights, [1300, 1300], 1e-6)
        .draw()
        .unwrap()
        .svg()
        .unwrap();
    assert!(svg.len() < 500_000, "{}", svg.len());
}

#[test]
fn height_maps_survive_degenerate_fields() {
    for (heights, shape, spacing) in [
        (vec![0.0], [1, 1], 1.0),
        (vec![0.0; 100], [10, 10], 1e-6),
        (vec![3e-3; 100], [10, 10], 1e-6),
        (vec![1e9, 1e9 + 1e-6, 1e9, 1e9], [2, 2], 1e9),
        (vec![f64::MAX, f64::MIN], [1, 2], 1.0),
        (vec![5e-324, 0.0], [2, 1], 5e-324),
        (waves(1, 700, 1e-6), [1, 700], 1e-6),
        (waves(700, 1, 1e-6), [700, 1], 1e-6),
        (waves(16, 64, 1e-12), [16, 64], 1e-12),
    ] {
        assert_has(
            &render(&map(&heights, shape, spacing).draw().unwrap()),
            &["height", "samples"],
        );
    }
}

#[test]
fn bad_input_is_refused_in_words() {
    let explicit = |sample| vec![Series::explicit("rays", Side::Transmitted, vec![sample])];
    let sample = Sample::exact(0.0, 1.0);
    let refused = |series: Vec<Series>| {
        let error = curves(series.clone()).draw().unwrap_err();
        // As text, for NaN differs from itself.
        let same = polar(series, Sides::Transmitted).draw().unwrap_err();
        assert_eq!(error.to_string(), same.to_string());
        error
    };
    let value = f64::NAN;
    let error = refused(explicit(Sample { value, ..sample }));
    assert_eq!(
        error.to_string(),
        "value of series \"rays\" must be finite, value 0 is NaN"
    );
    let theta_deg = 91.0;
    let error = refused(explicit(Sample {
        theta_deg,
        ..sample
    }));
    assert!(matches!(error, PlotError::OutOfRange { value: 91.0, .. }));
    let se = Some(-1.0);
    let error = refused(explicit(Sample { se, ..sample }));
    assert!(matches!(error, PlotError::OutOfRange { value: -1.0, .. }));
    let se = Some(f64::INFINITY);
    let error = refused(explicit(Sample { se, ..sample }));
    assert!(matches!(error, PlotError::NonFinite { .. }));
    let error = refused(vec![explicit(sample).remove(0).with_bin_width(-2.0)]);
    assert!(matches!(error, PlotError::OutOfRange { value: -2.0, .. }));

    for empty in [
        vec![],
        vec![Series::model("none", Side::Transmitted, vec![])],
    ] {
        assert!(matches!(
            curves(empty.clone()).draw(),
            Err(PlotError::NothingToDraw { .. })
        ));
        assert!(matches!(
            polar(empty, Sides::Both).draw(),
            Err(PlotError::NothingToDraw { .. })
        ));
    }
    let other_side = polar(explicit(sample), Sides::Reflected).draw();
    assert!(matches!(other_side, Err(PlotError::NothingToDraw { .. })));
    let from_below = PolarLobes {
        theta_i_deg: 120.0,
        ..polar(explicit(sample), Sides::Both)
    };
    assert!(matches!(
        from_below.draw(),
        Err(PlotError::OutOfRange { value: 120.0, .. })
    ));
}

#[test]
fn bad_height_fields_are_refused() {
    assert!(matches!(
        map(&[], [0, 5], 1.0).draw(),
        Err(PlotError::NothingToDraw { .. })
    ));
    assert!(matches!(
        map(&[1.0; 5], [2, 3], 1.0).draw(),
        Err(PlotError::MismatchedLengths {
            found: 5,
            expected: 6,
            ..
        })
    ));
    assert!(matches!(
        map(&[1.0, f64::NAN], [1, 2], 1.0).draw(),
        Err(PlotError::NonFinite { index: 1, .. })
    ));
    assert!(matches!(
        map(&[1.0, 2.0], [1, 2], 0.0).draw(),
        Err(PlotError::OutOfRange { .. })
    ));
    assert!(matches!(
        map(&[1.0, 2.0], [1, 2], f64::MAX).draw(),
        Err(PlotError::NonFinite { .. })
    ));
}

#[test]
fn odd_characters_in_names_leave_the_svg_well_formed() {
    let name = "a\u{1}b & \"<tag>\" 表面 \n c";
    let series = vec![Series::model(
        name,
        Side::Transmitted,
        lobe(1.0, 9.0, None, 3),
    )];
    let figure = InPlaneCurves {
        title: name.into(),
        ..curves(series)
    };
    assert_has(&render(&figure.draw().unwrap()), &["b & \"<tag>\""]);
}

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
    // A run without error has no place; another one beside it has.
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
