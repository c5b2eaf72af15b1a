//! Damaged, cut and lying files of every format: an error each time, a panic never.

use std::io::Cursor;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use asperity_surface::{
    Border, HeightField, LengthUnit, MissingPolicy, Provenance, Psd, RawHeightMap,
};

use crate::error::ReadError;
use crate::format::{HeightMapFormat, read_from, write_to};

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
        .with_provenance(Some(Provenance {
            psd: Psd::gaussian(0.5, 2.0).unwrap(),
            seed: 7,
            realisation: 3,
        }))
}

fn path(format: HeightMapFormat) -> PathBuf {
    PathBuf::from(format!("in memory.{}", format.endings()[0]))
}

/// A valid small file of each format that is read.
fn valid(format: HeightMapFormat) -> Vec<u8> {
    if format == HeightMapFormat::Text {
        return TEXT.into();
    }
    let mut out = Cursor::new(Vec::new());
    write_to(&path(format), format, &field(), &mut out).unwrap();
    out.into_inner()
}

fn read(format: HeightMapFormat, bytes: &[u8]) -> Result<RawHeightMap, ReadError> {
    read_from(
        &path(format),
        format,
        Cursor::new(bytes),
        bytes.len() as u64,
    )
}

fn formats() -> impl Iterator<Item = HeightMapFormat> {
    HeightMapFormat::ALL.into_iter().filter(|f| f.can_read())
}

/// Valid small files to damage: of EXR one of each compression, and tiles.
fn victims(format: HeightMapFormat) -> Vec<Vec<u8>> {
    use ::exr::prelude::*;
    let mut files = vec![valid(format)];
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
            files.push(exr_encoded(33, 70, &[("Z", samples.clone())], encoding));
        }
    }
    files
}

/// Reads what may be damaged; a panic of any crate fails the test.
fn survive(format: HeightMapFormat, bytes: &[u8]) -> Result<RawHeightMap, ReadError> {
    catch_unwind(AssertUnwindSafe(|| read(format, bytes)))
        .unwrap_or_else(|_| panic!("panic on {format}: {:?}", String::from_utf8_lossy(bytes)))
}

