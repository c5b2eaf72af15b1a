//! Random surfaces with the spectrum and the heights of files.

use crate::support::{json, refused, succeed, words};

/// A surface of a known spectrum; others like it have its roughness, on a tile of another size, and the heights too.
#[test]
fn surfaces_like_a_map_have_its_spectrum_and_its_heights() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let measured =
        "generate --tau 8 --sigma 2nm --skewness -1 --kurtosis 4.5 --size 256 -o measured.exr";
    succeed(folder, &words(measured));
    let like = "generate --psd like:measured.exr --heights like:measured.exr --size 384,320 --json -o like.exr";
    let like = json(&succeed(folder, &words(like)));
    let measured = json(&succeed(folder, &words("inspect measured.exr --json")));
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
    let read = json(&succeed(folder, &words("inspect like.exr --json")));
    assert_eq!(read["unit"], "nm");
}

#[test]
fn a_table_of_a_spectrum_is_drawn_and_traced() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
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
    std::fs::write(folder.join("psd.csv"), text).unwrap();
    let drawn = "generate --psd psd.csv --size 256 --spacing 1 --json -o drawn.exr";
    let drawn = json(&succeed(folder, &words(drawn)));
    let requested = |name: &str| drawn["realised"][name]["requested"].as_f64().unwrap();
    assert!((requested("sigma") / sigma - 1.0).abs() < 1e-3);
    assert!((requested("tau_x") / tau - 1.0).abs() < 1e-3);
    let verified = "verify --psd psd.csv --sigma 1 --models none --rays 2e3 --realisations 4 --no-plots -o verified";
    succeed(folder, &words(verified));
    let summary = std::fs::read_to_string(folder.join("verified/summary.json")).unwrap();
    assert!(summary.contains("psd.csv"));
}

#[test]
fn files_that_give_no_spectrum_get_one_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
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
        ("--psd grid.csv", "are not those of a grid"),
        ("--heights low.csv", "a cumulative probability is 1.5"),
        (
            "--heights other.csv",
            "needs the columns height and probability",
        ),
    ] {
        let line = format!("generate {flags} --size 64 -o a.exr");
        let said = refused(folder.path(), &words(&line), 1);
        assert!(said.contains(expected), "{flags}: {said}");
        assert!(!folder.path().join("a.exr").exists());
    }
    // A name that is misspelt is wrong usage, as that of any other choice
    let line = "generate --psd gausian --size 64 -o a.exr";
    let said = refused(folder.path(), &words(line), 2);
    assert!(
        said.contains("neither a file nor one of gaussian"),
        "{said}"
    );
}
