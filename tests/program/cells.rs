//! Surfaces of smooth cells.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, errors_of, files, json, rows, with_surface};

const VERIFY: &str = "verify --tau 4 --size 32 --spacing 1 --smoothness 1 --eta 1/1.5 --theta 20 --realisations 4 --rays 2e4 --bins 6x4 --models smith";
const TRACE: &str = "trace h.exr --eta 1.5 --theta 30 --bins 6x4";

/// The contents of all tables of a folder.
fn tables(folder: &Path) -> Vec<(String, String)> {
    let names = files(folder).into_iter();
    let names = names.filter(|name| name.ends_with(".csv"));
    let read = |name: String| {
        let text = folder.text(&name);
        (name, text)
    };
    names.map(read).collect()
}

/// Runs a command line with one thread and with two, and returns its summary.
fn run_with_threads(folder: &Path, line: &str) -> serde_json::Value {
    for threads in [1, 2] {
        let out = format!("{line} --threads {threads} -o out{threads}");
        folder.succeed(&out);
    }
    let [one, two] = [1, 2].map(|threads| tables(&folder.join(format!("out{threads}"))));
    assert!(!one.is_empty() && one == two, "{line}: other bytes");
    folder.json("out1/summary.json")
}

#[test]
fn smooth_cells_are_traced_with_all_energy_and_the_same_bytes_on_any_number_of_threads() {
    let folder = with_surface();
    for (line, config) in [
        (VERIFY, "/config/verify/surface/cells"),
        (TRACE, "/config/cells"),
    ] {
        let rays = if line == TRACE { " --rays 5e4" } else { "" };
        let flat = run_with_threads(&folder, &format!("{line}{rays} --cells flat"));
        let smooth = run_with_threads(&folder, &format!("{line}{rays} --cells smooth"));
        assert_eq!(flat.pointer(config).unwrap(), "flat");
        assert_eq!(smooth.pointer(config).unwrap(), "smooth");
        assert_ne!(flat["energy"], smooth["energy"]);
        let energy = |name: &str| smooth["energy"][name]["mean"].as_f64().unwrap();
        let sum: f64 = ["reflected", "transmitted", "absorbed", "truncated", "lost"]
            .map(energy)
            .iter()
            .sum();
        assert!((sum - 1.0).abs() < 1e-12, "{line}: {sum}");
        assert_eq!(energy("lost"), 0.0);
        assert!(energy("reflected") > 0.0 && energy("transmitted") > 0.0);
        let said = serde_json::to_string(&smooth["error_budget"]).unwrap();
        let mesh = ["per correlation length", "spline through the heights"];
        assert!(mesh.iter().any(|mesh| said.contains(mesh)), "{said}");
        let map = fs::metadata(folder.join("out1/height_map.png")).unwrap();
        assert!(map.len() > 1000);
        for threads in [1, 2] {
            fs::remove_dir_all(folder.join(format!("out{threads}"))).unwrap();
        }
    }
}

#[test]
fn reports_say_that_cells_are_smooth() {
    let folder = with_surface();
    let verify = folder.succeed(format!("{VERIFY} --cells smooth -o out"));
    verify.must_contain("cells are smooth");
    assert!(!verify.contains("mesh is 3"), "{verify}");
    let trace = folder.succeed(format!("{TRACE} --rays 1e4 --cells smooth"));
    trace.must_contain("spline through the heights given is the surface");
}

#[test]
fn stopped_runs_of_smooth_cells_resume_to_the_same_bytes_and_not_with_flat_ones() {
    let folder = with_surface();
    let long = VERIFY.replace(
        "--realisations 4 --rays 2e4",
        "--realisations 400 --rays 8e5",
    );
    for line in [format!("{TRACE} --rays 4e6"), long] {
        let line = format!("{line} --no-plots --cells smooth");
        folder.succeed(format!("{line} -o whole"));
        let stopped = folder.run(format!("{line} --max-time 0.05 -o part"));
        assert!(stopped.status.success());
        assert!(folder.join("part/results.npz").exists(), "{line}");
        let flat = line.replace("--cells smooth", "--cells flat");
        let said = folder.failed(format!("{flat} -o part"));
        assert!(
            ["another run", "\"smooth\"", "\"flat\""]
                .iter()
                .all(|part| said.contains(part)),
            "{said}"
        );
        let resumed = folder.run(format!("{line} -o part"));
        let errors = errors_of(&resumed);
        assert!(errors.starts_with("resumed"), "{errors}");
        assert!(
            tables(&folder.join("part")) == tables(&folder.join("whole")),
            "{line}"
        );
        for out in ["part", "whole"] {
            fs::remove_dir_all(folder.join(out)).unwrap();
        }
    }
}

#[test]
fn directions_of_gonio_and_cells_of_map_have_smooth_cells() {
    let folder = with_surface();
    let small =
        "--tau 4 --size 32 --spacing 1 --smoothness 1 --realisations 2 --rays 2e3 --theta 20";
    let given = "--surface h.exr --rays 2e3 --theta 20 --phi 0,90";
    for (line, table) in [
        (format!("map {small} --models smith"), "map.csv"),
        (format!("gonio {small}"), "gonio.csv"),
        (format!("gonio {given}"), "gonio.csv"),
    ] {
        let reflected = |cells: &str| {
            folder.succeed(format!(
                "{line} --bins 6x4 --no-plots --cells {cells} -o {cells}"
            ));
            let text = folder.join(cells).text(table);
            fs::remove_dir_all(folder.join(cells)).unwrap();
            text
        };
        assert_ne!(reflected("flat"), reflected("smooth"), "{line}");
    }
}

