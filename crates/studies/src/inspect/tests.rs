use asperity_io::{ResultFolder, read_text};
use asperity_simulate::Cells;
use asperity_surface::Roughness;
use asperity_synthesis::{Psd, Synthesis};
use serde_json::Value;

use super::*;

fn drawn() -> HeightField {
    let psd = Psd::anisotropic_gaussian(0.5, 8.0, 5.0, 0.3).unwrap();
    let synthesis = Synthesis::new(psd, [96, 128], [1.0, 1.0], false).unwrap();
    synthesis.draw(2, 0).unwrap()
}

/// Numbers of a column of a CSV file; nothing of empty fields.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let place = lines
        .next()
        .unwrap()
        .split(',')
        .position(|head| head == name);
    let fields = lines.filter_map(|line| line.split(',').nth(place.unwrap()));
    fields.filter_map(|field| field.parse().ok()).collect()
}

/// Files hold every digit: sums over them round at 1e-13.
#[test]
fn files_hold_the_mean_square_height_and_all_values() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let field = drawn();
    let results = ResultFolder::open(&out, "inspect", &[]).unwrap();
    results.check(inspection_files()).unwrap();
    let roughness = Roughness::of(&field);
    let inspection = Inspection {
        file: "drawn".into(),
        statistics: Statistics::of(&field, Cells::Flat, &[]).unwrap(),
        field,
        y_is_north: false,
    };
    inspection.report().unwrap().write(&results).unwrap();
    results.finish(true).unwrap();
    for name in inspection_files() {
        assert!(out.join(&name).exists(), "{name}");
    }

    let square = roughness.sq * roughness.sq;
    let summary: Value =
        serde_json::from_str(&read_text(out.join("summary.json")).unwrap()).unwrap();
    let psd = read_text(out.join("psd.csv")).unwrap();
    let powers = column(&psd, "density")
        .into_iter()
        .zip(column(&psd, "waves"));
    let power: f64 = powers.map(|(density, waves)| density * waves).sum();
    let power = power * summary["wave_area"].as_f64().unwrap();
    assert!((power / square - 1.0).abs() < 1e-12, "{power} {square}");
    assert!((summary["surface"]["sq"].as_f64().unwrap() / roughness.sq - 1.0).abs() < 1e-15);

    let lags = read_text(out.join("autocorrelation.csv")).unwrap();
    assert!((column(&lags, "along_x")[0] / square - 1.0).abs() < 1e-13);
    assert_eq!(column(&lags, "along_x").len(), 65);
    assert_eq!(column(&lags, "lag_y").len(), 49);
    for (file, axis, values) in [
        ("heights.csv", "height", ["density"].as_slice()),
        ("slopes.csv", "slope", &["along_x", "along_y"]),
    ] {
        let text = read_text(out.join(file)).unwrap();
        let middles = column(&text, axis);
        for name in values {
            let inside: f64 = column(&text, name).iter().sum::<f64>() * (middles[1] - middles[0]);
            assert!((inside - 1.0).abs() < 1e-9, "{file} {name}: {inside}");
        }
    }
}

/// The mean over azimuths of an anisotropic Gaussian density, by the modified Bessel function `I0`, summed as a power series.
#[test]
fn requested_density_is_the_mean_over_azimuths() {
    let [sigma, along, across] = [0.5, 8.0, 5.0];
    let psd = Psd::anisotropic_gaussian(sigma, along, across, 0.3).unwrap();
    for k in [0.1, 0.3, 0.5] {
        let [a, b] = [along, across].map(|tau: f64| (tau * k).powi(2) / 4.0);
        let half = (a - b) / 2.0;
        let mut term = 1.0;
        let mut bessel = 1.0;
        for i in 1..30 {
            term *= (half / 2.0).powi(2) / f64::from(i * i);
            bessel += term;
        }
        let peak = sigma * sigma * along * across / (4.0 * PI);
        let expected = peak * (-(a + b) / 2.0).exp() * bessel;
        let found = mean_over_azimuths(&psd, k);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
    }
}

#[test]
fn a_flat_surface_is_refused() {
    let flat = HeightField::new(vec![1.0; 9], [3, 3], [1.0, 1.0]).unwrap();
    assert!(matches!(Texture::of(&flat), Err(FileProblem::Flat)));
}

/// GGX in polar coordinates is `2 t dt / (1 + t^2)^2` of `t` over alpha; here it is integrated over lines across the x axis instead.
#[test]
fn slopes_of_ggx_along_an_axis_are_those_of_the_plane() {
    let alpha = 0.3;
    let in_plane = |x: f64, y: f64| {
        let square = 1.0 + (x * x + y * y) / (alpha * alpha);
        1.0 / (PI * alpha * alpha * square * square)
    };
    for x in [0.0, 0.2, 1.5] {
        // y = tan(u) makes the range finite
        let n = 20_000;
        let at = |i: i32| {
            let u = PI * ((f64::from(i) + 0.5) / f64::from(n) - 0.5);
            in_plane(x, u.tan()) / u.cos().powi(2)
        };
        let expected = (0..n).map(at).sum::<f64>() * PI / f64::from(n);
        assert!((ggx(x, alpha) / expected - 1.0).abs() < 1e-6, "{x}");
    }
}

#[test]
fn the_density_of_ggx_is_in_the_table_where_it_was_requested() {
    let table = |field: &HeightField| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("slopes.csv");
        let texture = Texture::of(field).unwrap();
        texture.slopes_table().write(&path).unwrap();
        read_text(&path).unwrap()
    };
    let student = asperity_synthesis::StudentSlopes::new(Psd::gaussian(0.5, 4.0).unwrap(), 2.0);
    let recipe = student.unwrap().into();
    let resolution = asperity_synthesis::Resolution::Any;
    let synthesis =
        asperity_synthesis::FieldSynthesis::new(recipe, [64, 64], [1.0, 1.0], resolution).unwrap();
    let text = table(&synthesis.draw(1, 0).unwrap());
    // 1 / (2 alpha) at zero, with alpha = 2 sigma / tau
    let middle = column(&text, "ggx_x")[60];
    assert!((middle / 2.0 - 1.0).abs() < 1e-12, "{middle}");
    assert_eq!(column(&table(&drawn()), "ggx_x").len(), 0);
}
