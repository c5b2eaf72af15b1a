//! Shards of a run: traced apart, merged to the bytes of the whole, planned, and extended.

use std::fs;
use std::path::Path;

use asperity_results::ResultSet;
use asperity_studies::SurveyedSurface;
use serde_json::Value;

use crate::support::{Folder, InFolder, MustContain, Table, files, json, unwrapped, with_surface};

/// Runs of every command that has shards, without their output.
const RUNS: [&str; 11] = [
    "verify --tau 4 --size 32 --smoothness 2,3 --theta 0,40 --realisations 6 --rays 4e3 --models smith,heitz --no-plots",
    "verify --tau 4 --size 32 --smoothness 2 --realisations 5 --rays 4e3 --refine --models smith --no-plots",
    "verify --tau 8 --size 64 --theta 50 --target-error 0.02 --of rings --models smith --no-plots",
    "map --tau 4 --size 32 --smoothness 1,2 --theta 0,30,60 --realisations 4 --rays 2e3 --models smith --no-plots",
    "gonio --tau 4 --size 32 --theta 0,30,60 --realisations 4 --rays 2e3 --bins 6x6 --no-plots",
    "gonio --surface h.exr --theta 0,40 --phi 0,90 --rays 2e4 --bins 6x6 --no-plots",
    "albedo --alpha 0.5,1 --cos 0.3,0.9 --realisations 3 --rays 2e3 --no-plots",
    "attenuation --tau 4 --spacing 1 --size 32 --sigma 1 --realisations 5 --theta 45 --no-plots",
    "trace g.exr --theta 30 --rays 4e4 --refine --models smith --no-plots",
    "trace h.exr --theta 30 --rays 2e4 --material gold --wavelength 450,550,650 --no-plots",
    "converge --tau 4 --size 32 --rays 1e3 --surfaces 2 --repeats 2 --reference-rays 1e4 --reference-surfaces 2 --no-plots",
];

/// Folders of the shards of a run.
fn traced(folder: &Folder, run: &str, of: u64) -> Vec<String> {
    let name = |number| format!("shards/{number}");
    for number in 1..=of {
        let said = folder.succeed(format!("{run} --shard {number}/{of} -o {}", name(number)));
        said.must_contain(format!("shard {number}/{of} is finished"));
        assert_eq!(
            files(&folder.join(name(number))),
            ["manifest.json", "results.npz"]
        );
    }
    // In an order of their own
    let mut names: Vec<String> = (1..=of).map(name).collect();
    names.rotate_left((of / 2) as usize);
    names.reverse();
    names
}

/// Results of a file without what depends on the machine and the moment.
fn comparable(path: &Path) -> Vec<u8> {
    match ResultSet::read(path) {
        Ok(set) => set.comparable_bytes().unwrap(),
        Err(_) => asperity_results::Container::<SurveyedSurface>::read(path)
            .unwrap()
            .comparable_bytes()
            .unwrap(),
    }
}

/// A value without times and machines.
fn without_times(mut value: Value) -> Value {
    match &mut value {
        Value::Object(map) => {
            map.retain(|key, _| {
                let is_time =
                    key.ends_with("seconds") || ["threads", "instructions"].contains(&key.as_str());
                !is_time && key != "machine"
            });
            map.values_mut()
                .for_each(|one| *one = without_times(one.take()));
        }
        Value::Array(values) => {
            values
                .iter_mut()
                .for_each(|one| *one = without_times(one.take()));
        }
        _ => {}
    }
    value
}

/// Asserts that two folders hold the same files and the same results; times and the command line may differ. Tables of `converge` are of times.
fn assert_same_results(a: &Path, b: &Path) {
    assert_eq!(files(a), files(b));
    if a.join("convergence.csv").exists() {
        return assert!(comparable(a) == comparable(b));
    }
    for name in files(a) {
        let (a, b) = (a.join(&name), b.join(&name));
        let [text_of_a, text_of_b] = [&a, &b].map(|path| fs::read(path).unwrap_or_default());
        let ending = a.extension().and_then(|ending| ending.to_str());
        if a.is_dir() {
            assert_same_results(&a, &b);
        } else if name == "results.npz" {
            assert!(comparable(&a) == comparable(&b), "{}", a.display());
        } else if ending == Some("json") && name != "manifest.json" {
            let [a, b] = [text_of_a, text_of_b]
                .map(|text| without_times(json(&String::from_utf8(text).unwrap())));
            assert!(a == b, "{name}");
        } else if name != "manifest.json" {
            assert!(text_of_a == text_of_b, "{}", a.display());
        }
    }
}

