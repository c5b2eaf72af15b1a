//! Verifications: verdicts, and the files they rest on.

use std::fs;

use crate::support::{Folder, InFolder, MustContain, files, json, unwrapped, with_surface};
use serde_json::Value;

#[test]
fn verify_judges_every_case_and_says_so() {
    let folder = Folder::new();
    let config = "
        [surface]
        smoothness = [1, 3]
        tau = 8
        size = 128
        [material]
        eta = [1.4, \"1/1.4\"]
        [run]
        realisations = 12
        rays = 3e4
    ";
    folder.write("v.toml", config);
    let text = folder.succeed("verify v.toml --models xu-sun,smith -o out");
    text.must_contain("Single scattering, tested at level");
    let out = folder.join("out");
    let cases = [
        "s1_n0.714286_theta30",
        "s1_n1.4_theta30",
        "s3_n0.714286_theta30",
        "s3_n1.4_theta30",
    ];
    for case in cases {
        for name in "summary.json comparison.csv in_plane.csv report.txt lobes.png".split(' ') {
            assert!(out.join(case).join(name).exists(), "{case}/{name}");
        }
    }
    let summary = out.json("summary.json");
    assert_eq!(summary["cases"].as_array().unwrap().len(), 4);
    // A rough surface transmits far more than Xu and Sun's visibility lets through.
    let rough = &summary["cases"][0]["summary"]["comparison"]["models"][0];
    assert_eq!(rough["model"], "xu-sun");
    assert_eq!(rough["verdict"], "rejected");
    assert!(rough["single"]["p"].as_f64().unwrap() < 0.01);
}

#[test]
fn verdicts_rest_on_single_scattering_and_the_table_of_bins() {
    let folder = Folder::new();
    let surface = "--smoothness 1 --tau 8 --size 128 --eta 1/1.4";
    let run = "--realisations 8 --rays 2e4 --models smith --no-plots";
    let above = format!("verify -o above --json {surface} {run}");
    let summary = json(&folder.succeed(&above));
    let file = folder.json("above/summary.json");
    assert_eq!(summary["comparison"], file["comparison"]);
    let model = &summary["comparison"]["models"][0];
    let distance = |of: &str| model[of]["total_variation"].as_f64().unwrap();
    // Half of this light is scattered more than once: far from all light, near to the single part.
    assert!(distance("total") > 3.0 * distance("single"));
    let table = folder.text("above/comparison.csv");
    let recomputed: f64 = table
        .lines()
        .skip(1)
        .map(|line| {
            let field = |i: usize| line.split(',').nth(i).unwrap().parse::<f64>().unwrap();
            0.5 * (field(5) - field(7)).abs()
        })
        .sum();
    assert!((recomputed - distance("single")).abs() < 1e-12);

    // From below, statistics are the same but the rays are others.
    let below = format!("verify -o below --json --from below {surface} {run}");
    let below = json(&folder.succeed(below));
    let reflected = |summary: &Value| {
        ["mean", "se"].map(|key| summary["energy"]["reflected"][key].as_f64().unwrap())
    };
    let ([a, se_a], [b, se_b]) = (reflected(&summary), reflected(&below));
    assert_ne!(a, b);
    assert!((a - b).abs() < 4.0 * se_a.hypot(se_b), "{a} {b}");
}

#[test]
fn vertical_light_is_even_over_azimuth_and_judged_by_rings() {
    let folder = Folder::new();
    let fixed = "verify --tau 8 --size 128 --smoothness 2 --eta 1.4 --theta 0 --realisations 12 --rays 1e5 -o out";
    let text = folder.succeed(fixed);
    text.must_contain("bins in rings of 20 deviating rays");
    assert!(!text.contains(" phi "), "no azimuth is named: {text}");
    let read = |name: &str| fs::read_to_string(folder.join("out").join(name)).unwrap();
    // Bins of a ring are copies of each other, in what was found and in what is expected.
    for name in ["histogram.csv", "comparison.csv"] {
        let table = read(name);
        let rows: Vec<String> = table
            .lines()
            .skip(1)
            .map(|line| {
                let mut fields: Vec<&str> = line.split(',').collect();
                fields.drain(3..5);
                fields.join(",")
            })
            .collect();
        assert_eq!(rows.len(), 36 * 36);
        for ring in rows.chunks_exact(36) {
            assert!(ring.iter().all(|row| *row == ring[0]), "{name}: {ring:?}");
        }
    }
    // A bin of a ring with some rays holds a part of a ray.
    assert!(
        read("histogram.csv").lines().skip(1).any(|line| line
            .split(',')
            .nth(11)
            .unwrap()
            .contains('.'))
    );
    // Backward and forward in the plane of incidence are the same.
    let table = read("in_plane.csv");
    let fluxes: Vec<&str> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(4).unwrap())
        .collect();
    for side in fluxes.chunks_exact(36) {
        assert!(side.iter().eq(side.iter().rev()));
    }
    let summary = json(&read("summary.json"));
    let models = summary["comparison"]["models"].as_array().unwrap();
    for model in models {
        let scales = model["single"]["scales"].as_array().unwrap();
        let number = |scale: usize, key: &str| scales[scale][key].as_f64().unwrap();
        assert_eq!(number(0, "p"), number(1, "p"));
        assert!((number(0, "max_t") / number(1, "max_t") - 1.0).abs() < 1e-9);
    }
    // A rough surface at normal incidence: Xu and Sun lose light, and the test sees it.
    assert_eq!(models[0]["verdict"], "rejected");
}

