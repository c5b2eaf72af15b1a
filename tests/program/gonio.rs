//! The virtual gonioreflectometer: its tables, its files, and runs that resume.

use std::fs;
use std::path::Path;

use crate::support::{
    asperity, assert_same_bytes, errors_of, files, json, refused, succeed, words,
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
fn with_config() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("g.toml"), CONFIG).unwrap();
    folder
}

/// A table by the names of its columns.
struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let split = |line: &str| line.split(',').map(str::to_owned).collect();
        let mut lines = text.lines();
        Self {
            header: split(lines.next().unwrap()),
            rows: lines.map(split).collect(),
        }
    }

    fn text<'a>(&self, row: &'a [String], name: &str) -> &'a str {
        let column = self.header.iter().position(|c| c == name);
        &row[column.unwrap_or_else(|| panic!("no column {name}"))]
    }

    fn number(&self, row: &[String], name: &str) -> f64 {
        self.text(row, name).parse().unwrap()
    }

    fn sum(&self, side: &str, name: &str) -> f64 {
        let of_side = |row: &&Vec<String>| self.text(row, "side") == side;
        self.rows
            .iter()
            .filter(of_side)
            .map(|row| self.number(row, name))
            .sum()
    }
}

/// Sums over all bins and conversions round: each of some hundred terms of at most one to 2^-53.
const ROUNDING: f64 = 1e-12;

