//! Diagrams.

use asperity_plot::{Colour, Diagram, DiagramLabel, DiagramPanel, DiagramPath, PlotError, Stroke};

use crate::{assert_has, render};

pub(crate) fn diagram(stroke: Stroke, points: Vec<[f64; 2]>) -> Diagram {
    let colour = Colour::Nth(1);
    let panel = DiagramPanel {
        caption: "from the side".into(),
        paths: vec![DiagramPath {
            stroke,
            colour,
            points,
        }],
        labels: vec![DiagramLabel {
            text: "k".into(),
            colour,
            at: [0.5, -0.5],
        }],
    };
    Diagram {
        title: "Rays".into(),
        subtitle: "two views".into(),
        panels: vec![panel.clone(), panel],
    }
}

/// Filled areas of an SVG.
fn heads(svg: &str) -> usize {
    svg.matches("<path fill").count()
}

#[test]
fn lines_and_arrows_are_drawn_to_scale_with_their_labels() {
    let corner = vec![[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];
    let counts = [Stroke::Line, Stroke::Arrow, Stroke::Guide].map(|stroke| {
        let figure = diagram(stroke, corner.clone()).draw().unwrap();
        let texts = render(&figure);
        assert_has(&texts, &["Rays", "two views", "from the side", "k"]);
        let svg = figure.svg().unwrap();
        // Each piece of a line begins with an "m".
        [heads(&svg), svg.matches('m').count()]
    });
    // One head to an arrow, two panels; guides are dashed.
    let [line, arrow, guide] = counts;
    assert_eq!(arrow[0], line[0] + 2);
    assert!(guide[1] > line[1] + 10, "{counts:?}");
    // A curve of many short pieces has a head too, and what is shorter than a head is a line.
    let curve = (0..200).map(|i| f64::from(i) / 200.0).map(|x| [x, x * x]);
    let heads_of = |points| {
        let figure = diagram(Stroke::Arrow, points).draw().unwrap();
        heads(&figure.svg().unwrap()) - line[0]
    };
    assert_eq!(heads_of(curve.collect()), 2);
    assert_eq!(heads_of(vec![[0.0, 0.0], [0.01, 0.0]]), 0);
}

#[test]
fn diagrams_without_meaning_are_refused() {
    let refuse = |diagram: Diagram| diagram.draw().err().unwrap();
    let empty = Diagram {
        panels: Vec::new(),
        ..diagram(Stroke::Line, vec![[0.0; 2]; 2])
    };
    for diagram in [empty, diagram(Stroke::Arrow, vec![[0.0; 2]])] {
        assert!(matches!(refuse(diagram), PlotError::NothingToDraw { .. }));
    }
    let mut bad = diagram(Stroke::Line, vec![[0.0, 0.0], [f64::NAN, 0.0]]);
    assert!(matches!(
        refuse(bad.clone()),
        PlotError::OutOfRange {
            range: "finite",
            ..
        }
    ));
    bad.panels[0].paths.clear();
    bad.panels[1].paths.clear();
    bad.panels[1].labels[0].at[0] = f64::INFINITY;
    assert!(matches!(
        refuse(bad),
        PlotError::OutOfRange {
            range: "finite",
            ..
        }
    ));
}
