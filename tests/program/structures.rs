//! Structured surfaces: settings, refusals, and what is read back.

use serde_json::Value;

use crate::support::{Folder, InFolder, MustContain, json, rows, unwrapped};

/// Report of `inspect` on the surface that `generate` writes with these flags.
fn generated(folder: &std::path::Path, flags: &str) -> Value {
    let written = json(&folder.succeed(format!("generate {flags} --size 128 --json -o a.exr")));
    let read = json(&folder.succeed("inspect a.exr --json"));
    let of = |value: &Value| value["realised_structure"].clone();
    assert_eq!(
        of(&written)["mean_square_slope"]["expected"],
        of(&read)["mean_square_slope"]["expected"],
        "{flags}"
    );
    of(&read)
}

/// Vertical light leaves facets at 54.74 degrees downwards, so that none is reflected once: not from the recipe, not from the file, and not from
/// the meshes of a refinement. Without the file's record of how it was drawn, cells are split across ridges.
#[test]
fn pyramids_are_split_along_their_ridges_and_read_back_so() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    let lattice = "--structure pyramids --arrangement lattice --width 16 --size 32 --spacing 1";
    run(&format!("generate {lattice} -o p.exr"));
    let told = unwrapped(&run(&format!("generate {lattice} -o p.npy")));
    told.must_contain("split along the same one");
    let angle = |file: &str| {
        json(&run(&format!("inspect {file} --json")))["steepest"]["angle_degrees"].clone()
    };
    assert!((angle("p.exr").as_f64().unwrap() - 54.7356).abs() < 1e-4);
    assert!(angle("p.npy").as_f64().unwrap() > 60.0);
    let light = "--theta 0 --models none --rays 2e3";
    let on_ridges = unwrapped(&run(&format!("trace p.exr {light}")));
    on_ridges.must_contain("reflected by order 2:");
    // The mirror image has the same light, and its file keeps the cells, as it does without the record of how it was drawn
    run("inspect p.exr --flip -o flipped.exr");
    run("inspect p.exr --remove plane -o level.exr");
    for file in [
        "p.exr --flip",
        "flipped.exr",
        "level.exr",
        "p.exr --l-filter 32",
        "p.exr --repose 80",
    ] {
        let told = unwrapped(&run(&format!("trace {file} {light}")));
        assert!(!told.contains("reflected by order 1:"), "{file}: {told}");
    }
    run(&format!("generate {lattice} -o p.gsf"));
    let told = unwrapped(&run(&format!("trace p.gsf {light}")));
    told.must_contain("does not keep along which diagonals");
    let across = unwrapped(&run(&format!("trace p.npy --border periodic {light}")));
    across.must_contain("reflected by order 1:");
    for output in ["v", "refined --refine"] {
        let line = format!("verify {lattice} {light} --realisations 2 --no-plots -o {output}");
        let told = unwrapped(&run(&line));
        told.must_contain("reflected single 0 ");
        assert!(!told.contains("cut across"), "{told}");
    }
    let told = folder.refused(format!("trace p.exr {light} --refine"));
    told.must_contain("edges have no spectrum");
    // A record of pyramids that do not fit the tile
    let mut file = std::fs::read(folder.join("p.exr")).unwrap();
    let width = br#""width":16.0"#;
    let at = file.windows(width.len()).position(|part| part == width);
    file[at.unwrap()..][..width.len()].copy_from_slice(br#""width":13.0"#);
    folder.write("p.exr", file);
    let told = folder.failed("inspect p.exr");
    told.must_contain("p.exr");
    told.must_contain("the surface cannot be what its record says: ");
    let caps = "--structure caps --width 16 --size 32x28 --spacing 1";
    let told = unwrapped(&run(&format!(
        "verify {caps} {light} --realisations 2 --no-plots -o c"
    )));
    told.must_contain("facets cut across edges or curves");
}

