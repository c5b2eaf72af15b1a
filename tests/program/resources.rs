//! What runs share with other runs, users and the system: folders, files, memory and time.

#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::Command;
use std::thread::sleep;
use std::time::{Duration, Instant};

use asperity_studies::settings::{Command as Name, settings_of};

use crate::support::{Folder, InFolder, MustContain, errors_of, files, json, with_surface};

/// A run that takes long, of the kind that keeps all for its end.
const LONG: &str = "verify --smoothness 2 --tau 4 --size 32 --insist --models none --no-plots --rays 1e12 --realisations 4";

/// Runs a command with the limits of `ulimit`.
fn limited(folder: &Path, limit: &str, line: &str) -> (Option<i32>, String) {
    let program = env!("CARGO_BIN_EXE_asperity");
    let output = Command::new("bash")
        .current_dir(folder)
        .args(["-c", &format!("ulimit {limit}; exec {program} {line}")])
        .env_remove("RUST_BACKTRACE")
        .output()
        .unwrap();
    (output.status.code(), errors_of(&output))
}

#[test]
fn a_folder_that_a_run_writes_refuses_others_by_any_name_until_that_run_is_gone() {
    let folder = Folder::new();
    let mut first = folder.begin(format!("{LONG} -o out"));
    let until = Instant::now() + Duration::from_secs(30);
    while !folder.join("out").exists() {
        assert!(Instant::now() < until, "never begun");
        sleep(Duration::from_millis(5));
    }
    sleep(Duration::from_millis(300));
    fs::create_dir(folder.join("out/cells")).unwrap();
    std::os::unix::fs::symlink("out", folder.join("link")).unwrap();
    folder.succeed("generate --size 32 --insist --tau 4 -o h.npy -q");
    let other_seed = format!("{LONG} --seed 2");
    for (line, out) in [
        (LONG, "out"),
        (&other_seed, "out/"),
        (LONG, "link"),
        ("gonio --theta 30 --size 32 --insist --tau 4", "out"),
        ("map --theta 30 --size 32 --insist --tau 4", "out"),
        ("converge --theta 30 --size 32 --tau 4", "out"),
        ("attenuation --size 64 --spacing 1 --tau 4", "out"),
        ("trace h.npy --spacing 1 --theta 30", "out"),
        ("inspect h.npy --spacing 1", "out"),
        ("man", "out"),
    ] {
        let line = match line {
            "man" => format!("man {out}"),
            line => format!("{line} -o {out}"),
        };
        let sentence = folder.failed(&line);
        sentence.must_contain("is being written by another run");
        assert!(first.try_wait().unwrap().is_none(), "{line}");
    }
    assert_eq!(files(&folder.join("out")), ["cells"]);
    // Folders above and inside, of which no results are its own
    let short = "verify --smoothness 2 --tau 4 --size 32 --insist --models none --no-plots --rays 1000 --realisations 2 -q";
    for other in [".", "out/cells/deep"] {
        folder.succeed(format!("{short} -o {other}"));
    }
    assert!(first.try_wait().unwrap().is_none());
    first.kill().unwrap();
    first.wait().unwrap();
    folder.succeed("verify --tau 4 --size 32 --insist --models none --no-plots --rays 1000 --realisations 2 -o out");
}

#[test]
fn a_run_without_a_folder_prints_its_results_and_writes_nothing() {
    let keep = Folder::new();
    let surface = "--tau 4 --size 32 --insist --rays 1000 --realisations 2 --theta 30";
    for (command, word) in [
        ("verify --models none", "reflected"),
        ("gonio", "theta"),
        ("map --models smith", "smith"),
    ] {
        let text = keep.succeed(format!("{command} {surface}"));
        assert!(
            text.contains(word) && !text.contains("results in"),
            "{text}"
        );
        let summary = keep.succeed(format!("{command} {surface} --json"));
        assert!(json(&summary).is_object());
    }
    assert!(files(&keep).is_empty());
}

