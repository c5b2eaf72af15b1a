//! Files on disk: round trips, real instruments, atomic writing, and what the file system refuses.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "the helpers of tests are tests too"
)]

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use asperity_io::{
    ReadProblem, WriteProblem, check_output_file, check_output_folder, create_output_folder,
    read_height_map, write_atomically, write_bytes, write_height_map,
};
use asperity_surface::{Border, HeightField, LengthUnit, MissingPolicy, TurnedCells};
use asperity_synthesis::{Provenance, Psd};

/// Not square, unequal spacings, no symmetry: a transposition or flip shows.
fn field() -> HeightField {
    let [ny, nx] = [37, 21];
    let heights = (0..ny * nx)
        .map(|i| {
            let [x, y] = [(i % nx) as f64, (i / nx) as f64];
            (0.3 * x + 0.1 * y).sin() / 3.0 + 1e-3 * x * y
        })
        .collect();
    HeightField::new(heights, [ny, nx], [0.1, 0.7])
        .unwrap()
        .with_unit(LengthUnit::Micrometre)
        .with_border(Border::Open)
}

fn generated() -> HeightField {
    field().with_provenance(Some(Arc::new(Provenance {
        recipe: Psd::anisotropic_gaussian(0.1, 1.0 / 3.0, 2.5, 0.7)
            .unwrap()
            .into(),
        seed: u64::MAX,
        realisation: 12,
    })))
}

fn round_trip(name: &str, field: &HeightField) -> HeightField {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    write_height_map(&path, field).unwrap();
    assert_eq!(entries(folder.path()), [name]);
    let map = read_height_map(&path).unwrap();
    assert_eq!(map.missing(), 0);
    map.into_height_field(MissingPolicy::Refuse, Border::Mirrored)
        .unwrap()
}

fn entries(folder: &Path) -> Vec<String> {
    fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect()
}

/// Half a unit in the last place of single precision.
const SINGLE: f64 = 1.0 / 16_777_216.0;

fn assert_single_precision(read: &HeightField, written: &HeightField) {
    for (a, b) in read.heights().iter().zip(written.heights()) {
        assert!((a - b).abs() <= SINGLE * b.abs(), "{a} {b}");
    }
}

#[test]
fn exr_keeps_all_but_the_last_digits() {
    let written = generated();
    let read = round_trip("a.exr", &written);
    assert_single_precision(&read, &written);
    assert_eq!(
        read.with_heights(written.heights().to_vec()).unwrap(),
        written
    );
    let plain = round_trip("a.EXR", &field().with_unit(LengthUnit::Arbitrary));
    assert_eq!(plain.unit(), LengthUnit::Arbitrary);
    assert_eq!(plain.provenance(), None);
}

#[test]
fn npy_keeps_heights_exactly_and_nothing_else() {
    let written = field();
    let read = round_trip("a.npy", &written);
    assert_eq!(read.heights(), written.heights());
    assert_eq!(read.shape(), written.shape());
    assert_eq!(read.spacing(), [1.0, 1.0]);
    assert_eq!(read.unit(), LengthUnit::Arbitrary);
    // The file states no border.
    assert_eq!(read.border(), Border::Mirrored);
}

#[test]
fn gsf_keeps_all_but_the_last_digits() {
    for unit in [
        LengthUnit::Arbitrary,
        LengthUnit::Metre,
        LengthUnit::Millimetre,
        LengthUnit::Micrometre,
        LengthUnit::Nanometre,
    ] {
        let written = field().with_unit(unit);
        let read = round_trip("a.gsf", &written);
        assert_single_precision(&read, &written);
        assert_eq!(read.shape(), written.shape());
        assert_eq!((read.unit(), read.border()), (unit, Border::Open));
        for (a, b) in read.spacing().iter().zip(written.spacing()) {
            // Multiplied and divided by the number of samples: two roundings.
            assert!((a / b - 1.0).abs() <= 2.0 * f64::EPSILON);
        }
    }
}