/// Each setting changes what is drawn; statistics expected of the structure come back from the file.
#[test]
fn settings_of_structures_are_drawn_and_read_back() {
    let folder = Folder::new();
    let of = |flags: &str, name: &str| {
        let found = generated(&folder, flags);
        ["expected", "realised"].map(|part| found[name][part].as_f64())
    };
    // 2 depth / width = 3/4
    let grooves = "--structure v-grooves --depth 6 --width 16";
    assert_eq!(
        of(grooves, "mean_square_slope"),
        [Some(0.5625), Some(0.5625)]
    );
    assert_eq!(of(grooves, "depth"), [Some(6.0), Some(6.0)]);
    let [_, rounded] = of(&format!("{grooves} --edge-radius 3"), "mean_square_slope");
    assert!(rounded.unwrap() < 0.5);
    let [_, azimuth] = of(&format!("{grooves} --azimuth 90"), "azimuth_degrees");
    assert!((azimuth.unwrap() - 90.0).abs() < 1e-9);
    // Heights of sigma / tau = 1/8 add 4 / 64
    let [with, _] = of(&format!("{grooves} --sigma 1 --tau 8"), "mean_square_slope");
    assert!((with.unwrap() - 0.625).abs() < 1e-12);
    let pits = "--structure pits --width 12 --depth 3 --arrangement separate --density 0.2";
    let [expected, realised] = of(pits, "coverage").map(Option::unwrap);
    // 128^2 0.2 / (36 pi) is 28.97, which becomes 29
    assert!((expected - 29.0 * 36.0 * std::f64::consts::PI / 16384.0).abs() < 1e-12);
    assert!((realised / expected - 1.0).abs() < 0.05);
    let scratches = "--structure scratches --width 6 --depth 1 --scratch-length 50";
    let [along, _] = of(scratches, "coverage").map(Option::unwrap);
    let [less, _] = of(&format!("{scratches} --density 0.1"), "coverage").map(Option::unwrap);
    assert!(less < 0.3 * along);
    let heights = |flags: &str| {
        generated(&folder, flags);
        std::fs::read(folder.join("a.exr")).unwrap()
    };
    let spread = heights(&format!("{scratches} --spread 40"));
    assert!(spread != heights(scratches));
    let pyramids = "--structure inverted-pyramids --randomness";
    assert!(heights(&format!("{pyramids} 0.5")) != heights(&format!("{pyramids} 0.1")));
}

/// Statistics without a number are left out or said, and never infinite.
#[test]
fn statistics_without_a_number_are_left_out() {
    let folder = Folder::new();
    let hemispheres = "--structure pits --width 16 --depth 8 --arrangement separate";
    let found = generated(&folder, hemispheres);
    assert_eq!(found["has_vertical_edges"], true);
    assert!(found["mean_square_slope"]["expected"].is_null());
    let text = folder.succeed("inspect a.exr");
    assert!(
        text.contains("edges are vertical") && !text.contains("inf "),
        "{text}"
    );
    let shallow = generated(
        &folder,
        "--structure pits --width 16 --depth 6 --arrangement separate",
    );
    assert!(shallow["has_vertical_edges"].is_null());
    // Of touching pyramids the samples on shared edges lie in the plane
    let pyramids = "--structure inverted-pyramids --density";
    assert!(generated(&folder, &format!("{pyramids} 1"))["coverage"].is_null());
    assert!(generated(&folder, &format!("{pyramids} 0.5"))["coverage"].is_object());
}

#[test]
fn structures_that_cannot_be_drawn_get_one_sentence() {
    let folder = Folder::new();
    let cases = "
        --structure sponge => must be pits, caps,
        --depth 3 => --depth 3 needs --structure
        --structure v-grooves --density 0.5 => goes with structure pits, caps, scratches, cracks, pyramids or inverted-pyramids, not v-grooves
        --structure cracks --randomness 0.5 => --randomness 0.5: goes with structure pits, caps,
        --structure pits --depth 9 => above 0, up to 8
        --structure pits --smoothness 3 => excludes
        --structure pits --tau-y 3 => with --structure pits needs --sigma
        --structure pits --tau 4 => with --structure pits needs --sigma
        --structure pits --azimuth 60 => no direction
        --structure pits --sigma 1 --tau 4 --azimuth 60 => no direction
        --azimuth 60 => no direction
        --structure sine-grooves --edge-radius 1 => or cracks, not sine-grooves
        --structure blazed-grooves --depth 9 => the depth of blazed grooves is 9
        --structure pits --sigma 1 --heights gaussian => --heights gaussian: goes with surfaces without a structure
        --structure pits --sigma 1 --slopes ggx => --slopes ggx: goes with surfaces without a structure
        --structure v-grooves --width 100 => take a side of 200
        --structure caps --width 3 => with --insist
    ";
    for [flags, expected] in rows(cases) {
        let said = folder.refused(format!("generate {flags} --size 256 -o a.exr"));
        said.must_contain(expected);
    }
}