/// Every setting that names a file, with a file of each command's that it must not replace.
#[test]
fn no_command_replaces_a_file_that_it_reads() {
    let folder = with_surface();
    fs::copy(folder.join("h.exr"), folder.join("in.exr")).unwrap();
    fs::hard_link(folder.join("in.exr"), folder.join("hard.exr")).unwrap();
    std::os::unix::fs::symlink("in.exr", folder.join("soft.exr")).unwrap();
    fs::create_dir(folder.join("sub")).unwrap();
    let before = fs::read(folder.join("in.exr")).unwrap();
    let mut walked = 0;
    for command in Name::ALL {
        for setting in settings_of(command) {
            let Some(flag) = setting.flag_name() else {
                continue;
            };
            let (value, own) = match (setting.section, setting.key) {
                ("surface", "psd" | "heights") => ("like:in.exr", ""),
                ("surface", "slopes_of") => ("in.exr", ""),
                ("medium", "bottom_surface") => ("in.exr --thickness 9", ""),
                ("measured", "file") => ("in.exr", "given"),
                _ => continue,
            };
            let run = match (command, own) {
                (_, "given") => format!("{command} in.exr"),
                (Name::Trace | Name::Render, _) => format!("{command} h.exr --{flag} {value}"),
                (Name::Model, _) => format!("{command} smith-slopes --{flag} {value}"),
                _ => format!("{command} --{flag} {value}"),
            };
            let as_file = matches!(
                command,
                Name::Generate | Name::Inspect | Name::Mesh | Name::Model | Name::Render
            );
            for out in "in.exr hard.exr soft.exr ./in.exr sub/../in.exr".split(' ') {
                let line = format!("{run} -o {out}");
                let output = folder.run(&line);
                let errors = errors_of(&output);
                assert!(!output.status.success(), "{line}");
                // Folders have no such names, and other formats other endings.
                assert!(
                    !as_file || errors.contains("in.exr") || errors.contains(".exr"),
                    "{line}: {errors}"
                );
                assert!(fs::read(folder.join("in.exr")).unwrap() == before, "{line}");
                walked += 1;
            }
        }
    }
    assert!(walked > 60, "{walked}");
}

/// Names of results that are inputs too, in the folder of an earlier run.
#[test]
fn results_that_a_run_reads_are_not_replaced_by_it() {
    let folder = Folder::new();
    let run = "verify --size 32 --insist --models none --no-plots --rays 1000 --realisations 2 --bins 6x6";
    folder.succeed(format!("{run} --tau 4 -o q"));
    let table = "wavevector,psd\n0.1,10\n1,1\n";
    for listed in ["null", "its fingerprint"] {
        folder.write("q/theta.csv", table);
        let manifest = folder.join("q/manifest.json");
        let mut found = json(&fs::read_to_string(&manifest).unwrap());
        if listed == "null" {
            found["files"]["theta.csv"] = serde_json::Value::Null;
        } else {
            found["files"]["theta.csv"] = serde_json::json!({"bytes": 27, "md5": "0"});
        }
        fs::write(&manifest, found.to_string()).unwrap();
        let output = folder.run(format!("{run} --psd q/theta.csv -o q"));
        assert!(!output.status.success(), "{listed}");
        assert_eq!(folder.text("q/theta.csv"), table);
    }
}

#[test]
fn after_a_kill_at_any_time_a_file_that_a_user_changed_is_refused() {
    let folder = Folder::new();
    let line = "gonio --smoothness 2 --size 32 --tau 4 --insist --theta 0,20 --realisations 2 --rays 4000 --bins 6x12 --no-plots -q -o g";
    let began = Instant::now();
    folder.succeed(line);
    let whole = began.elapsed();
    for step in 2..5 {
        fs::remove_dir_all(folder.join("g")).unwrap();
        let mut program = folder.begin(line);
        sleep(whole * step / 5);
        let _ = program.kill();
        program.wait().unwrap();
        let out = folder.join("g");
        let is_there = out.join("manifest.json").exists();
        if is_there {
            let manifest = out.json("manifest.json");
            for (name, content) in manifest["files"].as_object().unwrap() {
                assert!(!content.is_null() || name.starts_with("results."), "{name}");
            }
        }
        folder.succeed(line);
        let table = out.join("directions/s2_n1.5_theta0_phi0.csv");
        fs::write(&table, "note").unwrap();
        folder.failed(line).must_contain("was changed after");
        assert_eq!(fs::read_to_string(&table).unwrap(), "note");
    }
}