#[test]
fn x3p_in_metres_is_exact() {
    for border in [Border::Periodic, Border::Mirrored, Border::Open] {
        let written = field().with_unit(LengthUnit::Metre).with_border(border);
        assert_eq!(round_trip("a.x3p", &written), written);
    }
    let micrometres = field();
    let read = round_trip("a.x3p", &micrometres);
    assert_eq!(read.unit(), LengthUnit::Metre);
    assert_eq!(read.spacing(), micrometres.spacing().map(|x| x / 1e6));
    assert_eq!(read.heights()[5], micrometres.heights()[5] / 1e6);
}

#[test]
fn turned_cells_are_kept_or_said_to_be_lost() {
    let folder = tempfile::tempdir().unwrap();
    let cells = TurnedCells::new([37, 21], |ix, iy| (ix * iy) % 3 == 1);
    let written = field().with_turned_cells(Some(Arc::new(cells)));
    for (name, is_kept) in [("a.exr", true), ("a.gsf", false), ("a.x3p", false)] {
        let path = folder.path().join(name);
        write_height_map(&path, &field()).unwrap();
        assert_eq!(read_height_map(&path).unwrap().notes, [""; 0], "{name}");
        write_height_map(&path, &written).unwrap();
        let map = read_height_map(&path).unwrap();
        assert_eq!(map.notes.is_empty(), is_kept, "{name}");
        let told = |note: &String| note.contains("does not keep along which diagonals");
        assert!(map.notes.iter().all(told), "{name}");
        let read = map.into_height_field(MissingPolicy::Refuse, Border::Open);
        let expected = written.turned_cells().filter(|_| is_kept);
        assert_eq!(read.unwrap().turned_cells(), expected, "{name}");
    }
}

#[test]
fn equal_surfaces_give_equal_bytes() {
    let folder = tempfile::tempdir().unwrap();
    for ending in ["exr", "npy", "gsf", "x3p", "png"] {
        let [a, b] = ["a", "b"].map(|name| folder.path().join(format!("{name}.{ending}")));
        write_height_map(&a, &generated()).unwrap();
        write_height_map(&b, &generated()).unwrap();
        assert!(fs::read(a).unwrap() == fs::read(b).unwrap(), "{ending}");
    }
}

#[test]
fn png_maps_heights_linearly_and_says_how() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let decode = |field: &HeightField| {
        write_height_map(&path, field).unwrap();
        let file = io::BufReader::new(fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        let info = reader.info().clone();
        let greys: Vec<u16> = bytes
            .chunks(2)
            .map(|b| u16::from_be_bytes([b[0], b[1]]))
            .collect();
        (info, greys)
    };
    let written = field();
    let (info, greys) = decode(&written);
    assert_eq!((info.width, info.height), (21, 37));
    assert_eq!(info.bit_depth, png::BitDepth::Sixteen);
    let text = |keyword: &str| {
        let chunk = info
            .uncompressed_latin1_text
            .iter()
            .find(|chunk| chunk.keyword == keyword);
        chunk.unwrap().text.clone()
    };
    let number = |keyword| text(keyword).parse::<f64>().unwrap();
    let [lowest, highest] = ["height_min", "height_max"].map(number);
    assert_eq!(number("spacing_x"), 0.1);
    assert_eq!(number("spacing_y"), 0.7);
    assert_eq!(text("unit"), "um");
    assert_eq!(greys.iter().min(), Some(&0));
    assert_eq!(greys.iter().max(), Some(&65535));
    let step = (highest - lowest) / 65535.0;
    for (grey, height) in greys.iter().zip(written.heights()) {
        // Half a grey level, and a little for rounding.
        assert!((lowest + f64::from(*grey) * step - height).abs() < 0.5001 * step);
    }

    let flat = HeightField::new(vec![3.0; 6], [2, 3], [1.0, 1.0]).unwrap();
    assert!(decode(&flat).1.iter().all(|grey| *grey == 0));
    let extreme = HeightField::new(vec![1e100, -1e100, 0.0, 0.0], [2, 2], [1.0; 2]).unwrap();
    assert_eq!(decode(&extreme).1, [65535, 0, 32768, 32768]);
}

