//! Height maps.

use asperity_plot::{HeightMapFigure, PlotError};

use crate::{assert_has, render};

pub(crate) fn map(heights: &[f64], shape: [usize; 2], spacing: f64) -> HeightMapFigure<'_> {
    HeightMapFigure {
        title: "Surface".into(),
        subtitle: "sigma = 1 um".into(),
        heights,
        shape,
        spacing: [spacing, spacing],
        unit: "m".into(),
        y_up: false,
    }
}

pub(crate) fn waves(ny: usize, nx: usize, amplitude: f64) -> Vec<f64> {
    (0..ny * nx)
        .map(|i| {
            let (y, x) = ((i / nx) as f64, (i % nx) as f64);
            amplitude * ((0.31 * x).sin() + (0.17 * y + 0.05 * x).cos())
        })
        .collect()
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
        Err(PlotError::OutOfRange {
            index: 1,
            range: "finite",
            ..
        })
    ));
    assert!(matches!(
        map(&[1.0, 2.0], [1, 2], 0.0).draw(),
        Err(PlotError::OutOfRange { .. })
    ));
    assert!(matches!(
        map(&[1.0, 2.0], [1, 2], f64::MAX).draw(),
        Err(PlotError::OutOfRange {
            range: "finite",
            ..
        })
    ));
}

#[test]
fn the_first_row_is_on_top_or_at_the_bottom() {
    let heights: Vec<f64> = (0..6).map(f64::from).collect();
    let mirrored: Vec<f64> = heights.chunks(2).rev().flatten().copied().collect();
    let figure = |heights: &[f64], y_up| {
        let figure = HeightMapFigure {
            y_up,
            ..map(heights, [3, 2], 1.0)
        };
        figure.draw().unwrap().svg().unwrap()
    };
    let picture = |svg: &str| {
        let from = svg.find("<image").unwrap();
        svg[from..].split('>').next().unwrap().to_owned()
    };
    let [up, down] = [(&heights, true), (&mirrored, false)].map(|(h, up)| figure(h, up));
    assert_eq!(picture(&up), picture(&down));
    assert_ne!(picture(&up), picture(&figure(&heights, false)));
    assert!(up.contains("first row at the bottom") && down.contains("first row on top"));
}
