//! The virtual gonioreflectometer: its tables, its files, and runs that resume.

use std::fs;

use crate::support::{
    Folder, InFolder, MustContain, Table, assert_same_bytes, errors_of, files, json,
};
use serde_json::Value;

/// Two media and two angles, in a fraction of a second.
const CONFIG: &str = "
    [surface]
    smoothness = 2
    tau = 4
    size = 32
    [medium]
    mean_free_path = [4, 0.01]
    albedo = 0.9
    [light]
    theta = [20, 70]
    [run]
    realisations = 4
    rays = 8000
    bins = \"6x8\"
    [output]
    plots = false
";

const NAMES: [&str; 4] = [
    "s2_n1.5_theta20_mfp4_albedo0.9_phi0",
    "s2_n1.5_theta70_mfp4_albedo0.9_phi0",
    "s2_n1.5_theta20_mfp0.01_albedo0.9_phi0",
    "s2_n1.5_theta70_mfp0.01_albedo0.9_phi0",
];

/// A folder with the configuration.
fn with_config() -> Folder {
    let folder = Folder::new();
    folder.write("g.toml", CONFIG);
    folder
}

/// Sums over all bins and conversions round: each of some hundred terms of at most one to 2^-53.
const ROUNDING: f64 = 1e-12;

#[test]
fn bins_add_up_to_totals_and_are_fluxes_over_projected_solid_angle() {
    let folder = with_config();
    folder.succeed("gonio g.toml -o out");
    let out = folder.join("out");
    let all = Table::read(&out.join("gonio.csv"));
    let bsdf = Table::read(&out.join("bsdf.csv"));
    assert_eq!(all.rows.len(), NAMES.len());
    for (i, name) in NAMES.into_iter().enumerate() {
        assert_eq!(all.text(i, "direction"), name);
        let budget = ["reflected", "transmitted", "absorbed", "truncated", "lost"];
        let total: f64 = budget.iter().map(|part| all.number(i, part)).sum();
        assert!((total - 1.0).abs() < ROUNDING, "{name}: {total}");

        let bins = Table::read(&out.join(format!("directions/{name}.csv")));
        assert_eq!(bins.rows.len(), 2 * 6 * 8);
        for part in ["", "_unscattered", "_once", "_more"] {
            let reflected =
                (0..bins.rows.len()).filter(|&bin| bins.text(bin, "side") == "reflected");
            let flux = reflected.map(|bin| bins.number(bin, &format!("flux{part}")));
            let of_bins = flux.sum::<f64>();
            let total = all.number(i, &format!("reflected{part}"));
            assert!(
                (of_bins - total).abs() < ROUNDING,
                "{name}{part}: {of_bins} {total}"
            );
            assert!(total > 0.0);
        }
        for bin in 0..bins.rows.len() {
            let same = i * bins.rows.len() + bin;
            let number = |what| bins.number(bin, what);
            // The solid angle of a bin and the mean cosine over it, from its edges.
            let [a, b] = ["theta_min_deg", "theta_max_deg"].map(|e| number(e).to_radians());
            let solid_angle = (a.cos() - b.cos()) * std::f64::consts::TAU / 8.0;
            let projected =
                0.5 * (b.sin().powi(2) - a.sin().powi(2)).abs() * std::f64::consts::TAU / 8.0;
            assert!((number("solid_angle_sr") / solid_angle - 1.0).abs() < ROUNDING);
            for (flux, density) in [("flux", "bsdf"), ("flux_se", "bsdf_se")] {
                let difference = number(density) * projected - number(flux);
                assert!(difference.abs() < ROUNDING, "{flux}: {difference:e}");
            }
            let parts: f64 = ["flux_unscattered", "flux_once", "flux_more"]
                .map(number)
                .iter()
                .sum();
            assert!((parts - number("flux")).abs() < ROUNDING);
            assert_eq!(bsdf.text(same, "bsdf"), bins.text(bin, "bsdf"));
            assert_eq!(bsdf.text(same, "setting"), (i / 2).to_string());
        }
    }
    // NPY: a header of 128 bytes, then settings x angles x azimuths x sides x rings x sectors.
    for name in ["bsdf.npy", "bsdf_se.npy"] {
        let array = fs::read(out.join(name)).unwrap();
        let header = String::from_utf8_lossy(&array[..128]).into_owned();
        header.must_contain("(2, 2, 1, 2, 6, 8");
        assert_eq!(array.len(), 128 + 8 * 2 * 2 * 2 * 6 * 8);
    }
    let array = fs::read(out.join("bsdf.npy")).unwrap();
    for (row, bytes) in array[128..].chunks_exact(8).enumerate() {
        let value = f64::from_le_bytes(bytes.try_into().unwrap());
        assert_eq!(value, bsdf.number(row, "bsdf"));
    }
}

