//! Result folders: files that are replaced, removed, refused, and left alone.

use std::fs;
use std::path::Path;

use serde_json::Value;

use super::*;
use crate::build::{Build, RESULTS_EPOCH};
use crate::error::WriteProblem;
use crate::files::manifest::MANIFEST;
use crate::files::{read_json, write_bytes, write_json};

const USER: &str = "the user's own";

fn open(folder: &Path) -> ResultFolder {
    ResultFolder::open(folder, "verify", &[]).unwrap()
}

/// A complete run that writes these names, each with the content `text`.
fn run(folder: &Path, names: &[&str], text: &str) {
    let results = open(folder);
    results.check(names).unwrap();
    write(&results, names, text);
    results.finish(true).unwrap();
}

fn write(results: &ResultFolder, names: &[&str], text: &str) {
    for name in names {
        write_bytes(results.claim(name).unwrap(), text.as_bytes()).unwrap();
    }
}

fn text(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap()
}

/// All files below `folder` as relative paths, sorted.
fn tree(folder: &Path) -> Vec<String> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        if entry.file_type().unwrap().is_dir() {
            names.push(format!("{name}/"));
            names.extend(
                tree(&entry.path())
                    .iter()
                    .map(|below| format!("{name}/{below}")),
            );
        } else {
            names.push(name);
        }
    }
    names.sort();
    names
}

fn refused<T>(result: Result<T, ResultFolderError>, words: &str) -> ResultFolderError {
    let Err(error) = result else {
        panic!("not refused: {words}")
    };
    let text = error.to_string();
    assert!(text.contains(words) && !text.contains('\n'), "{text}");
    error
}

#[test]
fn manifest_lists_command_build_and_files() {
    let folder = tempfile::tempdir().unwrap();
    run(folder.path(), &["b.csv", "sub/deep/a.csv"], "1");
    let manifest: Value = read_json(folder.path().join(MANIFEST)).unwrap();
    let build = Build::current();
    let content = serde_json::json!({"bytes": 1, "md5": "c4ca4238a0b923820dcc509a6f75849b"});
    assert_eq!(
        manifest,
        serde_json::json!({
            "schema": 2,
            "command": "verify",
            "version": build.version,
            "results_epoch": RESULTS_EPOCH,
            "commit": build.commit,
            "complete": true,
            "files": {"b.csv": content, "sub/deep/a.csv": content},
        })
    );
}

#[test]
fn second_run_replaces_and_removes_only_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(
        path,
        &["a.csv", "old.csv", "old/x.csv", "both/x.csv"],
        "first",
    );
    for name in ["notes.txt", "both/notes.txt"] {
        fs::write(path.join(name), USER).unwrap();
    }
    run(path, &["a.csv", "new/y.csv"], "second");
    assert_eq!(
        tree(path),
        [
            "a.csv",
            "both/",
            "both/notes.txt",
            MANIFEST,
            "new/",
            "new/y.csv",
            "notes.txt"
        ]
    );
    assert_eq!(text(path, "a.csv"), "second");
    assert_eq!(text(path, "notes.txt"), USER);
    assert_eq!(text(path, "both/notes.txt"), USER);
}

#[test]
fn files_of_the_user_are_refused_and_survive() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let mine = ["report.txt", "comparison.csv", "lobes.png", "map.csv"];
    for name in mine {
        fs::write(path.join(name), USER).unwrap();
    }
    for name in mine {
        let results = open(path);
        let error = refused(results.check(["summary.json", name]), name);
        assert!(matches!(
            error,
            ResultFolderError::InTheWay { kind: "file", .. }
        ));
        refused(results.claim(name), name);
        assert!(!path.join(MANIFEST).exists());
    }
    run(path, &["summary.json"], "1");
    run(path, &["summary.json"], "2");
    for name in mine {
        assert_eq!(text(path, name), USER);
        refused(
            open(path).check([name]),
            "not written by an earlier `verify` run",
        );
    }
}

