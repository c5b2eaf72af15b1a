//! Files of a result folder: whole or not, temporary or not, equal or not.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use asperity_io::read_journal;
use asperity_results::ResultSet;
use serde_json::Value;

/// Contents of files by their path, without what depends on the machine, the moment and the command line.
pub(crate) type Contents = BTreeMap<String, Vec<u8>>;

/// Files and folders below `folder`, by their path in it.
fn entries(folder: &Path) -> Vec<(String, PathBuf)> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(below) = folders.pop() {
        for entry in fs::read_dir(below).into_iter().flatten() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(folder).unwrap().to_str().unwrap();
            found.push((name.to_owned(), path.clone()));
            if path.is_dir() {
                folders.push(path);
            }
        }
    }
    found.sort();
    found
}

fn is_temporary(name: &str) -> bool {
    let mut parts = name.split('/');
    parts.any(|part| part.starts_with(".asperity-") && part.ends_with(".part"))
}

/// Temporary files and folders.
pub(crate) fn temporary(folder: &Path) -> Vec<String> {
    let names = entries(folder).into_iter().map(|(name, _)| name);
    names.filter(|name| is_temporary(name)).collect()
}

/// Makes temporary files two days old.
pub(crate) fn make_old(folder: &Path) {
    for (_, path) in entries(folder)
        .into_iter()
        .filter(|(name, _)| is_temporary(name))
    {
        let time = SystemTime::now() - Duration::from_secs(48 * 3600);
        File::open(path).unwrap().set_modified(time).unwrap();
    }
}

/// Results that are not whole, with what is wrong with them.
pub(crate) fn half_written(folder: &Path) -> Vec<String> {
    let files = entries(folder).into_iter();
    let files = files.filter(|(name, path)| path.is_file() && !is_temporary(name));
    let damage = files.filter_map(|(name, path)| {
        let error = damage(&path).err()?;
        Some(format!("{name} is not whole: {error}"))
    });
    damage.collect()
}

fn damage(path: &Path) -> Result<(), String> {
    let bytes = fs::read(path).unwrap();
    let ends = |end: &[u8]| match bytes.ends_with(end) {
        true => Ok(()),
        false => Err(format!("its {} bytes have no end", bytes.len())),
    };
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("json") => match serde_json::from_slice::<Value>(&bytes) {
            Ok(_) => ends(b"}\n"),
            Err(error) => Err(error.to_string()),
        },
        Some("npz") => ResultSet::read(path)
            .map(drop)
            .map_err(|error| error.to_string()),
        Some("journal") => read_journal(path)
            .map(drop)
            .map_err(|error| error.to_string()),
        Some("csv") => {
            let text = String::from_utf8(bytes.clone()).map_err(|error| error.to_string())?;
            let columns = |line: &str| {
                let outside = line.split('"').step_by(2);
                outside.map(|part| part.matches(',').count()).sum::<usize>()
            };
            let mut lines = text.lines().map(columns);
            let first = lines.next().ok_or("it is empty")?;
            match lines.all(|count| count == first) {
                true => ends(b"\n"),
                false => Err("its lines differ in their columns".to_owned()),
            }
        }
        Some("svg") => ends(b"</svg>\n"),
        Some("png") => ends(b"IEND\xaeB`\x82"),
        Some("npy") => {
            let header = u16::from_le_bytes([bytes[8], bytes[9]]) as usize + 10;
            let text = String::from_utf8_lossy(&bytes[..header]);
            let shape = text.split(['(', ')']).nth(1).ok_or("it has no shape")?;
            let sides = shape
                .split(',')
                .filter_map(|side| side.trim().parse::<usize>().ok());
            match bytes.len() - header == 8 * sides.product::<usize>() {
                true => Ok(()),
                false => Err(format!("it has {} bytes", bytes.len())),
            }
        }
        Some("txt") => ends(b"\n"),
        _ => Err("files of this ending are not known to the test".to_owned()),
    }
}

/// Contents of all files but temporary ones.
pub(crate) fn contents(folder: &Path) -> Contents {
    let files = entries(folder).into_iter();
    let files = files.filter(|(name, path)| path.is_file() && !is_temporary(name));
    files
        .map(|(name, path)| {
            let bytes = fs::read(&path).unwrap();
            // Files that are damaged count as they are.
            let comparable = match path.extension().and_then(|ending| ending.to_str()) {
                Some("npz") => ResultSet::read(&path)
                    .and_then(|results| results.comparable_bytes())
                    .ok(),
                Some("json") => serde_json::from_slice(&bytes).ok().map(|mut value| {
                    forget(&mut value);
                    serde_json::to_vec(&value).unwrap()
                }),
                _ => None,
            };
            let bytes = comparable.unwrap_or(bytes);
            (name, bytes)
        })
        .collect()
}

/// Removes times, command lines, and fingerprints of files that hold times.
fn forget(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.retain(|key, _| !key.ends_with("seconds") && key != "arguments");
            for (key, member) in members {
                match key.ends_with("summary.json") {
                    true => *member = Value::Null,
                    false => forget(member),
                }
            }
        }
        Value::Array(values) => values.iter_mut().for_each(forget),
        _ => {}
    }
}

/// Files that only one has, or whose contents differ.
pub(crate) fn differences(expected: &Contents, found: &Contents) -> Vec<String> {
    let mut names: Vec<&String> = expected.keys().chain(found.keys()).collect();
    names.sort();
    names.dedup();
    let differing = names
        .into_iter()
        .filter(|name| expected.get(*name) != found.get(*name));
    differing
        .map(|name| match (expected.get(name), found.get(name)) {
            (Some(_), None) => format!("{name} is missing after the second run"),
            (None, _) => format!("{name} is not a file of an undisturbed run"),
            _ => format!("{name} differs from that of an undisturbed run"),
        })
        .collect()
}