#[test]
fn smooth_cells_take_coarser_grids_than_flat_ones() {
    let keep = Folder::new();
    let verify = VERIFY.replace("--tau 4", "--tau 2.5");
    let said = keep.refused(format!("{verify} --cells flat -o out"));
    said.must_contain("2.50 spacings");
    // Smooth cells are the default.
    keep.succeed(format!("{verify} -o out"));
    let verify = verify.replace("--tau 2.5", "--tau 2.4");
    let said = keep.refused(format!("{verify} --cells smooth -o no"));
    said.must_contain("2.40 spacings");
}

/// Cells and grid of random surfaces follow from the correlation length; those of given surfaces are facets.
#[test]
fn cells_are_smooth_where_surfaces_are_drawn_and_flat_where_they_are_given() {
    let folder = with_surface();
    let small = "verify --tau 2 --rays 1e3 --realisations 2 --models none --bins 6x4 --no-plots";
    for (flags, size, cells) in [
        ("", 128, "cells are smooth"),
        (" --cells smooth", 128, "cells are smooth"),
        (" --cells flat", 512, "cells are flat"),
        (" --size 160 --cells flat", 160, "cells are flat"),
    ] {
        let text = folder.succeed(format!("{small}{flags} -o out"));
        let said = format!("2 surfaces of {size} x {size}");
        text.must_contain(&said);
        text.must_contain(cells);
    }
    let energy = |cells: &str| {
        let line = format!("{TRACE} --rays 1e3 --json{cells}");
        let summary: serde_json::Value = serde_json::from_str(&folder.succeed(&line)).unwrap();
        summary["energy"].clone()
    };
    assert_eq!(energy(""), energy(" --cells flat"));
    assert_eq!(energy(""), energy(" --cells auto"));
    assert_ne!(energy(""), energy(" --cells smooth"));
}

/// Facets of tau = 8 spacings lack `d^2 / (2 tau^2)` of the slope variance, 0.8 %; a spline lacks none of it.
#[test]
fn inspect_says_that_cells_are_flat_and_compares_smooth_ones() {
    let folder = with_surface();
    let text = folder.succeed("inspect h.exr");
    text.must_contain("flat cells by default");
    let text = folder.succeed("inspect h.exr --cells smooth");
    text.must_contain("samples, flat cells  smooth cells");

    let inspected = |flags: &str| json(&folder.succeed(format!("inspect h.exr --json{flags}")));
    let (flat, smooth) = (inspected(""), inspected(" --cells smooth"));
    assert_eq!(
        (&flat["cells"], &smooth["cells"]),
        (&"flat".into(), &"smooth".into())
    );
    assert!(flat["smooth"].is_null() && flat["slope_variance"] == smooth["slope_variance"]);
    for axis in [0, 1] {
        let variance = |of: &serde_json::Value| of["slope_variance"][axis].as_f64().unwrap();
        let more = variance(&smooth["smooth"]) / variance(&smooth) - 1.0;
        assert!((0.006..0.010).contains(&more), "{more}");
    }
}

#[test]
fn what_smooth_cells_cannot_do_is_refused() {
    let folder = with_surface();
    folder.succeed("mesh h.exr -o h.ply");
    folder.write("c.toml", "[surface]\ncells = \"smooth\"\n");
    folder.write("bad.toml", "[surface]\ncells = \"round\"\n");
    let cases = "
        trace h.exr --refine => --refine: a spline through given heights is the surface itself
        trace h.exr --estimator controlled => these cells are smooth, so take auto or plain
        trace h.ply => h.ply: --cells smooth is for height maps
        gonio --surface h.ply -o out => h.ply: --cells smooth is for height maps
        trace h.exr --accelerator flat => the accelerator flat is for flat surfaces
        verify --accelerator flat -o out => accelerator flat: it is for flat surfaces
        render h.ply -o out.png => h.ply: --cells smooth is for height maps
        render h.exr -o out.png --mean-free-path 2 --albedo 0.9 --thickness 99 --bottom-surface h.ply => h.ply: --cells smooth is for height maps
        mesh h.ply -o out.ply => h.ply: this is a triangle mesh, where a height map is needed
        generate -o out.exr => --cells is for inspect, mesh, trace, render, verify, map, gonio and attenuation
        attenuation --demarcation -o out => --demarcation needs horizons, which are those of flat cells
        attenuation --tau 0.1 -o out => 2.00 spacings
        converge -o out => --cells is for inspect, mesh, trace, render, verify, map, gonio and attenuation
    ";
    for [line, expected] in rows(cases) {
        let said = folder.refused(format!("{line} --cells smooth"));
        said.must_contain(expected);
    }
    let said = folder.refused("converge c.toml -o out");
    said.must_contain(
        "surface.cells is for inspect, mesh, trace, render, verify, map, gonio and attenuation",
    );
    let said = folder.refused("trace bad.toml");
    said.must_contain("flat");
    said.must_contain("smooth");
    assert!(!folder.join("out").exists() && !folder.join("out.ply").exists());
}