#[test]
fn flat_surface_passes_the_compression_limit() {
    // Zeros are what deflate compresses best, hence nearest to the limit on what a file may claim.
    let flat = HeightField::new(vec![0.0; 1 << 20], [1 << 10, 1 << 10], [1.0, 1.0]).unwrap();
    assert!(round_trip("a.exr", &flat) == flat);
}

#[test]
fn large_maps_are_read_back() {
    // 2048^2 here to keep the tests quick; time and memory grow with the area.
    let n = 2048;
    let heights: Vec<f64> = (0..n * n).map(|i| ((i * 7919) % 10007) as f64).collect();
    let written = HeightField::new(heights, [n, n], [1.0, 1.0])
        .unwrap()
        .with_unit(LengthUnit::Metre)
        .with_border(Border::Mirrored);
    for name in ["a.x3p", "a.gsf"] {
        assert!(round_trip(name, &written) == written, "{name}");
    }
    assert!(round_trip("a.npy", &written).heights() == written.heights());
}

fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")).join(name);
    if path.exists() {
        Some(path)
    } else {
        println!("skipped: ../shared/{name} is not here");
        None
    }
}

/// Root mean square about the mean.
fn deviation(heights: &[f64]) -> f64 {
    let n = heights.len() as f64;
    let mean = heights.iter().sum::<f64>() / n;
    (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / n).sqrt()
}

fn report(path: &Path) -> HeightField {
    let map = read_height_map(path).unwrap();
    let missing = map.missing();
    assert_eq!(missing, 0);
    let field = map
        .into_height_field(MissingPolicy::Refuse, Border::Mirrored)
        .unwrap();
    let heights = field.heights();
    println!(
        "{}: shape {:?}, spacing {:?} {}, {missing} missing, {:e} to {:e}, rms {:e}",
        path.display(),
        field.shape(),
        field.spacing(),
        field.unit(),
        heights.iter().copied().fold(f64::INFINITY, f64::min),
        heights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        deviation(heights),
    );
    field
}

#[test]
fn the_profilometer_file_is_read() {
    let Some(path) = shared("data/measured/profilometer-650x650.x3p") else {
        return;
    };
    let field = report(&path);
    assert_eq!(field.shape(), [650, 650]);
    // As main.xml has them.
    assert_eq!(field.spacing(), [1.27656509837346e-7, 3.14582113527746e-7]);
    assert_eq!(field.unit(), LengthUnit::Metre);
    assert_eq!(field.border(), Border::Mirrored);
}

#[test]
fn the_interferometer_file_is_read() {
    let Some(path) = shared("data/measured/interferometer-650x650.asc") else {
        return;
    };
    let field = report(&path);
    assert_eq!(field.shape(), [650, 650]);
    assert_eq!(field.spacing(), [3.69862e-7, 3.69862e-7]);
    assert_eq!(field.unit(), LengthUnit::Metre);
    // First and last number of the file, in radians, by the factor of its header.
    assert_eq!(field.heights()[0], -3.564394 * 6.30079e-8);
    assert_eq!(field.heights()[650 * 650 - 1], 0.248515 * 6.30079e-8);
}

#[test]
fn the_reference_field_is_read() {
    let Some(path) = shared("reference/gauss_n512_tau16_s2.npy") else {
        return;
    };
    let field = report(&path);
    assert_eq!(field.shape(), [512, 512]);
    assert_eq!(field.border(), Border::Mirrored);
    // sigma = 8; the tile holds about (512 / 16)^2 / (pi / 2) = 650 independent areas, so that its
    // own deviation scatters by 8 / sqrt(2 * 650) = 0.22.
    assert!((deviation(field.heights()) - 8.0).abs() < 4.0 * 0.22);
}