#[test]
fn a_verification_of_one_side_judges_that_side() {
    let folder = Folder::new();
    let config = "
        [surface]
        smoothness = 1
        tau = 8
        size = 64
        [material]
        eta = 1.4
        [run]
        realisations = 10
        rays = 5e4
        side = \"transmitted\"
        [compare]
        model_rays = 1e4
    ";
    folder.write("v.toml", config);
    let text = folder.succeed("verify v.toml -o one");
    folder.succeed("verify v.toml --side both -o both");
    assert!(text.contains("transmitted single") && text.contains("not recorded"));
    assert!(!text.contains("reflected"), "{text}");
    let read = |name: &str| folder.text(name);
    // The control variate closes the budget with what was not recorded, which is summed in another order.
    let rows = |name: &str| -> Vec<Vec<String>> {
        let text = read(name);
        let rows = text.lines().filter(|line| !line.starts_with("reflected"));
        rows.map(|row| row.split(',').map(str::to_owned).collect())
            .collect()
    };
    for name in ["histogram.csv", "theta.csv", "in_plane.csv"] {
        let [one, both] = ["one", "both"].map(|run| rows(&format!("{run}/{name}")));
        assert_eq!(one.len(), both.len(), "{name}");
        for (one, both) in one.iter().flatten().zip(both.iter().flatten()) {
            let is_near = match (one.parse::<f64>(), both.parse::<f64>()) {
                (Ok(one), Ok(both)) => (one - both).abs() <= 1e-12 * (1.0 + both.abs()),
                _ => one == both,
            };
            assert!(is_near, "{name}: {one} {both}");
        }
    }
    for side in ["transmitted", "both"] {
        let run =
            format!("verify v.toml --estimator plain --no-plots --side {side} -o plain_{side}");
        folder.succeed(&run);
    }
    for name in "comparison.csv histogram.csv theta.csv in_plane.csv".split(' ') {
        let [one, both] = ["transmitted", "both"].map(|side| rows(&format!("plain_{side}/{name}")));
        assert!(one == both, "{name}");
    }
    let [one, both] = ["one", "both"].map(|run| json(&read(&format!("{run}/summary.json"))));
    for model in 0..3 {
        let [one, both] = [&one, &both].map(|run| &run["comparison"]["models"][model]);
        assert!(one["reflected"].is_null() && both["reflected"].is_f64());
        assert_eq!(one["transmitted"], both["transmitted"]);
        // The other side adds its own deviation.
        let distance = |of: &Value| of["single"]["total_variation"].as_f64().unwrap();
        assert!(distance(one) < distance(both));
        let tested = |of: &Value| of["single"]["bins_tested"].as_u64().unwrap();
        assert!(tested(one) <= 648 && tested(one) < tested(both));
        let scales = one["single"]["scales"].as_array().unwrap();
        assert!(scales[2]["name"] == "sides" && scales[2]["member"] == 0);
    }
    assert!(!folder.join("one/in_plane_reflected.svg").exists());
    let many = "verify v.toml --theta 0,60 --side reflected -o many";
    assert!(!folder.succeed(many).contains("transmitted"));
}