#[test]
fn bins_add_up_to_totals_and_are_fluxes_over_projected_solid_angle() {
    let folder = with_config();
    let folder = folder.path();
    succeed(folder, &words("gonio g.toml -o out"));
    let out = folder.join("out");
    let all = Table::read(&out.join("gonio.csv"));
    let bsdf = Table::read(&out.join("bsdf.csv"));
    assert_eq!(all.rows.len(), NAMES.len());
    for (i, (row, name)) in all.rows.iter().zip(NAMES).enumerate() {
        assert_eq!(all.text(row, "direction"), name);
        let budget = ["reflected", "transmitted", "absorbed", "truncated", "lost"];
        let total: f64 = budget.iter().map(|part| all.number(row, part)).sum();
        assert!((total - 1.0).abs() < ROUNDING, "{name}: {total}");

        let bins = Table::read(&out.join(format!("directions/{name}.csv")));
        assert_eq!(bins.rows.len(), 2 * 6 * 8);
        for part in ["", "_unscattered", "_once", "_more"] {
            let of_bins = bins.sum("reflected", &format!("flux{part}"));
            let total = all.number(row, &format!("reflected{part}"));
            assert!(
                (of_bins - total).abs() < ROUNDING,
                "{name}{part}: {of_bins} {total}"
            );
            assert!(total > 0.0);
        }
        let whole_table = &bsdf.rows[i * bins.rows.len()..];
        for (bin, same) in bins.rows.iter().zip(whole_table) {
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
        assert!(header.contains("(2, 2, 1, 2, 6, 8"), "{header}");
        assert_eq!(array.len(), 128 + 8 * 2 * 2 * 2 * 6 * 8);
    }
    let array = fs::read(out.join("bsdf.npy")).unwrap();
    for (row, bytes) in bsdf.rows.iter().zip(array[128..].chunks_exact(8)) {
        let value = f64::from_le_bytes(bytes.try_into().unwrap());
        assert_eq!(value, bsdf.number(row, "bsdf"));
    }
}

/// The file of one direction holds the results of `verify` for its case.
#[test]
fn a_direction_has_the_results_of_verify() {
    let folder = with_config();
    let folder = folder.path();
    succeed(folder, &words("gonio g.toml -o out"));
    let case =
        CONFIG.replace("[4, 0.01]", "4").replace("[20, 70]", "70") + "[compare]\nmodels = []\n";
    fs::write(folder.join("v.toml"), case).unwrap();
    succeed(folder, &words("verify v.toml -o verified"));
    let ours = Table::read(&folder.join(format!("out/directions/{}.csv", NAMES[1])));
    let theirs = Table::read(&folder.join("verified/histogram.csv"));
    for (a, b) in ours.rows.iter().zip(&theirs.rows) {
        for name in [
            "side",
            "theta_min_deg",
            "phi_max_deg",
            "flux",
            "flux_se",
            "bsdf",
        ] {
            assert_eq!(ours.text(a, name), theirs.text(b, name), "{name}");
        }
    }
}

#[test]
fn a_measurement_resumes_and_threads_change_no_byte() {
    let folder = with_config();
    let folder = folder.path();
    succeed(folder, &words("gonio g.toml --threads 1 -o whole"));
    let whole = folder.join("whole");
    assert_eq!(files(&whole.join("directions")).len(), NAMES.len());

    // The time of an instant is enough for one of four surfaces per run, which all directions share.
    for left in (0..4).rev() {
        let arguments = words("gonio g.toml --threads 3 --max-time 1e-9 -o pieces");
        let output = asperity(folder, &arguments);
        assert!(output.status.success());
        let said = errors_of(&output);
        assert_eq!(
            said.contains("the same command resumes"),
            left > 0,
            "{said}"
        );
        let report = fs::read_to_string(folder.join("pieces/report.txt")).unwrap();
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
        let output = asperity(folder, &words("gonio g.toml -o pieces"));
        let said = errors_of(&output);
        assert!(said.contains("is damaged and is computed again"), "{said}");
        assert_same_bytes(&whole, &folder.join("pieces"));
    }
    // Plots too depend on the directions alone.
    let with_plots = CONFIG.replace("plots = false", "scale = \"common\"");
    fs::write(folder.join("g.toml"), with_plots).unwrap();
    for (threads, out) in [("1", "whole"), ("3", "pieces")] {
        let line = format!("gonio g.toml --threads {threads} -o {out}");
        succeed(folder, &words(&line));
    }
    // A matrix, and for each angle parts, profiles and lobe, of reflected light alone: none is transmitted.
    assert_eq!(files(&whole.join("plots")).len(), 2 * (1 + 3 * 2));
    assert_same_bytes(&whole, &folder.join("pieces"));
    // More directions join those that are there; plots that are not requested go.
    succeed(
        folder,
        &words("gonio g.toml --theta 20,50,70 --no-plots -o pieces"),
    );
    assert_eq!(files(&folder.join("pieces/directions")).len(), 6);
    assert!(!folder.join("pieces/plots").exists());
}

#[test]
fn directions_of_another_measurement_are_refused() {
    let folder = with_config();
    let folder = folder.path();
    succeed(
        folder,
        &words("gonio g.toml --theta 20 --mean-free-path 4 -o out"),
    );
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
        let said = refused(folder, &words(&line), 1);
        assert!(said.contains("another run") && said.contains(key), "{said}");
    }
    assert_eq!(fs::read(folder.join("out/report.txt")).unwrap(), report);
}

/// Tables tell of the directions of one measurement, so a folder that holds others as well is left as it is.
#[test]
fn a_folder_with_directions_that_are_not_planned_is_refused() {
    let folder = with_config();
    let folder = folder.path();
    succeed(
        folder,
        &words("gonio g.toml --theta 20 --mean-free-path 4 -o out"),
    );
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
        let said = refused(folder, &words(&format!("gonio g.toml {flags} -o out")), 1);
        assert!(said.contains(&expected), "{said}");
        assert_eq!(files(&out.join("directions")).len(), 1);
        assert_eq!(fs::read(out.join("gonio.csv")).unwrap(), before);
    }
    // The same with more directions is the same measurement.
    succeed(
        folder,
        &words("gonio g.toml --theta 20,50 --mean-free-path 4 -o out"),
    );
    assert_eq!(files(&out.join("directions")).len(), 2);
}

