//! The program as its users meet it: files in, files and sentences out.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, errors_of, json, unwrapped, with_surface};

#[test]
fn generate_then_inspect_shows_requested_and_realised_statistics() {
    let folder = with_surface();
    let text = folder.succeed("inspect h.exr");
    for word in [
        "Sq",
        "Sdq",
        "Ssk",
        "Sku",
        "exp(-r^2 / tau^2)",
        "requested",
        "realised",
    ] {
        assert!(text.contains(word), "{word} is missing in\n{text}");
    }
    let report = json(&folder.succeed("inspect h.exr --json"));
    assert_eq!(report["realised"]["sigma"]["requested"], 4.0);
    let realised = report["realised"]["sigma"]["realised"].as_f64().unwrap();
    let scatter = report["realised"]["sigma"]["expected_deviation"]
        .as_f64()
        .unwrap();
    assert!(
        (realised - 4.0).abs() < 4.0 * scatter,
        "{realised} +- {scatter}"
    );
}

#[test]
fn every_format_that_is_written_and_read_holds_the_same_surface() {
    let folder = with_surface();
    for name in ["a.npy", "a.gsf", "a.exr"] {
        folder.succeed(format!("inspect h.exr -o {name}"));
        let sq = |file: &str| {
            let text = folder.succeed(format!("inspect {file} --border periodic --json"));
            json(&text)["sq"].as_f64().unwrap()
        };
        assert!((sq(name) / sq("h.exr") - 1.0).abs() < 1e-6, "{name}");
    }
    let metres = "--tau 8e-6 --smoothness 2 --size 64 --spacing 1e-6";
    let rest = "--unit m --seed 7 -o m.x3p";
    folder.succeed(format!("generate {metres} {rest}"));
    let report = json(&folder.succeed("inspect m.x3p --json"));
    assert_eq!(report["unit"], "m");
}

#[test]
fn the_accelerator_changes_no_byte_and_is_told() {
    let folder = with_surface();
    let light = "--theta 60 --eta 1.5 --rays 5000 --no-plots";
    for name in ["mesh", "tiles", "pyramid", "auto"] {
        let rest = format!("--accelerator {name} -o {name}");
        folder.succeed(format!("trace h.exr {light} {rest}"));
        let read = |name: &str| fs::read(folder.join(name).join("histogram.csv")).unwrap();
        assert!(read(name) == read("mesh"), "{name}");
        let text = folder.join(name).text("summary.json");
        let work = &json(&text)["work"];
        // `tiles` is an old name.
        let expected = if name == "mesh" { "mesh" } else { "pyramid" };
        assert_eq!(work["accelerator"], expected);
        assert_eq!(work["instructions"].is_null(), expected != "pyramid");
        assert!(work["segments_skipped"].as_u64() >= work["segments_skipped_nearby"].as_u64());
    }
    let sentence = folder.refused(format!("trace h.exr --accelerator flat {light}"));
    sentence.must_contain("flat");
    let flat = folder.succeed(format!("trace --flat --json {light}"));
    assert_eq!(json(&flat)["work"]["accelerator"], "flat");
}

#[test]
fn same_seed_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    let surface = "--tau 8 --smoothness 2 --size 128,96 --seed 3";
    for threads in ["1", "2", "3"] {
        let name = format!("h{threads}.npy");
        let rest = format!("-o {name} --threads {threads}");
        folder.succeed(format!("generate {surface} {rest}"));
        let out = format!("t{threads}");
        let rest = format!("--theta 40 --rays 3e4 -o {out} --threads {threads}");
        folder.succeed(format!("trace h1.npy {rest}"));
        let out = format!("v{threads}");
        let rays = "--size 128 --tau 8 --realisations 7 --rays 2e4 --model-rays 1e4";
        let rest = format!("-o {out} --threads {threads}");
        folder.succeed(format!("verify {rays} {rest}"));
    }
    let same = |name: &str| {
        let read = |threads: &str| fs::read(folder.join(name.replace('#', threads))).unwrap();
        assert!(
            read("1") == read("2") && read("1") == read("3"),
            "{name} differs"
        );
    };
    same("h#.npy");
    for result in "histogram.csv theta.csv in_plane.csv lobes.svg lobes.png".split(' ') {
        same(&format!("t#/{result}"));
        same(&format!("v#/{result}"));
    }
    same("v#/comparison.csv");
    same("v#/report.txt");
}