#[test]
fn folders_and_links_in_the_way_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::create_dir(path.join("summary.json")).unwrap();
    fs::write(path.join("file"), USER).unwrap();
    refused(open(path).check(["summary.json"]), "the folder");
    refused(open(path).check(["file/below.csv"]), "the file");
    fs::write(path.join("out"), "").unwrap();
    let below = ResultFolder::open(path.join("out"), "verify", &[]);
    let error = below.unwrap_err();
    assert!(
        matches!(&error, ResultFolderError::Write(error)
            if matches!(error.problem, WriteProblem::FolderIsFile(_))),
        "{error}"
    );
    #[cfg(unix)]
    {
        let other = tempfile::tempdir().unwrap();
        fs::write(other.path().join("a.csv"), USER).unwrap();
        std::os::unix::fs::symlink(other.path(), path.join("cases")).unwrap();
        std::os::unix::fs::symlink(other.path().join("a.csv"), path.join("a.csv")).unwrap();
        refused(open(path).check(["a.csv"]), "the symbolic link");
        refused(open(path).check(["cases/a.csv"]), "the symbolic link");
        std::os::unix::fs::symlink(other.path().join("a.csv"), path.join(MANIFEST)).unwrap();
        refused(ResultFolder::open(path, "verify", &[]), "symbolic link");
        assert_eq!(text(other.path(), "a.csv"), USER);
    }
}

#[test]
fn changed_files_are_refused_before_the_run_and_survive() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let names = ["a.csv", "lobes.png", "cases/b.csv"];
    run(path, &names, "result");
    // Of another length and of the same, written again by the next run or not
    for (name, own) in [
        ("a.csv", USER),
        ("lobes.png", "RESULT"),
        ("cases/b.csv", ""),
    ] {
        fs::write(path.join(name), own).unwrap();
        let before = text(path, MANIFEST);
        for written in [&names[..], &["a.csv"], &["new.csv"]] {
            let error = refused(
                open(path).check(written),
                "was changed after the `verify` run",
            );
            assert!(
                matches!(&error, ResultFolderError::Changed { path: p, .. } if *p == path.join(name))
            );
            assert_eq!(text(path, MANIFEST), before);
        }
        refused(open(path).claim(name), "was changed after");
        assert_eq!(text(path, name), own);
        // Moved or deleted, it is not in the way.
        fs::remove_file(path.join(name)).unwrap();
        run(path, &names, "result");
    }
}

#[test]
fn files_changed_during_a_run_are_not_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["a.csv", "old.csv", "older.csv"], "first");
    let results = open(path);
    results.check(["a.csv"]).unwrap();
    write(&results, &["a.csv"], "second");
    fs::write(path.join("old.csv"), USER).unwrap();
    results.discard("old.csv").unwrap();
    results.finish(true).unwrap();
    drop(results);
    assert_eq!(tree(path), ["a.csv", MANIFEST, "old.csv"]);
    assert_eq!(text(path, "old.csv"), USER);
    // From then on it is the user's.
    refused(open(path).check(["old.csv"]), "not written by an earlier");
}

/// A run that was killed while it put its files in place has replaced some of the old: both contents are known, any other
/// is the user's.
#[test]
fn after_a_kill_each_file_is_old_or_new_or_the_users() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["a.csv", "b.csv"], "first");
    let before: Value = read_json(path.join(MANIFEST)).unwrap();
    run(path, &["a.csv", "b.csv", "new.csv"], "second");
    let mut killed: Value = read_json(path.join(MANIFEST)).unwrap();
    killed["complete"] = false.into();
    killed["replacing"] = killed["files"].clone();
    killed["files"] = before["files"].clone();
    for (a, b, has_new) in [
        ("first", "first", false),
        ("second", "first", false),
        ("second", "second", true),
    ] {
        let restore = || {
            write_json(path.join(MANIFEST), &killed).unwrap();
            fs::write(path.join("a.csv"), a).unwrap();
            fs::write(path.join("b.csv"), b).unwrap();
            let _ = fs::remove_file(path.join("new.csv"));
            let _ = fs::remove_file(path.join("other.csv"));
            if has_new {
                fs::write(path.join("new.csv"), "second").unwrap();
            }
        };
        for name in ["a.csv", "b.csv", "new.csv"] {
            restore();
            fs::write(path.join(name), USER).unwrap();
            for written in [&["a.csv", "b.csv", "new.csv"][..], &["other.csv"]] {
                refused(open(path).check(written), "was changed after");
            }
            assert_eq!(text(path, name), USER);
        }
        restore();
        run(path, &["a.csv", "other.csv"], "third");
        assert_eq!(tree(path), ["a.csv", MANIFEST, "other.csv"]);
    }
}