#[test]
fn given_surfaces_are_measured_and_told_apart() {
    let (_keep, folder) = crate::support::with_surface();
    let surface = "gonio --surface h.exr --theta 30 --phi 0,90 --rays 2e4 --no-plots";
    let text = succeed(&folder, &words(&format!("{surface} -o out")));
    assert!(
        text.contains("h.exr, n = 1.5") && text.contains("one surface"),
        "{text}"
    );
    // The same as by trace, to the byte.
    succeed(
        &folder,
        &words("trace h.exr --theta 30 --phi 90 --rays 2e4 --no-plots -o traced"),
    );
    let ours = Table::read(&folder.join("out/directions/n1.5_theta30_phi90.csv"));
    let theirs = Table::read(&folder.join("traced/histogram.csv"));
    for (a, b) in ours.rows.iter().zip(&theirs.rows) {
        assert_eq!(ours.text(a, "flux_se"), theirs.text(b, "flux_se"));
        assert_eq!(ours.text(a, "bsdf"), theirs.text(b, "bsdf"));
    }
    // Another surface of the same name is another measurement.
    let other = words("generate --tau 8 --smoothness 2 --size 64 --seed 8 -o h.exr");
    succeed(&folder, &other);
    let said = refused(&folder, &words(&format!("{surface} -o out")), 1);
    assert!(said.contains("measured.heights"), "{said}");
    // A mesh as well.
    succeed(&folder, &words("mesh h.exr -o h.ply"));
    let mesh = "gonio --surface h.ply --border periodic --theta 30 --rays 1e4 --no-plots -o mesh";
    succeed(&folder, &words(mesh));
    assert_eq!(files(&folder.join("mesh/directions")).len(), 1);
}

/// Light that never enters: a flat mirror sends all of it into the bin of the mirror direction, at every azimuth.
#[test]
fn a_flat_mirror_reflects_into_the_bin_across_the_normal() {
    let folder = tempfile::tempdir().unwrap();
    let line =
        "gonio --flat --material mirror --directions 3x4 --bins 3x4 --rays 1e3 --no-plots -o out";
    succeed(folder.path(), &words(line));
    let bsdf = Table::read(&folder.path().join("out/bsdf.csv"));
    assert_eq!(bsdf.rows.len(), 12 * 24);
    for row in &bsdf.rows {
        let number = |name| bsdf.number(row, name);
        let turned = (number("phi_i_deg") + 180.0) % 360.0;
        let across = bsdf.text(row, "side") == "reflected"
            && (number("theta_o_deg") - number("theta_i_deg")).abs() < 1e-9
            && (number("phi_o_deg") - turned).abs() < 1e-9;
        assert_eq!(number("bsdf") > 0.0, across, "{row:?}");
    }
}

