//! Result folders through the program: what a run may replace, and what it must leave alone.

use std::fs;
use std::path::Path;

use asperity_io::read_height_map;
use asperity_results::Thumbnail;
use asperity_surface::{Border, MissingPolicy};

use crate::support::{Folder, InFolder, MustContain, files, with_surface};

/// A run of each command that writes a folder, without its output.
const RUNS: [&str; 7] = [
    "trace h.exr --theta 30 --rays 1e3 --no-plots",
    "verify --tau 4 --size 32 --realisations 2 --rays 2e3 --models smith --no-plots",
    "map --tau 4 --size 32 --theta 0 --realisations 2 --rays 2e3 --models smith --no-plots",
    "gonio --tau 4 --size 32 --theta 30 --realisations 2 --rays 2e3 --bins 6x6 --no-plots",
    "albedo --alpha 1 --cos 0.5 --realisations 2 --rays 2e3 --no-plots",
    "attenuation --tau 4 --spacing 1 --size 32 --sigma 1 --realisations 2 --theta 45 --no-plots",
    "converge --tau 4 --size 32 --rays 1e3 --surfaces 2 --repeats 1 --reference-rays 1e4 --reference-surfaces 2 --no-plots",
];

/// Names that results of some command have.
const NAMES: [&str; 13] = [
    "report.txt",
    "comparison.csv",
    "lobes.png",
    "map.csv",
    "map_own.png",
    "gonio.csv",
    "bsdf.npy",
    "albedo.exr",
    "histogram.csv",
    "attenuation.csv",
    "convergence.csv",
    "visibility.svg",
    "height_map.svg",
];

/// Names of the files of a run, sub-folders aside.
fn written(folder: &Path, run: &str) -> Vec<String> {
    folder.succeed(format!("{run} --quiet -o empty"));
    let written = files(&folder.join("empty"));
    fs::remove_dir_all(folder.join("empty")).unwrap();
    written
}

#[test]
fn files_of_the_user_survive_every_command() {
    let folder = with_surface();
    for run in RUNS {
        let written = written(&folder, run);
        let out = folder.join("out");
        fs::create_dir(&out).unwrap();
        let free = NAMES
            .into_iter()
            .filter(|name| !written.contains(&(*name).to_owned()));
        let mine: Vec<&str> = free.collect();
        for name in &mine {
            out.write(name, name);
        }
        // What is in no one's way is left alone, by the first run and by the next.
        for _ in 0..2 {
            folder.succeed(format!("{run} --quiet -o out"));
            for name in &mine {
                assert_eq!(out.text(name), *name, "{run}");
            }
        }
        fs::remove_dir_all(&out).unwrap();
        // What is in the way is named before the run begins, and left alone.
        fs::create_dir(&out).unwrap();
        let in_the_way = written.iter().find(|name| name.ends_with(".csv"));
        let in_the_way = in_the_way.unwrap_or(&written[0]);
        out.write(in_the_way, "mine");
        let said = folder.failed(format!("{run} -o out"));
        said.must_contain(in_the_way.as_str());
        assert_eq!(files(&out), [in_the_way.as_str()], "{run}");
        assert_eq!(out.text(in_the_way), "mine");
        fs::remove_dir_all(&out).unwrap();
        // So is a folder of the name of a result.
        fs::create_dir_all(out.join("summary.json")).unwrap();
        let said = folder.failed(format!("{run} -o out"));
        said.must_contain("the folder `out/summary.json`");
        assert_eq!(files(&out), ["summary.json"], "{run}");
        fs::remove_dir_all(&out).unwrap();
    }
}

/// Files that are named are checked before an input is read: here none is there, and yet it is the output that is
/// refused.
#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_work() {
    let folder = Folder::new();
    for ending in ["exr", "ply", "csv", "svg"] {
        fs::create_dir(folder.join(format!("folder.{ending}"))).unwrap();
    }
    folder.write("file", "");
    for (command, ending) in [
        ("generate --tau 8 --size 64 -o", "exr"),
        ("mesh no.exr -o", "ply"),
        ("inspect no.exr -o", "exr"),
        ("inspect no.exr --plot", "svg"),
        ("model smith -o", "csv"),
        ("render no.exr -o", "exr"),
    ] {
        for (name, expected) in [
            (format!("folder.{ending}"), "is a folder"),
            (format!("file/out.{ending}"), "`file` is a file"),
        ] {
            let line = format!("{command} {name}");
            let said = folder.failed(&line);
            let names_it = said.contains(&format!("`{name}`")) || said.contains("`file`");
            assert!(names_it && said.contains(expected), "{line}: {said}");
        }
        if cfg!(target_os = "linux") {
            let name = format!("/proc/self/out.{ending}");
            let said = folder.failed(format!("{command} {name}"));
            said.must_contain(format!("cannot write `{name}`"));
        }
    }
    #[cfg(unix)]
    {
        folder.succeed("generate --tau 8 --size 64 --quiet -o h.exr");
        let before = fs::read(folder.join("h.exr")).unwrap();
        for (command, name) in [("mesh", "link.ply"), ("inspect", "link.npy")] {
            std::os::unix::fs::symlink("h.exr", folder.join(name)).unwrap();
            let said = folder.refused(format!("{command} h.exr -o {name}"));
            said.must_contain("is the input of this command");
        }
        assert!(fs::read(folder.join("h.exr")).unwrap() == before);
    }
}

