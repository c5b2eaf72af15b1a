//! Tells the crate which git commit it is built from.

#[path = "src/build/package_commit.rs"]
mod package_commit;

use std::fs;
use std::path::Path;
use std::process::Command;

use package_commit::package_commit;

/// The output of `git` in this folder, or `None` where there is no git or no repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    (output.status.success() && !text.trim().is_empty()).then(|| text.trim().to_owned())
}

/// The commit of the checkout, with `-dirty` if tracked files were changed since.
fn checkout_commit() -> Option<String> {
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
    git(&["rev-parse", "HEAD"]).map(|head| head + mark)
}

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    // Every commit would rebuild all crates above this one, which only releases are worth.
    let is_release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    let commit = if is_release {
        // Of a package first: git may find a repository around the folder that cargo unpacks it to.
        let commit = match fs::read_to_string(".cargo_vcs_info.json") {
            Ok(text) => package_commit(&text),
            Err(_) => checkout_commit(),
        };
        commit.unwrap_or_else(|| "unknown".to_owned())
    } else {
        "development".to_owned()
    };
    println!("cargo::rustc-env=ASPERITY_COMMIT={commit}");
}
