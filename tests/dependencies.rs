//! Dependencies: permissive licences, and no later compiler than the workspace declares.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "tests fail as their helpers do, and say what they skip"
)]

use std::process::Command;

use serde_json::Value;
use spdx::{Expression, ParseMode};

/// Licences that a dependency may be used under.
const ALLOWED: [&str; 9] = [
    "MIT",
    "Apache-2.0",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "0BSD",
    "ISC",
    "Unicode-3.0",
    "Unlicense",
    "Zlib",
];

/// The platform that this compiler builds for.
fn host() -> String {
    let output = Command::new("rustc").arg("-vV").output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let line = text.lines().find_map(|line| line.strip_prefix("host: "));
    line.unwrap().to_owned()
}

/// All packages that the program is built of on this platform, or `None` if cargo cannot list them (for instance
/// without a network before the first build).
fn packages() -> Option<Vec<Value>> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--locked"])
        .args(["--filter-platform", &host()])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    if !output.status.success() {
        println!("skipped: cargo metadata lists no packages here");
        return None;
    }
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().cloned()
}

#[test]
fn every_dependency_has_a_permissive_licence() {
    let Some(packages) = packages() else { return };
    for package in &packages {
        let name = package["name"].as_str().unwrap();
        let text = package["license"].as_str().unwrap_or("none");
        let expression = Expression::parse_mode(text, ParseMode::LAX);
        let allowed = expression.is_ok_and(|expression| {
            expression.evaluate(|required| {
                required
                    .license
                    .id()
                    .is_some_and(|id| ALLOWED.contains(&id.name))
            })
        });
        assert!(allowed, "{name} has the licence {text}");
    }
    assert!(packages.len() > 50, "{} packages listed", packages.len());
}

#[test]
fn no_dependency_needs_a_later_compiler_than_the_workspace_declares() {
    let Some(packages) = packages() else { return };
    let version =
        |text: &str| -> Vec<u32> { text.split('.').map(|n| n.parse().unwrap()).collect() };
    let declared = version(env!("CARGO_PKG_RUST_VERSION"));
    for package in &packages {
        if let Some(needed) = package["rust_version"].as_str() {
            let name = package["name"].as_str().unwrap();
            assert!(
                version(needed)[..2] <= declared[..2],
                "{name} needs {needed}"
            );
        }
    }
}
