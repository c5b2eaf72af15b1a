//! Maps of cells.

use asperity_plot::{CellMapFigure, PlotError};

use crate::{assert_has, render};

fn map(values: &[f64], shape: [usize; 2]) -> CellMapFigure<'_> {
    CellMapFigure {
        title: "Absorbed light".into(),
        subtitle: "gold".into(),
        quantity: "absorbed / incident flux".into(),
        values,
        shape,
        spacing: [2e-6, 1e-6],
        unit: "m".into(),
        y_up: false,
        noun: "cells",
        decades: false,
    }
}

/// 6 columns and 2 rows: 6 µm by 4 µm.
#[test]
fn cells_are_told_of_by_number_mean_and_extremes() {
    let values: Vec<f64> = (1..=12).map(|i| 0.05 * f64::from(i)).collect();
    let texts = render(&map(&values, [2, 6]).draw().unwrap());
    let facts = "6 × 2 cells, first row on top; mean 0.325, lowest 0.0500, highest 0.600";
    assert_has(
        &texts,
        &[facts, "x (µm)", "y (µm)", "absorbed / incident flux"],
    );
    let faint: Vec<f64> = values.iter().map(|value| 1e-6 * value).collect();
    let texts = render(&map(&faint, [2, 6]).draw().unwrap());
    assert_has(&texts, &["absorbed / incident flux (10⁻⁷)"]);
}

/// Cells of one value have the colour of the upper end, and no light that of the lower end.
#[test]
fn colours_begin_at_zero() {
    let picture = |values: &[f64]| {
        let svg = map(values, [1, values.len()])
            .draw()
            .unwrap()
            .svg()
            .unwrap();
        let from = svg.find("<image").unwrap();
        svg[from..].split('>').next().unwrap().to_owned()
    };
    let same = picture(&[0.4; 3]);
    assert_eq!(same, picture(&[0.1; 3]));
    assert_ne!(same, picture(&[0.0; 3]));
    assert_ne!(picture(&[0.3, 0.4, 0.4]), picture(&[0.0, 0.4, 0.4]));
}

/// The lower end is three decades below the upper one, and has the colour of all smaller values.
#[test]
fn logarithmic_colours_span_three_decades_at_most() {
    let values = [0.0, 1e-7, 2e-3, 0.7];
    let figure = CellMapFigure {
        noun: "pixels",
        decades: true,
        ..map(&values, [1, 4])
    };
    let texts = render(&figure.draw().unwrap());
    assert_has(&texts, &["4 × 1 pixels", "10⁻³", "10⁻²", "10⁻¹", "10⁰"]);
    assert!(!texts.contains("10⁻⁴"), "{texts}");
    let dark = CellMapFigure {
        values: &[0.0; 4],
        ..figure
    };
    assert_has(&render(&dark.draw().unwrap()), &["0.0", "1.0"]);
}

#[test]
fn bad_maps_are_refused() {
    assert!(matches!(
        map(&[], [0, 5]).draw(),
        Err(PlotError::NothingToDraw { .. })
    ));
    for value in [-0.1, f64::NAN] {
        assert!(matches!(
            map(&[1.0, value], [1, 2]).draw(),
            Err(PlotError::OutOfRange { index: 1, .. })
        ));
    }
}