/// One sentence that names the file.
pub(crate) fn assert_sentence(error: &ReadError) {
    let text = error.to_string();
    assert!(text.contains("in memory."), "{text}");
    assert!(!text.contains('\n') && !text.ends_with('.'), "{text}");
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

/// SplitMix64 (Steele, Lea and Flood 2014): enough to damage files, the same ones each time.
struct Damage(u64);

impl Damage {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
}

/// `original` with up to four changes, the same ones for the same seed.
pub(crate) fn damaged(original: &[u8], seed: u64) -> Vec<u8> {
    let mut damage = Damage(seed);
    let mut bytes = original.to_vec();
    for _ in 0..=damage.below(4) {
        let i = damage.below(bytes.len());
        match damage.below(6) {
            0 => bytes[i] ^= 1 << damage.below(8),
            1 => bytes[i] = damage.next() as u8,
            2 => bytes[i] = [0, 0xff, 0x7f, 0x80, b'9', b'-'][damage.below(6)],
            3 => bytes.insert(i, damage.next() as u8),
            4 if bytes.len() > 1 => _ = bytes.remove(i),
            _ => {
                let j = (i + 4).min(bytes.len());
                bytes[i..j].fill([0, 0xff, 0x7f][damage.below(3)]);
            }
        }
    }
    bytes
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
fn one_format_named_as_another_is_told() {
    for format in formats() {
        let bytes = valid(format);
        for other in formats().filter(|other| *other != format) {
            let error = read(other, &bytes).unwrap_err();
            assert_sentence(&error);
            assert!(matches!(error, ReadError::WrongFormat { .. }), "{error}");
        }
    }
    let error = read(HeightMapFormat::Gsf, &valid(HeightMapFormat::Exr)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`in memory.gsf` is named as GSF field but begins like an EXR image"
    );
}

fn refused(format: HeightMapFormat, bytes: &[u8], words: &str) -> ReadError {
    let error = survive(format, bytes).unwrap_err();
    assert_sentence(&error);
    assert!(error.to_string().contains(words), "{error}");
    error
}

fn npy(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

#[test]
fn npy_headers_are_refused_before_allocation() {
    use HeightMapFormat::Npy;
    let claim = |shape: &str| {
        npy(
            &format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}"),
            &[0; 32],
        )
    };
    for shape in ["(4000000000, 4000000000)", "(4000000000, 2)"] {
        let error = refused(Npy, &claim(shape), "claims");
        assert!(matches!(error, ReadError::TooLarge { .. }), "{error}");
    }
    refused(Npy, &claim("(1099511627776, 1099511627776)"), "can hold");
    refused(Npy, &claim("(18446744073709551615, 2)"), "can hold");
    refused(Npy, &claim("(99999999999999999999, 2)"), "can hold");
    refused(Npy, &claim("(2, 3)"), "only 32 bytes");
    refused(Npy, &claim("(2, 1)"), "at least 2 x 2");
    refused(Npy, &claim("(1, 1)"), "at least 2 x 2");
    refused(Npy, &claim("(0, 0)"), "at least 2 x 2");
    refused(Npy, &claim("(4,)"), "two axes");
    refused(Npy, &claim("(2, 2, 1)"), "two axes");
    refused(Npy, &claim("(-2, 2)"), "negative");
    refused(Npy, &npy(&"(".repeat(60_000), &[]), "brackets");
    let twice = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), 'shape': (2, 2), }";
    refused(Npy, &npy(twice, &[0; 32]), "2 times");
    for kind in ["<c16", "|b1", "|O", "<U3", "<f2", "<M8[ns]"] {
        let header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': (2, 2), }}");
        refused(Npy, &npy(&header, &[0; 32]), "allowed are f4");
    }
    let mut long = npy("", &[0; 40]);
    long[6] = 2;
    long.splice(8..10, u32::MAX.to_le_bytes());
    refused(Npy, &long, "claims");
    let mut text = claim("(2, 2)");
    text[20] = 0xff;
    refused(Npy, &text, "UTF-8");
    refused(
        Npy,
        &[claim("(2, 2)"), vec![0; 3]].concat(),
        "3 bytes follow",
    );
    let infinite: Vec<u8> = [1.0, 2.0, f64::INFINITY, 4.0]
        .iter()
        .flat_map(|x: &f64| x.to_le_bytes())
        .collect();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 2), }";
    refused(Npy, &npy(header, &infinite), "column 0, row 1 is inf");
}

#[test]
fn npy_is_read_in_every_type_and_order() {
    let expected: [f64; 6] = [1.0, -2.0, 3.0, 4.0, 5.0, 100.0];
    let fortran: [f64; 6] = [1.0, 4.0, -2.0, 5.0, 3.0, 100.0];
    macro_rules! bytes {
        ($values:expr, $number:ty, $to:ident) => {
            $values
                .iter()
                .flat_map(|x| (*x as $number).$to())
                .collect::<Vec<u8>>()
        };
    }
    for (kind, c, f) in [
        (
            "<f4",
            bytes!(expected, f32, to_le_bytes),
            bytes!(fortran, f32, to_le_bytes),
        ),
        (
            ">f4",
            bytes!(expected, f32, to_be_bytes),
            bytes!(fortran, f32, to_be_bytes),
        ),
        (
            ">f8",
            bytes!(expected, f64, to_be_bytes),
            bytes!(fortran, f64, to_be_bytes),
        ),
        (
            "|i1",
            bytes!(expected, i8, to_le_bytes),
            bytes!(fortran, i8, to_le_bytes),
        ),
        (
            "<i2",
            bytes!(expected, i16, to_le_bytes),
            bytes!(fortran, i16, to_le_bytes),
        ),
        (
            ">i2",
            bytes!(expected, i16, to_be_bytes),
            bytes!(fortran, i16, to_be_bytes),
        ),
        (
            "<i4",
            bytes!(expected, i32, to_le_bytes),
            bytes!(fortran, i32, to_le_bytes),
        ),
        (
            ">i8",
            bytes!(expected, i64, to_be_bytes),
            bytes!(fortran, i64, to_be_bytes),
        ),
    ] {
        for (order, data) in [("False", c), ("True", f)] {
            let header =
                format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': (2, 3), }}\n");
            let map = read(HeightMapFormat::Npy, &npy(&header, &data)).unwrap();
            assert_eq!(map.shape(), [2, 3]);
            let field = map
                .into_height_field(MissingPolicy::Refuse, Border::Periodic)
                .unwrap();
            assert_eq!(field.heights(), expected, "{kind} {order}");
        }
    }
}

