//! Given surfaces: units, borders and the order of rows, from the file to what is printed.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, errors_of, json, unwrapped};

/// A matrix of text: waves along x on a ramp along y.
fn ramp(folder: &Path, name: &str) {
    let row = |y: usize| {
        let heights = (0..32).map(|x| (x as f64 * 0.7).sin() + 0.5 * y as f64);
        heights.map(|h| h.to_string()).collect::<Vec<_>>().join(" ")
    };
    let rows: Vec<String> = (0..32).map(row).collect();
    folder.write(name, rows.join("\n"));
}

fn inspected(folder: &Path, arguments: &str) -> serde_json::Value {
    let text = folder.succeed(format!("inspect {arguments} --json"));
    json(&text)
}

#[test]
fn one_border_is_assumed_for_every_format_and_said() {
    let folder = Folder::new();
    ramp(&folder, "a.txt");
    folder.succeed("inspect a.txt -o a.npy");
    for name in ["a.txt", "a.npy"] {
        let text = folder.succeed(format!("inspect {name}"));
        text.must_contain("mirrored border, as for every file");
        text.must_contain("mean slope along y is 0.5");
    }
    let sdq = |name: &str| inspected(&folder, name)["sdq"].as_f64().unwrap();
    assert!((sdq("a.txt") / sdq("a.npy") - 1.0).abs() < 1e-12);
    let text = folder.succeed("trace a.npy --border periodic --rays 100");
    text.must_contain("borders along y do not fit");
    assert!(!text.contains("borders along x"), "{text}");
}

#[test]
fn units_convert_from_the_file_to_what_is_printed() {
    let folder = Folder::new();
    ramp(&folder, "a.txt");
    let um = "a.txt --assume-unit nm --spacing 0.1um";
    let report = inspected(&folder, &format!("{um} --unit um"));
    assert_eq!(report["unit"], "um");
    assert!((report["spacing"][0].as_f64().unwrap() - 0.1).abs() < 1e-12);
    let nm = inspected(&folder, um);
    let ratio = report["sq"].as_f64().unwrap() / nm["sq"].as_f64().unwrap();
    assert!((ratio - 1e-3).abs() < 1e-12);
    let slopes = report["sdq"].as_f64().unwrap() / nm["sdq"].as_f64().unwrap();
    assert!((slopes - 1.0).abs() < 1e-12);

    // A length is the same in every unit, and printed with that of the surface.
    let medium = "--albedo 0.9 --rays 200 --seed 3";
    let trace = |flags: &str| folder.succeed(format!("trace {um} {flags} {medium}"));
    let plain = trace("--mean-free-path 400");
    let suffixed = trace("--mean-free-path 0.4um");
    plain.must_contain("mean free path = 400 nm");
    suffixed.must_contain("mean free path = 400 nm");
    let converted = trace("--unit um --mean-free-path 400nm");
    converted.must_contain("mean free path = 0.4 um");

    for (arguments, expected) in [
        ("a.txt --unit um", "the file states no unit"),
        ("a.txt --spacing 3um", "the surface has no unit of length"),
        ("a.txt --assume-unit furlong", "nm, um, mm, m or km"),
        (
            "a.txt --spacing 3furlong",
            "a number above 0, for both axes or two as X,Y, such as 1.4, 2e-3 or 5um",
        ),
    ] {
        let text = folder.refused(format!("inspect {arguments}"));
        text.must_contain(expected);
    }
    let text = folder.refused("trace a.txt --mean-free-path 5um --albedo 1");
    text.must_contain("--assume-unit");
}

#[test]
fn random_surfaces_take_lengths_with_units() {
    let folder = Folder::new();
    let size = "--size 64 --insist --seed 1";
    for (name, lengths) in [
        ("a.exr", "--tau 4um --sigma 2000nm --spacing 1"),
        ("b.exr", "--tau 4 --sigma 2 --spacing 1 --unit um"),
    ] {
        folder.succeed(format!("generate {lengths} {size} -o {name}"));
    }
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert!(bytes("a.exr") == bytes("b.exr"));
    assert_eq!(inspected(&folder, "a.exr")["unit"], "um");
    let text = folder.refused(format!("generate --tau 4um --unit 1 {size} -o c.exr"));
    text.must_contain("--unit");
}