/// The file of one direction holds the results of `verify` for its case.
#[test]
fn a_direction_has_the_results_of_verify() {
    let folder = with_config();
    folder.succeed("gonio g.toml -o out");
    let case =
        CONFIG.replace("[4, 0.01]", "4").replace("[20, 70]", "70") + "[compare]\nmodels = []\n";
    folder.write("v.toml", case);
    folder.succeed("verify v.toml -o verified");
    let ours = Table::read(&folder.join(format!("out/directions/{}.csv", NAMES[1])));
    let theirs = Table::read(&folder.join("verified/histogram.csv"));
    for row in 0..ours.rows.len() {
        for name in "side theta_min_deg phi_max_deg flux flux_se bsdf".split(' ') {
            assert_eq!(ours.text(row, name), theirs.text(row, name), "{name}");
        }
    }
}

#[test]
fn a_measurement_resumes_and_threads_change_no_byte() {
    let folder = with_config();
    folder.succeed("gonio g.toml --threads 1 -o whole");
    let whole = folder.join("whole");
    assert_eq!(files(&whole.join("directions")).len(), NAMES.len());

    // The time of an instant is enough for one of four surfaces per run, which all directions share.
    for left in (0..4).rev() {
        let output = folder.run("gonio g.toml --threads 3 --max-time 1e-9 -o pieces");
        assert!(output.status.success());
        let said = errors_of(&output);
        assert_eq!(
            said.contains("the same command resumes"),
            left > 0,
            "{said}"
        );
        let report = folder.text("pieces/report.txt");
        assert_eq!(
            report.contains("4 of 4 directions were cut short"),
            left > 0,
            "{report}"
        );
    }
    assert_same_bytes(&whole, &folder.join("pieces"));

    // Damaged results are measured again, with a note.
    let path = folder.join("pieces/results.npz");
    let bytes = fs::read(&path).unwrap();
    let mut changed = bytes.clone();
    let middle = bytes.len() / 2;
    changed[middle] ^= 1;
    for damage in [&bytes[..middle], &changed] {
        fs::write(&path, damage).unwrap();
        let output = folder.run("gonio g.toml -o pieces");
        let said = errors_of(&output);
        said.must_contain("is damaged and is computed again");
        assert_same_bytes(&whole, &folder.join("pieces"));
    }
    // Plots too depend on the directions alone.
    let with_plots = CONFIG.replace("plots = false", "scale = \"common\"");
    folder.write("g.toml", with_plots);
    for (threads, out) in [("1", "whole"), ("3", "pieces")] {
        folder.succeed(format!("gonio g.toml --threads {threads} -o {out}"));
    }
    // A matrix, and for each angle parts, profiles and lobe, of reflected light alone: none is transmitted.
    assert_eq!(files(&whole.join("plots")).len(), 2 * (1 + 3 * 2));
    assert_same_bytes(&whole, &folder.join("pieces"));
    // More directions join those that are there; plots that are not requested go.
    folder.succeed("gonio g.toml --theta 20,50,70 --no-plots -o pieces");
    assert_eq!(files(&folder.join("pieces/directions")).len(), 6);
    assert!(!folder.join("pieces/plots").exists());
}