#[test]
fn the_overview_of_several_cases_names_case_and_model_in_every_row() {
    let folder = Folder::new();
    let run = "verify --tau 8 --size 64 --smoothness 1 --realisations 6 --rays 6e3 --no-plots --theta 0,30";
    let overview = |models: &str| {
        let line = format!("{run} --models {models} -o {models}");
        let text = folder.succeed(&line);
        let from = text.find("\ncase ").map(|start| text[start..].to_owned());
        let from = from.unwrap_or_default();
        // The cases follow
        let end = from.find("\ns = 1, n = 1.5, theta = 0 deg\n");
        from[..end.unwrap_or(from.len())].to_owned()
    };
    let text = overview("smith,heitz");
    text.must_contain("multiple flux");
    let lines = || text.lines().filter(|line| !line.is_empty());
    let heads = lines().filter(|line| line.starts_with("case "));
    assert!(heads.clone().count() > 1, "{text}");
    for head in heads {
        head.must_contain("model");
        head.must_contain("light");
    }
    for row in lines().filter(|line| line.starts_with("s = 1, ")) {
        assert!(row.contains("smith") || row.contains("heitz"), "{row}");
    }
    // Without models there is nothing to give an overview of.
    assert_eq!(overview("none"), "");
}

#[test]
fn a_run_that_ends_paths_says_which_orders_it_shows() {
    let folder = Folder::new();
    let fixed = "verify --tau 8 --size 64 --smoothness 1 --realisations 6 --rays 6e3 --models smith -o out --max-order";
    for (max_order, orders) in [
        ("1", "single scattering"),
        ("2", "orders up to 2"),
        ("1000", "all orders"),
    ] {
        let text = folder.succeed(format!("{fixed} {max_order}"));
        let distance = format!("total variation from {orders} ");
        text.must_contain(&distance);
        let ended = text.contains(&format!("{orders} only; further paths are truncated"));
        assert_eq!(ended, max_order != "1000", "{text}");
        for plot in ["lobes.svg", "in_plane_reflected.svg"] {
            let plot = fs::read_to_string(folder.join("out").join(plot)).unwrap();
            assert!(plot.contains(&format!("explicit, {orders}")), "{max_order}");
            assert_eq!(plot.contains("all orders"), max_order == "1000");
        }
    }
}

#[test]
fn a_new_run_leaves_nothing_of_an_old_one_in_its_folder() {
    let folder = Folder::new();
    let fixed = "verify --tau 8 --size 64 --realisations 6 --rays 6e3 -o out";
    folder.succeed(fixed);
    folder.write("out/notes.txt", "mine");
    folder.succeed(format!("{fixed} --models none --no-plots"));
    let expected = [
        "appearance.csv",
        "histogram.csv",
        "in_plane.csv",
        "manifest.json",
        "notes.txt",
        "report.txt",
        "results.npz",
        "summary.json",
        "theta.csv",
    ];
    assert_eq!(files(&folder.join("out")), expected);
}

#[test]
fn verify_with_one_surface_takes_its_errors_from_ray_blocks() {
    let folder = Folder::new();
    let fixed = "verify --tau 8 --size 64 --realisations 1 --rays 1e4";
    let text = folder.succeed(format!("{fixed} --no-plots -o out"));
    text.must_contain("ray blocks");
    text.must_contain("not resolved");
}

/// Columns of a table by name, as numbers; `None` where a field is empty.
fn column(table: &str, name: &str) -> Vec<Option<f64>> {
    let at = |line: &str| line.split(',').position(|field| field == name);
    let i = at(table.lines().next().unwrap()).unwrap_or_else(|| panic!("no column {name}"));
    let field = |line: &str| line.split(',').nth(i).unwrap().parse().ok();
    table.lines().skip(1).map(field).collect()
}

