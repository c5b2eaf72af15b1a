//! Validity maps: verdicts, the files, and runs that resume.

use std::fs;
use std::path::Path;

use crate::support::{
    Folder, InFolder, MustContain, Table, assert_same_bytes, errors_of, files, json, unwrapped,
};

/// Four cells in which a model is within tolerance, beyond it and not resolved; in a fraction of a second.
const CONFIG: &str = "
    [surface]
    smoothness = [1, 100]
    tau = 4
    size = 64
    [light]
    theta = [0, 60]
    [run]
    realisations = 12
    rays = 24000
    bins = \"18x6\"
    [compare]
    models = [\"xu-sun\", \"smith\"]
";

const FILES: [&str; 9] = [
    "manifest.json",
    "map.csv",
    "map_all.png",
    "map_all.svg",
    "map_own.png",
    "map_own.svg",
    "report.txt",
    "results.npz",
    "summary.json",
];

/// A folder with the configuration.
fn with_config() -> Folder {
    let folder = Folder::new();
    folder.write("m.toml", CONFIG);
    folder
}

/// The row of one cell, model and comparison.
fn row_of(table: &Table, s: &str, theta: &str, model: &str, light: &str) -> usize {
    let wanted = [
        ("s", s),
        ("theta_deg", theta),
        ("model", model),
        ("light", light),
    ];
    let is_it = |row: &usize| wanted.iter().all(|(k, v)| table.text(*row, k) == *v);
    let mut found = (0..table.rows.len()).filter(is_it);
    let row = found.next().unwrap();
    assert!(found.next().is_none());
    row
}

fn verdict_of<'a>(table: &'a Table, s: &str, theta: &str, model: &str, light: &str) -> &'a str {
    table.text(row_of(table, s, theta, model, light), "verdict")
}

/// Nothing deviates at s = 100 and 0 degrees: single scattering is all, and every model has it. At s = 1
/// the visibility of Xu and Sun loses some 4 % of the light at 0 degrees, and more than 10 % at 60.
#[test]
fn a_map_gives_every_verdict_and_writes_its_files() {
    let folder = with_config();
    let text = folder.succeed("map m.toml -o out");
    let out = folder.join("out");
    assert_eq!(files(&out), FILES);
    let report = out.text("report.txt");
    assert_eq!(text, format!("{report}results in out\n"));
    assert!(report.contains("validity map: 4 of 4 cells; s = 1, 100; theta = 0, 60 deg"));

    let table = Table::read(&out.join("map.csv"));
    assert_eq!(table.rows.len(), 4 * 2 * 2);
    for light in ["own", "all"] {
        for model in ["xu-sun", "smith"] {
            assert_eq!(verdict_of(&table, "100", "0", model, light), "within");
        }
        for theta in ["0", "60"] {
            assert_eq!(verdict_of(&table, "1", theta, "xu-sun", light), "beyond");
        }
    }
    // Nearly flat glass: Fresnel's 4 % at 0 degrees; at 60 degrees mirror and Snell, both near the edge
    // of a bin of 5 degrees, which tells where they are.
    let number = |theta, name: &str| {
        let row = row_of(&table, "100", theta, "smith", "own");
        table.number(row, name)
    };
    assert!((number("0", "reflected_explicit") - 0.04).abs() < 1e-4);
    assert!((number("0", "transmitted_model") - 0.96).abs() < 1e-3);
    let snell = (60.0_f64.to_radians().sin() / 1.5).asin().to_degrees();
    for (name, angle) in [("reflected", 60.0), ("transmitted", snell)] {
        let peak = number("60", &format!("{name}_peak_explicit_deg"));
        assert!((peak - angle).abs() <= 2.6, "{name}: {peak}");
    }
    assert_eq!(verdict_of(&table, "100", "60", "smith", "own"), "within");
    // Light scattered more than once counts against a model of single scattering, and only over all light.
    let of = |light, name: &str| {
        let row = row_of(&table, "1", "60", "smith", light);
        table.number(row, name)
    };
    assert!(
        of("all", "total_variation_low") > 0.05,
        "{}",
        of("all", "total_variation")
    );
    assert!(of("own", "total_variation_low") < 0.05);
    for row in 0..table.rows.len() {
        let number = |name: &str| table.number(row, name);
        let [low, value, high] = [
            "total_variation_low",
            "total_variation",
            "total_variation_high",
        ]
        .map(number);
        assert!(low <= value && value < high && low >= 0.0);
        let [explicit, model, difference] = [
            "transmitted_explicit",
            "transmitted_model",
            "transmitted_difference",
        ]
        .map(number);
        assert!((explicit - model - difference).abs() < 1e-12);
        let [low, high] = ["transmitted_difference_low", "transmitted_difference_high"].map(number);
        assert!(low < difference && difference < high);
        // What leaves with more or less energy has to have moved.
        let moved = 2.0 * number("total_variation") + 1e-9;
        assert!(difference.abs() <= moved);
    }

    let summary = out.json("summary.json");
    assert_eq!(
        (&summary["schema"], &summary["command"]),
        (&2.into(), &"map".into())
    );
    assert_eq!(summary["complete"], true);
    assert_eq!(summary["cells"].as_array().unwrap().len(), 4);
    let text = out.text("summary.json");
    assert!(!text.contains("seconds") && !text.contains("threads"));
    let smith = summary["summary"]
        .as_array()
        .unwrap()
        .iter()
        .find(|s| s["model"] == "smith" && s["light"] == "own")
        .unwrap();
    assert_eq!(smith["within_from"][0][0], 0.0);
    let cells: u64 = (0..3).map(|i| smith["cells"][i].as_u64().unwrap()).sum();
    assert_eq!(cells, 4);
}