#[test]
fn directions_of_another_measurement_are_refused() {
    let folder = with_config();
    folder.succeed("gonio g.toml --theta 20 --mean-free-path 4 -o out");
    let report = fs::read(folder.join("out/report.txt")).unwrap();
    for (flag, key) in [
        ("--seed 2", "run.seed 1 in place of 2"),
        ("--rays 9000", "run.rays 8000 in place of 9000"),
        (
            "--light-azimuth fixed",
            "light.azimuth null in place of \"fixed\"",
        ),
        ("--max-scatterings 7", "medium.max_scatterings"),
    ] {
        let line = format!("gonio g.toml --theta 20 --mean-free-path 4 {flag} -o out");
        let said = folder.failed(&line);
        said.must_contain("another run");
        said.must_contain(key);
    }
    assert_eq!(fs::read(folder.join("out/report.txt")).unwrap(), report);
}

/// Tables tell of the directions of one measurement, so a folder that holds others as well is left as it is.
#[test]
fn a_folder_with_directions_that_are_not_planned_is_refused() {
    let folder = with_config();
    folder.succeed("gonio g.toml --theta 20 --mean-free-path 4 -o out");
    let out = folder.join("out");
    let before = fs::read(out.join("gonio.csv")).unwrap();
    let name = NAMES[0];
    let expected = format!(
        "results of another run (the case {name} is not among those planned); choose another"
    );
    for flags in [
        "--theta 50 --mean-free-path 4",
        "--theta 20 --mean-free-path 1",
        "--theta 20,50 --mean-free-path 4 --smoothness 3",
    ] {
        let said = folder.failed(format!("gonio g.toml {flags} -o out"));
        said.must_contain(&expected);
        assert_eq!(files(&out.join("directions")).len(), 1);
        assert_eq!(fs::read(out.join("gonio.csv")).unwrap(), before);
    }
    // The same with more directions is the same measurement.
    folder.succeed("gonio g.toml --theta 20,50 --mean-free-path 4 -o out");
    assert_eq!(files(&out.join("directions")).len(), 2);
}

#[test]
fn given_surfaces_are_measured_and_told_apart() {
    let folder = crate::support::with_surface();
    let surface = "gonio --surface h.exr --theta 30 --phi 0,90 --rays 2e4 --no-plots";
    let text = folder.succeed(format!("{surface} -o out"));
    text.must_contain("h.exr, n = 1.5");
    text.must_contain("one surface");
    // The same as by trace, to the byte.
    folder.succeed("trace h.exr --theta 30 --phi 90 --rays 2e4 --no-plots -o traced");
    let ours = Table::read(&folder.join("out/directions/n1.5_theta30_phi90.csv"));
    let theirs = Table::read(&folder.join("traced/histogram.csv"));
    for row in 0..ours.rows.len() {
        assert_eq!(ours.text(row, "flux_se"), theirs.text(row, "flux_se"));
        assert_eq!(ours.text(row, "bsdf"), theirs.text(row, "bsdf"));
    }
    // Another surface of the same name is another measurement.
    folder.succeed("generate --tau 8 --smoothness 2 --size 64 --seed 8 -o h.exr");
    let said = folder.failed(format!("{surface} -o out"));
    said.must_contain("measured.heights");
    // A mesh as well.
    folder.succeed("mesh h.exr -o h.ply");
    let mesh = "gonio --surface h.ply --border periodic --theta 30 --rays 1e4 --no-plots -o mesh";
    folder.succeed(mesh);
    assert_eq!(files(&folder.join("mesh/directions")).len(), 1);
}

/// Light that never enters: a flat mirror sends all of it into the bin of the mirror direction, at every azimuth.
#[test]
fn a_flat_mirror_reflects_into_the_bin_across_the_normal() {
    let folder = Folder::new();
    let line =
        "gonio --flat --material mirror --directions 3x4 --bins 3x4 --rays 1e3 --no-plots -o out";
    folder.succeed(line);
    let bsdf = Table::read(&folder.join("out/bsdf.csv"));
    assert_eq!(bsdf.rows.len(), 12 * 24);
    for row in 0..bsdf.rows.len() {
        let number = |name| bsdf.number(row, name);
        let turned = (number("phi_i_deg") + 180.0) % 360.0;
        let across = bsdf.text(row, "side") == "reflected"
            && (number("theta_o_deg") - number("theta_i_deg")).abs() < 1e-9
            && (number("phi_o_deg") - turned).abs() < 1e-9;
        assert_eq!(number("bsdf") > 0.0, across, "{:?}", bsdf.rows[row]);
    }
}

