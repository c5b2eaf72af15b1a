//! Temporary files of processes that end in the middle of a file, and their removal by other processes.

#![allow(clippy::unwrap_used, reason = "the helpers of tests are tests too")]

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, SystemTime};

use asperity_io::{
    ResultFolder, check_output_file, check_output_folder, remove_temporary_files, write_atomically,
    write_bytes, write_height_map,
};
use asperity_surface::HeightField;

/// Names the folder in which a process of this test program writes, and how it ends.
const FOLDER: &str = "ASPERITY_TEST_FOLDER";
const REMOVES: &str = "ASPERITY_TEST_REMOVES";

/// Not a test by itself: what the processes of the tests do.
#[test]
fn writer() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        return;
    };
    let written = write_atomically(Path::new(&folder).join("file"), |out| {
        out.write_all(&[b'x'; 1 << 17])?;
        if std::env::var_os(REMOVES).is_some() {
            // As in the handler of a signal, which has a thread of its own.
            std::thread::spawn(|| {
                remove_temporary_files();
                std::process::exit(130);
            });
        } else {
            std::io::Write::write_all(&mut std::io::stderr(), b"half\n")?;
        }
        std::thread::sleep(Duration::from_secs(60));
        Ok(())
    });
    written.unwrap();
}

/// A process that has half written `file` in `folder`.
fn half_written(folder: &Path) -> Child {
    let mut child = writer_in(folder).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = String::new();
    let errors = child.stderr.take().unwrap();
    BufReader::new(errors).read_line(&mut said).unwrap();
    assert_eq!(said, "half\n");
    child
}

fn writer_in(folder: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command
        .args(["writer", "--exact", "--nocapture"])
        .env(FOLDER, folder)
        .stdout(Stdio::null());
    command
}

fn entries(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    names
}

/// Young temporary files are never removed.
fn make_old(folder: &Path, name: &str) {
    let hour = Duration::from_secs(3600);
    let file = File::options().write(true).open(folder.join(name));
    file.unwrap()
        .set_modified(SystemTime::now() - hour)
        .unwrap();
}

fn is_part(name: &str) -> bool {
    name.starts_with(".asperity-") && name.ends_with(".part")
}

#[test]
fn what_a_killed_process_left_is_removed_by_the_next_and_what_a_running_one_writes_stays() {
    let field = HeightField::new(vec![0.0; 4], [2, 2], [1.0; 2]).unwrap();
    let sweeps: [&dyn Fn(&Path); 5] = [
        &|folder| check_output_file(folder.join("other")).unwrap(),
        &|folder| check_output_folder(folder).unwrap(),
        &|folder| check_output_folder(folder.join("new")).unwrap(),
        &|folder| write_height_map(folder.join("h.npy"), &field).unwrap(),
        &|folder| {
            let results = ResultFolder::open(folder, "trace", &[]).unwrap();
            write_bytes(results.claim("a.csv").unwrap(), b"a").unwrap();
        },
    ];
    for sweep in sweeps {
        let place = tempfile::tempdir().unwrap();
        let folder = place.path();
        fs::write(folder.join("file"), "old").unwrap();
        let mut running = half_written(folder);
        let parts: Vec<String> = entries(folder).into_iter().filter(|n| is_part(n)).collect();
        assert_eq!(parts.len(), 1, "{parts:?}");
        make_old(folder, &parts[0]);
        sweep(folder);
        assert!(entries(folder).contains(&parts[0]), "a running process");
        running.kill().unwrap();
        running.wait().unwrap();
        assert!(
            entries(folder).contains(&parts[0]),
            "nothing else removes it"
        );
        sweep(folder);
        assert!(!entries(folder).iter().any(|name| is_part(name)));
        assert_eq!(fs::read_to_string(folder.join("file")).unwrap(), "old");
    }
}

#[test]
fn a_process_that_ends_at_once_removes_its_temporary_files() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("file"), "old").unwrap();
    let status = writer_in(place.path())
        .env(REMOVES, "1")
        .stderr(Stdio::null())
        .status()
        .unwrap();
    assert_eq!(status.code(), Some(130));
    assert_eq!(entries(place.path()), ["file"]);
    assert_eq!(
        fs::read_to_string(place.path().join("file")).unwrap(),
        "old"
    );
}