/// Below a flat interface of the medium's own index the medium is bare: a dense one that absorbs nothing reflects all
/// light, evenly to both sides of the plane of incidence (z score of the difference below 4 in each ring).
#[test]
fn a_bare_medium_is_even_across_the_plane_of_incidence() {
    let folder = tempfile::tempdir().unwrap();
    let line = "gonio --flat --eta 1.000001 --mean-free-path 1 --albedo 1 --thickness 1 --bottom mirror \
                --theta 60 --rays 4e4 --bins 6x2 --no-plots -o out";
    let line = line.split_whitespace().collect::<Vec<_>>();
    succeed(folder.path(), &line);
    let all = Table::read(&folder.path().join("out/gonio.csv"));
    let reflected = all.number(&all.rows[0], "reflected");
    let absorbed = all.number(&all.rows[0], "absorbed");
    // Roulette is even on average: what it removes lies within errors.
    let error = all.number(&all.rows[0], "truncated_se");
    println!("reflected {reflected}, absorbed {absorbed}, truncated +- {error}");
    assert!((reflected - 1.0).abs() <= 5.0 * error + 1e-12);
    assert_eq!(absorbed, 0.0);
    let bins = Table::read(
        &folder
            .path()
            .join("out/directions/n1_mfp1_albedo1_d1_theta60_phi0.csv"),
    );
    for pair in bins.rows[..12].chunks(2) {
        let [a, b] = [0, 1].map(|i| bins.number(&pair[i], "flux_more"));
        let se = [0, 1].map(|i| bins.number(&pair[i], "flux_more_se"));
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
    let folder = folder.path();
    for (line, code, expected) in [
        ("gonio no.toml -o out", 1, "no.toml"),
        ("gonio g.toml --theta 90 -o out", 2, "below 90"),
        ("gonio g.toml --theta 3,3 -o out", 2, "twice"),
        ("gonio g.toml --directions 0x3 -o out", 2, "THETAxPHI"),
        (
            "gonio g.toml --directions 2x3 --theta 3 -o out",
            2,
            "--theta",
        ),
        ("gonio g.toml --surface h.npy --tau 3 -o out", 2, "excludes"),
        ("gonio --surface h.npy -o out", 1, "h.npy"),
        ("gonio --flat --border open -o out", 2, "not a flat surface"),
        (
            "gonio --border open -o out",
            2,
            "--border open needs --surface (",
        ),
        (
            "gonio g.toml --material mirror -o out",
            2,
            "no light enters",
        ),
        (
            "gonio g.toml --bottom-surface h.npy -o out",
            2,
            "flat, same or independent",
        ),
        (
            "gonio g.toml --side transmitted -o out",
            2,
            "nothing leaves below",
        ),
        ("gonio g.toml --size 16 -o out", 2, "--insist"),
    ] {
        let said = refused(folder, &words(line), code);
        assert!(said.contains(expected), "{line}: {said}");
    }
    assert_eq!(files(folder), ["g.toml"]);
    // Keys of verify and trace, even where a flag replaces them.
    for (key, flags) in [
        ("target_error = 0.01", ""),
        ("target_error = 0.01", "--rays 100 "),
        ("of = \"bins\"", ""),
        ("refine = true", ""),
    ] {
        let of_file = CONFIG.replace("    rays = 8000\n", &format!("    {key}\n"));
        fs::write(folder.join("v.toml"), of_file).unwrap();
        let said = refused(folder, &words(&format!("gonio v.toml {flags}-o out")), 2);
        let key = key.split(' ').next().unwrap();
        let expected = format!("run.{key} is for trace, verify and map, not for gonio");
        assert!(said.contains(&expected), "{said}");
        assert_eq!(files(folder), ["g.toml", "v.toml"]);
    }
    // Checkpoints of earlier versions are refused, and so is a folder in the place of the results.
    fs::create_dir_all(folder.join("old/directions")).unwrap();
    fs::write(
        folder.join(format!("old/directions/{}.json", NAMES[0])),
        "{}",
    )
    .unwrap();
    let said = refused(folder, &words("gonio g.toml -o old"), 1);
    assert!(said.contains("earlier version"), "{said}");
    fs::create_dir_all(folder.join("out/results.npz")).unwrap();
    refused(folder, &words("gonio g.toml -o out"), 1);
}

/// Nothing is told of transmission by a metal, and each peak stands beside its direction.
#[test]
fn columns_without_light_are_left_out_of_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let report = |material: &str| {
        let line = format!(
            "gonio --smoothness 2 --tau 4 --size 64 --theta 0,40 --rays 500 --realisations 2 --no-plots --material {material}"
        );
        succeed(folder.path(), &words(&line))
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
fn summary_tells_all_and_examples_are_understood() {
    let folder = with_config();
    let folder = folder.path();
    let text = succeed(folder, &words("gonio g.toml --json -o out"));
    let file = fs::read_to_string(folder.join("out/summary.json")).unwrap();
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
    let report = fs::read_to_string(folder.join("out/report.txt")).unwrap();
    assert!(
        report.contains("4 of 4 directions; s = 2, n = 1.5, albedo = 0.9"),
        "{report}"
    );
    assert!(report.contains("mean free path = 0.01"), "{report}");

    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut seen = 0;
    for entry in fs::read_dir(examples).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.starts_with("translucent_") || name == "small_gonio.toml" {
            let text = fs::read_to_string(&path).unwrap();
            let config = asperity_studies::GonioConfig::from_toml(&text).unwrap();
            config.plan(None).unwrap();
            seen += 1;
        }
    }
    assert!(seen >= 4, "{seen}");
}