#[test]
fn checkpoints_are_extended_and_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let results = open(path);
    let names = ["cells/1.json", "cells/2.json"];
    for name in names {
        write_bytes(results.claim_checkpoint(name).unwrap(), b"1").unwrap();
    }
    results.finish(false).unwrap();
    drop(results);
    // A damaged one is found by its reader, not by the folder.
    fs::write(path.join("cells/1.json"), "damaged").unwrap();
    let results = open(path);
    results.check(["a.csv"]).unwrap();
    results.keep("cells/2.json");
    write_bytes(results.claim_checkpoint("cells/1.json").unwrap(), b"2").unwrap();
    results.finish(false).unwrap();
    let manifest: Value = read_json(path.join(MANIFEST)).unwrap();
    assert_eq!(
        manifest["files"],
        serde_json::json!({"cells/1.json": null, "cells/2.json": null})
    );
}

/// A list of names, as the first form of the manifest has it, says nothing of contents.
#[test]
fn manifests_of_the_first_form_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["a.csv", "old.csv"], "first");
    let mut manifest: Value = read_json(path.join(MANIFEST)).unwrap();
    manifest["schema"] = 1.into();
    manifest["files"] = serde_json::json!(["a.csv", "old.csv"]);
    write_json(path.join(MANIFEST), &manifest).unwrap();
    fs::write(path.join("a.csv"), "other").unwrap();
    run(path, &["a.csv"], "second");
    assert_eq!(tree(path), ["a.csv", MANIFEST]);
    let manifest: Value = read_json(path.join(MANIFEST)).unwrap();
    assert_eq!(manifest["schema"], 2);
}

/// A file that is no longer as it was written is no longer ours.
#[cfg(unix)]
#[test]
fn listed_files_that_became_links_or_folders_are_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let other = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["link.csv", "dir.csv", "cases/a.csv"], "1");
    fs::write(other.path().join("a.csv"), USER).unwrap();
    for name in ["link.csv", "dir.csv"] {
        fs::remove_file(path.join(name)).unwrap();
    }
    fs::remove_dir_all(path.join("cases")).unwrap();
    std::os::unix::fs::symlink(other.path().join("a.csv"), path.join("link.csv")).unwrap();
    std::os::unix::fs::symlink(other.path(), path.join("cases")).unwrap();
    fs::create_dir(path.join("dir.csv")).unwrap();
    refused(open(path).check(["link.csv"]), "the symbolic link");
    run(path, &["b.csv"], "2");
    assert_eq!(text(other.path(), "a.csv"), USER);
    assert!(path.join("dir.csv").is_dir() && path.join("link.csv").is_symlink());
}

#[test]
fn inputs_are_neither_replaced_nor_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["map.csv", "old.csv", "a.csv"], "result");
    // The same file by another name.
    let detour = path
        .join("../")
        .join(path.file_name().unwrap())
        .join("map.csv");
    let open = || {
        let inputs = [detour.as_path(), &path.join("old.csv")].map(Path::to_owned);
        ResultFolder::open(path, "verify", &[&inputs[0], &inputs[1]]).unwrap()
    };
    let error = refused(open().check(["map.csv"]), "input of this run");
    assert!(matches!(error, ResultFolderError::Input { .. }));
    refused(open().claim("old.csv"), "input of this run");
    let results = open();
    write(&results, &["b.csv"], "result");
    results.discard("old.csv").unwrap();
    results.finish(true).unwrap();
    assert_eq!(tree(path), ["b.csv", MANIFEST, "map.csv", "old.csv"]);
}

#[test]
fn checks_leave_no_trace() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("new/deep");
    open(&path).check(["a.csv", "cases/b.csv"]).unwrap();
    drop(open(&path));
    assert_eq!(tree(folder.path()).len(), 0);
}