/// With a control variate few rays are counted in a bin whose flux is known well.
#[test]
fn bins_of_small_relative_error_do_not_rest_on_few_rays() {
    let folder = Folder::new();
    folder.succeed("generate --tau 8 --smoothness 2 --size 128 -o h.exr");
    folder.succeed("trace h.exr --border periodic --rays 1e4 --no-plots -o t");
    let table = folder.text("t/histogram.csv");
    let mut lines = table
        .lines()
        .map(|line| line.split(',').collect::<Vec<_>>());
    let head = lines.next().unwrap();
    let column = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let [flux, se, few] = ["flux", "flux_se", "few_rays"].map(column);
    let mut counts = [0, 0];
    for row in lines {
        let [flux, se] = [flux, se].map(|i| row[i].parse::<f64>().unwrap());
        let is_few = se > flux.abs() / 20_f64.sqrt();
        assert_eq!(row[few], if is_few { "yes" } else { "no" }, "{row:?}");
        counts[usize::from(is_few)] += 1;
    }
    assert!(counts[0] > 0 && counts[1] > 0, "{counts:?}");
}

/// Few of the surfaces send light of the highest orders out of V grooves of random depth.
#[test]
fn light_of_few_surfaces_is_marked_in_report_and_files() {
    let folder = Folder::new();
    let report = folder.succeed(
            "verify --structure v-grooves --randomness 0.5 --width 16 --spacing 1 --size 256x64 --realisations 32 --rays 32000 --models none --bins 6x12 --theta 30 --no-plots -o v",
    );
    let is_few = |mean: f64, se: f64| se > mean.abs() / 20_f64.sqrt();
    let summary = folder.json("v/summary.json");
    let mut counts = [0, 0];
    for order in summary["orders"]["reflected"].as_array().unwrap() {
        let [mean, se] = ["mean", "se"].map(|key| order[key].as_f64().unwrap());
        let marked = order["few_samples"] == true;
        assert_eq!(marked, is_few(mean, se), "{order}");
        counts[usize::from(marked)] += 1;
        let named = format!("order {}", order["order"]);
        let line = "fewer than 20 surfaces or rays carry reflected light of ";
        let of_few = unwrapped(&report)
            .split_once(line)
            .map(|(_, rest)| rest.split_once(':').unwrap().0.to_owned());
        assert_eq!(of_few.unwrap().contains(&named), marked, "{report}");
    }
    assert!(counts[0] > 0 && counts[1] > 0, "{counts:?}");
    for name in ["theta", "in_plane"] {
        let table = folder.text(format!("v/{name}.csv"));
        let mut lines = table
            .lines()
            .map(|line| line.split(',').collect::<Vec<_>>());
        let head = lines.next().unwrap();
        let column = |name: &str| head.iter().position(|column| *column == name).unwrap();
        let components = ["order_1", "order_2", "order_3", "order_4_and_above"];
        let mut marks = 0;
        for row in lines {
            let value = |name: &str| row[column(name)].parse::<f64>().unwrap();
            let marked: Vec<&str> = row[column("few_samples")].split_whitespace().collect();
            marks += marked.len();
            for of in components {
                let few = is_few(
                    value(&format!("flux_{of}")),
                    value(&format!("flux_{of}_se")),
                );
                assert_eq!(marked.contains(&of), few, "{row:?}");
            }
        }
        assert!(marks > 0, "{name}");
    }
}