#[test]
fn files_beyond_the_largest_size_are_refused_and_leave_nothing() {
    let folder = with_surface();
    for (limit, line, word) in [
        (
            "-f 20",
            "generate --tau 8 --smoothness 2 --size 256 -o x.npy",
            "`x.npy`",
        ),
        ("-f 20", "mesh h.exr -o x.obj", "`x.obj`"),
        ("-f 4", "trace h.exr --theta 30 --rays 1000 -o out", "`out/"),
    ] {
        let (code, sentence) = limited(&folder, limit, line);
        assert_eq!(code, Some(1), "{sentence}");
        assert!(
            sentence.starts_with("asperity: cannot write ") && sentence.contains(word),
            "{sentence}"
        );
        assert!(
            !sentence.contains(".part") && sentence.lines().count() == 1,
            "{sentence}"
        );
        let left = files(&folder);
        assert!(!left.iter().any(|name| name.ends_with(".part")), "{left:?}");
        let _ = fs::remove_dir_all(folder.join("out"));
    }
    assert_eq!(files(&folder), ["h.exr"]);
}

#[test]
fn too_little_memory_is_told_in_one_sentence() {
    let folder = Folder::new();
    folder.succeed("generate --tau 8 --smoothness 2 --size 256 -o k.exr -q");
    let mut refused = 0;
    for kibibytes in [50_000, 60_000, 100_000, 200_000] {
        let line = "trace k.exr --theta 30 --rays 20000 --threads 2 -q -o o";
        let (code, sentence) = limited(&folder, &format!("-v {kibibytes}"), line);
        if code == Some(0) {
            continue;
        }
        refused += 1;
        assert_eq!(code, Some(1), "{kibibytes}: {sentence}");
        assert!(
            sentence.starts_with("asperity: ") && sentence.lines().count() == 1,
            "{sentence}"
        );
        assert!(!files(&folder).iter().any(|name| name.ends_with(".part")));
    }
    assert!(refused > 0);
}

#[test]
fn a_reader_says_in_its_own_words_that_a_limit_leaves_too_little_memory() {
    let folder = Folder::new();
    let fields = "{'descr': '<f8', 'fortran_order': False, 'shape': (8000, 8000), }";
    let mut header = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    header.extend(format!("{fields:<117}\n").into_bytes());
    folder.write("big.npy", header);
    let file = fs::File::options().write(true).open(folder.join("big.npy"));
    file.unwrap().set_len(128 + 8 * 8000 * 8000).unwrap();
    let (code, sentence) = limited(&folder, "-v 300000", "inspect big.npy --threads 1");
    assert_eq!(code, Some(1), "{sentence}");
    let words = "`big.npy` holds 8000 x 8000 samples (columns x rows), for which there is not enough memory";
    sentence.must_contain(words);
}

