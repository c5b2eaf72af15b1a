//! Pages of results: `asperity report` and `--report`.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, files, unwrapped, with_surface};

const TINY: &str = "verify --tau 8 --smoothness 2 --size 32 --insist --models none --rays 500 --realisations 2 --bins 4x6";

/// A folder with the results of a small run.
fn with_results() -> Folder {
    let folder = Folder::new();
    folder.succeed(format!("{TINY} -o v"));
    folder
}

/// Runs a command on results in which a text is replaced in a file, and puts the file back.
fn edited<T>(folder: &Path, [name, from, to]: [&str; 3], run: impl FnOnce(&Path) -> T) -> T {
    let text = folder.text(name);
    text.must_contain(from);
    folder.write(name, text.replace(from, to));
    let found = run(folder);
    folder.write(name, text);
    found
}

#[test]
fn a_run_and_a_report_on_it_write_the_same_page() {
    let pages = [1, 2].map(|threads| {
        let folder = Folder::new();
        folder.succeed(format!("{TINY} --threads {threads} -o v --report run.html"));
        let said = folder.succeed(format!("report v --threads {threads} -o again.html"));
        assert!(
            said.starts_with("again.html: ") && said.ends_with(" kB\n"),
            "{said}"
        );
        let page = folder.text("run.html");
        assert!(page == folder.text("again.html"));
        // The command stands on the page.
        let command = format!("--threads {threads}");
        page.must_contain(&command);
        page.replace(&command, "--threads N")
    });
    assert!(pages[0] == pages[1]);
    for part in [
        "<!DOCTYPE html>",
        "s = 2, n = 1.5",
        "500",
        "<svg ",
        "theta.csv",
    ] {
        pages[0].must_contain(part);
    }
    assert!(pages[0].len() < 500_000);
}

#[test]
fn pages_have_the_numbers_of_the_terminal() {
    let folder = with_results();
    folder.succeed("report v --quiet -o page.html");
    let report = unwrapped(&folder.text("v/report.txt"));
    let (_, after) = report.split_once("reflected total ").unwrap();
    let reflected: Vec<&str> = after.split(' ').take(3).collect();
    let reflected = reflected.join(" ").replace("+-", "±");
    folder.text("page.html").must_contain(reflected);
}

#[test]
fn several_folders_are_compared() {
    let folder = with_results();
    folder.succeed(format!("{TINY} --eta 1.4 -o w"));
    assert_eq!(folder.succeed("report v w --quiet -o page.html"), "");
    let page = folder.text("page.html");
    for part in [
        "<h1>v and w</h1>",
        "id=\"comparison\"",
        "<th scope=\"row\">material.eta</th><td>1.5</td><td>1.4</td>",
    ] {
        page.must_contain(part);
    }
    folder.succeed("report w v --quiet -o other.html");
    folder.text("other.html").must_contain("<h1>w and v</h1>");
}

#[test]
fn wrong_usage_is_refused_in_a_sentence_and_writes_nothing() {
    let folder = with_results();
    folder.succeed("generate --tau 8 --smoothness 2 --size 32 --insist -o surface/h.exr");
    fs::create_dir(folder.join("empty")).unwrap();
    let before = [files(&folder), files(&folder.join("v"))];
    folder.refuses(
        "report -o x.html => a report needs a result folder
         report nowhere -o x.html => the result folder nowhere does not exist
         report empty -o x.html => it has no manifest.json
         report surface -o x.html => it has no manifest.json
         report v v -o x.html => v is given twice
         report v ./v -o x.html => ./v is given twice
         report v -o x.pdf => pages are written as .html
         report v -o v => pages are written as .html
         report v -o v/summary.json => pages are written as .html
         report v => report needs --output FILE
         inspect surface/h.exr --report x.html => not for inspect",
    );
    folder
        .refused(format!("{TINY} --report x.html"))
        .must_contain("--report needs -o DIR");
    folder
        .refused(format!("{TINY} -o new --report x.txt"))
        .must_contain("pages are written as .html");
    assert_eq!(before, [files(&folder), files(&folder.join("v"))]);
}

#[test]
fn a_page_replaces_no_file_of_the_results() {
    let folder = with_results();
    folder.write("v/page.html", "mine");
    let listed = [
        "v/manifest.json",
        "\"files\": {",
        "\"files\": { \"page.html\": {},",
    ];
    let said = edited(&folder, listed, |folder| {
        folder.refused("report v -o v/../v/page.html")
    });
    said.must_contain("is a file of the results");
    assert_eq!(folder.text("v/page.html"), "mine");
}

