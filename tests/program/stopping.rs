//! Runs that end at an error or at the end of their time.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, errors_of, files, json, rows, with_surface};

const SURFACES: &str = "--tau 8 --size 128 --smoothness 2 --models none --no-plots";

fn verify(flags: &str) -> String {
    format!("verify {SURFACES} {flags}")
}

#[test]
fn a_target_is_reached_with_the_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    for threads in ["1", "2"] {
        let run = "--seed 3 --target-error 1e-2 --of rings --theta 0,40";
        folder.succeed(verify(&format!("{run} -o {threads} --threads {threads}")));
    }
    let summary = |threads: &str, case: &str| {
        let file = folder.join(threads).join(case).join("summary.json");
        json(&fs::read_to_string(file).unwrap())
    };
    for case in ["s2_n1.5_theta0", "s2_n1.5_theta40"] {
        for name in ["histogram.csv", "report.txt"] {
            let read = |threads: &str| fs::read(folder.join(threads).join(case).join(name));
            assert!(read("1").unwrap() == read("2").unwrap(), "{case}/{name}");
        }
        let one = summary("1", case);
        assert_eq!(one["stopping"], summary("2", case)["stopping"]);
        let stopping = &one["stopping"];
        assert_eq!(stopping["stopped_by"], "target");
        assert_eq!(stopping["of"], "rings");
        assert!(stopping["error"].as_f64().unwrap() <= 1e-2);
        assert!(stopping["pilot"]["rays"].as_u64().unwrap() > 0);
        // Numbers that were not requested do not stand there as if they had been.
        assert!(one["config"]["verify"]["run"]["rays"].is_null());
        let report = fs::read_to_string(folder.join("1").join(case).join("report.txt")).unwrap();
        report.must_contain("error of rings");
    }
}

#[test]
fn what_is_known_is_not_traced() {
    let folder = Folder::new();
    let text = folder.succeed("verify --smoothness 100 --target-error 1e-4 --models smith -o out");
    text.must_contain("nothing was traced");
    let summary = folder.json("out/summary.json");
    assert_eq!(summary["work"]["rays"], 0);
    assert_eq!(summary["stopping"]["stopped_by"], "bound");
    assert!(summary["deviation_bound"].as_f64().unwrap() < 1e-8);
    let reflected = &summary["energy"]["reflected"];
    assert!((reflected["mean"].as_f64().unwrap() - 0.0415).abs() < 1e-4);
    assert!(reflected["se"].as_f64().unwrap() < 1e-8);
}

#[test]
fn when_the_time_is_over_results_are_valid_and_marked() {
    let folder = with_surface();
    let line = verify("--rays 1e9 --realisations 10000 -o v --max-time 0.2s");
    let text = ended_by_time(&folder, &line);
    text.must_contain("warning: the time limit ended the run");
    let trace = "trace h.exr --theta 30 --rays 4e6 --max-time 0.1 --no-plots -o t";
    let text = ended_by_time(&folder, trace);
    text.must_contain("note: the time limit ended the run");
    for out in ["v", "t"] {
        let summary = folder.join(out).json("summary.json");
        assert_eq!(summary["stopping"]["stopped_by"], "time");
        assert!(summary["warnings"].to_string().contains("time"));
        let energy = &summary["energy"];
        let sum: f64 = ["reflected", "transmitted", "absorbed", "truncated", "lost"]
            .map(|part| energy[part]["mean"].as_f64().unwrap())
            .iter()
            .sum();
        assert!((sum - 1.0).abs() < 1e-9);
        assert!(energy["reflected"]["se"].as_f64().unwrap() > 0.0);
        assert!(files(&folder.join(out)).contains(&"histogram.csv".to_owned()));
    }
}

#[test]
fn rays_on_one_surface_are_as_many_as_the_target_takes() {
    let folder = with_surface();
    let trace = "trace h.exr --theta 30 --target-error 3e-3 --of rings --json";
    let run = |threads: &'static str| {
        let text = folder.succeed(format!("{trace} --threads {threads}"));
        json(&text)
    };
    let [one, two] = [run("1"), run("2")];
    assert_eq!(one["stopping"], two["stopping"]);
    assert_eq!(one["energy"], two["energy"]);
    let stopping = &one["stopping"];
    assert_eq!(stopping["stopped_by"], "target");
    assert!(stopping["error"].as_f64().unwrap() <= 3e-3);
    assert!(one["config"]["rays"].is_null());
    // The same rays, requested by their number.
    let rays = one["work"]["rays"].to_string();
    if stopping["rounds"] == 0 {
        let plain = format!("trace h.exr --theta 30 --json --rays {rays}");
        assert_eq!(json(&folder.succeed(&plain))["energy"], one["energy"]);
    }
}