fn gsf(header: &str, heights: &[f32]) -> Vec<u8> {
    let mut bytes = format!("Gwyddion Simple Field 1.0\n{header}").into_bytes();
    bytes.extend(&[0; 4][..4 - bytes.len() % 4]);
    bytes.extend(heights.iter().flat_map(|h| h.to_le_bytes()));
    bytes
}

#[test]
fn gsf_headers_are_checked() {
    use HeightMapFormat::Gsf;
    let four = [1.0, 2.0, 3.0, 4.0];
    for (header, words) in [
        (
            "XRes = 4000000000\nYRes = 4000000000\n",
            "claims 4000000000 x 4000000000",
        ),
        (
            "XRes = 18446744073709551615\nYRes = 2\n",
            "claims 18446744073709551615 x 2",
        ),
        (
            "XRes = 99999999999999999999\nYRes = 2\n",
            "positive whole number",
        ),
        ("XRes = 3\nYRes = 2\n", "only 16 bytes"),
        ("XRes = 2\nYRes = 1\n", "at least 2 x 2"),
        ("XRes = 1\nYRes = 1\n", "at least 2 x 2"),
        ("XRes = 1\nYRes = 4\n", "at least 2 x 2"),
        ("XRes = 0\nYRes = 4\n", "XRes is `0`"),
        ("XRes = -2\nYRes = 2\n", "XRes is `-2`"),
        ("YRes = 2\n", "lacks the field XRes"),
        ("XRes = 2\nXRes = 2\nYRes = 2\n", "XRes twice"),
        ("XRes = 2\nYRes = 2\nrubbish\n", "name = value"),
        ("XRes = 2\nYRes = 2\nXReal = 0\n", "XReal is `0`"),
        ("XRes = 2\nYRes = 2\nYReal = -1e-6\n", "YReal is `-1e-6`"),
        ("XRes = 2\nYRes = 2\nXReal = nan\n", "positive finite"),
        ("XRes = 2\nYRes = 2\nXOffset = left\n", "XOffset"),
        (
            "XRes = 2\nYRes = 2\nXYUnits = m\nZUnits = V\n",
            "ZUnits is `V`",
        ),
        ("XRes = 2\nYRes = 2\nXYUnits = m\n", "ZUnits is ``"),
        ("XRes = 2\nYRes = 2\nBorder = round\n", "unknown border"),
    ] {
        refused(Gsf, &gsf(header, &four), words);
    }
    let good = "XRes = 2\nYRes = 2\n";
    refused(Gsf, &gsf(good, &[1.0, f32::NEG_INFINITY, 3.0, 4.0]), "-inf");
    refused(Gsf, &gsf(good, &[1.0; 5]), "4 bytes follow");
    let mut text = gsf(good, &four);
    text[30] = 0xff;
    refused(Gsf, &text, "UTF-8");
    refused(Gsf, b"Gwyddion Simple Field 1.0\nXRes = 2\n", "NUL");
    let missing = read(Gsf, &gsf(good, &[1.0, f32::NAN, 3.0, 4.0])).unwrap();
    assert_eq!(missing.missing(), 1);
}

#[test]
fn gsf_brings_lateral_and_height_units_together() {
    let header = "XRes = 3\nYRes = 2\nXReal = 6\nYReal = 2e0\nXYUnits = µm\nZUnits = nm\n\
        XOffset = 1\nYOffset = 2\nTitle = Wäre = gut\n";
    let heights = [250.0, 0.0, -500.0, 1.0, 2.0, 3.0];
    let map = read(HeightMapFormat::Gsf, &gsf(header, &heights)).unwrap();
    assert_eq!(map.border, None);
    let field = map
        .into_height_field(MissingPolicy::Refuse, Border::Mirrored)
        .unwrap();
    assert_eq!(field.unit(), LengthUnit::Micrometre);
    assert_eq!(field.shape(), [2, 3]);
    assert_eq!(field.spacing(), [2.0, 1.0]);
    assert_eq!(field.heights()[..3], [0.25, 0.0, -0.5]);
}