#[test]
fn lengths_are_judged_against_the_wavelength() {
    let folder = Folder::new();
    ramp(&folder, "a.txt");
    let trace = |flags: &str| {
        let line = format!("trace a.txt --remove plane --rays 100 {flags}");
        folder.succeed(line.trim())
    };
    let doubtful = trace("--assume-unit nm");
    doubtful.must_contain("note: geometric optics is doubtful");
    doubtful.must_contain("550 nm, assumed");
    for wavelength in ["633nm", "0.633um"] {
        let with_unit = trace(&format!("--assume-unit mm --wavelength {wavelength}"));
        with_unit.must_contain("(633 nm)");
    }
    let large = trace("--assume-unit mm --wavelength 633");
    large.must_contain("note: lengths are large against the wavelength (633 nm)");
    assert!(!trace("").contains("wavelength"));
    let summary = json(&trace("--assume-unit nm --json"));
    assert_eq!(summary["validity"]["holds"], false);
    assert_eq!(summary["validity"]["wavelength_nm"], 550.0);
    assert!(json(&trace("--json"))["validity"].is_null());
}

/// Sine grooves of 400 nm leave J_0^2 of their amplitude coherent, which no Gaussian heights of their sigma do; V grooves a sinc^2, as height map,
/// mesh and structure alike.
#[test]
fn what_stays_coherent_follows_from_the_heights() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    let tile = "--width 32um --size 128 --spacing 0.5um --unit um";
    run(&format!(
        "generate --structure sine-grooves --depth 400nm {tile} -o sine.exr"
    ));
    run(&format!(
        "generate --structure v-grooves --depth 150nm {tile} -o v.npy"
    ));
    run("mesh v.npy --spacing 0.5 --assume-unit um --border periodic -o v.ply");
    let fraction = |line: &str| {
        let summary = json(&run(&format!("{line} --material mirror --json")));
        assert_eq!(summary["validity"]["holds"], false);
        let reflected = &summary["validity"]["reflected"];
        reflected["coherent_fraction"].as_f64().unwrap()
    };
    let light = "--theta 0 --rays 100 --border periodic";
    let sine = format!("trace sine.exr {light} --wavelength 633nm");
    // J_0(4 pi 0.2 / 0.633) = -0.3989
    let found = fraction(&sine);
    assert!((found - 0.3989_f64.powi(2)).abs() < 1e-4, "{found}");
    let report = run(&format!("{sine} --material mirror"));
    assert!(
        report.contains("warning: 15.9 % of the reflected light"),
        "{report}"
    );
    // Half a turn: (2 / pi)^2, of 32 samples per flank 0.16 % less
    let exact = (2.0 / std::f64::consts::PI).powi(2);
    let structure = "verify --structure v-grooves --depth 150nm --realisations 2 --models none --rays 200 --theta 0";
    for line in [
        format!("trace v.npy --spacing 0.5 --assume-unit um {light}"),
        format!("trace v.ply --assume-unit um {light}"),
        format!("{structure} {tile}"),
    ] {
        let found = fraction(&format!("{line} --wavelength 600nm"));
        assert!((found / exact - 1.0).abs() < 2e-3, "{line}: {found}");
    }
}