/// The choice of the pilot run is printed, and gives the same bytes when it is named.
#[test]
#[ignore = "slow: cargo test -- --ignored --skip at_full_size"]
fn a_long_run_chooses_its_branches_and_says_so() {
    let keep = Folder::new();
    let folder = keep;
    let rough = "verify --smoothness 1 --tau 4 --spacing 1 --size 32 --theta 60 --models none --no-plots --estimator plain";
    let run = |out: &str, paths: &str| {
        let text = folder.succeed(format!("{rough} --target-error 4.8e-3 -o {out}{paths}"));
        let read = |name: &str| folder.join(out).text(name);
        (text, json(&read("summary.json")), read("histogram.csv"))
    };
    let (text, summary, bins) = run("free", "");
    let settings = &summary["config"]["verify"]["run"];
    assert_eq!([&settings["branching"], &settings["roulette"]], ["auto"; 2]);
    let chosen = &summary["stopping"]["paths"];
    assert_eq!(chosen["tried"].as_array().unwrap().len(), 4, "{text}");
    for key in ["branching", "roulette"] {
        assert_eq!(summary["work"][key], chosen[key]);
    }
    assert_eq!(chosen["branching"], "pick");
    let said = "paths: pick, roulette 0.01, from above, plain (chosen by the pilot run:";
    let in_a_line = text.replace('\n', " ");
    assert!(in_a_line.contains(said), "{text}");
    let (text, _, named) = run("named", " --branching pick --roulette 0.01");
    let in_a_line = text.replace('\n', " ");
    assert!(in_a_line.contains("paths: pick") && !in_a_line.contains("chosen by"));
    assert!(named == bins, "other numbers");
}

#[test]
fn without_a_target_both_branches_are_followed() {
    let folder = with_surface();
    let energy = |paths: &str| {
        let line = format!("trace h.exr --theta 60 --rays 1000 --json{paths}");
        json(&folder.succeed(&line))["energy"].clone()
    };
    let auto = energy("");
    assert_eq!(auto, energy(" --branching split --roulette 0.01"));
    assert_eq!(auto, energy(" --branching auto --roulette auto"));
    for other in [" --branching pick", " --roulette 0.3"] {
        assert_ne!(auto, energy(other), "{other}");
    }
}

#[test]
fn bad_targets_and_times_get_a_sentence() {
    let folder = with_surface();
    let cases = "
        --target-error 0 => --target-error 0: must be
        --target-error -1 => --target-error -1: must be
        --target-error nan => nan
        --target-error 1e-3 --of ring => in-plane
        --of bins => --of bins needs --target-error
        --target-error 1e-3 --of transmitted --material mirror => nothing is transmitted
        --target-error 1e-3 --of absorbed => nothing is absorbed
        --target-error 1e-3 --of reflected --side transmitted => not recorded
        --target-error 1e-3 --rays 1e4 => --rays
        --max-time 0 => a time above 0
        --max-time -5 => a time above 0
        --max-time soon => a time above 0
    ";
    for [flags, expected] in rows(cases) {
        for command in ["trace h.exr", &verify("-o out")] {
            let sentence = folder.refused(format!("{command} {flags}"));
            sentence.must_contain(expected);
        }
    }
    let both = verify("--target-error 1e-3 --realisations 9 -o out");
    folder.refused(&both).must_contain("--realisations");
    assert!(!folder.join("out").exists());
}

#[test]
fn flags_say_whether_the_target_of_a_file_holds() {
    let folder = Folder::new();
    let text = "[surface]\ntau = 8\nsize = 128\n[run]\ntarget_error = 0.05\n[compare]\nmodels = []";
    folder.write("v.toml", text);
    let work = |flags: &str| {
        let fixed = "verify v.toml --no-plots --json -o out";
        json(&folder.succeed(format!("{fixed} {flags}")))
    };
    assert_eq!(work("")["stopping"]["target_error"], 0.05);
    let counted = work("--realisations 3 --rays 3000");
    assert_eq!(counted["work"]["realisations"], 3);
    assert!(counted["stopping"].is_null());
    folder.write("v.toml", format!("{text}\n[output]\nplots = true"));
    let text = text.replace("[run]", "[run]\nrays = 1e4");
    folder.write("v.toml", text);
    let error = folder.refused("verify v.toml -o out");
    error.must_contain("v.toml");
    error.must_contain("excludes");
}