/// Roughness on top has a correlation length by default, and with a direction it gives one to the surface.
#[test]
fn roughness_on_top_of_a_structure_needs_its_height_alone() {
    let folder = Folder::new();
    for flags in ["--sigma 0.1", "--sigma 0.1 --tau 4 --tau-y 8 --azimuth 60"] {
        folder.succeed(format!(
            "generate --structure pits --size 256 {flags} -o a.exr"
        ));
    }
}

/// V grooves of mirrors at 45 degrees send vertical light back after two reflections, in every surface of the run.
#[test]
fn structures_are_traced_in_verify_and_gonio() {
    let folder = Folder::new();
    let grooves =
        "--structure v-grooves --depth 8 --material mirror --realisations 2 --rays 2e3 --no-plots";
    let line = format!("verify {grooves} --theta 0 --models none --json -o out");
    let summary = json(&folder.succeed(&line));
    assert_eq!(summary["work"]["estimator"], "plain");
    assert_eq!(summary["paths"][0]["events"], "RR");
    assert!((summary["paths"][0]["mean"].as_f64().unwrap() - 1.0).abs() < 1e-12);
    let line = "gonio --structure sine-grooves --width 16 --spacing 0.5 --realisations 2 --rays 2e3 --directions 2x2 --no-plots --json -o bsdf";
    let summary = json(&folder.succeed(line)).to_string();
    summary.must_contain("\"structure\":\"sine-grooves\"");
}

/// A plane of pits: slipping flattens their walls, and etching lowers all and widens the pits.
#[test]
fn height_maps_are_eroded_by_inspect() {
    let folder = Folder::new();
    folder.succeed("generate --structure pits --depth 7 --size 128 --unit um -o a.exr");
    let of = |flags: &str| json(&folder.succeed(format!("inspect a.exr --json{flags}")));
    let number = |value: &Value, name: &str| value[name].as_f64().unwrap();
    let before = of("");
    let slipped = of(" --repose 20 --slip-steps 3000");
    // Facets have the slope of repose along x, y and one diagonal, up to sqrt 2 of it along the other: 27.2 degrees
    let [steep, less] = [&before, &slipped].map(|r| number(&r["steepest"], "angle_degrees"));
    assert!(steep > 60.0 && less < 28.0, "{steep} {less}");
    assert!(slipped["realised_structure"].is_null());
    let etched = of(" --etch 2000nm -o b.exr");
    let sinks = number(&before, "mean") - number(&etched, "mean");
    assert!(sinks > 2.0 && sinks < 4.0, "{sinks}");
    assert!(folder.join("b.exr").is_file());
    let said = |depth: &str| unwrapped(&folder.succeed(format!("inspect a.exr --etch {depth}")));
    assert!(said("0.5").contains("less than the spacing of 1 um"));
    assert!(!said("1").contains("less than the spacing"));
    for (flags, expected) in [
        ("--etch 300", "more than 64 spacings"),
        ("--slip-steps 5", "--slip-steps 5 needs --repose"),
        ("--repose 90", "from 0 to below 90"),
    ] {
        let said = folder.refused(format!("inspect a.exr {flags}"));
        said.must_contain(expected);
    }
}

#[test]
fn ensembles_of_worn_surfaces_are_those_that_inspect_writes() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    run("generate --smoothness 1 --tau 4 --size 32 --realisations 2 --format gsf -o set");
    let worn = "--repose 30 --slip-steps 200 --etch 1.5";
    for number in [0, 1] {
        run(&format!(
            "inspect set/surface_{number}.gsf {worn} -o {number}.npy"
        ));
    }
    let light = "--theta 50 --rays 2e4 --bins 6x8 --no-plots";
    run(&format!("trace 0.npy 1.npy --border periodic {light} -o a"));
    run(&format!(
        "trace set/surface_0.gsf set/surface_1.gsf {worn} {light} -o b"
    ));
    run(&format!(
        "trace set/surface_0.gsf set/surface_1.gsf {light} -o c"
    ));
    let files = "--surface set/surface_0.gsf --surface set/surface_1.gsf";
    run(&format!("gonio {files} {worn} {light} -o g"));
    let table = |out: &str| std::fs::read(folder.join(out).join("theta.csv")).unwrap();
    assert!(table("a") == table("b") && table("a") != table("c"));
    let read = |out: &str| {
        let text = std::fs::read_to_string(folder.join(out).join("summary.json"));
        json(&text.unwrap())
    };
    let (traced, measured) = (read("b"), read("g"));
    assert_eq!(traced["config"]["surface"][1]["etch"], 1.5);
    let reflected = &measured["directions"][0]["results"]["flux"]["all"]["reflected"];
    assert_eq!(reflected, &traced["energy"]["reflected"]);
}