/// A run that does not come to its end leaves the old results, and the next run can resume.
#[test]
fn interrupted_run_loses_nothing_and_is_taken_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["a.csv", "b.csv", "old.csv"], "first");
    let results = open(path);
    write(&results, &["a.csv", "new.csv"], "second");
    results.claim("never written.csv").unwrap();
    drop(results);
    let content = ["a.csv", "b.csv", "old.csv"].map(|name| text(path, name));
    assert_eq!(content, ["first"; 3]);
    assert_eq!(tree(path).len(), 4);
    let manifest: Value = read_json(path.join(MANIFEST)).unwrap();
    assert_eq!(manifest["complete"], false);

    run(path, &["a.csv", "b.csv"], "third");
    assert_eq!(tree(path), ["a.csv", "b.csv", MANIFEST]);
    assert_eq!(text(path, "b.csv"), "third");
}

#[test]
fn checkpoints_are_listed_before_they_exist_and_results_come_with_their_fingerprints() {
    let folder = tempfile::tempdir().unwrap();
    let results = open(folder.path());
    for name in ["a.npz", "cases/b.npz"] {
        let file = results.claim_checkpoint(name).unwrap();
        assert!(!file.exists() && file.parent().unwrap().is_dir());
        let manifest: Value = read_json(folder.path().join(MANIFEST)).unwrap();
        assert_eq!(manifest["files"].get(name), Some(&Value::Null), "{name}");
    }
    for name in ["a.csv", "cases/b.csv"] {
        write_bytes(results.claim(name).unwrap(), b"1").unwrap();
        assert!(!folder.path().join(name).exists());
        let manifest: Value = read_json(folder.path().join(MANIFEST)).unwrap();
        assert_eq!(manifest["files"].get(name), None, "{name}");
    }
    results.claim("never written.csv").unwrap();
    // What was claimed but not written is not listed in the end.
    results.finish(true).unwrap();
    let manifest: Value = read_json(folder.path().join(MANIFEST)).unwrap();
    let files = manifest["files"].as_object().unwrap();
    assert_eq!(files.keys().collect::<Vec<_>>(), ["a.csv", "cases/b.csv"]);
    assert!(manifest.get("replacing").is_none());
}

#[test]
fn checkpoints_are_kept_or_discarded() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["cells/1.json", "cells/2.json", "cells/3.json"], "1");
    fs::write(path.join("cells/mine.json"), USER).unwrap();
    let results = open(path);
    results.keep("cells/1.json");
    results.keep("cells/mine.json");
    results.discard("cells/2.json").unwrap();
    results.discard("cells/mine.json").unwrap();
    results.discard("cells/none.json").unwrap();
    assert!(!path.join("cells/2.json").exists() && path.join("cells/3.json").exists());
    write(&results, &["a.csv"], "2");
    results.finish(true).unwrap();
    drop(results);
    assert_eq!(
        tree(path),
        [
            "a.csv",
            "cells/",
            "cells/1.json",
            "cells/mine.json",
            MANIFEST
        ]
    );
    run(path, &["a.csv"], "3");
    assert_eq!(tree(path), ["a.csv", "cells/", "cells/mine.json", MANIFEST]);
}

#[test]
fn results_of_other_commands_and_results_without_manifest_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["a.csv"], "1");
    let error = refused(
        ResultFolder::open(path, "gonio", &[]),
        "holds results of `verify`",
    );
    assert!(matches!(error, ResultFolderError::OtherResults { .. }));

    fs::remove_file(path.join(MANIFEST)).unwrap();
    let summary = serde_json::json!({"schema": 1, "command": "verify", "version": "0.1.0"});
    write_json(path.join("summary.json"), &summary).unwrap();
    let error = refused(
        ResultFolder::open(path, "verify", &[]),
        "without the manifest.json",
    );
    assert!(matches!(error, ResultFolderError::OtherResults { .. }));
    // A summary.json of anything else is the user's.
    fs::write(path.join("summary.json"), "{\"schema\": 1}").unwrap();
    refused(open(path).check(["summary.json"]), "not written by");
    open(path).check(["other.csv"]).unwrap();
}