#[test]
fn text_errors_name_line_and_column() {
    use HeightMapFormat::Text;
    let at = |text: &str| match refused(Text, text.as_bytes(), "") {
        ReadError::Text { line, column, .. } => (line, column),
        other => panic!("{other}"),
    };
    assert_eq!(at("1 2 3\n4 x5 6\n"), (2, 3));
    assert_eq!(at("# a comment\n\n1,2\n3, inf\n"), (4, 4));
    assert_eq!(at("1 2\n3 1e999\n"), (2, 3));
    assert_eq!(at("1 2 3\n4 5\n"), (2, 4));
    assert_eq!(at("1 2\n3 4 5\n"), (2, 6));
    assert_eq!(at("h=2 h=2\n1 2\n"), (1, 1));
    assert_eq!(at("h=0 w=2\n1 2\n"), (1, 1));
    assert_eq!(at("h=1 w=2\n1 2\n3 4\n"), (3, 1));
    assert_eq!(at("colour=red\n1 2\n"), (1, 1));
    assert_eq!(at("pixel size=0 m\n1 2\n"), (1, 1));
    assert_eq!(at("pixel size=-1e-6 m\n1 2\n"), (1, 1));
    assert_eq!(at("pixel size=1 V\n1 2\n"), (1, 1));
    assert_eq!(at("pixel size=1\n1 2\n"), (1, 1));
    refused(Text, b"1 2\n3 \xff\n", "line 2, column 3");
    refused(
        Text,
        b"h=4000000000 w=4000000000\n1 2\n",
        "claims 4000000000 x 4000000000",
    );
    refused(Text, b"h=3 w=2\n1 2\n3 4\n", "3 rows were expected");
    refused(
        Text,
        b"h=2 w=2\ndata unit=rad\n1 2\n3 4\n",
        "no `pixel size`",
    );
    refused(
        Text,
        b"pixel size=1 um\ndata unit=rad\n1 2\n3 4\n",
        "conversion factor",
    );
    refused(Text, b"5\n", "at least 2 x 2");
    refused(Text, b"5 6 7 8\n", "at least 2 x 2");
    refused(Text, b"\n# nothing\n", "no numbers");
}

#[test]
fn text_is_read_with_and_without_header() {
    let heights = |text: &str| {
        let map = read(HeightMapFormat::Text, text.as_bytes()).unwrap();
        let shape = map.shape();
        let field = map
            .into_height_field(MissingPolicy::Refuse, Border::Mirrored)
            .unwrap();
        assert_eq!(field.shape(), shape);
        field
    };
    for text in [
        "1 2 3\n4 5 -6e0\n",
        "\u{feff}1,2,3\r\n4,5,-6",
        "# comment\n1\t2\t 3\n\n 4 , 5 , -6 \n",
    ] {
        let field = heights(text);
        assert_eq!(field.shape(), [2, 3]);
        assert_eq!(field.heights(), [1.0, 2.0, 3.0, 4.0, 5.0, -6.0]);
        assert_eq!(field.unit(), LengthUnit::Arbitrary);
        assert_eq!(field.spacing(), [1.0, 1.0]);
    }
    let field = heights("pixel size=2 um\ndata unit=nm\n1 2 3\n4 5 6\n");
    assert_eq!(field.unit(), LengthUnit::Micrometre);
    assert_eq!(field.spacing(), [2.0, 2.0]);
    assert_eq!(field.heights()[0], 0.001);
    let field =
        heights("w=3 h=2\npixel size=2 um\nheight conversion factor (-> m)=1e-9\n1 2 3\n4 5 6\n");
    assert_eq!(field.unit(), LengthUnit::Micrometre);
    assert_eq!(field.heights()[1], 2.0 * 1e-9 * 1e6);
    let holes = read(HeightMapFormat::Text, b"1,,NaN\nbad,5,BAD\n").unwrap();
    assert_eq!(holes.missing(), 4);
}