#[test]
fn an_input_is_never_replaced_or_removed() {
    let folder = with_surface();
    let matrix = "0 0.1 0 0.2\n0.3 0 0.1 0\n0 0.2 0 0.1\n0.1 0 0.3 0\n";
    // A height map under the name of a table of the run that reads it.
    folder.write("histogram.txt", matrix);
    folder.write("histogram.csv", matrix);
    let trace = |file: &str, out: &str| {
        format!("trace {file} --spacing 1 --border periodic --rays 1e3 --quiet --no-plots -o {out}")
    };
    let refuse = |file: &str, out: &str| {
        let said = folder.failed(trace(file, out));
        assert_eq!(folder.text(file), matrix);
        said
    };
    refuse("histogram.csv", ".").must_contain("histogram.csv");
    // An input that an earlier manifest lists is still an input.
    folder.succeed(trace("histogram.csv", "out"));
    folder.write("out/histogram.csv", matrix);
    let said = refuse("out/histogram.csv", "out");
    said.must_contain("is an input of this run");
    fs::remove_file(folder.join("histogram.csv")).unwrap();
    let trace = "trace histogram.txt --spacing 1 --border periodic --theta 30 --rays 1e3 --quiet --no-plots -o .";
    folder.succeed(trace);
    assert_eq!(folder.text("histogram.txt"), matrix);
}

#[test]
fn a_folder_keeps_to_one_command_and_says_what_wrote_it() {
    let folder = with_surface();
    let line = format!("{} --quiet -o out", RUNS[1]);
    folder.succeed(&line);
    let before = files(&folder.join("out"));
    let said = folder.failed(format!("{} -o out", RUNS[0]));
    said.must_contain("holds results of `verify`");
    assert_eq!(files(&folder.join("out")), before);
    let manifest = folder.json("out/manifest.json");
    assert_eq!(manifest["command"], "verify");
    let arguments: Vec<&str> = line.split(' ').collect();
    assert_eq!(manifest["arguments"], serde_json::json!(arguments));
    assert_eq!(manifest["complete"], true);
    assert!(manifest["commit"].is_string() && manifest["results_epoch"].is_u64());
    let summary = folder.json("out/summary.json");
    for key in ["version", "results_epoch", "commit"] {
        assert_eq!(summary[key], manifest[key], "{key}");
    }
    let listed: Vec<&String> = manifest["files"].as_object().unwrap().keys().collect();
    let others = before.iter().filter(|name| *name != "manifest.json");
    assert!(listed.iter().copied().eq(others), "{listed:?} {before:?}");
    // Results of a build without manifests are told apart from files of the user.
    fs::remove_file(folder.join("out/manifest.json")).unwrap();
    let said = folder.failed(format!("{} -o out", RUNS[1]));
    said.must_contain("manifest.json");
}

/// A file of the user in the place of a result is neither replaced nor removed.
#[test]
fn a_result_that_was_changed_is_refused_by_name() {
    let folder = with_surface();
    let run = "trace h.exr --theta 30 --rays 1e3 --quiet -o out";
    folder.succeed(run);
    for (name, line) in [
        ("lobes.png", format!("{run} --no-plots")),
        ("in_plane.csv", run.to_owned()),
    ] {
        let path = folder.join("out").join(name);
        fs::write(&path, "mine").unwrap();
        let said = folder.failed(&line);
        said.must_contain(name);
        said.must_contain("was changed after the `trace` run that wrote it; move it, or delete it");
        assert_eq!(fs::read_to_string(&path).unwrap(), "mine");
        fs::remove_file(&path).unwrap();
        folder.succeed(run);
        assert!(path.exists());
    }
}

/// Files of `folder` and its folders that end in `.csv`, as paths within it.
fn tables(folder: &Path) -> Vec<String> {
    let mut found = Vec::new();
    for name in files(folder) {
        if folder.join(&name).is_dir() {
            let within = tables(&folder.join(&name));
            found.extend(within.iter().map(|table| format!("{name}/{table}")));
        } else if name.ends_with(".csv") {
            found.push(name);
        }
    }
    found
}

