//! Dependencies between the crates run downward only.

#![allow(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Crates of the workspace that each crate may use, outside of its tests.
const ALLOWED: [(&str, &[&str]); 10] = [
    ("optics", &[]),
    ("tally", &["optics"]),
    ("surface", &[]),
    ("tracer", &["optics", "surface", "tally"]),
    ("analysis", &["optics", "tally"]),
    ("io", &["surface"]),
    ("plot", &[]),
    (
        "simulate",
        &["optics", "surface", "tally", "tracer", "analysis", "io"],
    ),
    (
        "studies",
        &[
            "optics", "surface", "tally", "tracer", "analysis", "io", "plot", "simulate",
        ],
    ),
    (
        "render",
        &["optics", "surface", "tally", "tracer", "io", "simulate"],
    ),
];

#[test]
fn crates_use_only_what_lies_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    for (name, allowed) in ALLOWED {
        let manifest = fs::read_to_string(root.join(name).join("Cargo.toml")).unwrap();
        let section = manifest.split("[dependencies]").nth(1).unwrap();
        let section = section.split("\n[").next().unwrap();
        let used: BTreeSet<&str> = section
            .lines()
            .filter_map(|line| line.strip_prefix("asperity-"))
            .filter_map(|line| line.split(['.', ' ', '=']).next())
            .collect();
        let allowed: BTreeSet<&str> = allowed.iter().copied().collect();
        assert!(
            used.is_subset(&allowed),
            "{name} uses {used:?}, allowed are {allowed:?}"
        );
    }
}

#[test]
fn unsafe_code_is_in_one_module() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let mut folders = vec![root];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs")
                && !path.ends_with("pyramid/x86.rs")
            {
                let text = fs::read_to_string(&path).unwrap();
                assert!(!text.contains("unsafe {"), "{}", path.display());
            }
        }
    }
}

#[test]
fn single_precision_and_obvhs_stay_in_the_accelerators() {
    let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/tracer/src");
    for entry in fs::read_dir(sources).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            continue;
        }
        let text = fs::read_to_string(&path).unwrap();
        let code: Vec<&str> = text
            .lines()
            .filter(|line| !line.trim_start().starts_with("//"))
            .collect();
        for word in ["obvhs::", "f32", "Vec3A"] {
            assert!(
                !code.iter().any(|line| line.contains(word)),
                "{}: {word}",
                path.display()
            );
        }
    }
}
