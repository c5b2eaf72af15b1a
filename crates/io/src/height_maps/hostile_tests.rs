//! Damaged, truncated and inconsistent files of every format give an error, never a panic.

mod exr;
mod gsf;
mod instruments;
mod npy;
mod text;
mod tiff;
mod x3p;

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_surface::{Border, HeightField, LengthUnit, MissingPolicy, RawHeightMap};
use asperity_synthesis::{Provenance, Psd};

use super::{read_from, write_to};
use crate::damage_tests::{assert_sentence, damaged};
use crate::error::{ReadError, ReadProblem};
use crate::formats::HeightMapFormat;

const TEXT: &str = "h=3 w=4\npixel size=2.5e-007 m\ndata unit=rad\n\
    height conversion factor (-> m)=6.30079e-008\n\
    -3.564394 -3.375837 -3.281305 -3.330100 \n\
    -2.778230 bad 3.114096 2.103312 \n\
    0.881800 0.248515 1.118282 -0.5 \n";

fn field() -> HeightField {
    let heights = (0..15).map(|i| (f64::from(i) * 0.7).sin()).collect();
    HeightField::new(heights, [3, 5], [0.5, 0.25])
        .unwrap()
        .with_unit(LengthUnit::Metre)
        .with_border(Border::Open)
        .with_provenance(Some(Arc::new(Provenance {
            recipe: Psd::gaussian(0.5, 2.0).unwrap().into(),
            seed: 7,
            realisation: 3,
        })))
}

fn path(format: HeightMapFormat) -> PathBuf {
    PathBuf::from(format!("in memory.{}", format.endings()[0]))
}

/// A valid small file of each format that is read.
fn valid(format: HeightMapFormat) -> Vec<u8> {
    match format {
        HeightMapFormat::Text => return TEXT.into(),
        HeightMapFormat::Tiff => return tiff::terrain(),
        _ if !format.can_write() => return instruments::valid(format),
        _ => {}
    }
    let mut out = Cursor::new(Vec::new());
    write_to(format, &field(), &mut out).unwrap();
    out.into_inner()
}

fn read(format: HeightMapFormat, bytes: &[u8]) -> Result<RawHeightMap, ReadError> {
    read_from(
        &path(format),
        &[format],
        Cursor::new(bytes),
        bytes.len() as u64,
    )
}

/// The surface of a map without missing points.
fn whole(map: RawHeightMap) -> HeightField {
    let field = map.into_height_field(MissingPolicy::Refuse, Border::Mirrored);
    field.unwrap()
}

/// The surface of a map whose missing points are filled.
fn filled(map: RawHeightMap) -> HeightField {
    map.into_height_field(MissingPolicy::Fill, Border::Open)
        .unwrap()
}

fn formats() -> impl Iterator<Item = HeightMapFormat> {
    HeightMapFormat::ALL.into_iter().filter(|f| f.can_read())
}

/// Valid small files to damage: of EXR one of each compression, and tiles.
fn victims(format: HeightMapFormat) -> Vec<Vec<u8>> {
    use ::exr::prelude::*;
    let mut files = vec![valid(format)];
    files.extend(instruments::variants(format));
    if format == HeightMapFormat::Tiff {
        files.extend(tiff::variants());
    }
    if format == HeightMapFormat::Exr {
        let samples = FlatSamples::F32((0..70 * 33).map(|i| (i as f32 * 0.1).sin()).collect());
        let tiles = Blocks::Tiles(Vec2(16, 8));
        for (compression, blocks) in [
            (Compression::Uncompressed, Blocks::ScanLines),
            (Compression::RLE, Blocks::ScanLines),
            (Compression::ZIP1, Blocks::ScanLines),
            (Compression::PIZ, Blocks::ScanLines),
            (Compression::PXR24, Blocks::ScanLines),
            (Compression::B44, Blocks::ScanLines),
            (Compression::ZIP16, tiles),
            (Compression::PIZ, tiles),
        ] {
            let encoding = Encoding {
                compression,
                blocks,
                line_order: LineOrder::Increasing,
            };
            files.push(exr::exr_encoded(
                33,
                70,
                &[("Z", samples.clone())],
                encoding,
            ));
        }
    }
    files
}