#[test]
fn unreadable_files_have_errors_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let error = |name: &str| read_height_map(at(name)).unwrap_err();
    assert!(matches!(error("none.exr").problem, ReadProblem::NotFound));
    fs::create_dir(at("folder.npy")).unwrap();
    assert!(matches!(
        error("folder.npy").problem,
        ReadProblem::NotRegular(_)
    ));
    for ending in ["exr", "npy", "gsf", "x3p", "asc", "txt", "csv"] {
        let name = format!("empty.{ending}");
        fs::write(at(&name), "").unwrap();
        assert!(matches!(error(&name).problem, ReadProblem::Empty), "{name}");
    }
    let unknown = error("a.jpg").to_string();
    assert!(unknown.contains("unknown ending `.jpg`"), "{unknown}");
    assert!(
        unknown
            .contains(".exr, .npy, .gsf, .x3p, .asc, .txt, .csv, .xyz, .dat, .tif, .tiff, .sur,")
            && unknown.ends_with(" and .gwy"),
        "{unknown}"
    );
    assert!(error("a").to_string().contains("no ending"));
    assert!(matches!(
        error("a.png").problem,
        ReadProblem::WrongEnding { .. }
    ));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/null", at("null.npy")).unwrap();
        assert!(matches!(
            error("null.npy").problem,
            ReadProblem::NotRegular(_)
        ));
    }
}

#[test]
fn surfaces_that_a_format_cannot_hold_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = |name: &str, field: &HeightField| {
        let error = write_height_map(folder.path().join(name), field).unwrap_err();
        assert_eq!(entries(folder.path()).len(), 0);
        assert!(error.to_string().contains(name), "{error}");
        error
    };
    let field = field();
    let arbitrary = field.clone().with_unit(LengthUnit::Arbitrary);
    assert!(matches!(
        error("a.x3p", &arbitrary).problem,
        WriteProblem::NoUnit
    ));
    let huge = HeightField::new(vec![0.0, 0.0, 0.0, 1e39], [2, 2], [1.0, 1.0]).unwrap();
    for name in ["a.exr", "a.gsf"] {
        assert!(matches!(
            error(name, &huge).problem,
            WriteProblem::OutOfRange { .. }
        ));
    }
    assert!(matches!(
        error("a.asc", &field).problem,
        WriteProblem::WrongEnding { .. }
    ));
    let unknown = error("a.tiff", &field).to_string();
    assert!(
        unknown.contains(".exr, .npy, .gsf, .x3p and .png"),
        "{unknown}"
    );
}

#[test]
fn failing_writer_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.txt");
    let fail = || {
        write_atomically(&path, |out| {
            out.write_all(&[b'x'; 100_000])?;
            Err(io::Error::other("no more"))
        })
    };
    let error = fail().unwrap_err();
    assert!(error.to_string().contains("a.txt") && error.to_string().contains("no more"));
    assert_eq!(entries(folder.path()).len(), 0);
    write_bytes(&path, b"old").unwrap();
    fail().unwrap_err();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(entries(folder.path()), ["a.txt"]);
    let panicked = std::panic::catch_unwind(|| {
        let _ = write_atomically(&path, |_| panic!("on purpose"));
    });
    assert!(panicked.is_err());
    assert_eq!(entries(folder.path()), ["a.txt"]);
    write_bytes(&path, b"new").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"new");
}

#[test]
fn a_full_disk_is_an_error() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        println!("skipped: there is no /dev/full");
        return;
    }
    for bytes in [10, 1_000_000] {
        let error = write_bytes(full, &vec![0; bytes]).unwrap_err();
        assert!(matches!(error.problem, WriteProblem::Io(_)), "{error}");
    }
    assert!(full.exists());
    // A height map whose writer flushes on its way.
    let folder = tempfile::tempdir().unwrap();
    #[cfg(unix)]
    for name in ["a.npy", "a.gsf", "a.exr", "a.x3p", "a.png"] {
        let path = folder.path().join(name);
        std::os::unix::fs::symlink(full, &path).unwrap();
        let error = write_height_map(&path, &field()).unwrap_err();
        assert!(matches!(error.problem, WriteProblem::Io(_)), "{error}");
    }
}