/// Erosion is a step of the recipe: every drawn surface is worn as if it was written, and read with the same flags.
#[test]
fn eroded_random_surfaces_have_the_results_of_files_that_are_eroded_when_they_are_read() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    let recipe = "--smoothness 1 --tau 4 --size 32 --spacing 1 --realisations 2";
    let worn = "--repose 30 --slip-steps 200 --etch 1.5";
    let light = "--theta 50 --rays 2e4 --bins 6x8 --no-plots";
    let files = "set/surface_0.npy set/surface_1.npy --border periodic";
    run(&format!("generate {recipe} --format npy -o set"));
    run(&format!("generate {recipe} {worn} --format npy -o worn"));
    run(&format!("trace {files} {worn} {light} -o traced"));
    run(&format!(
        "trace worn/surface_0.npy worn/surface_1.npy --border periodic {light} -o generated"
    ));
    let random = format!("{recipe} {worn} {light} --light-azimuth fixed --no-fold");
    let report = unwrapped(&run(&format!("verify {random} --models smith -o drawn")));
    report.must_contain("cells are flat: erosion leaves");
    report.must_contain("are those before");
    run(&format!("gonio {random} -o measured"));
    let read = |out: &str| {
        let text = std::fs::read_to_string(folder.join(out).join("summary.json"));
        json(&text.unwrap())
    };
    let reflected = |out: &str| read(out)["energy"]["reflected"]["mean"].clone();
    let traced = reflected("traced");
    assert!(traced.as_f64().unwrap() > 0.01);
    assert_eq!(traced, reflected("generated"));
    assert_eq!(traced, reflected("drawn"));
    let gonio = &read("measured")["directions"][0];
    assert_eq!(traced, gonio["results"]["flux"]["all"]["reflected"]["mean"]);
    assert_eq!(read("measured")["config"]["surface"]["etch"], 1.5);
    // A file remembers it
    run(&format!(
        "generate {} {worn} -o worn.exr",
        recipe.replace(" --realisations 2", "")
    ));
    run("trace worn.exr --theta 50 --rays 200 --no-plots -o exr");
    let generated = &read("exr")["config"]["surface"]["generated"];
    assert_eq!(generated["psd"]["erosion"][0]["steps"], 200);
    // The same command takes the results that are there; another erosion replaces them
    run(&format!("verify {random} --models smith -o drawn"));
    assert_eq!(traced, reflected("drawn"));
    let other = random.replace("--etch 1.5", "--etch 2.5");
    run(&format!("verify {other} --models smith -o drawn"));
    assert_ne!(traced, reflected("drawn"));
}

#[test]
fn erosion_of_random_surfaces_is_refused_or_explained_where_it_makes_no_sense() {
    let folder = Folder::new();
    let few = "--tau 4 --size 32 --spacing 1 --realisations 2 --rays 200 --no-plots";
    for (flags, expected) in [
        ("--etch 65", "more than 64 spacings"),
        ("--slip-steps 5", "--slip-steps 5 needs --repose"),
        (
            "--repose 30 --estimator controlled",
            "not known for these surfaces",
        ),
        ("--repose 30 --spacing 2", "insist"),
    ] {
        let few = match flags.contains("--spacing") {
            true => few.replace(" --spacing 1", ""),
            false => few.to_owned(),
        };
        for command in ["verify", "gonio", "map"] {
            let line = format!("{command} {few} {flags} -o {command}");
            folder.refused(&line).must_contain(expected);
        }
    }
    let converge = format!("converge {few} --repose 30 --estimators controlled -o c");
    let line = converge
        .replace(" --rays 200 --no-plots", "")
        .replace(" --realisations 2", "");
    let said = folder.refused(&line);
    said.must_contain("not known for these surfaces");
    // Slopes are no longer GGX, so that neither are the models
    let ggx = "--slopes ggx --ggx-alpha 0.3 --tau 4 --amplitude-ratio 2 --size 64 --spacing 1";
    let line = format!("verify {ggx} --realisations 8 --rays 800 --model-rays 2e3 --etch 0.5 -o g");
    let report = unwrapped(&folder.succeed(&line));
    assert!(
        report.contains("xu-sun") && !report.contains("heitz-ggx"),
        "{report}"
    );
    report.must_contain("--etch 0.5 is less than the spacing of 1");
}