/// `--max-time` ends a run after one more surface, and the last of such runs completes the map.
#[test]
fn a_resumed_map_has_the_bytes_of_an_uninterrupted_one_on_any_number_of_threads() {
    let folder = with_config();
    folder.succeed("map m.toml --realisations 6 --threads 1 -o whole");
    let mut calls = 0;
    loop {
        calls += 1;
        let threads = ["2", "1", "3"][calls % 3];
        let line = "map m.toml --realisations 6 --max-time 1e-9 -o parts --threads";
        let output = folder.run(format!("{line} {threads}"));
        assert!(output.status.success());
        let told = errors_of(&output);
        if !told.contains("the time is over; ") {
            break;
        }
        told.must_contain("and the same command resumes");
        let report = folder.text("parts/report.txt");
        assert!(report.contains("cells were cut short") || report.contains("are missing"));
    }
    // Six surfaces of each smoothness, one per call.
    assert_eq!(calls, 2 * 6);
    // What a time was given for is the only thing that may differ, and it is not written.
    assert_same_bytes(&folder.join("whole"), &folder.join("parts"));
    // Once more, with nothing to do.
    folder.succeed("map m.toml --realisations 6 -o parts");
    assert_same_bytes(&folder.join("whole"), &folder.join("parts"));
}

#[test]
fn other_tolerances_need_no_tracing_and_change_verdicts() {
    let folder = with_config();
    folder.succeed("map m.toml --quiet --no-plots -o out");
    let cell = folder.join("out/results.npz");
    let before = fs::metadata(&cell).unwrap().modified().unwrap();
    let found = || {
        let table = Table::read(&folder.join("out/map.csv"));
        verdict_of(&table, "1", "0", "xu-sun", "own").to_owned()
    };
    assert_eq!(found(), "beyond");
    let wide = "map m.toml --quiet --no-plots --tolerance-total-variation 0.9 --tolerance-energy 0.9 --tolerance-peak 180 -o out";
    folder.succeed(wide);
    assert_eq!(found(), "within");
    let after = fs::metadata(&cell).unwrap().modified().unwrap();
    assert_eq!(before, after);
}

/// 60 rays cannot tell 1 % from nothing: even where no ray deviates, three of them may have been missed.
#[test]
fn too_small_a_budget_is_not_resolved() {
    let folder = Folder::new();
    let surfaces = "map --tau 4 --size 32 --theta 0 --models smith --no-plots --quiet --bins 6x6";
    let run = |rest: &str, out: &str| {
        folder.succeed(format!("{surfaces} {rest} -o {out}"));
        let table = Table::read(&folder.join(out).join("map.csv"));
        (table.text(0, "verdict").to_owned(), table)
    };
    let (verdict, table) = run("--smoothness 100 --rays 60 --realisations 10", "few");
    assert_eq!(verdict, "not resolved");
    let high = table.number(0, "total_variation_high");
    let rays = table.number(0, "rays");
    println!("up to {high} of {rays} rays");
    assert!(high >= 3.0 / rays);
    let (verdict, _) = run("--smoothness 100 --rays 6000 --realisations 10", "enough");
    assert_eq!(verdict, "within");
    // Fewer than eight surfaces say nothing of their scatter, however many rays.
    for surfaces in ["1", "7"] {
        let flags = format!("--smoothness 100 --rays 6000 --realisations {surfaces}");
        let (verdict, table) = run(&flags, surfaces);
        assert_eq!(verdict, "not resolved");
        assert_eq!(table.text(0, "total_variation_high"), "");
    }
    // Where a bound says that nothing can deviate, nothing needs to be traced.
    let target = "map --tau 4 --size 32 --theta 0 --models smith --no-plots --quiet --bins 6x6 --smoothness 100 --target-error 1e-3 -o bound";
    folder.succeed(target);
    let table = Table::read(&folder.join("bound/map.csv"));
    assert_eq!(verdict_of(&table, "100", "0", "smith", "own"), "within");
    assert_eq!(table.text(0, "rays"), "0");
}