fn merged_shards_have_the_bytes_of_the_whole(divisions: &[u64]) {
    for run in RUNS {
        let folder = with_surface();
        folder.succeed("generate --tau 4 --smoothness 2 --size 64 --quiet -o g.exr");
        folder.succeed(format!("{run} --quiet -o whole"));
        for &of in divisions {
            let shards = traced(&folder, run, of).join(" ");
            folder.succeed(format!("merge {shards} --quiet -o merged"));
            println!("{run} {of}");
            assert_same_results(&folder.join("whole"), &folder.join("merged"));
            for name in ["shards", "merged"] {
                fs::remove_dir_all(folder.join(name)).unwrap();
            }
        }
    }
}

#[test]
fn merged_shards_of_every_command_have_the_bytes_of_the_whole_run() {
    merged_shards_have_the_bytes_of_the_whole(&[7]);
}

#[test]
#[ignore = "slow: cargo test -- --ignored --skip at_full_size"]
fn merged_shards_of_other_divisions_have_the_bytes_of_the_whole_run() {
    merged_shards_have_the_bytes_of_the_whole(&[1, 2, 3]);
}

#[test]
#[ignore = "full size, takes minutes: run by hand, see CONTRIBUTING.md"]
fn many_merged_shards_have_the_bytes_of_the_whole_run_at_full_size() {
    merged_shards_have_the_bytes_of_the_whole(&[64]);
}

const RUN: &str = "verify --tau 4 --size 32 --smoothness 2 --theta 0,40 --realisations 9 --rays 9e3 --models smith --no-plots";

#[test]
fn a_partial_merge_is_marked_and_merges_again_to_the_whole() {
    let folder = Folder::new();
    folder.succeed(format!("{RUN} --quiet -o whole"));
    traced(&folder, RUN, 4);
    let refused = folder.failed("merge shards/4 shards/1 -o some");
    refused.must_contain("2 shards of 4 are missing (2, 3); --partial merges the others");
    assert!(!folder.join("some").exists());
    let run = folder.run("merge shards/4 shards/1 --partial -o some");
    assert!(run.status.success());
    let told = unwrapped(&String::from_utf8_lossy(&run.stderr));
    told.must_contain("2 shards of 4 are missing (2, 3): the results are those of the others");
    let summary = json(&folder.text("some/summary.json"));
    let stopping = &summary["cases"][0]["summary"]["stopping"];
    assert_eq!(stopping["stopped_by"], "shards", "{stopping}");
    let surfaces = &summary["cases"][0]["summary"]["work"]["realisations"];
    assert!((3..=6).contains(&surfaces.as_u64().unwrap()), "{surfaces}");
    unwrapped(&folder.text("some/report.txt")).must_contain("shards of the run are missing");
    // In its own place, with more shards, and by the run itself.
    let runs = |line: &str| assert!(folder.run(line).status.success(), "{line}");
    runs("merge shards/4 shards/1 shards/2 --partial --quiet -o some");
    runs(&format!("{RUN} --quiet -o some"));
    assert_same_results(&folder.join("whole"), &folder.join("some"));
    fs::remove_dir_all(folder.join("some")).unwrap();
    runs("merge shards/4 shards/1 --partial --quiet -o some");
    // With a folder in which no shard has results yet.
    fs::create_dir(folder.join("empty")).unwrap();
    folder.failed("merge shards/1 empty -o other");
    runs("merge empty shards/1 --partial --quiet -o other");
    // With a shard twice, and with those that were missing.
    let twice = folder.failed("merge some shards/1 shards/2 shards/3 -o all");
    twice.must_contain("shard 1/4 is in");
    folder.succeed("merge shards/3 some shards/2 --quiet -o all");
    assert_same_results(&folder.join("whole"), &folder.join("all"));
}

