//! Several quantities over the signed angle, in rows and columns.

use asperity_plot::{
    AngleGrid, AnglePanel, Colour, Curve, CurveAxis, PlotError, Point, Side, Style,
};

use crate::{assert_has, render};

fn panel(name: &str, range: Option<[f64; 2]>, points: Vec<Point>) -> AnglePanel {
    AnglePanel {
        name: name.into(),
        y: CurveAxis {
            label: format!("label of {name}"),
            range,
        },
        curves: vec![Curve {
            name: "all & <one>".into(),
            colour: Colour::Component(0),
            style: Style::Points(0),
            points,
        }],
    }
}

fn points(value: f64) -> Vec<Point> {
    let point = |i: i32| Point::with_error(10.0 * f64::from(i), value, Some(0.1));
    (-9..=9).map(point).collect()
}

fn grid(columns: usize, panels: Vec<AnglePanel>) -> AngleGrid {
    AngleGrid {
        title: "Grid".into(),
        subtitle: "s = 1".into(),
        side: Side::Transmitted,
        flat_direction_deg: Some(20.0),
        columns,
        panels,
        notes: vec!["A remark.".into()],
    }
}

#[test]
fn panels_have_names_and_axes_of_their_own_and_one_legend() {
    let unit = Some([-1.0, 1.0]);
    let mut panels = vec![panel("a", Some([0.0, 0.5]), points(0.2))];
    panels.extend(["b", "c", "d"].map(|name| panel(name, unit, points(0.2))));
    panels.push(panel("e", unit, vec![]));
    let texts = render(&grid(3, panels).draw().unwrap());
    assert_has(
        &texts,
        &[
            "label of a",
            "label of d",
            "refraction at a flat surface",
            "Bars: ±1 standard error.",
            "A remark.",
            "Angles are positive forward",
        ],
    );
    let count = |wanted: &str| texts.lines().filter(|text| *text == wanted).count();
    assert_eq!(["a", "b", "c", "d", "e"].map(count), [1; 5]);
    assert_eq!(count("all & <one>"), 1);
    // Labels stand in the first column, numbers wherever the panel to the left has others: at b and d.
    assert!(!texts.contains("label of b") && !texts.contains("label of e"));
    assert_eq!(count("−1.0"), 2);
    // Angles stand below every panel.
    assert_eq!(count("−90"), 5);
}

#[test]
fn grids_grow_by_columns_and_rows() {
    let size = |columns, panels| {
        let panels = vec![panel("a", None, points(0.2)); panels];
        grid(columns, panels).draw().unwrap().size()
    };
    let [row, more, wide] = [size(3, 3), size(3, 4), size(4, 4)];
    assert!(row.0 == more.0 && row.1 < more.1);
    assert!(wide.0 > row.0 && wide.1 == row.1);
}

#[test]
fn bad_input_is_refused() {
    let of = |point| grid(1, vec![panel("a", None, vec![point])]).draw();
    let point = Point::exact(0.0, 1.0);
    assert!(of(point).is_ok());
    assert!(matches!(
        of(Point { x: 91.0, ..point }),
        Err(PlotError::OutOfRange { value: 91.0, .. })
    ));
    assert!(matches!(
        of(Point {
            y: f64::NAN,
            ..point
        }),
        Err(PlotError::OutOfRange {
            range: "finite",
            ..
        })
    ));
    for empty in [
        grid(0, vec![panel("a", None, vec![point])]),
        grid(1, vec![]),
    ] {
        assert!(matches!(empty.draw(), Err(PlotError::NothingToDraw { .. })));
    }
}
