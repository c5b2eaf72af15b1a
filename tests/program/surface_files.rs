//! Random surfaces with the spectrum and the heights of files.

use crate::support::{Folder, InFolder, MustContain, errors_of, json, unwrapped};

/// A surface of a known spectrum; others like it have its roughness, on a tile of another size, and the heights too.
#[test]
fn surfaces_like_a_map_have_its_spectrum_and_its_heights() {
    let folder = Folder::new();
    let measured =
        "generate --tau 8 --sigma 2nm --skewness -1 --kurtosis 4.5 --size 256 -o measured.exr";
    folder.succeed(measured);
    let like = "generate --psd like:measured.exr --heights like:measured.exr --size 384,320 --json -o like.exr";
    let like = json(&folder.succeed(like));
    let measured = json(&folder.succeed("inspect measured.exr --json"));
    let realised = |of: &str| like["realised"][of]["requested"].as_f64().unwrap();
    let sq = measured["sq"].as_f64().unwrap();
    assert!((realised("sigma") / sq - 1.0).abs() < 1e-6);
    // Tabulated at 65 quantiles, and at the waves of one tile: within 5 %
    let ssk = measured["ssk"].as_f64().unwrap();
    assert!((realised("skewness") - ssk).abs() < 0.05, "{ssk}");
    let along_x = measured["realised"]["tau_x"]["realised"].as_f64().unwrap();
    assert!(
        (realised("tau_x") / along_x - 1.0).abs() < 0.05,
        "{along_x}"
    );
    let read = json(&folder.succeed("inspect like.exr --json"));
    assert_eq!(read["unit"], "nm");
}

/// A surface like one that was drawn from the same seed, on the same grid, is another one: heights of both correlate as those of independent
/// surfaces do, by `sqrt(pi tau^2 / 2) / side`, 0.04, and not by 0.97 as with the same random numbers.
#[test]
fn surfaces_like_a_drawn_one_are_independent_of_it() {
    let folder = Folder::new();
    folder.succeed("generate --tau 8 --sigma 1 --size 256 --spacing 1 -o first.npy");
    let like = "generate --psd like:first.npy --size 256 --spacing 1 --insist -o second.npy";
    let output = folder.run(like);
    assert!(output.status.success());
    let heights = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let body = &bytes[bytes.len() - 256 * 256 * 8..];
        let (numbers, _) = body.as_chunks::<8>();
        numbers
            .iter()
            .map(|n| f64::from_le_bytes(*n))
            .collect::<Vec<f64>>()
    };
    let (first, second) = (heights("first.npy"), heights("second.npy"));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let correlation =
        product(&first, &second) / (product(&first, &first) * product(&second, &second)).sqrt();
    println!("{correlation}");
    assert!(correlation.abs() < 0.2, "{correlation}");
}

/// A spectrum over the plane has directions: unless told otherwise, light comes from the azimuths given, and random ones are refused.
#[test]
fn spectra_over_the_plane_are_lit_from_fixed_azimuths() {
    let folder = Folder::new();
    let grooves = "generate --tau 24 --tau-y 8 --sigma 1 --size 256 --spacing 2 -o grooves.exr";
    folder.succeed(grooves);
    let verify = "verify --psd like:grooves.exr --size 192 --theta 50 --models smith --rays 3e4 --realisations 6 --insist --no-plots";
    let output = folder.run(format!("{verify} --light-azimuth random -o random"));
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    message.must_contain("matters on anisotropic surfaces");
    let output = folder.run(format!("{verify} -o fixed"));
    assert!(output.status.success());
    let summary = folder.text("fixed/summary.json");
    assert!(!summary.contains("\"verdict\": \"rejected\""), "{summary}");
}