#[test]
fn foreign_and_damaged_results_have_no_page() {
    let folder = with_results();
    let manifest = "v/manifest.json";
    for (edit, code, expected) in [
        (
            [manifest, "\"results_epoch\": ", "\"results_epoch\": 9"],
            2,
            "v is of results epoch 9",
        ),
        (
            [manifest, "\"verify\"", "\"render\""],
            2,
            "v holds results of render, which have no page",
        ),
        ([manifest, "{", "["], 1, "v/manifest.json is damaged"),
        (["v/summary.json", "{", "["], 1, "v/summary.json is damaged"),
        (
            ["v/histogram.csv", "\nreflected,", "\n"],
            1,
            "v/histogram.csv is damaged",
        ),
        (
            ["v/lobes.svg", "</svg>", "<script>alert(1)</script></svg>"],
            1,
            "v/lobes.svg is damaged: it has the element script",
        ),
        (
            ["v/lobes.svg", "<svg ", "<svg onload=\"alert(1)\" "],
            1,
            "v/lobes.svg is damaged: it has the attribute onload",
        ),
    ] {
        edited(&folder, edit, |folder| {
            folder
                .stopped("report v -o x.html", code)
                .must_contain(expected)
        });
    }
    fs::remove_file(folder.join("v/summary.json")).unwrap();
    folder
        .refused("report v -o x.html")
        .must_contain("it has no summary.json");
    assert!(!folder.join("x.html").exists());
}

#[test]
fn files_outside_the_folder_are_not_read() {
    let folder = with_results();
    for name in ["theta.csv", "lobes.svg"] {
        fs::copy(folder.join("v").join(name), folder.join(name)).unwrap();
    }
    let manifest = folder.text("v/manifest.json");
    let manifest = manifest.replace("\"theta.csv\"", "\"../theta.csv\"");
    folder.write(
        "v/manifest.json",
        manifest.replace("\"lobes.svg\"", "\"../lobes.svg\""),
    );
    folder.succeed("report v --quiet -o x.html");
    let page = folder.text("x.html");
    page.must_contain("histogram.csv");
    assert!(!page.contains("theta.csv") && !page.contains("Source: ../lobes.svg"));
}

#[test]
fn texts_of_files_are_escaped() {
    const HOSTILE: &str = "</script><img src=x onerror=alert(1)>";
    const SHOWN: &str = "&#60;/script&#62;&#60;img src=x onerror=alert(1)&#62;";
    let folder = with_results();
    for [name, from] in [
        ["v/summary.json", "s = 2, "],
        ["v/theta.csv", "reflected"],
        ["v/histogram.csv", "reflected"],
        ["v/report.txt", "reflected"],
        ["v/manifest.json", "\"--insist\""],
    ] {
        let to = if name.ends_with("manifest.json") {
            format!("\"{HOSTILE}\"")
        } else {
            HOSTILE.to_owned()
        };
        edited(&folder, [name, from, &to], |folder| {
            folder.succeed("report v --quiet -o x.html")
        });
        let page = folder.text("x.html");
        assert!(!page.contains("<img") && !page.contains(HOSTILE), "{name}");
        let json = "\\u003c/script>\\u003cimg src=x";
        page.must_contain(if name.ends_with("histogram.csv") {
            json
        } else {
            SHOWN
        });
    }
}

#[test]
fn pages_of_runs_that_were_ended_say_so() {
    const SENTENCE: &str = "The run was ended before it was complete";
    let folder = with_results();
    folder.succeed("report v --quiet -o x.html");
    assert!(!folder.text("x.html").contains(SENTENCE));
    let complete = [
        "v/manifest.json",
        "\"complete\": true",
        "\"complete\": false",
    ];
    edited(&folder, complete, |folder| {
        folder.succeed("report v --quiet -o x.html")
    });
    folder.text("x.html").must_contain(SENTENCE);
    let line = "gonio --tau 8 --smoothness 2 --size 32 --insist --theta 0,30,60 --rays 1e8 --realisations 10000 --bins 6x6 --max-time 1 --no-plots";
    let output = folder.run(format!("{line} -o g --report g.html"));
    assert!(output.status.success());
    folder.text("g.html").must_contain(SENTENCE);
}

#[test]
fn results_without_figures_and_of_meshes_have_pages() {
    let folder = with_surface();
    folder.succeed("mesh h.exr -o h.ply --quiet");
    folder.succeed(
        "trace h.ply --theta 30 --eta 1.5 --rays 2e3 --no-plots -o out --report page.html --quiet",
    );
    let page = folder.text("page.html");
    page.must_contain("h.ply");
    assert!(!page.contains("The first surface") && !page.contains("<figure"));
}