#[test]
fn trace_writes_what_it_says() {
    let folder = with_surface();
    let text = folder.succeed("trace h.exr --eta 1.5 --theta 30 --rays 2e4 -o out");
    text.must_contain("reflected");
    text.must_contain("ray blocks");
    let out = folder.join("out");
    for name in "summary.json histogram.csv in_plane.csv theta.csv height_map.svg".split(' ') {
        assert!(out.join(name).exists(), "{name}");
    }
    for name in "lobes in_plane_reflected in_plane_transmitted height_map".split(' ') {
        let png = fs::read(out.join(format!("{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG"));
        out.text(format!("{name}.svg")).must_contain("<svg");
    }
    let summary = out.json("summary.json");
    assert_eq!(summary["schema"], 2);
    assert_eq!(summary["command"], "trace");
    let energy = |name: &str| summary["energy"][name]["mean"].as_f64().unwrap();
    let names = ["reflected", "transmitted", "absorbed", "truncated", "lost"];
    assert!((names.map(energy).iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert_eq!(energy("lost"), 0.0);
    for key in [
        "realisations",
        "rays",
        "segments",
        "segments_skipped",
        "accelerator",
        "estimator",
        "generate_seconds",
        "build_seconds",
        "trace_seconds",
        "seconds",
        "threads",
    ] {
        assert!(!summary["work"][key].is_null(), "{key}");
    }
    assert_eq!(summary["orders"]["reflected"][0]["order"], 1);
    assert_eq!(summary["paths"][0]["events"], "T");

    // The histogram holds the energies, 18 x 36 bins per side.
    let table = out.text("histogram.csv");
    let header = "side,theta_min_deg,theta_max_deg,phi_min_deg,phi_max_deg,solid_angle_sr,flux,flux_se,intensity,bsdf,bsdf_se";
    assert!(table.starts_with(header));
    let mut sums = [0.0, 0.0];
    let mut rays = 0;
    for line in table.lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let number = |i: usize| fields[i].parse::<f64>().unwrap();
        let transmitted = fields[0] == "transmitted";
        rays += fields[11].parse::<u64>().unwrap();
        sums[usize::from(transmitted)] += number(6);
        assert_eq!(transmitted, number(1) >= 90.0);
        let cos = 0.5 * (number(1).to_radians().cos() + number(2).to_radians().cos());
        assert!((number(9) * cos.abs() - number(8)).abs() < 1e-9 * number(8).max(1e-3));
        assert!((number(8) * number(5) - number(6)).abs() < 1e-12);
    }
    assert_eq!(table.lines().count(), 1 + 2 * 18 * 36);
    // Every incident ray leaves at least once, and splits into few.
    let traced = summary["work"]["rays"].as_u64().unwrap();
    assert!(rays >= traced && rays < 5 * traced, "{rays} of {traced}");
    assert!((sums[0] - energy("reflected")).abs() < 1e-12);
    assert!((sums[1] - energy("transmitted")).abs() < 1e-12);
}

#[test]
fn a_side_that_is_not_recorded_is_left_out_of_every_file() {
    let folder = with_surface();
    let fixed = "trace h.exr --theta 40 --rays 2e4 --max-order 1 --roulette 0.1 --estimator plain";
    folder.succeed(format!("{fixed} -o both"));
    for (side, other) in [("reflected", "transmitted"), ("transmitted", "reflected")] {
        let text = folder.succeed(format!("{fixed} --side {side} -o {side}"));
        text.must_contain("not recorded");
        assert!(!text.contains(&format!("  {other} ")), "{text}");
        let out = folder.join(side);
        // What is requested is the same to the byte as in a run that asks for both sides.
        for name in ["histogram.csv", "theta.csv", "in_plane.csv"] {
            let found = out.text(name);
            let both = fs::read_to_string(folder.join("both").join(name)).unwrap();
            let expected: String = both
                .lines()
                .filter(|line| !line.starts_with(other))
                .map(|line| format!("{line}\n"))
                .collect();
            assert!(found == expected, "{side} {name}");
        }
        let [one, both] = [&out, &folder.join("both")].map(|folder| {
            let text = folder.text("summary.json");
            json(&text)
        });
        assert_eq!(one["energy"][side], both["energy"][side]);
        assert_eq!(one["orders"][side], both["orders"][side]);
        assert!(one["energy"].as_object().unwrap()[other].is_null());
        assert!(one["orders"].as_object().unwrap()[other].is_null());
        let paths = one["paths"].as_array().unwrap();
        assert!(paths.iter().all(|path| path["side"] == side), "{paths:?}");
        let mean = |key: &str| one["energy"][key]["mean"].as_f64().unwrap();
        assert!(mean("not_recorded") > 0.01 && mean("not_recorded") <= mean("truncated") + 0.01);
        assert!((mean(side) + mean("truncated") - 1.0).abs() < 1e-12);
        assert!(one["work"]["branches_not_recorded"].as_u64().unwrap() > 1000);
        assert_eq!(both["work"]["branches_not_recorded"], 0);
        assert_eq!(both["energy"]["not_recorded"]["mean"], 0.0);
        assert_eq!(one["config"]["side"], side);

        let in_plane = |side: &str| out.join(format!("in_plane_{side}.svg"));
        assert!(in_plane(side).exists() && !in_plane(other).exists());
        let lobes = out.text("lobes.svg");
        assert!(lobes.contains(&format!("{other} light not recorded")));
    }
    let mirror = "--material mirror --side reflected -o mirror";
    folder.succeed(format!("{fixed} {mirror}"));
}

#[test]
fn under_a_control_a_side_is_the_same_but_for_rounding_whatever_else_is_asked_for() {
    let folder = with_surface();
    let fixed = "trace h.exr --theta 40 --rays 2e4 --estimator controlled --no-plots";
    let fluxes = |side: &str| -> Vec<f64> {
        folder.succeed(format!("{fixed} --side {side} -o {side}"));
        let table = folder.join(side).text("histogram.csv");
        let rows = table.lines().filter(|line| line.starts_with("transmitted"));
        rows.map(|line| line.split(',').nth(6).unwrap().parse().unwrap())
            .collect()
    };
    let (both, one) = (fluxes("both"), fluxes("transmitted"));
    assert_eq!(both.len(), 18 * 36);
    // The budget closes by what is missing of one, a sum over all that leaves.
    for (both, one) in both.iter().zip(&one) {
        assert!((both - one).abs() < 1e-14, "{both} {one}");
    }
}

#[test]
fn flat_surface_reflects_by_fresnel() {
    let folder = Folder::new();
    let summary = json(&folder.succeed("trace --flat --eta 1.5 --theta 0 --rays 100 --json"));
    let reflected = summary["energy"]["reflected"]["mean"].as_f64().unwrap();
    assert!((reflected - 0.04).abs() < 1e-15);
    let summary = json(&folder.succeed("trace --flat --eta 1 --theta 60 --rays 100 --json"));
    assert_eq!(summary["energy"]["transmitted"]["mean"], 1.0);
}

#[test]
fn mirror_conductor_and_light_from_below_are_traced() {
    let folder = with_surface();
    let energy = |flags: &str| {
        let fixed = "trace h.exr --theta 50 --rays 5e3 --json";
        let summary = json(&folder.succeed(format!("{fixed} {flags}")));
        ["reflected", "transmitted", "absorbed"]
            .map(|name| summary["energy"][name]["mean"].as_f64().unwrap())
    };
    let [r, t, a] = energy("--material mirror");
    assert!((r - 1.0).abs() < 1e-12 && t == 0.0 && a == 0.0);
    let [r, t, a] = energy("--material conductor --eta 0.21 --kappa 3.272");
    assert!(r > 0.8 && t == 0.0 && a > 0.01);
    let [r, t, _] = energy("--eta 1/1.5 --from below");
    assert!(r > 0.3 && t > 0.2, "{r} {t}");
    let [picked, ..] = energy("--eta 1/1.5 --from below --branching pick");
    assert!((picked - r).abs() < 0.05);
}

#[test]
fn mesh_writes_each_format() {
    let folder = with_surface();
    for (name, start) in [("m.ply", "ply\n"), ("m.obj", ""), ("m.stl", "")] {
        let text = folder.succeed(format!("mesh h.exr -o {name}"));
        text.must_contain("4225 vertices, 8192 triangles");
        assert!(
            fs::read(folder.join(name))
                .unwrap()
                .starts_with(start.as_bytes())
        );
    }
}

#[test]
fn model_prints_its_bsdf_in_the_plane_of_incidence_and_over_the_sphere() {
    let folder = Folder::new();
    let fixed = "model smith --smoothness 3 --eta 1.4 --theta 30";
    let text = folder.succeed(format!("{fixed} --step 10"));
    assert!(text.starts_with("side,theta_deg,phi_deg,bsdf\n"));
    // 17 directions a side, from -80 to 80 deg.
    assert_eq!(text.lines().count(), 1 + 34);
    folder.succeed(format!("{fixed} --step 10 --sphere -o m.csv"));
    let table = folder.text("m.csv");
    assert_eq!(table.lines().count(), 1 + 2 * 9 * 36);
    for (line, expected) in [
        ("model walter --smoothness 3 --theta 0", "xu-sun"),
        (&format!("{fixed} --step 0"), "--step"),
        ("model smith --smoothness 3 --eta 1 --theta 3", "delta"),
    ] {
        folder.refused(line).must_contain(expected);
    }
}

#[test]
fn spacing_and_unit_come_from_the_file_or_from_flags() {
    let folder = with_surface();
    let half = "--tau 4 --smoothness 2 --size 64 --spacing 0.5 --unit um";
    let text = folder.succeed(format!("generate --seed 1 -o a.npy {half}"));
    assert!(
        unwrapped(&text).contains("--spacing 0.5,0.5 --assume-unit um --border periodic"),
        "{text}"
    );
    folder.succeed(format!("generate --seed 1 -o a.exr {half}"));
    let sdq = |arguments: &str| {
        let text = folder.succeed(format!("inspect --json {arguments}"));
        json(&text)["sdq"].as_f64().unwrap()
    };
    let told = sdq("a.npy --spacing 0.5 --assume-unit um --border periodic");
    assert!((told / sdq("a.exr") - 1.0).abs() < 1e-6);
    folder.succeed("inspect a.npy").must_contain("1 is assumed");
    assert!(!folder.succeed("inspect a.exr").contains("assumed"));
}

/// Values of a surface in metres leave little room for their meanings, and means are rounded as they deserve.
#[test]
fn a_table_of_parameters_is_printed_once_whatever_its_values() {
    let folder = Folder::new();
    folder.succeed("generate --tau 8um --sigma 1um --size 64 -o a.x3p -q --insist");
    let text = folder.succeed("inspect a.x3p");
    assert_eq!(text.matches("\nSq ").count(), 1, "{text}");
    assert!(
        text.lines().all(|line| line.chars().count() <= 80),
        "{text}"
    );
    text.must_contain("mean                 0 m  ");
    text.must_contain("slope mean x, y      0, 0  ");
}

/// The unit of a terrain or a list of points is not known, and the extent of a GSF file may be left out.
#[test]
fn what_a_height_map_does_not_state_is_told() {
    let folder = Folder::new();
    let terrain = "ncols 3\nnrows 2\ncellsize 10\n1 2 3\n2 4 7\n";
    folder.write("a.asc", terrain);
    folder.write("a.xyz", "0 0 1\n1 0 2\n0 1 4\n1 1 2\n");
    let mut gsf = b"Gwyddion Simple Field 1.0\nXRes = 4\nYRes = 2\n".to_vec();
    gsf.resize((gsf.len() / 4 + 1) * 4 + 4 * 8, 0);
    folder.write("a.gsf", gsf);
    let notes = |line: &str| unwrapped(&folder.succeed(format!("inspect {line}")));
    let unknown = "note: the file states no unit: x, y and heights are taken to be in one";
    for name in ["a.asc", "a.xyz"] {
        assert!(notes(name).contains(unknown), "{name}");
        assert!(!notes(&format!("{name} --assume-unit m")).contains("no unit"));
        let said = folder.refused(format!("inspect {name} --unit um"));
        said.must_contain("the file states no unit, so that its lengths cannot be");
    }
    let spacing = "note: the file has no spacing: 0.25 x 0.5 is assumed; set it with --spacing";
    assert!(notes("a.gsf").contains(spacing), "{}", notes("a.gsf"));
    assert!(!notes("a.gsf --spacing 1").contains("assumed"));
}

#[test]
fn measured_files_go_through_every_command() {
    let measured = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data/measured");
    if !measured.exists() {
        println!("skipped: {} is not there", measured.display());
        return;
    }
    let folder = Folder::new();
    for (name, sq, border) in [
        ("profilometer-650x650.x3p", 77e-9, "mirrored"),
        ("interferometer-650x650.asc", 0.24e-6, "open"),
    ] {
        let file = measured.join(name).to_str().unwrap().to_owned();
        let reading = format!("--remove parabola --border {border}");
        let report = json(&folder.succeed(format!("inspect {file} --json --plot h.png {reading}")));
        let found = report["sq"].as_f64().unwrap();
        assert!((found / sq - 1.0).abs() < 0.02, "{name}: Sq {found}");
        folder
            .succeed(format!("mesh {file} -o m.stl {reading}"))
            .must_contain("842402 triangles");
        let trace = format!("trace {file} --theta 60 --rays 2e4 -o out --json");
        let summary = json(&folder.succeed(format!("{trace} {reading}")));
        assert_eq!(summary["energy"]["lost"]["mean"], 0.0);
        assert!(folder.join("out/height_map.png").exists());
    }
}

#[test]
fn tall_surface_and_grazing_light_lose_nothing() {
    let folder = Folder::new();
    let surface = "--tau 8 --smoothness 0.25 --size 96 --seed 1";
    folder.succeed(format!("generate {surface} -o tall.npy"));
    let trace = "trace tall.npy --border periodic --theta 89.9 --rays 2e4 --json";
    let summary = json(&folder.succeed(trace));
    assert_eq!(summary["energy"]["lost"]["mean"], 0.0);
    assert!(
        summary["energy"]["truncated"]["mean"]
            .as_f64()
            .unwrap()
            .abs()
            < 1e-3
    );
}

#[test]
fn quiet_says_nothing_and_help_names_every_command() {
    let folder = with_surface();
    for quiet in [
        "generate --tau 8 --smoothness 2 --size 64 --seed 1 -o g.npy",
        "mesh h.exr -o m.ply",
        "inspect h.exr",
        "trace h.exr --theta 3 --rays 64",
        "verify --tau 8 --size 64 --realisations 2 --rays 128 --no-plots -o v",
    ] {
        assert!(folder.succeed(format!("{quiet} --quiet")).is_empty());
    }
    let help = folder.succeed("--help");
    for command in ["generate", "inspect", "mesh", "trace", "verify", "model"] {
        assert!(help.contains(command));
    }
    let verbose = folder.run("trace h.exr --theta 3 --rays 1e3 -v");
    assert!(errors_of(&verbose).contains("traced in"));
}

/// Names of other programs and slips of the pen are answered with the name here.
#[test]
fn refusals_suggest_the_name_that_is_likely_meant() {
    let folder = with_surface();
    fs::create_dir(folder.join("results")).unwrap();
    folder.write("bare.toml", "tau = 8\n");
    folder.write("key.toml", "[surface]\nangle = 3\n");
    folder.write("section.toml", "[source]\ntheta = 3\n");
    let slopes = "[surface]\nslopes = \"ggx\"\nggx_alpha = 0.2\n";
    folder.write("ggx.toml", slopes);
    let models = "[material]\neta = 1\n[compare]\nmodels = [\"smith\"]\n";
    folder.write("models.toml", models);
    let cases = "
        trce => unknown command `trce`; did you mean trace? The commands
        verify --n 1.5 => --n; did you mean --eta?
        verify --angle 30 => --angle; did you mean --theta?
        verify --ior 1.5 => --ior; did you mean --eta?
        verify --max-bounces 3 => did you mean --max-order?
        verify --material metal -o q => did you mean conductor?
        verify --slopes gauss -o q => did you mean gaussian?
        verify --models smiht -o q => unknown model `smiht`; did you mean smith? The models
        model trowbridge-reitz => did you mean ggx?
        model walter => did you mean ggx-separable?
        model beckmann => did you mean smith?
        model cook-torrance => did you mean v-cavity?
        verify bare.toml -o q => bare.toml: line 1: `tau` stands in no section; it is a key of [surface]
        verify key.toml -o q => `angle` in [surface]; its name may be theta of [light]
        verify section.toml -o q => unknown section `source`; did you mean light?
        verify models.toml -o q => models.toml: line 4: the model smith: eta is 1
        verify --eta 1 -o q => xu-sun is compared with by default
        trace results => `results` is a folder
        trace h.exr --theta 0,30 => for several use `asperity gonio --surface FILE`
        trace h.exr --bottom-surface smae --thickness 9 --scattering 1 => did you mean same?
    ";
    folder.refuses(cases);
    // Where flags replace surfaces of a file, a note says so
    let small = "--size 64 --tau 4 --smoothness 3 --models none --realisations 2 --rays 200 --no-plots -o q";
    let run = folder.run(format!("verify ggx.toml {small}"));
    assert!(run.status.success(), "{}", errors_of(&run));
    let note = "line 2: slopes = \"ggx\" does not hold, since --smoothness 3 replaces it";
    assert!(errors_of(&run).contains(note), "{}", errors_of(&run));
    // Folders of files are made, as those of results are
    folder.succeed("mesh h.exr -o made/below/h.ply");
    let list = json(&folder.succeed("model --list --json"));
    assert!(
        list.as_array()
            .unwrap()
            .iter()
            .any(|one| one["name"] == "heitz-ggx")
    );
    folder.succeed("inspect h.exr -o statistics.v1");
    assert!(folder.join("statistics.v1/summary.json").exists());
}