/// Writes an EXR by the encoder's general interface.
fn exr(width: usize, height: usize, channels: &[(&str, ::exr::image::FlatSamples)]) -> Vec<u8> {
    exr_encoded(
        width,
        height,
        channels,
        ::exr::image::Encoding::FAST_LOSSLESS,
    )
}

fn exr_encoded(
    width: usize,
    height: usize,
    channels: &[(&str, ::exr::image::FlatSamples)],
    encoding: ::exr::image::Encoding,
) -> Vec<u8> {
    use ::exr::prelude::*;
    let channels = channels
        .iter()
        .map(|(name, samples)| AnyChannel::new(*name, samples.clone()))
        .collect();
    let layer = Layer::new(
        (width, height),
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels),
    );
    let mut out = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut out)
        .unwrap();
    out.into_inner()
}

#[test]
fn exr_channels_are_chosen_by_name_and_read_in_every_type() {
    use ::exr::image::FlatSamples;
    use ::exr::prelude::f16;
    use HeightMapFormat::Exr;
    let expected = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let single = FlatSamples::F32(expected.map(|x| x as f32).to_vec());
    let half = FlatSamples::F16(expected.map(f16::from_f64).to_vec());
    let whole = FlatSamples::U32(expected.map(|x| x as u32).to_vec());
    let other = FlatSamples::F32(vec![9.0; 6]);
    for channels in [
        vec![("Z", single.clone()), ("A", other.clone())],
        vec![("Y", half.clone()), ("R", other.clone())],
        vec![
            ("B", other.clone()),
            ("height", whole.clone()),
            ("Z", other.clone()),
        ],
        vec![("anything", half)],
    ] {
        let map = read(Exr, &exr(3, 2, &channels)).unwrap();
        assert_eq!(map.shape(), [2, 3]);
        assert!(map.border.is_none() && map.provenance.is_none());
        let field = map
            .into_height_field(MissingPolicy::Refuse, Border::Periodic)
            .unwrap();
        assert_eq!(field.heights(), expected);
        assert_eq!(field.spacing(), [1.0, 1.0]);
    }
    let colours = [("R", single.clone()), ("G", single), ("B", other)];
    refused(Exr, &exr(3, 2, &colours), "B, G, R");
    let holes = FlatSamples::F32(vec![1.0, f32::NAN, 3.0, 4.0]);
    assert_eq!(read(Exr, &exr(2, 2, &[("Z", holes)])).unwrap().missing(), 1);
    let infinite = FlatSamples::F32(vec![1.0, f32::INFINITY, 3.0, 4.0]);
    refused(
        Exr,
        &exr(2, 2, &[("Z", infinite)]),
        "column 1, row 0 is inf",
    );
    let line = FlatSamples::F32(vec![1.0; 4]);
    refused(Exr, &exr(1, 4, &[("Z", line.clone())]), "at least 2 x 2");
    refused(Exr, &exr(4, 1, &[("Z", line)]), "at least 2 x 2");
}

/// Replaces the value of an EXR attribute by one of the same length.
fn with_attribute(mut bytes: Vec<u8>, name: &str, kind: &str, value: &[u8]) -> Vec<u8> {
    let mark = format!("{name}\0{kind}\0");
    let at = bytes
        .windows(mark.len())
        .position(|w| w == mark.as_bytes())
        .unwrap()
        + mark.len();
    assert_eq!(bytes[at..at + 4], (value.len() as u32).to_le_bytes());
    bytes[at + 4..at + 4 + value.len()].copy_from_slice(value);
    bytes
}

