//! Plain curves.

use asperity_plot::{Colour, Curve, CurveAxis, Curves, PlotError, Point, Style};

fn curve(name: &str, style: Style, points: &[(f64, f64, Option<f64>)]) -> Curve {
    Curve {
        name: name.into(),
        colour: Colour::Ramp(0.5),
        style,
        points: points
            .iter()
            .map(|&(x, y, se)| Point::with_error(x, y, se))
            .collect(),
    }
}

fn figure(curves: Vec<Curve>) -> Curves {
    let axis = |label: &str| CurveAxis {
        label: label.into(),
        range: None,
    };
    Curves {
        title: "Curves".into(),
        subtitle: "s = 1".into(),
        x: axis("across"),
        y: axis("upwards"),
        log_from: None,
        curves,
        notes: vec!["A remark.".into()],
    }
}

pub(crate) fn sample() -> Curves {
    let points = [(0.0, 1.0, Some(0.1)), (1.0, 2.0, Some(0.2))];
    let styles = [
        Style::Points,
        Style::Hollow,
        Style::Joined,
        Style::Line,
        Style::Band,
    ];
    let curves = styles.iter().zip(["a", "b", "c", "d", "e"]).enumerate();
    figure(
        curves
            .map(|(i, (style, name))| curve(name, style(i), &points))
            .collect(),
    )
}

#[test]
fn a_second_panel_is_logarithmic_and_legends_take_no_more_room_than_they_need() {
    let mut short = sample();
    let one = short.draw().unwrap();
    short.log_from = Some(0.1);
    let two = short.draw().unwrap();
    assert!(two.size().1 > 3 * one.size().1 / 2);
    let svg = two.svg().unwrap();
    assert!(svg.contains("upwards, logarithmic") && svg.contains("10⁻¹"));
    let mut long = sample();
    long.curves[0].name = "a long name in the legend".into();
    assert!(long.draw().unwrap().size().0 > one.size().0);
    short.log_from = Some(0.0);
    assert!(short.draw().is_err());
}

#[test]
fn every_style_is_drawn_and_named_curves_have_entries() {
    let points = [(0.0, 1.0, Some(0.1)), (1.0, 2.0, Some(0.2))];
    let curves = vec![
        curve("points & <bars>", Style::Points(0), &points),
        curve("hollow", Style::Hollow(3), &points),
        curve("joined", Style::Joined(2), &points),
        curve("line", Style::Line(1), &points),
        curve("", Style::Line(7), &points),
    ];
    let drawn = figure(curves).draw().unwrap();
    let svg = drawn.svg().unwrap();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|n| n.text()).collect();
    let texts = texts.join("\n");
    for text in [
        "points & <bars>",
        "hollow",
        "joined",
        "line",
        "across",
        "upwards",
        "Bars: ±1 standard error.",
        "A remark.",
    ] {
        assert!(texts.contains(text), "{text}: {texts}");
    }
    assert!(drawn.png().unwrap().starts_with(b"\x89PNG"));
    // Equal input, equal bytes.
    let again = figure(vec![curve("x", Style::Points(0), &points)]);
    assert_eq!(
        again.draw().unwrap().svg().unwrap(),
        again.clone().draw().unwrap().svg().unwrap()
    );
}

#[test]
fn one_point_has_a_figure_and_what_lies_outside_a_range_is_left_out() {
    let mut one = figure(vec![curve("", Style::Points(0), &[(3.0, 3.0, None)])]);
    assert!(!one.draw().unwrap().svg().unwrap().contains("Bars"));
    let shapes = |curves: &Curves| {
        let svg = curves.draw().unwrap().svg().unwrap();
        svg.matches("<circle").count()
    };
    let inside = shapes(&one);
    one.x.range = Some([0.0, 1.0]);
    assert!(shapes(&one) < inside);
}

#[test]
fn numbers_without_meaning_are_refused() {
    let refuse = |curves: Curves| curves.draw().err().unwrap();
    assert!(matches!(
        refuse(figure(Vec::new())),
        PlotError::NothingToDraw { .. }
    ));
    let of = |point: (f64, f64, Option<f64>)| figure(vec![curve("a", Style::Line(0), &[point])]);
    for bad in [
        (f64::NAN, 0.0, None),
        (0.0, f64::INFINITY, None),
        (0.0, 0.0, Some(f64::NAN)),
    ] {
        assert!(matches!(
            refuse(of(bad)),
            PlotError::OutOfRange {
                range: "finite",
                ..
            }
        ));
    }
    assert!(matches!(
        refuse(of((0.0, 0.0, Some(-1.0)))),
        PlotError::OutOfRange { .. }
    ));
    let mut backwards = of((0.0, 0.0, None));
    backwards.y.range = Some([1.0, 0.0]);
    assert!(matches!(refuse(backwards), PlotError::OutOfRange { .. }));
}