#[test]
fn a_folder_with_a_part_of_other_results_is_refused_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let results = open(folder.path());
    let summary = serde_json::json!({"schema": 1, "command": "verify", "version": "0.1.0"});
    let path = results.claim("s3_n1.5/summary.json").unwrap();
    write_json(path, &summary).unwrap();
    results.finish(true).unwrap();
    drop(results);
    let case = folder.path().join("s3_n1.5");
    let error = refused(
        ResultFolder::open(&case, "verify", &[]),
        "holds a part of the results of `verify` in",
    );
    assert!(matches!(error, ResultFolderError::OtherResults { .. }));
}

#[test]
fn invalid_manifests_are_refused_and_left() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["a.csv"], "1");
    let valid = text(path, MANIFEST);
    let outside = tempfile::NamedTempFile::new().unwrap();
    let absolute = outside.path().to_str().unwrap();
    for (manifest, words) in [
        ("{}".to_owned(), "missing field"),
        (valid.replace("\"md5\"", "\"sha1\""), "not a manifest"),
        (String::new(), "EOF"),
        (valid[..valid.len() / 2].to_owned(), "not a manifest"),
        (
            valid.replace("\"schema\": 2", "\"schema\": 7"),
            "schema is 7",
        ),
        (valid.replace("a.csv", "../a.csv"), "`../a.csv`"),
        (valid.replace("a.csv", absolute), "not in the folder"),
        (valid.replace("a.csv", ""), "``"),
        (valid.replace("a.csv", MANIFEST), "manifest.json`"),
        (valid.replace("a.csv", "../\u{7f}"), "`../\\u{7f}`"),
    ] {
        fs::write(path.join(MANIFEST), &manifest).unwrap();
        let error = refused(ResultFolder::open(path, "verify", &[]), words);
        assert!(
            matches!(error, ResultFolderError::InvalidManifest { .. }),
            "{error}"
        );
        assert_eq!(text(path, MANIFEST), manifest);
    }
    assert!(outside.path().exists());
    let other = valid.replace("verify", "\u{7f}");
    fs::write(path.join(MANIFEST), other).unwrap();
    refused(
        ResultFolder::open(path, "verify", &[]),
        "results of `\\u{7f}`",
    );
}

#[test]
fn stale_parts_are_swept_from_all_folders_of_results() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    run(path, &["cells/1.json"], "1");
    let check = || open(path).check(["cells/1.json"]).unwrap();
    let write = || run(path, &["cells/1.json"], "1");
    for sweep in [&check as &dyn Fn(), &write] {
        for name in ".asperity-0123456789ab.part cells/.asperity-0123456789ac.part".split(' ') {
            let part = fs::File::create(path.join(name)).unwrap();
            let hour = std::time::Duration::from_secs(3600);
            part.set_modified(std::time::SystemTime::now() - hour)
                .unwrap();
        }
        assert_eq!(tree(path).len(), 5);
        sweep();
        assert_eq!(tree(path), ["cells/", "cells/1.json", MANIFEST]);
    }
}

/// No message names the temporary folder in which a file waits.
#[test]
fn results_that_cannot_be_written_are_named_by_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let results = open(folder.path());
    let path = results.claim("a.csv").unwrap();
    fs::create_dir(&path).unwrap();
    let error = write_bytes(&path, b"1").unwrap_err().to_string();
    let place = folder.path().join("a.csv");
    assert!(
        error.starts_with(&format!("`{}` is a folder", place.display())),
        "{error}"
    );
}

#[test]
fn files_are_claimed_from_several_threads() {
    let folder = tempfile::tempdir().unwrap();
    let results = open(folder.path());
    std::thread::scope(|scope| {
        for thread in 0..4 {
            let results = &results;
            scope.spawn(move || {
                for i in 0..8 {
                    let name = format!("{thread}/{i}.csv");
                    write_bytes(results.claim(&name).unwrap(), b"1").unwrap();
                }
            });
        }
    });
    results.finish(true).unwrap();
    let manifest: Value = read_json(folder.path().join(MANIFEST)).unwrap();
    assert_eq!(manifest["files"].as_object().unwrap().len(), 32);
}

#[test]
#[should_panic(expected = "not a name inside")]
fn names_outside_the_folder_are_bugs() {
    let folder = tempfile::tempdir().unwrap();
    let _ = open(folder.path()).claim("../a.csv");
}