#[test]
fn finished_files_of_a_set_stay_after_an_interrupt_and_the_same_command_goes_on() {
    let folder = Folder::new();
    let line = "generate --tau 8 --smoothness 2 --size 256 --realisations 1000 -o set";
    let interrupted_at = |name: &str| {
        let program = folder.begin(line);
        let until = Instant::now() + Duration::from_secs(60);
        while !folder.join("set").join(name).exists() {
            assert!(Instant::now() < until, "{name}");
            sleep(Duration::from_millis(5));
        }
        let id = program.id().to_string();
        Command::new("kill").args(["-INT", &id]).status().unwrap();
        let output = program.wait_with_output().unwrap();
        let errors = errors_of(&output);
        assert_eq!(output.status.code(), Some(3), "{errors}");
        assert!(errors.contains("of 1000 files are written, and the same command resumes"));
        let manifest = folder.text("set/manifest.json");
        let manifest = json(&manifest);
        assert_eq!(manifest["complete"], false);
        let listed = manifest["files"].as_object().unwrap().keys().cloned();
        let listed: Vec<String> = ["manifest.json".to_owned()]
            .into_iter()
            .chain(listed)
            .collect();
        assert_eq!(files(&folder.join("set")), listed);
        errors
    };
    let written = || {
        fs::metadata(folder.join("set/surface_000.exr"))
            .unwrap()
            .modified()
            .unwrap()
    };
    interrupted_at("surface_001.exr");
    let first = written();
    let errors = interrupted_at("surface_005.exr");
    errors.must_contain("files of an earlier run with these settings are kept");
    assert_eq!(written(), first);

    // Meshes go on as well, but not with those of other inputs or settings.
    let mesh = "mesh set/surface_000.exr set/surface_001.exr -o meshes";
    let run = |line: &str| errors_of(&folder.run(line));
    assert_eq!(run(mesh), "");
    let bytes = || fs::read(folder.join("meshes/surface_001.ply")).unwrap();
    let whole = bytes();
    fs::remove_file(folder.join("meshes/surface_001.ply")).unwrap();
    assert!(run(mesh).contains("1 file of an earlier run"));
    assert!(bytes() == whole);
    assert_eq!(run(&format!("{mesh} --cells smooth")), "");
    fs::copy(
        folder.join("set/surface_002.exr"),
        folder.join("set/surface_001.exr"),
    )
    .unwrap();
    assert_eq!(run(mesh), "");
    assert!(bytes() != whole);
}

#[test]
fn a_run_that_fails_leaves_no_folder_behind() {
    let folder = Folder::new();
    for line in [
        "generate --tau 8 --smoothness 2 --size 64 -o new/deep/a.x3p",
        "generate --tau 8 --smoothness 2 --size 64 --realisations 2 --format x3p -o set/deep",
    ] {
        let output = folder.run(line);
        assert!(!output.status.success(), "{line}");
        assert!(files(&folder).is_empty(), "{line}: {:?}", files(&folder));
    }
}

#[test]
fn comparisons_with_models_end_with_the_time_of_the_run() {
    let keep = Folder::new();
    let line = "verify --size 32 --tau 4 --insist --no-plots --realisations 2 --rays 200 --smoothness 1,2,3,4,5,6,7,8,9,10 --theta 0,10,20,30,40,50,60,70 --eta 1.5,2 -o o --max-time 2s";
    let began = Instant::now();
    let output = keep.run(line);
    assert!(output.status.success(), "{}", errors_of(&output));
    assert!(errors_of(&output).contains("the time is over"));
    assert!(
        began.elapsed() < Duration::from_secs(9),
        "{:?}",
        began.elapsed()
    );
    let report = keep.text("o/report.txt");
    let report = report.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(report.contains("ended before the case was compared with models"));
}

#[test]
fn figures_that_there_is_no_time_for_are_left_out_and_counted() {
    let folder = Folder::new();
    let line = "verify --size 32 --tau 4 --insist --models none --realisations 2 --rays 200 --smoothness 1,2,3,4,5,6,7,8,9,10 --theta 0,10,20,30,40,50,60,70 --eta 1.5,2 -o o --threads 1 --max-time 0.1";
    // The first runs may end before all is traced
    let is_undrawn = (0..50).any(|_| {
        let began = Instant::now();
        let output = folder.run(line);
        let errors = errors_of(&output);
        let is_in_time = began.elapsed() < Duration::from_secs(9);
        assert!(output.status.success() && is_in_time, "{errors}");
        errors.contains(" figures are not drawn, and the same command resumes")
    });
    assert!(is_undrawn);
}