/// Rays beyond any number that could be traced, on one surface and on each of several: what is there when the
/// time is over is written, and blocks and surfaces are small enough to end soon.
#[test]
fn endless_runs_end_when_their_time_is_over() {
    let folder = with_surface();
    let trace = "trace h.exr --theta 30 --rays 1e13 --max-time 4 --no-plots -o t";
    let target = "trace h.exr --theta 30 --target-error 1e-9 --max-time 4 --no-plots -o e";
    let several = &verify("--rays 1e13 --realisations 4 --max-time 4 -o v");
    for (out, line) in [("t", trace), ("e", target), ("v", several)] {
        ended_by_time(&folder, line);
        let summary = folder.join(out).json("summary.json");
        assert_eq!(summary["stopping"]["stopped_by"], "time");
        let rays = summary["work"]["rays"].as_u64().unwrap();
        assert!(rays > 0 && rays < 1_000_000_000, "{rays}");
        assert!(summary["energy"]["transmitted"]["se"].as_f64().unwrap() > 0.0);
    }
}

/// Sentence of a run that its time limit ended.
const TIME_IS_OVER: &str = "the time is over; the results so far are written";

/// Runs a command that its time limit must end, and returns its standard output.
fn ended_by_time(folder: &Path, line: &str) -> String {
    let output = folder.run(line);
    let errors = errors_of(&output);
    assert!(output.status.success(), "{line}: {errors}");
    assert!(
        errors.starts_with(TIME_IS_OVER) && errors.lines().count() == 1,
        "{errors}"
    );
    String::from_utf8(output.stdout).unwrap()
}

/// Runs a command, which must succeed, and returns whether it said that it resumed.
fn resumes(folder: &Path, line: &str) -> bool {
    let output = folder.run(line);
    let errors = errors_of(&output);
    assert!(output.status.success(), "{line}: {errors}");
    let resumed = errors.starts_with("resumed");
    let others = errors
        .lines()
        .filter(|line| !line.starts_with(TIME_IS_OVER));
    assert!(others.count() == usize::from(resumed), "{errors}");
    resumed
}

#[test]
fn a_stopped_trace_resumes_to_the_bytes_of_an_uninterrupted_one() {
    let folder = with_surface();
    for (effort, time) in [
        ("--rays 2e6", 0.02),
        ("--target-error 5e-6 --of reflected --refine", 1.0),
    ] {
        let flags = format!("trace h.exr --theta 30 --bins 9x4 {effort}");
        let run = |more: &str| {
            let line = format!("{flags} {more}");
            resumes(&folder, &line)
        };
        assert!(!run("-o whole"));
        assert!(!run(&format!("--max-time {time} --no-plots -o t")));
        assert!(folder.join("t/results.npz").exists());
        assert!(run(&format!("--max-time {time} --threads 1 -o t")));
        assert!(run("-o t"));
        let names = files(&folder.join("whole"));
        assert_eq!(files(&folder.join("t")), names);
        for name in names.iter().filter(|name| name.ends_with(".csv")) {
            let read = |out: &str| fs::read(folder.join(out).join(name)).unwrap();
            assert!(read("t") == read("whole"), "{name}");
        }
        let summary = |out: &str| {
            let text = folder.join(out).text("summary.json");
            let mut summary = json(&text);
            let work = summary["work"].as_object_mut().unwrap();
            work.retain(|key, _| !key.ends_with("seconds"));
            summary
        };
        assert_eq!(summary("t"), summary("whole"));
        for out in ["t", "whole"] {
            fs::remove_dir_all(folder.join(out)).unwrap();
        }
    }
}

#[test]
fn a_trace_is_not_resumed_with_other_settings_or_on_another_surface() {
    let folder = with_surface();
    let trace = "trace h.exr --theta 30 --rays 4e6 --max-time 0.02 --no-plots -o t";
    assert!(!resumes(&folder, trace));
    let left = fs::read(folder.join("t/results.npz")).unwrap();
    let other = trace.replace("--theta 30", "--theta 40");
    folder.failed(&other).must_contain("light.theta 30");
    folder.succeed("generate --tau 8 --smoothness 2 --size 64 --seed 8 -o h.exr");
    folder.failed(trace).must_contain("points.given");
    assert!(fs::read(folder.join("t/results.npz")).unwrap() == left);
}
