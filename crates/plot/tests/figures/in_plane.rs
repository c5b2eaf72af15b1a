//! Lobes and curves in the plane of incidence.

use asperity_plot::{InPlaneCurves, PlotError, Point, PolarLobes, Series, Side, Sides};

use crate::{assert_has, render};

/// A lobe with a reproducible ripple in place of noise.
fn lobe(peak: f64, width: f64, se: Option<f64>, step: usize) -> Vec<Point> {
    (-90..=90)
        .step_by(step)
        .map(|t| {
            let theta_deg = f64::from(t);
            let ripple = se.unwrap_or(0.0) * (37.0 * theta_deg).sin();
            let value = peak * (-((theta_deg - 20.0) / width).powi(2)).exp() + ripple;
            Point {
                x: theta_deg,
                y: value,
                se,
                x_range: Some([theta_deg - 1.0, theta_deg + 1.0]),
            }
        })
        .collect()
}

pub(crate) fn both_sides(peak: f64) -> Vec<Series> {
    let mut series = Vec::new();
    for (side, peak) in [(Side::Reflected, 0.03 * peak), (Side::Transmitted, peak)] {
        series.push(Series::explicit(
            "explicit",
            0,
            side,
            lobe(peak, 15.0, Some(0.02 * peak), 2),
        ));
        series.push(Series::model(
            "Smith & co <1>",
            0,
            side,
            lobe(peak, 16.0, None, 1),
        ));
        series.push(Series::model(
            "Xu-Sun",
            1,
            side,
            lobe(0.9 * peak, 15.0, None, 1),
        ));
    }
    series
}

pub(crate) fn polar(series: Vec<Series>, sides: Sides) -> PolarLobes {
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

pub(crate) fn curves(series: Vec<Series>) -> InPlaneCurves {
    InPlaneCurves {
        title: "Curves".into(),
        subtitle: "n = 1.4, s = 3".into(),
        side: Side::Transmitted,
        flat_direction_deg: Some(20.9),
        least: None,
        series,
    }
}

#[test]
fn polar_lobes_say_what_they_show() {
    let texts = render(&polar(both_sides(2.0), Sides::Both).draw().unwrap());
    assert_has(
        &texts,
        &[
            "Lobes",
            "n = 1.4, s = 3",
            "reflected, enlarged 40 times",
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
            "θₒ from the downward normal, forward positive (°)",
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
fn a_narrow_lobe_fills_the_linear_panel() {
    let fine: Vec<Point> = (0..=600)
        .map(|i| {
            let theta = 17.0 + 0.01 * f64::from(i);
            Point::exact(theta, 900.0 * (-((theta - 20.0) / 0.5).powi(2)).exp())
        })
        .collect();
    let texts = |points: Vec<Point>| {
        let series = vec![Series::model("narrow", 0, Side::Transmitted, points)];
        render(&curves(series).draw().unwrap())
    };
    let has = |texts: &str, tick: &str| texts.lines().any(|text| text == tick);
    let alone = texts(fine.clone());
    assert!(has(&alone, "20") && !has(&alone, "−90"));
    // Faint light far from the lobe: ticks of the linear panel and of the logarithmic one.
    let faint = [-60.0, 60.0].map(|theta| Point::exact(theta, 0.01));
    let with_faint = texts([&fine[..], &faint].concat());
    assert!(has(&with_faint, "20.0") && has(&with_faint, "−90"));
    let marked = "range of the panel on the left";
    assert!(has(&with_faint, marked));
    // A wide lobe has one range in both panels.
    let wide = (-60..=60).map(f64::from);
    let wide = wide.map(|theta| Point::exact(theta, (-(theta / 30.0).powi(2)).exp()));
    assert!(!has(&texts(wide.collect()), marked));
}

#[test]
fn a_lobe_too_narrow_for_lobes_is_drawn_over_its_angles_too() {
    let lobe = |width: f64| {
        let point = |i: i32| {
            let x = 30.0 + 0.05 * width * f64::from(i);
            Point::exact(x, (-((x - 30.0) / width).powi(2)).exp())
        };
        let points = (-60..=60).map(point).filter(|p| p.x.abs() < 90.0).collect();
        let series = vec![Series::model("narrow", 0, Side::Reflected, points)];
        render(&polar(series, Sides::Both).draw().unwrap())
    };
    assert_has(&lobe(0.1), &["reflected, over the angle", "30.0"]);
    assert!(!lobe(20.0).contains("over the angle"));
}

#[test]
fn lobes_and_curves_survive_degenerate_series() {
    let sample = |x: f64, y, se| Point {
        x,
        y,
        se,
        x_range: Some([x - 1.0, x + 1.0]),
    };
    let flat = |value: f64, se| -> Vec<Point> {
        (-9..=9)
            .map(|t| sample(10.0 * f64::from(t), value, se))
            .collect()
    };
    let cases: Vec<(&str, Vec<Point>)> = vec![
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
            Series::explicit(name, 0, Side::Transmitted, samples.clone()),
            Series::model("model", 0, Side::Transmitted, samples),
            Series::model("empty", 1, Side::Transmitted, vec![]),
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
        .map(|i| {
            Series::model(
                name(i as i32),
                i,
                Side::Transmitted,
                lobe(1.0, 10.0, None, 5),
            )
        })
        .collect();
    assert_has(
        &render(&curves(series.clone()).draw().unwrap()),
        &["model 19"],
    );
    let figure = polar(series, Sides::Transmitted);
    assert_has(&render(&figure.draw().unwrap()), &["model 19"]);
}

#[test]
fn bad_input_is_refused_in_words() {
    let explicit = |sample| vec![Series::explicit("rays", 0, Side::Transmitted, vec![sample])];
    let sample = Point::exact(0.0, 1.0);
    let refused = |series: Vec<Series>| {
        let error = curves(series.clone()).draw().unwrap_err();
        // As text, for NaN differs from itself.
        let same = polar(series, Sides::Transmitted).draw().unwrap_err();
        assert_eq!(error.to_string(), same.to_string());
        error
    };
    let y = f64::NAN;
    let error = refused(explicit(Point { y, ..sample }));
    assert_eq!(
        error.to_string(),
        "value of \"rays\" must be finite, value 0 is NaN"
    );
    let error = refused(explicit(Point { x: 91.0, ..sample }));
    assert!(matches!(error, PlotError::OutOfRange { value: 91.0, .. }));
    let se = Some(-1.0);
    let error = refused(explicit(Point { se, ..sample }));
    assert!(matches!(error, PlotError::OutOfRange { value: -1.0, .. }));
    let se = Some(f64::INFINITY);
    let error = refused(explicit(Point { se, ..sample }));
    assert!(matches!(
        error,
        PlotError::OutOfRange {
            range: "finite",
            ..
        }
    ));
    let error = refused(explicit(Point {
        x_range: Some([1.0, -1.0]),
        ..sample
    }));
    assert!(matches!(error, PlotError::OutOfRange { value: -2.0, .. }));

    for empty in [
        vec![],
        vec![Series::model("none", 0, Side::Transmitted, vec![])],
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
fn odd_characters_in_names_leave_the_svg_well_formed() {
    let name = "a\u{1}b & \"<tag>\" 表面 \n c";
    let series = vec![Series::model(
        name,
        0,
        Side::Transmitted,
        lobe(1.0, 9.0, None, 3),
    )];
    let figure = InPlaneCurves {
        title: name.into(),
        ..curves(series)
    };
    assert_has(&render(&figure.draw().unwrap()), &["b & \"<tag>\""]);
}