#[test]
fn shards_that_do_not_belong_together_are_refused_by_name() {
    let folder = with_surface();
    traced(&folder, RUN, 2);
    folder.succeed(format!("{RUN} --quiet --seed 2 --shard 2/2 -o seed"));
    folder.succeed(format!("{RUN} --quiet --shard 2/3 -o three"));
    folder.succeed(format!("{RUN} --quiet -o whole"));
    let other = RUN.replace("--smoothness 2", "--smoothness 3");
    folder.succeed(format!("{other} --quiet --shard 2/2 -o smoothness"));
    folder.succeed("map --tau 4 --size 32 --theta 0 --realisations 2 --rays 2e3 --models smith --no-plots --quiet --shard 2/2 -o map");
    for (shards, reason) in [
        ("shards/1 seed", "seed 2 in place of 1"),
        ("shards/1 three", "it is one of 3 shards in place of 2"),
        ("shards/1 whole", "it is of a whole run"),
        ("shards/1 smoothness", "smoothness"),
        ("shards/1 map", "study map in place of verify"),
        ("shards/1 shards/1", "shard 1/2 is in"),
        ("whole", "holds no shard"),
        ("shards/1 nowhere", "nowhere"),
    ] {
        let said = unwrapped(&folder.failed(format!("merge {shards} -o merged")));
        said.must_contain(reason);
        assert!(!folder.join("merged").exists(), "{shards}");
    }
    for (command, reason) in [
        (format!("{RUN} --shard 1/2"), "--shard 1/2 needs -o DIR"),
        (format!("{RUN} --shard 3/2 -o new"), "K/N"),
        (
            format!("{RUN} --shard 1/2 --report page.html -o new"),
            "--report needs",
        ),
        ("merge -o merged".to_owned(), "give the folders"),
        (
            "merge shards/1 shards/2 -o shards/1".to_owned(),
            "is the input",
        ),
    ] {
        let said = folder.run(&command);
        assert!(!said.status.success(), "{command}");
        unwrapped(&String::from_utf8_lossy(&said.stderr)).must_contain(reason);
    }
    // Results of a run are neither replaced by a shard nor by a plan.
    let whole = files(&folder.join("whole"));
    for task in ["--shard 1/2", "--plan-only", "--shard 1/2 --seed 2"] {
        let said = folder.failed(format!("{RUN} {task} -o whole"));
        unwrapped(&said).must_contain("holds the results of a run");
        assert_eq!(files(&folder.join("whole")), whole);
    }
    let said = folder.failed(format!("{RUN} --shard 2/2 -o shards/1"));
    unwrapped(&said).must_contain("shard 1/2 in place of shard 2/2");
}

#[test]
fn a_shard_that_was_stopped_resumes_and_is_not_merged_before() {
    let folder = Folder::new();
    let long = RUN.replace("--rays 9e3", "--rays 1e6");
    let run = folder.run(format!("{long} --shard 1/3 --max-time 0.2 -o 1"));
    assert_eq!(run.status.code(), Some(3));
    String::from_utf8_lossy(&run.stdout).must_contain("shard 1/3 is not finished");
    for partial in ["", "--partial"] {
        let refused = unwrapped(&folder.failed(format!("merge 1 {partial} -o merged")));
        refused.must_contain("finished");
        assert!(!folder.join("merged").exists());
    }
    assert!(ResultSet::read(folder.join("1")).unwrap().resumed().parts > 0);
    let again = folder.run(format!("{long} --shard 1/3 -o 1"));
    String::from_utf8_lossy(&again.stderr).must_contain("resumed from surfaces");
    for number in [2, 3] {
        folder.succeed(format!("{long} --quiet --shard {number}/3 -o {number}"));
    }
    folder.succeed("merge 1 2 3 --quiet -o merged");
    folder.succeed(format!("{long} --quiet -o whole"));
    assert_same_results(&folder.join("whole"), &folder.join("merged"));
}