/// A model of all orders has one and the same claim on its own light and on all.
#[test]
fn a_model_of_all_orders_is_the_sum_of_single_and_multiple() {
    let folder = Folder::new();
    let line = "map --tau 4 --size 64 --smoothness 1 --theta 40 --models smith,heitz --realisations 10 --rays 20000 --model-rays 20000 --bins 18x6 --no-plots --quiet -o out";
    folder.succeed(line);
    let table = Table::read(&folder.join("out/map.csv"));
    let both = ["own", "all"].map(|light| {
        let row = row_of(&table, "1", "40", "heitz", light);
        assert_eq!(table.text(row, "model_rays"), "20000");
        table.text(row, "total_variation")
    });
    assert_eq!(both[0], both[1]);
    let of = |model| -> f64 {
        let row = row_of(&table, "1", "40", model, "all");
        table.number(row, "total_variation")
    };
    assert!(
        of("heitz") < 0.7 * of("smith"),
        "{} {}",
        of("heitz"),
        of("smith")
    );
}

#[test]
fn damaged_results_are_recomputed_and_those_of_other_settings_refused() {
    let folder = with_config();
    folder.succeed("map m.toml --quiet --no-plots -o out");
    let results = folder.join("out/results.npz");
    let whole = fs::read(&results).unwrap();
    let table = fs::read(folder.join("out/map.csv")).unwrap();
    for damaged in [&b""[..], b"PK", &whole[..whole.len() / 2]] {
        fs::write(&results, damaged).unwrap();
        let output = folder.run("map m.toml --quiet --no-plots -o out");
        let told = errors_of(&output);
        assert!(output.status.success(), "{told}");
        told.must_contain("is damaged and is computed again");
        assert_eq!(fs::read(folder.join("out/map.csv")).unwrap(), table);
    }
    for (flag, what) in [
        ("--seed 99", "run.seed"),
        ("--models smith", "compare.models"),
        ("--rays 77", "run.rays"),
    ] {
        let told = folder.failed(format!("map m.toml --no-plots {flag} -o out"));
        told.must_contain("another run");
        told.must_contain(what);
        assert_eq!(fs::read(folder.join("out/map.csv")).unwrap(), table);
    }
}

#[test]
fn invalid_map_settings_are_refused() {
    let folder = with_config();
    let cases = "
        map m.toml --models none -o out => needs models
        map m.toml --models walter -o out => ggx-separable
        map m.toml --tolerance-energy 0 -o out => --tolerance-energy 0: must be a number above 0
        map m.toml --tolerance-peak nan -o out => must be a number above 0
        map m.toml --level 0.05 -o out => --level is for trace and verify, not for map
        map m.toml --theta 90 -o out => below 90
        map m.toml --tau 2 --spacing 1 -o out => --insist
        map m.toml --models cook-torrance-neumann -o out => reflect
    ";
    folder.refuses(cases);
    assert!(!folder.join("out").exists());
    folder.write("bad.toml", "[map]\nenergie = 1\n");
    let told = folder.refused("map bad.toml -o out");
    told.must_contain("energie");
    told.must_contain("line 2");
    fs::create_dir_all(folder.join("dir/cells")).unwrap();
    folder.write("dir/cells/s1_n1.5_theta0.json", "{}");
    let told = folder.failed("map m.toml -o dir");
    told.must_contain("s1_n1.5_theta0.json");
    told.must_contain("earlier version");
}

#[test]
fn the_examples_are_maps() {
    for (name, cells) in [("validity_map", 8 * 2 * 5), ("small_map", 4 * 2)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/{name}.toml"));
        let text = fs::read_to_string(path).unwrap();
        let config = asperity_studies::MapConfig::from_toml(&text).unwrap();
        assert_eq!(config.plan().unwrap().cases.len(), cells, "{name}");
    }
}

/// Heights of 0.135 um mix the phases of reflected light, and leave more than half of the transmitted light coherent; four times as high
/// ones mix both.
#[test]
fn cells_are_judged_by_the_wavelength_one_by_one() {
    let folder = Folder::new();
    let line = "map --tau 5um --sigma 0.135um,0.54um --theta 0,60 --size 32 --realisations 8 --rays 800 --models smith --no-plots";
    let report = folder.succeed(format!("{line} -o m"));
    let text = unwrapped(&report);
    text.must_contain("warning: s37.037_n1.5_theta0: up to 55.2 % of the transmitted light is coherent at 550 nm, assumed");
    text.must_contain("in 1 other cells");
    text.must_contain("geometric optics is doubtful");
    let summary = |out: &str| {
        let text = fs::read_to_string(folder.join(out).join("summary.json"));
        json(&text.unwrap())
    };
    let cells = summary("m")["cells"].clone();
    let holds = |i: usize| cells[i]["validity"]["holds"].clone();
    assert_eq!([holds(0), holds(2)], [false, true]);
    // The same results under another wavelength
    let long = folder.succeed(format!("{line} --wavelength 5um -o m"));
    assert!(unwrapped(&long).contains("at 5000 nm:"), "{long}");
    assert_eq!(summary("m")["cells"][2]["validity"]["holds"], false);
    let unknown = line.replace("um", "");
    let text = unwrapped(&folder.succeed(format!("{unknown} --wavelength 500 -o u")));
    assert!(
        text.contains("has no effect") && !text.contains("geometric optics"),
        "{text}"
    );
}