#[test]
fn lengths_of_random_surfaces_and_directions_are_judged() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    let size = "--smoothness 2 --eta 1.5 --size 32 --realisations 2 --rays 200 --no-plots";
    let verify = run(&format!(
        "verify --tau 2um --theta 0 {size} --models none -o v"
    ));
    verify.must_contain("tau / lambda = 3.636");
    let read = |path: &str| folder.json(path);
    let validity = &read("v/summary.json")["validity"];
    // R = tau^2 / (sqrt(12) sigma) = 1.155 um at vertical light
    let radius = validity["curvature_radius_over_wavelength"]
        .as_f64()
        .unwrap();
    assert!((radius - 4.0 / 12_f64.sqrt() / 0.55).abs() < 1e-12);
    assert_eq!(validity["wavelength_is_assumed"], true);

    // A wavelength belongs to no checkpoint
    run(&format!(
        "verify --tau 2um --theta 0 {size} --models none --wavelength 10 -o v"
    ));
    assert_eq!(read("v/summary.json")["validity"]["holds"], true);

    // Heights that mix the phases of reflected light leave more than half of the transmitted light coherent
    let report = run(
        "verify --tau 5um --sigma 0.135um --theta 0 --eta 1.5 --size 64 --realisations 2 --rays 200 --models none --no-plots -o w",
    );
    // Below the headline
    let mut lines = report.lines().skip_while(|line| !line.is_empty()).skip(1);
    assert!(lines.next().unwrap().starts_with("s = 37"), "{report}");
    let second = lines.next().unwrap();
    assert!(
        second.starts_with("warning: 55.2 % of the transmitted light"),
        "{report}"
    );
    let validity = &read("w/summary.json")["validity"];
    let coherent = validity["transmitted"]["coherent_fraction"]
        .as_f64()
        .unwrap();
    let phase = std::f64::consts::TAU * 0.135 * 0.5 / 0.55;
    assert!((coherent - (-phase * phase).exp()).abs() < 1e-9);
    assert_eq!(validity["holds"], false);
    let report = run(&format!(
        "verify --tau 8 {size} --wavelength 633um --models none -o x"
    ));
    let text = report.split_whitespace().collect::<Vec<_>>().join(" ");
    text.must_contain("has no effect");
    text.must_contain("far from visible");

    let gonio = run(&format!(
        "gonio --tau 2um --theta 0,80 {size} --wavelength 300 -o g"
    ));
    gonio.must_contain("theta80");
    let text = gonio.split_whitespace().collect::<Vec<_>>().join(" ");
    text.must_contain("geometric optics is doubtful");
    let directions = &read("g/summary.json")["directions"];
    let holds = [0, 1].map(|i| directions[i]["validity"]["holds"].as_bool().unwrap());
    assert_eq!(holds, [true, false]);
}

#[test]
fn rows_are_reversed_on_request() {
    let folder = Folder::new();
    ramp(&folder, "a.txt");
    let slope = |flags: &str| {
        let report = inspected(&folder, format!("a.txt {flags}").trim());
        report["slope_mean"][1].as_f64().unwrap()
    };
    assert!((slope("") - 0.5).abs() < 1e-12 && (slope("--flip") + 0.5).abs() < 1e-12);
}

#[test]
fn surfaces_too_smooth_for_quadrature_are_refused_at_once() {
    let folder = Folder::new();
    for arguments in [
        "verify --smoothness 1e9 -o o",
        "verify --tau 1e9 --sigma 1 -o o",
        "verify --tau 1 --tau-y 1e7 --sigma 1 -o o",
        "gonio --smoothness 1e8 -o o",
        "model heitz --smoothness 1e8 --theta 30",
    ] {
        let text = folder.refused(arguments);
        assert!(
            text.contains("1e6") || text.contains("1000000"),
            "{arguments}: {text}"
        );
    }
}

#[cfg(unix)]
#[test]
fn names_that_are_not_text_are_refused_by_name() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    use std::process::Command;

    let run = |arguments: &[&[u8]]| {
        let output = Command::new(env!("CARGO_BIN_EXE_asperity"))
            .args(arguments.iter().map(|argument| OsStr::from_bytes(argument)))
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(2));
        errors_of(&output)
    };
    let file = run(&[b"trace", b"surface\xff.npy"]);
    file.must_contain("surface\u{fffd}.npy");
    file.must_contain("UTF-8");
    let output = run(&[b"gonio", b"-o", b"out\xff"]);
    output.must_contain("out\u{fffd}");
}

