//! Tells the crate which git commit it is built from.

use std::path::Path;
use std::process::Command;

/// The output of `git` in this folder, or `None` where there is no git or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Every commit would rebuild all crates above this one, which only releases are worth.
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = if is_release {
        // The log of HEAD changes with each commit, HEAD itself where another branch is checked out.
        for file in ["HEAD", "logs/HEAD"] {
            if let Some(path) = git(&["rev-parse", "--git-path", file])
                && Path::new(&path).exists()
            {
                println!("cargo::rerun-if-changed={path}");
            }
        }
        let changes = git(&["status", "--porcelain", "--untracked-files=no"]);
        let mark = if changes.is_some() { "-dirty" } else { "" };
        git(&["rev-parse", "HEAD"]).map_or_else(|| "unknown".to_owned(), |head| head + mark)
    } else {
        "development".to_owned()
    };
    println!("cargo::rustc-env=ASPERITY_COMMIT={commit}");
}
