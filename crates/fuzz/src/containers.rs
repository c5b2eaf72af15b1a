//! Containers: files of parts with checksums, of which one part is damaged and the checksums are made right again.

use std::io::{Cursor, Read, Write};
use std::path::Path;

use asperity_io::{Journal, read_journal};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::mutate::mutate;

/// Damages a file, or mostly, if it is an archive or a journal, one of its parts. `folder`: for temporary files.
pub(crate) fn damage(rng: &mut ChaCha8Rng, bytes: &mut Vec<u8>, others: &[Vec<u8>], folder: &Path) {
    if rng.random_range(0..8) > 0 {
        let packed = match bytes.starts_with(b"PK") {
            true => in_archive(rng, bytes),
            false => in_journal(rng, bytes, folder),
        };
        if let Some(packed) = packed {
            *bytes = packed;
            return;
        }
    }
    mutate(rng, bytes, others);
}

/// The part that is damaged: often one of the first, which say what the others are.
fn part_of(rng: &mut ChaCha8Rng, count: usize) -> usize {
    let among = if rng.random() { count } else { count.min(2) };
    rng.random_range(0..among.max(1))
}

fn in_archive(rng: &mut ChaCha8Rng, bytes: &[u8]) -> Option<Vec<u8>> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).ok()?;
    let mut parts = Vec::new();
    for number in 0..archive.len() {
        let mut part = archive.by_index(number).ok()?;
        let (name, mut content) = (part.name().ok()?.into_owned(), Vec::new());
        // A checksum of another part: the error of that would hide all others.
        if name.ends_with("md5checksum.hex") && rng.random_range(0..8) > 0 {
            continue;
        }
        part.by_ref().take(1 << 20).read_to_end(&mut content).ok()?;
        parts.push((name, content));
    }
    let contents: Vec<Vec<u8>> = parts.iter().map(|(_, content)| content.clone()).collect();
    let number = part_of(rng, parts.len());
    mutate(rng, &mut parts.get_mut(number)?.1, &contents);
    match rng.random_range(0..16) {
        0 => drop(parts.remove(rng.random_range(0..parts.len()))),
        1 => parts[rng.random_range(0..contents.len())].0 = parts[number].0.clone() + "x",
        _ => {}
    }
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in parts {
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
        let options = options.last_modified_time(zip::DateTime::default());
        writer.start_file(name, options).ok()?;
        writer.write_all(&content).ok()?;
    }
    Some(writer.finish().ok()?.into_inner())
}

fn in_journal(rng: &mut ChaCha8Rng, bytes: &[u8], folder: &Path) -> Option<Vec<u8>> {
    let path = folder.join("parts.journal");
    std::fs::write(&path, bytes).ok()?;
    let records = read_journal(&path).ok()?.records.into_iter();
    let mut records: Vec<Vec<u8>> = records.map(|(_, record)| record).collect();
    let others = records.clone();
    let number = part_of(rng, records.len());
    mutate(rng, records.get_mut(number)?, &others);
    if rng.random_range(0..16) == 0 {
        records.swap(0, number);
    }
    Journal::open(&path, 0).ok()?.append(&records).ok()?;
    std::fs::read(&path).ok()
}