#[test]
fn shadow_of_a_terrain_is_measured_in_both_formats() {
    let folder = Folder::new();
    // A wall of height 30 along y in a plane of 10 x 10 cells of 10 m, one corner of which is missing
    let row = |y: usize| {
        let heights = (0..11).map(|x| match (x, y) {
            (0, 0) => "-9999",
            (5, _) => "30",
            _ => "0",
        });
        heights.collect::<Vec<_>>().join(" ")
    };
    let rows: Vec<String> = (0..11).map(row).collect();
    let header = "ncols 11\nnrows 11\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value -9999\n";
    folder.write("wall.asc", header.to_owned() + &rows.join("\n"));
    let inspect = |file: &str| {
        let line = format!("inspect {file} --missing fill --border open --theta 0,60 --json");
        json(&folder.succeed(&line))["shadows"].clone()
    };
    let found = inspect("wall.asc");
    assert_eq!(found[0]["lit"]["mean"], 1.0);
    // Light from +x, 30 degrees high: the slope of 10 m behind the crest faces away, and the shadow on the ground ends
    // at 30 tan(60) = 52 m from the crest, beyond the border at 50 m
    let away = found[1]["facing_away"]["mean"].as_f64().unwrap();
    let hidden = found[1]["hidden"]["mean"].as_f64().unwrap();
    assert!((away - 0.1).abs() < 1e-9, "{found}");
    assert!((hidden - 0.4).abs() < 0.01, "{found}");
    folder.succeed("inspect wall.asc --missing fill --border open -o wall.exr");
    assert_eq!(inspect("wall.exr"), found);
    let text = folder.succeed("inspect wall.exr --theta 60");
    text.must_contain("light from theta 60 deg, phi 0 deg: lit");
    let error = folder.refused("inspect wall.exr --theta 95");
    error.must_contain("--theta");
}

/// A terrain of 12 x 9 cells of 10 m, a ridge that falls towards the south-east, as an ESRI grid and as a list of points.
fn terrain(folder: &Path) {
    let height = |east: usize, north: usize| {
        let (x, y) = (east as f64, north as f64);
        30.0 * (-0.3 * (x - 0.7 * y).powi(2)).exp() + 2.0 * (0.9 * x + 0.4 * y).sin()
    };
    let mut grid = "ncols 12\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 10\n".to_owned();
    let mut points = String::new();
    for north in (0..9).rev() {
        for east in 0..12 {
            grid += &format!("{} ", height(east, north));
            points += &format!("{} {} {}\n", 10 * east, 10 * north, height(east, north));
        }
        grid += "\n";
    }
    folder.write("t.asc", grid);
    folder.write("t.xyz", points);
}

#[test]
fn the_sun_stands_where_a_compass_says_whatever_the_order_of_rows() {
    let folder = Folder::new();
    terrain(&folder);
    let lit = |line: &str| -> Vec<[f64; 2]> {
        let line = format!("inspect {line} --border open --json");
        let shadows = json(&folder.succeed(&line))["shadows"].clone();
        let shadows = shadows.as_array().unwrap().iter();
        let lit = shadows.map(|one| ["mean", "se"].map(|key| one["lit"][key].as_f64().unwrap()));
        lit.collect()
    };
    let sun = "--sun-elevation 15,40 --sun-azimuth 300";
    let expected = lit(&format!("t.asc {sun} --cells smooth"));
    assert!(expected[0][0] < 0.9 && expected[0][0] < expected[1][0]);
    let differs =
        |[a, error]: [f64; 2], [b, other]: [f64; 2]| (a - b).abs() > 5.0 * error.hypot(other);
    for map in ["t.xyz", "t.asc --flip", "t.xyz --flip"] {
        let found = lit(&format!("{map} {sun} --cells smooth"));
        for (found, expected) in found.into_iter().zip(&expected) {
            assert!(!differs(found, *expected), "{map}: {found:?} {expected:?}");
        }
    }
    let from_the_east = lit("t.asc --sun-elevation 15 --sun-azimuth 120 --cells smooth");
    assert!(differs(from_the_east[0], expected[0]), "{from_the_east:?}");
    // Rows from the north: west-north-west is at 300 - 90 degrees from +x towards the south. Otherwise at 90 - 300.
    for (map, phi) in [("t.asc", 210), ("t.xyz", 150)] {
        let by_angles = lit(&format!("{map} --theta 75,50 --phi {phi}"));
        assert_eq!(lit(&format!("{map} {sun}")), by_angles);
    }

    let light = "--border open --material lambertian --reflectance 0.3 --rays 1e4 --bins 6x8";
    let run = |line: String| folder.succeed(&line);
    run(format!(
        "trace t.asc {light} --sun-elevation 40 --sun-azimuth 300 -o a"
    ));
    run(format!("trace t.asc {light} --theta 50 --phi 210 -o b"));
    run(format!("trace t.asc {light} --theta 50 --phi 210 -o a"));
    let table = |out: &str| fs::read(folder.join(out).join("histogram.csv")).unwrap();
    assert!(table("a") == table("b"));
    let gonio = "--sun-elevation 40,20 --sun-azimuth 300 --no-plots -o g";
    run(format!("gonio --surface t.asc {light} {gonio}"));
    let found = folder.json("g/summary.json");
    assert_eq!(found["thetas_deg"], serde_json::json!([50.0, 70.0]));
    assert_eq!(found["phis_deg"], serde_json::json!([210.0]));
    let picture = "--size 16x12 --samples 4 --view-theta 30";
    let text = run(format!(
        "render t.asc {picture} --sun-elevation 40 --sun-azimuth 300 -o a.exr"
    ));
    run(format!(
        "render t.asc {picture} --sun-theta 50 --sun-phi 210 -o b.exr"
    ));
    let [a, b] = ["a.exr", "b.exr"].map(|file| fs::read(folder.join(file)).unwrap());
    assert!(a == b);
    assert!(unwrapped(&text).contains("its mirror image"), "{text}");
}