#[test]
fn an_estimator_that_needs_known_slopes_is_refused_before_slopes_are_measured() {
    let folder = Folder::new();
    let cases = "
        verify --repose 1 --slip-steps 100000 --estimator controlled -o o => needs the distribution of slopes
        gonio --repose 1 --slip-steps 100000 --estimator controlled -o o => needs the distribution of slopes
        converge --repose 1 --slip-steps 100000 --estimators controlled -o o => needs the distribution of slopes
    ";
    folder.refuses(cases);
}

/// Runs whose first direction, cell or group of rays takes far longer than their time.
#[test]
fn every_command_ends_soon_after_its_time_limit() {
    let folder = with_surface();
    let random =
        "--rays 1e12 --theta 0,30,60 --size 64 --tau 4 --insist --realisations 2 --no-plots";
    let steep = "--smoothness 0.001 --insist --tau 8 --size 128 --no-plots --rays 1e8";
    for line in [
        format!("gonio {random} -o g"),
        format!("map {random} --models smith -o m"),
        format!("verify {random} --models none -o v"),
        format!("verify {steep} --models none -o s"),
        "verify --size 4096 --tau 16 --theta 10 --models none --no-plots -o l".to_owned(),
        "trace h.exr --theta 30 --rays 1e12 --no-plots -o t".to_owned(),
        "render h.exr --size 64x48 --samples 1e9 -o r.exr".to_owned(),
    ] {
        let began = Instant::now();
        let output = folder.run(format!("{line} --max-time 1s"));
        let (seconds, errors) = (began.elapsed().as_secs_f64(), errors_of(&output));
        println!("{seconds:.2} s: {line}: {errors}");
        // Half a second to finish what is under way, and what a busy machine takes; without a limit most of these runs take hours
        assert!(seconds < 20.0, "{line}: {seconds} s");
        errors.must_contain("the time is over");
        let has_results = !errors.contains("stopped before");
        assert_eq!(
            output.status.code(),
            Some(i32::from(!has_results)),
            "{errors}"
        );
    }
}

/// Rays among the peaks of very steep surfaces take long.
#[test]
fn the_first_interrupt_ends_rays_under_way() {
    let keep = Folder::new();
    let line = "verify --smoothness 0.001 --insist --tau 8 --size 128 --no-plots --rays 1e8 --models none -o s";
    let program = keep.begin(line);
    sleep(Duration::from_millis(1500));
    let began = Instant::now();
    let id = program.id().to_string();
    Command::new("kill").args(["-INT", &id]).status().unwrap();
    let output = program.wait_with_output().unwrap();
    assert!(
        matches!(output.status.code(), Some(1 | 3)),
        "{}",
        output.status
    );
    assert!(
        began.elapsed() < Duration::from_secs(5),
        "{:?}",
        began.elapsed()
    );
}

#[test]
fn lists_and_widths_beyond_what_ends_are_refused_at_once() {
    let keep = Folder::new();
    let numbers = |from: f64| {
        let values = (0..200).map(|i| (from + 0.01 * f64::from(i)).to_string());
        values.collect::<Vec<_>>().join(",")
    };
    let (smoothness, theta) = (numbers(1.0), numbers(0.0));
    let line = format!("map --smoothness {smoothness} --theta {theta} -o o");
    let sentence = keep.refused(&line);
    sentence.must_contain("40000 cases");
    sentence.must_contain("20000");
    for structure in [
        "pits",
        "cracks",
        "pyramids",
        "scratches --scratch-length 16",
    ] {
        let line = format!(
            "generate --structure {structure} --size 48 --tau 4 --sigma 0.1 --insist --width 1e12 -o s.npy"
        );
        keep.refused(&line).must_contain("take a width of at most");
    }
    for eta in ["1e-3", "1e-5"] {
        let line = format!("verify --size 32 --tau 4 --insist --eta {eta} -o o");
        keep.refused(&line).must_contain("from 0.01");
    }
}