/// Cases that take long have shards of their own; pilot runs of the plan are not traced again.
#[test]
fn shards_that_follow_a_plan_merge_to_the_whole() {
    let folder = Folder::new();
    let run = "map --tau 8 --size 64 --smoothness 1,2,4 --theta 0,60 --target-error 0.01 --models smith --no-plots";
    let said = folder.succeed(format!("{run} --plan-only --shard 1/3 -o plan"));
    said.must_contain("3 shards of");
    let plan = Table::read(&folder.join("plan/plan.csv"));
    let seconds: Vec<f64> = (0..6).map(|row| plan.number(row, "seconds")).collect();
    let shards = json(&folder.text("plan/plan.json"))["shards"].clone();
    let of_shards: Vec<f64> = serde_json::from_value(shards).unwrap();
    let all: f64 = seconds.iter().sum();
    assert!((of_shards.iter().sum::<f64>() - all).abs() < 1e-9 * all);
    assert!(
        of_shards
            .iter()
            .all(|one| (one / all - 1.0 / 3.0).abs() < 0.1),
        "{of_shards:?}"
    );
    folder.succeed(format!("{run} --quiet -o whole"));
    let shards = traced(&folder, &format!("{run} --plan plan"), 3).join(" ");
    folder.succeed(format!("merge {shards} --quiet -o merged"));
    assert_same_results(&folder.join("whole"), &folder.join("merged"));
    let refused = folder.failed(format!("{run} --seed 2 --shard 1/3 --plan plan -o other"));
    refused.must_contain("the plan in plan is of another run: run.seed");
    // Without a folder, and of a plan of fixed effort.
    let said = folder.succeed(format!("{RUN} --plan-only"));
    said.must_contain("2 rows");
}

#[test]
fn a_run_with_more_surfaces_goes_on_from_an_earlier_one() {
    let folder = Folder::new();
    let run = |surfaces: u32, rest: &str| {
        format!(
            "verify --tau 4 --size 32 --smoothness 2 --theta 0,40 --realisations {surfaces} --rays {surfaces}e3 --models smith --no-plots {rest}"
        )
    };
    folder.succeed(run(20, "--quiet --extendable -o whole"));
    folder.succeed(run(12, "--quiet --extendable -o grown"));
    let said = folder.run(run(20, "--verbose --extendable -o grown"));
    assert!(said.status.success());
    assert_same_results(&folder.join("whole"), &folder.join("grown"));
    let shards = traced(&folder, &run(20, "--extendable"), 2).join(" ");
    folder.succeed(format!("merge {shards} --quiet -o merged"));
    assert_same_results(&folder.join("whole"), &folder.join("merged"));
    // By a target error likewise, whose pilot run is not traced again.
    let target = |error: f64, rest: &str| {
        format!(
            "verify --tau 8 --size 64 --theta 50 --target-error {error} --of rings --models smith --no-plots {rest}"
        )
    };
    folder.succeed(target(0.01, "--quiet --extendable -o whole"));
    folder.succeed(target(0.02, "--quiet --extendable -o fine"));
    let said = folder.run(target(0.01, "--quiet --extendable -o fine"));
    String::from_utf8_lossy(&said.stderr).must_contain("resumed from surfaces");
    assert_same_results(&folder.join("whole"), &folder.join("fine"));
    // Surfaces of attenuation are results of their own.
    let points = |surfaces: u32, out: &str| {
        format!(
            "attenuation --tau 4 --spacing 1 --size 32 --sigma 1 --realisations {surfaces} --theta 45 --no-plots --quiet -o {out}"
        )
    };
    for (surfaces, out) in [(5, "a"), (9, "a"), (9, "b"), (5, "c"), (9, "d"), (5, "d")] {
        folder.succeed(points(surfaces, out));
    }
    assert_same_results(&folder.join("a"), &folder.join("b"));
    assert_same_results(&folder.join("c"), &folder.join("d"));
}