/// Below a flat interface of the medium's own index the medium is bare: a dense one that absorbs nothing reflects all
/// light, evenly to both sides of the plane of incidence (z score of the difference below 4 in each ring).
#[test]
fn a_bare_medium_is_even_across_the_plane_of_incidence() {
    let folder = Folder::new();
    let line = "gonio --flat --eta 1.000001 --mean-free-path 1 --albedo 1 --thickness 1 --bottom mirror \
                --theta 60 --rays 4e4 --bins 6x2 --no-plots -o out";
    folder.succeed(line);
    let all = Table::read(&folder.join("out/gonio.csv"));
    let reflected = all.number(0, "reflected");
    let absorbed = all.number(0, "absorbed");
    // Roulette is even on average: what it removes lies within errors.
    let error = all.number(0, "truncated_se");
    println!("reflected {reflected}, absorbed {absorbed}, truncated +- {error}");
    assert!((reflected - 1.0).abs() <= 5.0 * error + 1e-12);
    assert_eq!(absorbed, 0.0);
    let bins = Table::read(&folder.join("out/directions/n1_mfp1_albedo1_d1_theta60_phi0.csv"));
    for pair in 0..6 {
        let [a, b] = [0, 1].map(|i| bins.number(2 * pair + i, "flux_more"));
        let se = [0, 1].map(|i| bins.number(2 * pair + i, "flux_more_se"));
        let z = (a - b) / se[0].hypot(se[1]);
        println!("z = {z:.2}");
        assert!(z.abs() < 4.0);
    }
}

/// Figures of `translucent_matrix.toml`: 11 maxima along a line of 512 samples, by Rice's formula
/// sqrt(m4 / m2) / (2 pi) = sqrt(6) / (2 pi tau), and some 6.9 sigma from the lowest to the highest point.
#[test]
fn bumps_are_as_many_and_as_high_as_the_example_says() {
    let tau = 0.0354 * 512.0;
    let psd = asperity_synthesis::Psd::gaussian(1.0, tau).unwrap();
    let synthesis = asperity_synthesis::Synthesis::new(psd, [512, 512], [1.0, 1.0], false).unwrap();
    let expected = 512.0 * 6.0_f64.sqrt() / (2.0 * std::f64::consts::PI * tau);
    assert!((expected - 11.0).abs() < 0.05, "{expected}");
    let surfaces: Vec<[f64; 2]> = (0..6)
        .map(|realisation| {
            let field = synthesis.draw(1, realisation).unwrap();
            let heights = field.heights();
            let maxima = heights.chunks(512).map(|row| {
                let at = |i: usize| row[i % 512];
                let is_maximum = |i: &usize| at(i + 1) > at(*i) && at(i + 1) > at(i + 2);
                (0..512).filter(is_maximum).count() as f64
            });
            let range = heights.iter().copied().fold(f64::MIN, f64::max)
                - heights.iter().copied().fold(f64::MAX, f64::min);
            [maxima.sum::<f64>() / 512.0, range]
        })
        .collect();
    let [maxima, range] = [0, 1].map(|i| {
        let mean = surfaces.iter().map(|s| s[i]).sum::<f64>() / 6.0;
        let square = surfaces.iter().map(|s| (s[i] - mean).powi(2)).sum::<f64>();
        (mean, (square / 30.0).sqrt())
    });
    println!("maxima {maxima:?}, expected {expected}; range {range:?} sigma");
    // Student's t of five degrees of freedom is below 6.9 but for one in a thousand.
    assert!((maxima.0 - expected).abs() < 6.9 * maxima.1);
    assert!((range.0 - 6.9).abs() < 6.9 * range.1);
    assert!(maxima.1 < 0.2 && range.1 < 0.4);
}