#[test]
fn a_table_of_a_spectrum_is_drawn_and_traced() {
    let folder = Folder::new();
    // A Gaussian spectrum of sigma 1.5 and tau 10, in steps of 2 %
    let (sigma, tau) = (1.5_f64, 10.0_f64);
    let mut text = String::from("# rad per length unit\nk,density\n");
    let mut k = 0.002;
    while k < 1.2 {
        let density = sigma * sigma * tau * tau / (4.0 * std::f64::consts::PI)
            * (-0.25 * k * k * tau * tau).exp();
        text += &format!("{k},{density}\n");
        k *= 1.02;
    }
    folder.write("psd.csv", text);
    let drawn = "generate --psd psd.csv --size 256 --spacing 1 --json -o drawn.exr";
    let drawn = json(&folder.succeed(drawn));
    let requested = |name: &str| drawn["realised"][name]["requested"].as_f64().unwrap();
    assert!((requested("sigma") / sigma - 1.0).abs() < 1e-3);
    assert!((requested("tau_x") / tau - 1.0).abs() < 1e-3);
    let verified = "verify --psd psd.csv --sigma 1 --models none --rays 2e3 --realisations 4 --no-plots -o verified";
    folder.succeed(verified);
    let summary = folder.text("verified/summary.json");
    assert!(summary.contains("psd.csv"));
}

#[test]
fn files_that_give_no_spectrum_get_one_sentence() {
    let folder = Folder::new();
    let write = |name: &str, text: &str| folder.write(name, text);
    write("other.csv", "k,W\n1,2\n2,1\n");
    write("back.csv", "k,density\n2,1\n1,1\n");
    write("below.csv", "k,density\n1,1\n2,-1\n");
    write("grid.csv", "kx,ky,density\n0,0,1\n1,0,1\n0,1,1\n2,1,1\n");
    write("low.csv", "height,probability\n1,0\n2,1.5\n");
    for (flags, expected) in [
        ("--psd none.csv", "none.csv"),
        ("--psd like:none.exr", "none.exr"),
        ("--psd other.csv", "needs the columns k and density"),
        ("--psd back.csv", "must be finite and ascend"),
        ("--psd below.csv", "a density is -1"),
        ("--psd grid.csv", "needs the rows kx, ky of a grid"),
        ("--heights low.csv", "a cumulative probability is 1.5"),
        (
            "--heights other.csv",
            "needs the columns height and probability",
        ),
    ] {
        folder
            .failed(format!("generate {flags} --size 64 -o a.exr"))
            .must_contain(expected);
        assert!(!folder.join("a.exr").exists());
    }
    // A name that is misspelt is wrong usage, as that of any other choice
    let said = folder.refused("generate --psd gausian --size 64 -o a.exr");
    said.must_contain("or a file; did you mean gaussian?");
}

/// Rows of a text matrix.
fn matrix(n: i32, height: impl Fn(f64, f64) -> f64) -> String {
    let row = |y: i32| -> String {
        let heights = (0..n).map(|x| format!("{:.6} ", height(f64::from(x), f64::from(y))));
        heights.collect::<String>() + "\n"
    };
    (0..n).map(row).collect()
}

/// Notes on the map that surfaces are to be like: unit assumed, points filled, form removed, and its limits.
#[test]
fn what_is_made_of_a_source_is_said() {
    let folder = Folder::new();
    let rough = |x: f64, y: f64| (1.7 * x + 0.3 * y * y).sin() + (2.3 * y - 0.2 * x * x).cos();
    let text = matrix(48, rough).replacen("1.000000", "nan", 1);
    folder.write("a.txt", text);
    let notes = [
        "a.txt: the file has no spacing: 1 is assumed",
        "a.txt: 1 missing point was filled",
        "a.txt: its plane of best fit is removed",
        "correlation areas, which tell sigma within about",
    ];
    let line = "generate --psd like:a.txt --heights like:a.txt --size 256 -o b.exr";
    let said = unwrapped(&folder.succeed(line));
    for note in notes {
        assert_eq!(said.matches(note).count(), 1, "{note}: {said}");
    }
    let line = "verify --psd like:a.txt --size 64 --models none --rays 100 --realisations 1 --no-plots -o c";
    let said = unwrapped(&errors_of(&folder.run(line)));
    said.must_contain(notes[1]);
}

#[test]
fn a_source_of_few_samples_is_refused() {
    let folder = Folder::new();
    let rough = |x: f64, y: f64| (1.7 * x + y * y).sin();
    folder.write("small.txt", matrix(7, rough));
    for flag in ["--psd", "--heights"] {
        let line = format!("generate {flag} like:small.txt --size 64 --insist -o a.exr");
        folder.failed(&line).must_contain("but the file has 7 x 7");
    }
}