#[test]
fn exr_headers_are_refused_before_allocation() {
    use HeightMapFormat::Exr;
    let window =
        |x: i32, y: i32| -> Vec<u8> { [0, 0, x, y].iter().flat_map(|n| n.to_le_bytes()).collect() };
    for (x, y) in [
        (1 << 30, 1 << 30),
        (i32::MAX - 1, 2),
        (4, 1 << 30),
        (19_999, 19_999),
    ] {
        let blocks = (y + 16) / 16;
        let bytes = with_attribute(valid(Exr), "dataWindow", "box2i", &window(x, y));
        let bytes = with_attribute(bytes, "chunkCount", "int", &blocks.to_le_bytes());
        let error = refused(Exr, &bytes, "");
        println!("{error}");
        // The decoder itself refuses windows of 2^30.
        if x < 20_000 && y < 20_000 {
            assert!(matches!(error, ReadError::TooLarge { .. }), "{error}");
        }
    }
    let zero = with_attribute(valid(Exr), "spacing_x", "double", &0_f64.to_le_bytes());
    refused(Exr, &zero, "spacing along x is 0");
    let negative = with_attribute(valid(Exr), "spacing_y", "double", &(-1_f64).to_le_bytes());
    refused(Exr, &negative, "spacing along y is -1");
    refused(
        Exr,
        &with_attribute(valid(Exr), "unit", "string", b"V"),
        "unknown length unit",
    );
    refused(
        Exr,
        &with_attribute(valid(Exr), "border", "string", b"ajar"),
        "unknown border",
    );
    refused(
        Exr,
        &with_attribute(valid(Exr), "seed", "string", b"x"),
        "whole number",
    );
    refused(
        Exr,
        &with_attribute(valid(Exr), "sigma", "double", &(-1_f64).to_le_bytes()),
        "sigma is -1",
    );
}

#[test]
fn exr_bytes_do_not_depend_on_the_run() {
    // The encoder's hash map gets another order each time.
    let first = valid(HeightMapFormat::Exr);
    for _ in 0..20 {
        assert!(valid(HeightMapFormat::Exr) == first);
    }
}