#[test]
fn bad_input_gets_a_sentence() {
    let folder = with_config();
    let cases = "
        gonio g.toml --theta 90 -o out => below 90
        gonio g.toml --theta 3,3 -o out => twice
        gonio g.toml --directions 0x3 -o out => THETAxPHI
        gonio g.toml --directions 2x3 --theta 3 -o out => --theta
        gonio g.toml --surface h.npy --tau 3 -o out => excludes
        gonio --flat --border open -o out => not a flat surface
        gonio --border open -o out => --border open needs --surface (
        gonio g.toml --material mirror -o out => no light enters
        gonio g.toml --mean-free-path 4 --albedo 1 --thickness 99 --bottom-surface h.npy -o out => goes with a given surface or a flat surface, not random surfaces
        gonio g.toml --bottom-surface saem -o out => flat, same, independent or a file; did you mean same?
        gonio g.toml --side transmitted -o out => nothing leaves below
        gonio g.toml --size 16 -o out => --insist
    ";
    folder.refuses(cases);
    folder
        .failed("gonio no.toml -o out")
        .must_contain("no.toml");
    folder
        .failed("gonio --surface h.npy -o out")
        .must_contain("h.npy");
    assert_eq!(files(&folder), ["g.toml"]);
    // Keys of other commands, even where a flag replaces them.
    for (key, flags) in [
        ("target_error = 0.01", ""),
        ("target_error = 0.01", "--rays 100 "),
        ("of = \"bins\"", ""),
        ("refine = true", ""),
    ] {
        let of_file = CONFIG.replace("    rays = 8000\n", &format!("    {key}\n"));
        folder.write("v.toml", of_file);
        let said = folder.refused(format!("gonio v.toml {flags}-o out"));
        let key = key.split(' ').next().unwrap();
        let commands = match key {
            "target_error" => "trace, verify, map and albedo",
            _ => "trace, verify and map",
        };
        let expected = format!("run.{key} is for {commands}, not for gonio");
        said.must_contain(&expected);
        assert_eq!(files(&folder), ["g.toml", "v.toml"]);
    }
    // Checkpoints of earlier versions are refused, and so is a folder in the place of the results.
    fs::create_dir_all(folder.join("old/directions")).unwrap();
    folder.write(format!("old/directions/{}.json", NAMES[0]), "{}");
    let said = folder.failed("gonio g.toml -o old");
    said.must_contain("earlier version");
    fs::create_dir_all(folder.join("out/results.npz")).unwrap();
    folder.failed("gonio g.toml -o out");
}

/// Nothing is told of transmission by a metal, and each peak stands beside its direction.
#[test]
fn columns_without_light_are_left_out_of_the_report() {
    let folder = Folder::new();
    let report = |material: &str| {
        folder.succeed(format!(
            "gonio --smoothness 2 --tau 4 --size 64 --theta 0,40 --rays 500 --realisations 2 --no-plots --material {material}"
        ))
    };
    let metal = report("conductor --eta 0.2 --kappa 3");
    assert!(metal.lines().all(|line| line.len() <= 80), "{metal}");
    assert!(
        !metal.contains("transmitted") && !metal.contains("BTDF"),
        "{metal}"
    );
    assert!(metal.contains("absorbed "), "{metal}");
    let glass = report("dielectric");
    let peaks = "theta  phi  BRDF peak (1/sr) at theta, phi  BTDF peak (1/sr) at theta, phi";
    assert!(
        glass.contains(peaks) && !glass.contains("absorbed"),
        "{glass}"
    );
    assert!(glass.contains("transmitted "), "{glass}");
}

#[test]
fn summary_tells_all() {
    let folder = with_config();
    let text = folder.succeed("gonio g.toml --json -o out");
    let file = folder.text("out/summary.json");
    assert_eq!(json(&text), json(&file));
    let summary = json(&file);
    assert_eq!(summary["command"], "gonio");
    assert_eq!(summary["complete"], true);
    assert_eq!(summary["azimuth"], "random");
    assert_eq!(
        summary["components"],
        serde_json::json!(["all", "unscattered", "once", "more"])
    );
    let directions: &Vec<Value> = summary["directions"].as_array().unwrap();
    assert_eq!(directions.len(), 4);
    let flux = &directions[0]["results"]["flux"]["once"]["reflected"];
    assert!(flux["mean"].as_f64().unwrap() > 0.0 && flux["se"].is_f64());
    let report = folder.text("out/report.txt");
    report.must_contain("4 of 4 directions; s = 2, n = 1.5, albedo = 0.9");
    report.must_contain("mean free path = 0.01");
}