/// Reads what may be damaged; a panic of any crate fails the test.
fn survive(format: HeightMapFormat, bytes: &[u8]) -> Result<RawHeightMap, ReadError> {
    catch_unwind(AssertUnwindSafe(|| read(format, bytes)))
        .unwrap_or_else(|_| panic!("panic on {format}: {:?}", String::from_utf8_lossy(bytes)))
}

/// The ending chooses the reader. `SMALL_FILES=FOLDER` keeps the files there, for other programs to read and as seeds of `crates/fuzz`.
#[test]
fn small_files_are_read_by_their_names() {
    let temporary = tempfile::tempdir().unwrap();
    let kept = std::env::var_os("SMALL_FILES").map(PathBuf::from);
    let folder = kept.as_deref().unwrap_or(temporary.path());
    std::fs::create_dir_all(folder).unwrap();
    for format in formats() {
        for (k, bytes) in victims(format).iter().enumerate() {
            let path = folder.join(format!("small-{k}.{}", format.endings()[0]));
            std::fs::write(&path, bytes).unwrap();
            let read = crate::read_height_map(&path);
            let is_small = read.is_ok_and(|map| map.shape() == [3, 4]);
            let is_other = matches!(format, HeightMapFormat::Tiff) || format.can_write();
            assert!(is_small || is_other, "{format}");
        }
    }
}

#[test]
fn every_cut_is_an_error() {
    for format in formats() {
        let bytes = valid(format);
        assert!(read(format, &bytes).is_ok(), "{format}");
        // The last number of a text may be cut without a trace.
        let longest = match format {
            HeightMapFormat::Text => TEXT.trim_end().rfind(' ').unwrap(),
            _ => bytes.len() - 1,
        };
        let step = (longest / 60).max(1);
        for length in (1..=longest).step_by(step).chain([longest]) {
            match survive(format, &bytes[..length]) {
                Err(error) => assert_sentence(&error),
                Ok(_) => panic!("{format} cut to {length} of {} bytes", bytes.len()),
            }
        }
    }
}

#[test]
fn no_damage_causes_a_panic() {
    const CASES: u64 = 40_000;
    // The guard around decoders turns panics into errors, but their messages would fill the screen.
    let hook = Arc::new(std::panic::take_hook());
    let here = std::thread::current().id();
    let others = Arc::clone(&hook);
    let caught = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&caught);
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().id() == here {
            count.fetch_add(1, Ordering::Relaxed);
        } else {
            others(info);
        }
    }));
    let mut failures = Vec::new();
    for format in formats() {
        let originals = victims(format);
        let mut refused = 0;
        for seed in 0..CASES {
            let bytes = damaged(&originals[seed as usize % originals.len()], seed);
            match catch_unwind(AssertUnwindSafe(|| read(format, &bytes))) {
                Ok(Ok(_)) => {}
                Ok(Err(error)) => {
                    refused += 1;
                    let text = error.to_string();
                    if !text.contains("in memory.") {
                        failures.push(format!("{format} {seed}: {text}"));
                    }
                }
                Err(_) => failures.push(format!("{format} {seed}: panic")),
            }
        }
        println!(
            "{format}: {refused} of {CASES} damaged files refused, {} panics of the decoder caught",
            caught.swap(0, Ordering::Relaxed)
        );
    }
    std::panic::set_hook(Box::new(move |info| hook(info)));
    assert!(failures.is_empty(), "{failures:?}");
}

#[test]
fn content_of_another_format_is_reported() {
    for format in formats() {
        let bytes = valid(format);
        for other in formats().filter(|other| *other != format) {
            let error = read(other, &bytes).unwrap_err();
            assert_sentence(&error);
            // Formats without a mark, and the two in ZIP archives, are told apart by what follows.
            let is_alike = format.is_unmarked() && other.is_unmarked() || other.has_mark(&bytes);
            let is_reported = matches!(error.problem, ReadProblem::WrongFormat { .. });
            assert!(is_reported || is_alike, "{error}");
        }
    }
    let error = read(HeightMapFormat::Gsf, &valid(HeightMapFormat::Exr)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`in memory.gsf`: its name says GSF field, but it begins like an EXR image"
    );
}

fn refused(format: HeightMapFormat, bytes: &[u8], words: &str) -> ReadError {
    let error = survive(format, bytes).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(words), "{error}");
    error
}

#[test]
fn png_is_refused_since_it_has_no_scale() {
    let error = crate::read_height_map(Path::new("height.png")).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("carry neither heights nor spacings"),
        "{error}"
    );
}