#[test]
fn the_sun_is_given_whole_and_alone() {
    let folder = Folder::new();
    terrain(&folder);
    let cases = "
        trace t.asc --sun-elevation 40 => sun-azimuth
        inspect t.asc --sun-azimuth 40 => sun-elevation
        render t.asc -o a.png --sun-azimuth 40 => sun-elevation
        trace t.asc --sun-elevation 40 --sun-azimuth 3 --theta 3 => excludes
        inspect t.asc --sun-elevation 40 --sun-azimuth 3 --phi 3 => goes with
        render t.asc -o a.png --sun-elevation 4 --sun-azimuth 3 --sun-phi 3 => excludes
        gonio --surface t.asc --sun-elevation 4 --sun-azimuth 3 --directions 2x2 -o g => excludes
        gonio --smoothness 3 --sun-elevation 4 --sun-azimuth 3 -o g => given surface
        trace t.asc --sun-elevation 0 --sun-azimuth 3 => above 0
        trace t.asc --sun-elevation 91 --sun-azimuth 3 => 90
        verify --sun-elevation 9 --sun-azimuth 3 -o v => not for verify
    ";
    folder.refuses(cases);
}

#[test]
fn paths_of_single_rays_are_listed_and_drawn() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    run("generate --tau 4um --smoothness 1 --size 64 -o a.exr");
    run("trace a.exr --theta 40 --rays 2e3 --paths 7 -o out");
    let read = |out: &str, file: &str| folder.join(out).text(file);
    let table = read("out", "paths.csv");
    let mut lines = table.lines();
    let header = "path,point,along,across,height,order,scatterings,end";
    assert_eq!(lines.next().unwrap(), header);
    let numbers: std::collections::BTreeSet<&str> =
        lines.map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(numbers.len(), 7);
    let columns = &json(&read("out", "summary.json"))["columns"]["paths.csv"];
    assert_eq!(columns[2]["unit"], "um");
    let figure = read("out", "paths.svg");
    figure.must_contain("Light paths on a.exr");
    figure.must_contain("height (um)");
    // Results do not depend on them, and are kept
    let bare = run("trace a.exr --theta 40 --rays 2e3 -o bare --no-plots");
    run("trace a.exr --theta 40 --rays 2e3 --paths 7 --no-plots -o out");
    assert!(!folder.join("out/paths.svg").exists() && table == read("out", "paths.csv"));
    assert_eq!(read("out", "theta.csv"), read("bare", "theta.csv"));
    assert!(!folder.join("bare/paths.csv").exists() && !bare.contains("paths.csv"));
    let said = folder.refused("trace a.exr --from below --paths 3 -o below");
    said.must_contain("follows light from above alone");
}