#[test]
fn files_and_folders_in_the_way_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    // The folder of a file is made when the file is written, and not before
    check_output_file(at("some/where.txt")).unwrap();
    assert!(!at("some").exists());
    write_bytes(at("some/where.txt"), b"").unwrap();
    assert_eq!(entries(&at("some")), ["where.txt"]);
    let error = check_output_file(at("some/where.txt/else.txt")).unwrap_err();
    assert!(
        matches!(error.problem, WriteProblem::FolderIsFile(_)),
        "{error}"
    );
    check_output_file(at("where.txt")).unwrap();
    check_output_file("where.txt").unwrap();
    create_output_folder(at("new/deep")).unwrap();
    create_output_folder(at("new/deep")).unwrap();
    assert_eq!(entries(&at("new/deep")).len(), 0);
    for error in [write_bytes(at("new"), b""), check_output_file(at("new"))] {
        let error = error.unwrap_err();
        assert!(matches!(error.problem, WriteProblem::IsFolder), "{error}");
    }
    write_bytes(at("file"), b"").unwrap();
    for name in ["file", "file/below"] {
        for refuse in [create_output_folder, check_output_folder] {
            let error = refuse(at(name)).unwrap_err();
            assert!(
                matches!(error.problem, WriteProblem::FolderIsFile(_)),
                "{error}"
            );
        }
    }
}

#[test]
fn a_folder_is_checked_without_a_trace() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("there")).unwrap();
    for name in ["there", "there/new", "new/deep", "new/../../new"] {
        check_output_folder(at(name)).unwrap();
    }
    let long = "x".repeat(1000);
    let error = check_output_folder(at("new").join(long)).unwrap_err();
    assert!(matches!(error.problem, WriteProblem::Folder(_)), "{error}");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("nowhere", at("there/link")).unwrap();
        let error = check_output_folder(at("there/link")).unwrap_err();
        assert!(matches!(error.problem, WriteProblem::Folder(_)), "{error}");
        fs::remove_file(at("there/link")).unwrap();
    }
    assert_eq!(entries(folder.path()), ["there"]);
    assert_eq!(entries(&at("there")).len(), 0);
}

#[cfg(unix)]
#[test]
fn folders_without_permission_to_write_are_reported() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let closed = folder.path().join("closed");
    fs::create_dir(&closed).unwrap();
    fs::set_permissions(&closed, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(closed.join("probe"), "").is_ok() {
        println!("skipped: this user may write anywhere");
        // The kernel's own file system refuses even this user.
        if Path::new("/proc/self").exists() {
            for place in ["/proc/self/results", "/proc/self"] {
                let error = check_output_folder(place).unwrap_err();
                assert!(matches!(error.problem, WriteProblem::Folder(_)), "{error}");
            }
            let error = check_output_file("/proc/self/results").unwrap_err();
            assert!(matches!(error.problem, WriteProblem::Io(_)), "{error}");
        }
        return;
    }
    for place in [closed.clone(), closed.join("deeper")] {
        let error = check_output_folder(place).unwrap_err();
        assert!(matches!(error.problem, WriteProblem::Folder(_)), "{error}");
    }
    let error = write_height_map(closed.join("a.npy"), &field()).unwrap_err();
    assert!(matches!(error.problem, WriteProblem::Io(_)), "{error}");
    let error = check_output_file(closed.join("a.npy")).unwrap_err();
    assert!(matches!(error.problem, WriteProblem::Io(_)), "{error}");
}

#[cfg(unix)]
#[test]
fn file_modes_follow_the_umask_and_links_are_followed() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let mode = |name: &str| fs::metadata(at(name)).unwrap().permissions().mode() & 0o777;
    fs::write(at("ordinary"), "").unwrap();
    write_bytes(at("ours"), b"").unwrap();
    assert_eq!(mode("ours"), mode("ordinary"));
    fs::set_permissions(at("ours"), fs::Permissions::from_mode(0o640)).unwrap();
    write_bytes(at("ours"), b"again").unwrap();
    assert_eq!(mode("ours"), 0o640);
    std::os::unix::fs::symlink(at("ours"), at("link")).unwrap();
    write_bytes(at("link"), b"through").unwrap();
    assert!(fs::symlink_metadata(at("link")).unwrap().is_symlink());
    assert_eq!(fs::read(at("ours")).unwrap(), b"through");
}