/// An X3P of the given main.xml and parts, as any ZIP program would pack it.
fn x3p(xml: &str, parts: &[(&str, &[u8])]) -> Vec<u8> {
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for (name, bytes) in [("main.xml", xml.as_bytes())].iter().chain(parts) {
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A main.xml for 3 x 2 points.
fn main_xml(z: &str, data: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\
         <p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\">\
         <Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>\
         <CX><AxisType>I</AxisType><Increment>1e-6</Increment><Offset>0</Offset></CX>\
         <CY><AxisType>I</AxisType><Increment>2e-6</Increment><Offset>0</Offset></CY>\
         <CZ><AxisType>A</AxisType>{z}</CZ></Axes></Record1>\
         <Record3><MatrixDimension><SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ></MatrixDimension>\
         {data}</Record3></p:ISO5436_2>"
    )
}

const LINK: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";
const DATA: &str = "bindata/data.bin";

#[test]
fn x3p_is_read_in_every_type() {
    use HeightMapFormat::X3p;
    let heights = |bytes: &[u8]| {
        let map = read(X3p, bytes).unwrap();
        assert_eq!(map.shape(), [2, 3]);
        assert_eq!(map.unit, LengthUnit::Metre);
        let field = map
            .into_height_field(MissingPolicy::Refuse, Border::Mirrored)
            .unwrap();
        assert_eq!(field.spacing(), [1e-6, 2e-6]);
        field.into_heights()
    };
    let numbers = [1, -2, 3, 4, 5, 100];
    let scaled = numbers.map(|n| f64::from(n) * 0.5 + 10.0);
    let scale = "<Increment>0.5</Increment><Offset>10</Offset>";
    let i16s: Vec<u8> = numbers
        .iter()
        .flat_map(|n| (*n as i16).to_le_bytes())
        .collect();
    let i32s: Vec<u8> = numbers.iter().flat_map(|n: &i32| n.to_le_bytes()).collect();
    let f32s: Vec<u8> = numbers
        .iter()
        .flat_map(|n| (*n as f32).to_le_bytes())
        .collect();
    let f64s: Vec<u8> = numbers
        .iter()
        .flat_map(|n| f64::from(*n).to_le_bytes())
        .collect();
    let z = |kind: &str, scale: &str| format!("<DataType>{kind}</DataType>{scale}");
    assert_eq!(
        heights(&x3p(&main_xml(&z("I", scale), LINK), &[(DATA, &i16s)])),
        scaled
    );
    assert_eq!(
        heights(&x3p(&main_xml(&z("L", scale), LINK), &[(DATA, &i32s)])),
        scaled
    );
    let plain = numbers.map(f64::from);
    assert_eq!(
        heights(&x3p(&main_xml(&z("F", ""), LINK), &[(DATA, &f32s)])),
        plain
    );
    assert_eq!(
        heights(&x3p(&main_xml(&z("D", ""), LINK), &[(DATA, &f64s)])),
        plain
    );
    // A program on Windows may name the part by a backslash.
    let name = "bindata\\data.bin";
    assert_eq!(
        heights(&x3p(&main_xml(&z("D", ""), LINK), &[(name, &f64s)])),
        plain
    );

    let list = "<DataList><Datum>;;1</Datum><Datum>0;0;-2</Datum><Datum>3</Datum>\
        <Datum>4</Datum><Datum>5</Datum><Datum>1e2</Datum></DataList>";
    assert_eq!(heights(&x3p(&main_xml(&z("D", ""), list), &[])), plain);
    let hole = list.replace("0;0;-2", ";;");
    assert_eq!(
        read(X3p, &x3p(&main_xml(&z("D", ""), &hole), &[]))
            .unwrap()
            .missing(),
        1
    );
    let short = list.replace("<Datum>3</Datum>", "");
    refused(X3p, &x3p(&main_xml(&z("D", ""), &short), &[]), "5 data");

    // Bits 1 and 4 are zero, the lowest bit first.
    let masked = LINK.replace(
        "</DataLink>",
        "<ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>",
    );
    let mask: &[u8] = &[0b10_1101];
    let bytes = x3p(
        &main_xml(&z("I", scale), &masked),
        &[(DATA, &i16s), ("bindata/valid.bin", mask)],
    );
    let map = read(X3p, &bytes).unwrap();
    assert_eq!(map.missing(), 2);
    let first = map
        .into_height_field(MissingPolicy::Refuse, Border::Open)
        .unwrap_err();
    assert!(first.to_string().contains("column 1, row 0"), "{first}");
    let infinite: Vec<u8> = [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]
        .iter()
        .flat_map(|x: &f64| x.to_le_bytes())
        .collect();
    refused(
        X3p,
        &x3p(&main_xml(&z("D", ""), LINK), &[(DATA, &infinite)]),
        "column 0, row 1 is inf",
    );
}

#[test]
fn x3p_checksums_are_verified() {
    use HeightMapFormat::X3p;
    let z = "<DataType>D</DataType>";
    let data: &[u8] = &[0; 48];
    // MD5 of 48 zero bytes, by an independent program.
    let right = "b203621a65475445e6fcdca717c667b5";
    let stated = |sum: &str| {
        let sum = format!("<MD5ChecksumPointData>{sum}</MD5ChecksumPointData></DataLink>");
        main_xml(z, &LINK.replace("</DataLink>", &sum))
    };
    assert!(read(X3p, &x3p(&stated(&right.to_uppercase()), &[(DATA, data)])).is_ok());
    refused(
        X3p,
        &x3p(&stated(&right.replace('0', "1")), &[(DATA, data)]),
        "states",
    );
    let line: &[u8] = b"00000000000000000000000000000000 *main.xml\n";
    let bytes = x3p(
        &main_xml(z, LINK),
        &[(DATA, data), ("md5checksum.hex", line)],
    );
    refused(X3p, &bytes, "part `main.xml`");
    let masked = LINK.replace(
        "</DataLink>",
        "<ValidPointsLink>v</ValidPointsLink>\
         <MD5ChecksumValidPoints>00</MD5ChecksumValidPoints></DataLink>",
    );
    let bytes = x3p(&main_xml(z, &masked), &[(DATA, data), ("v", &[0xff])]);
    refused(X3p, &bytes, "part `v`");
    // Any damage to the stored samples of our own files is found.
    let mut own = valid(X3p);
    let sample = field().heights()[7].to_le_bytes();
    let at = own.windows(8).position(|w| w == sample).unwrap();
    own[at] ^= 1;
    refused(X3p, &own, "damaged");
}

#[test]
fn x3p_headers_are_checked() {
    use HeightMapFormat::X3p;
    let data: &[u8] = &[0; 48];
    let z = "<DataType>D</DataType>";
    let good = main_xml(z, LINK);
    assert!(read(X3p, &x3p(&good, &[(DATA, data)])).is_ok());
    let size = "<SizeX>3</SizeX><SizeY>2</SizeY>";
    let huge = |n: &str| format!("<SizeX>{n}</SizeX><SizeY>{n}</SizeY>");
    for (old, new, words) in [
        (
            size,
            huge("4000000000").as_str(),
            "claims 4000000000 x 4000000000",
        ),
        (size, huge("18446744073709551615").as_str(), "claims"),
        (size, huge("99999999999999999999").as_str(), "whole number"),
        (size, huge("1").as_str(), "at least 2 x 2"),
        (size, huge("0").as_str(), "at least 2 x 2"),
        (size, huge("-3").as_str(), "whole number"),
        (size, "<SizeX>3</SizeX><SizeY>3</SizeY>", "claims 48 bytes"),
        (size, "<SizeX>3</SizeX>", "lacks SizeY"),
        (
            "<SizeX>3</SizeX>",
            "<SizeX>3</SizeX><SizeX>3</SizeX>",
            "SizeX twice",
        ),
        ("<SizeZ>1</SizeZ>", "<SizeZ>2</SizeZ>", "2 layers"),
        (
            "<AxisType>I</AxisType><Increment>1e-6",
            "<AxisType>A</AxisType><Increment>1e-6",
            "axis CX is of type `A`",
        ),
        ("<Increment>1e-6</Increment>", "", "lacks Increment"),
        (
            "<Increment>1e-6</Increment>",
            "<Increment>0</Increment>",
            "spacing along x is 0",
        ),
        (
            "<Increment>2e-6</Increment>",
            "<Increment>-1</Increment>",
            "spacing along y is -1",
        ),
        (
            "<Increment>2e-6</Increment>",
            "<Increment>wide</Increment>",
            "`wide`",
        ),
        (z, "<DataType>L</DataType>", "no Increment"),
        (z, "<DataType>Q</DataType>", "I, L, F and D"),
        (
            z,
            "<DataType>D</DataType><Increment>0</Increment>",
            "not zero",
        ),
        (
            "<AxisType>A</AxisType>",
            "<AxisType>I</AxisType>",
            "CZ is of type `I`",
        ),
        ("SUR", "PCL", "`PCL`"),
        ("MatrixDimension", "ListDimension", "list of points"),
        (DATA, "elsewhere.bin", "no part `elsewhere.bin`"),
        (LINK, "", "lacks DataList"),
        ("p:ISO5436_2", "p:Other", "`Other`"),
        ("</Record3>", "", "cannot be parsed"),
    ] {
        assert!(good.contains(old), "{old}");
        refused(X3p, &x3p(&good.replace(old, new), &[(DATA, data)]), words);
    }
    refused(X3p, &x3p("", &[(DATA, data)]), "cannot be parsed");
    let deep = format!("{}{}", "<a>".repeat(200_000), "</a>".repeat(200_000));
    refused(X3p, &x3p(&deep, &[]), "ISO5436_2 is needed");
    let bomb = "<!DOCTYPE a [<!ENTITY b \"bbbb\">]><a>&b;</a>";
    refused(X3p, &x3p(bomb, &[]), "cannot be parsed");
    let parts = x3p(&good, &[("other", data)]);
    refused(X3p, &parts, "no part `bindata/data.bin`");
    // Deflated zeros, a thousandfold: within what deflate can do, but not what the axes say.
    refused(
        X3p,
        &x3p(&good, &[(DATA, &vec![0; 10_000_000])]),
        "claims 10000000 bytes",
    );
    let text = [good.as_bytes(), b"<!-- \xff -->"].concat();
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    archive
        .start_file("main.xml", zip::write::SimpleFileOptions::default())
        .unwrap();
    std::io::Write::write_all(&mut archive, &text).unwrap();
    let bytes = archive.finish().unwrap().into_inner();
    refused(X3p, &bytes, "not UTF-8");
}

#[test]
fn png_is_refused_for_want_of_a_scale() {
    let error = crate::read_height_map(Path::new("height.png")).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("carry neither heights nor spacings"),
        "{error}"
    );
}