#[test]
fn every_result_says_where_its_error_comes_from() {
    let folder = Folder::new();
    let fixed = "verify --cells flat --tau 8 --spacing 1 --size 64 --smoothness 3 --realisations 6 --rays 2e4 --models none --no-plots --json -o out --estimator";
    for (estimator, refine) in [
        ("plain", false),
        ("controlled", false),
        ("controlled", true),
    ] {
        let flags = if refine { "--refine" } else { "" };
        let summary = json(&folder.succeed(format!("{fixed} {estimator} {flags}")));
        let budget = &summary["error_budget"];
        let of = |part: &str| budget["reflected"][part].as_f64();
        assert!(of("rays").unwrap() > 0.0 && of("total") >= of("rays"));
        // A control variate leaves nothing of the first order, so that only a finer mesh shows the rest.
        assert_eq!(of("mesh").is_some(), estimator == "plain" || refine);
        assert_eq!(of("mesh_se").is_some(), refine);
        assert_eq!(of("mesh_removed").is_some(), estimator == "controlled");
        let explanation = |part: &str| budget["explanations"][part].as_str().unwrap().to_owned();
        assert!(
            explanation("rays").contains("ray blocks")
                && explanation("surfaces").contains("0 where")
        );
        assert_eq!(
            explanation("mesh").contains("--refine"),
            !refine,
            "{}",
            explanation("mesh")
        );
        assert_eq!(budget["refinement"].is_object(), refine);
        let read = |name: &str| fs::read_to_string(folder.join("out").join(name)).unwrap();
        for name in ["histogram.csv", "theta.csv", "in_plane.csv"] {
            let table = read(name);
            let [se, rays, surfaces, mesh] =
                ["flux_se", "flux_se_rays", "flux_se_surfaces", "flux_mesh"]
                    .map(|name| column(&table, name));
            for i in 0..se.len() {
                let sampled = rays[i].unwrap().hypot(surfaces[i].unwrap());
                assert!(sampled >= se[i].unwrap() * (1.0 - 1e-12), "{name} {i}");
            }
            assert_eq!(mesh.iter().any(Option::is_some), of("mesh").is_some());
        }
        let report = read("report.txt");
        report.must_contain("between surfaces");
        assert_eq!(report.contains("removed)"), estimator == "controlled");
        if refine {
            let refinement = &budget["refinement"];
            let spacings = &refinement["spacings"];
            for (name, expected) in [("reported", 0.5), ("given", 1.0), ("coarser", 2.0)] {
                assert_eq!(spacings[name], serde_json::json!([expected, expected]));
            }
            let shift = refinement["reflected"]["given_less_reported"]["mean"].as_f64();
            assert!((shift.unwrap() / 3.0 - of("mesh").unwrap()).abs() < 1e-15);
            report.must_contain("mesh is 0.20 % below");
        }
    }
}

#[test]
fn finer_meshes_are_asked_for_where_there_are_any() {
    let folder = with_surface();
    let light = "--theta 40 --rays 5e3 --no-plots";
    let trace = |more: &str| format!("trace h.exr {light} {more}");
    for border in ["periodic", "mirrored"] {
        for (threads, out) in [("1", "one"), ("3", "three")] {
            let more = format!("--refine --border {border} --threads {threads} -o {out}");
            let text = folder.succeed(trace(&more));
            text.must_contain("between surfaces");
        }
        let read = |out: &str, name: &str| folder.join(out).text(name);
        assert!(read("one", "histogram.csv") == read("three", "histogram.csv"));
        let [one, three] = ["one", "three"].map(|out| json(&read(out, "summary.json")));
        assert_eq!(one["error_budget"], three["error_budget"]);
        let reflected = &one["error_budget"]["reflected"];
        assert!(reflected["surfaces"].is_null() && reflected["mesh"].is_f64());
        // The results are those of the finer mesh.
        folder.succeed(trace(&format!("--border {border} -o given")));
        let given = json(&read("given", "summary.json"));
        let mean = |of: &Value| of["energy"]["reflected"]["mean"].as_f64().unwrap();
        let mesh = reflected["mesh"].as_f64().unwrap();
        assert!((mean(&given) - mean(&one) - 3.0 * mesh).abs() < 1e-12);
        let explanation = given["error_budget"]["explanations"]["mesh"]
            .as_str()
            .unwrap();
        assert!(
            explanation == "not estimated: --refine traces a finer mesh",
            "{explanation}"
        );
    }
    let open = folder.refused(trace("--refine --border open"));
    open.must_contain("--refine");
    open.must_contain("open border");
    folder.succeed("mesh h.exr -o h.ply");
    let mesh = format!("trace h.ply --refine {light}");
    folder.refused(&mesh).must_contain("triangle mesh");
    folder
        .refused(format!("trace --flat --refine {light}"))
        .must_contain("--refine");
}

#[test]
fn more_rays_than_requested_are_told() {
    let folder = Folder::new();
    let surface = "--smoothness 3 --tau 4 --size 32 --no-plots";
    for (line, traced, requested) in [
        ("verify --models none --rays 10 -o v", 32, 10),
        ("gonio --theta 30 --rays 100 -o g", 256, 100),
    ] {
        let text = folder.succeed(format!("{line} {surface}"));
        let sentence = format!("{traced} rays were traced in place of {requested}");
        assert!(unwrapped(&text).contains(&sentence), "{text}");
    }
    let text = folder.succeed(format!("verify --models none --rays 4000 {surface} -o w"));
    assert!(!text.contains("in place of"), "{text}");
}