#[test]
fn every_column_of_every_table_has_a_name_a_unit_and_a_description() {
    let folder = with_surface();
    for run in RUNS {
        let run = run.replace(
            "--realisations 2 --theta 45",
            "--realisations 2 --theta 45 --heights --demarcation",
        );
        folder.succeed(format!("{run} --quiet -o out"));
        let out = folder.join("out");
        let summary = out.json("summary.json");
        let tables = tables(&out);
        assert!(!tables.is_empty(), "{run}");
        for table in tables {
            let key = match table.strip_prefix("directions/") {
                Some(_) => "directions/*.csv",
                None => &table,
            };
            let columns = summary["columns"][key].as_array();
            let columns = columns.unwrap_or_else(|| panic!("{run}: {table} is not described"));
            let names: Vec<&str> = columns
                .iter()
                .map(|c| c["name"].as_str().unwrap())
                .collect();
            let text = out.text(&table);
            assert_eq!(
                text.lines().next().unwrap(),
                names.join(","),
                "{run}: {table}"
            );
            for column in columns {
                let unit = &column["unit"];
                assert!(unit.is_null() || unit != "", "{run}: {column}");
                assert!(
                    !column["description"].as_str().unwrap().is_empty(),
                    "{run}: {column}"
                );
                let is_angle = column["name"].as_str().unwrap().ends_with("_deg");
                assert!(!is_angle || unit == "deg", "{run}: {column}");
            }
        }
        fs::remove_dir_all(&out).unwrap();
    }
}

/// 64 x 64 and 32 x 32 samples are kept as they are, blocks of 2 x 2 samples of 512 as their means.
#[test]
fn results_have_a_thumbnail_of_the_first_surface() {
    let folder = with_surface();
    for run in RUNS {
        folder.succeed(format!("{run} --quiet -o out"));
        let found = Thumbnail::read(folder.join("out")).unwrap().unwrap();
        let [ny, nx] = found.shape;
        assert_eq!(found.heights.len(), nx * ny, "{run}");
        let is_inside = |samples: usize| (32..=256).contains(&samples);
        assert!(is_inside(nx) && is_inside(ny), "{run}");
        fs::remove_dir_all(folder.join("out")).unwrap();
    }
    let drawn = "--tau 8um --size 512 --spacing 0.5um --seed 3";
    folder.succeed(format!("generate {drawn} -o drawn.exr -q"));
    let few = "--rays 1e3 --no-plots -q";
    let verify = format!("verify {drawn} --models none --realisations 2 {few} --threads");
    for (run, file, side, extent) in [
        (format!("trace h.exr {few}"), "h.exr", 64, 64.0),
        (format!("{verify} 1"), "drawn.exr", 256, 256.0),
        (format!("{verify} 3"), "drawn.exr", 256, 256.0),
    ] {
        folder.succeed(format!("{run} -o out"));
        let found = Thumbnail::read(folder.join("out/results.npz")).unwrap();
        let found = found.unwrap();
        let raw = read_height_map(folder.join(file)).unwrap();
        let field = raw.into_height_field(MissingPolicy::Refuse, Border::Periodic);
        let field = field.unwrap();
        assert_eq!(found.shape, [side; 2]);
        assert_eq!([found.extent, field.extent()], [[extent; 2]; 2]);
        assert_eq!(found.unit, field.unit());
        let [mean, expected] = [&found.heights[..], field.heights()]
            .map(|heights| heights.iter().sum::<f64>() / heights.len() as f64);
        // Half a step of the range in each, and single precision in the file.
        let range = field
            .heights()
            .iter()
            .fold(0.0_f64, |range, h| range.max(h.abs()));
        assert!((mean - expected).abs() <= 2e-5 * range, "{mean} {expected}");
        fs::remove_dir_all(folder.join("out")).unwrap();
    }
    folder.succeed("mesh h.exr -o m.ply -q");
    folder.succeed(format!("trace m.ply --border periodic {few} -o out"));
    assert_eq!(Thumbnail::read(folder.join("out")).unwrap(), None);
}

/// Results of other settings replace those that are there: no figure of theirs stays.
#[test]
fn figures_that_a_later_run_has_no_light_for_go() {
    let folder = Folder::new();
    let run = |material: &str| {
        folder.succeed(format!(
            "verify --material {material} --size 32 --tau 4 --insist --rays 500 --realisations 2 --models none -q -o v"
        ));
        files(&folder.join("v"))
    };
    let transmitted = |names: Vec<String>| {
        let names = names.into_iter();
        names.filter(|name| name.contains("transmitted")).count()
    };
    assert_eq!(transmitted(run("dielectric")), 2);
    assert_eq!(transmitted(run("mirror")), 0);
}
