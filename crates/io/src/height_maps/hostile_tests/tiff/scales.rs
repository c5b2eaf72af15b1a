//! Scales of TIFF files: spacings, units and orientations, by the tags of several programs.

use asperity_surface::LengthUnit;

use super::made::{Page, Values};
use super::{HEIGHTS, OME, Tags, filled, heights_of, map, page, read, refused, terrain};
use crate::formats::HeightMapFormat::Tiff;

const US_FOOT: f64 = 1200.0 / 3937.0;

#[test]
fn terrain_has_spacing_unit_and_missing_points() {
    let terrain = read(Tiff, &terrain()).unwrap();
    assert_eq!((terrain.shape(), terrain.missing()), ([2, 3], 1));
    assert_eq!(terrain.unit, LengthUnit::Metre);
    assert!(terrain.spacing_is_known() && terrain.notes.is_empty());
    let field = filled(terrain);
    assert_eq!(field.spacing(), [30.0, 20.0]);
    assert_eq!(field.height(1, 1), 13.25);
}

#[test]
fn a_bad_scale_or_offset_is_named() {
    for role in ["scale", "offset"] {
        let metadata = format!(
            "<GDALMetadata><Item name=\"X\" sample=\"0\" role=\"{role}\">ten</Item></GDALMetadata>"
        );
        let file = map(Tags {
            metadata: Some(&metadata),
            ..Tags::default()
        });
        let said = read(Tiff, &file).unwrap_err().to_string();
        assert!(
            said.contains(&format!("the {role} of its heights is `ten`")),
            "{said}"
        );
    }
}

#[test]
fn feet_are_brought_to_metres_and_heights_are_scaled() {
    let file = map(Tags {
        matrix: Some(&[
            0.0, 10.0, 0.0, 5e5, 20.0, 0.0, 0.0, 4e6, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
        ]),
        keys: &[[1024, 1], [3076, 9002], [4099, 9003]],
        nodata: Some("14"),
        metadata: Some(
            "<GDALMetadata><Item name=\"OFFSET\" sample=\"0\" role=\"offset\">100</Item>\
             <Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.5</Item></GDALMetadata>",
        ),
        ..Tags::default()
    });
    let map = read(Tiff, &file).unwrap();
    assert_eq!(map.missing(), 1);
    let field = filled(map);
    // Columns run along y on this map
    assert_eq!(field.spacing(), [20.0 * 0.3048, 10.0 * 0.3048]);
    assert_eq!(field.height(0, 0), 105.0 * US_FOOT);
}

/// Heights and notes of a map with the matrix of columns and rows `[x_column, x_row, y_column, y_row]`.
fn placed([a, b, c, d]: [f64; 4]) -> (Vec<f64>, Vec<String>) {
    let file = map(Tags {
        matrix: Some(&[a, b, 0.0, 5e5, c, d, 0.0, 4e6]),
        keys: &[[1024, 1], [3076, 9001], [4099, 9001]],
        ..Tags::default()
    });
    let map = read(Tiff, &file).unwrap();
    let notes = map.notes.clone();
    let field = filled(map);
    (field.heights().to_vec(), notes)
}

#[test]
fn the_first_row_is_that_of_the_north_and_the_first_column_of_the_west() {
    let stored = HEIGHTS.map(f64::from);
    let [a, b, c, d, e, f] = stored;
    for (matrix, expected) in [
        ([2.0, 0.0, 0.0, -3.0], stored),
        ([2.0, 0.0, 0.0, 3.0], [d, e, f, a, b, c]),
        ([-2.0, 0.0, 0.0, -3.0], [c, b, a, f, e, d]),
        ([-2.0, 0.0, 0.0, 3.0], [f, e, d, c, b, a]),
    ] {
        assert_eq!(placed(matrix), (expected.to_vec(), vec![]), "{matrix:?}");
    }
    // Turned, as stored and mirrored.
    let turned = "its rows run 45.0 deg counter-clockwise from east";
    for (matrix, expected) in [
        ([1.0, 1.0, 1.0, -1.0], stored),
        ([1.0, -1.0, 1.0, 1.0], [d, e, f, a, b, c]),
    ] {
        let (heights, notes) = placed(matrix);
        assert_eq!(heights, expected, "{matrix:?}");
        assert!(notes.iter().any(|note| note.contains(turned)), "{notes:?}");
    }
}

#[test]
fn an_orientation_that_is_ignored_is_named() {
    for (orientation, is_named) in [(1, false), (4, true), (6, true)] {
        let file = page(Tags::default()).with_short(274, orientation).bytes();
        let notes = read(Tiff, &file).unwrap().notes;
        let named = notes.iter().any(|note| note.contains("Orientation"));
        assert_eq!(named, is_named, "{notes:?}");
    }
}

#[test]
fn units_follow_from_the_codes_of_coordinate_systems() {
    let grid = "the file states no unit for its grid; metres are assumed";
    let vertical = "the file states no unit for its heights; metres are assumed, though its grid is in units of 0.3048 m";
    let both = "the file states no unit for its grid and its heights; metres are assumed";
    let unknown = "the file states no unit for its grid (system EPSG:33999, which is not known); metres are assumed";
    for (keys, spacing, height, note) in [
        (&[[1024, 1], [3072, 2263]][..], US_FOOT, 1.0, vertical),
        (&[[3072, 2263]], US_FOOT, 1.0, vertical),
        (&[[1024, 1], [3072, 2227], [4096, 5703]], US_FOOT, 1.0, ""),
        (
            &[[1024, 1], [3072, 32064], [4096, 6360]],
            US_FOOT,
            US_FOOT,
            "",
        ),
        (&[[1024, 1], [3072, 2256], [4096, 8228]], 0.3048, 0.3048, ""),
        (&[[1024, 1], [3072, 32633], [4096, 6360]], 1.0, US_FOOT, ""),
        // A compound system of feet, and Clarke's link, with the last code of a range
        (&[[1024, 1], [3072, 8712]], US_FOOT, US_FOOT, ""),
        (
            &[[1024, 1], [3072, 30200], [4096, 5703]],
            0.201_166_195_164,
            1.0,
            "",
        ),
        (&[[1024, 1], [3072, 3360], [4099, 9001]], 1.0, 1.0, ""),
        // The keys of units count more than the system
        (
            &[[1024, 1], [3072, 2263], [3076, 9001], [4099, 9002]],
            1.0,
            0.3048,
            "",
        ),
        (&[[1024, 1], [3072, 32767], [4099, 9001]], 1.0, 1.0, grid),
        (&[[1024, 1], [3072, 33999], [4099, 9001]], 1.0, 1.0, unknown),
        (&[[1024, 1]], 1.0, 1.0, both),
    ] {
        let file = map(Tags {
            pixel_scale: Some(&[30.0, 30.0, 0.0]),
            keys,
            ..Tags::default()
        });
        let map = read(Tiff, &file).unwrap();
        assert_eq!(map.notes.join(""), note, "{keys:?}");
        assert_eq!(map.unit, LengthUnit::Metre);
        let field = filled(map);
        assert_eq!(
            (field.spacing()[0], field.height(0, 0)),
            (30.0 * spacing, 10.0 * height),
            "{keys:?}"
        );
    }
    let named = page(Tags {
        pixel_scale: Some(&[1.0, 1.0, 0.0]),
        keys: &[[1024, 1], [3072, 32767], [4099, 9001]],
        ..Tags::default()
    });
    let notes = read(
        Tiff,
        &named.with_text(34737, "State plane, US feet|").bytes(),
    )
    .unwrap();
    assert_eq!(
        notes.notes,
        [
            "the file states no unit for its grid (called `State plane, US feet|`); metres are assumed"
        ]
    );
    let depth = map(Tags {
        pixel_scale: Some(&[1.0, 1.0, 0.0]),
        keys: &[[1024, 1], [3076, 9001], [4096, 5715]],
        ..Tags::default()
    });
    let notes = read(Tiff, &depth).unwrap().notes;
    assert!(notes[0].contains("EPSG:5715 counts downwards"), "{notes:?}");
    // A unit without a code: its size stands among the numbers of double precision
    let sized = page(Tags {
        pixel_scale: Some(&[2.0, 2.0, 0.0]),
        keys: &[[1024, 1], [3076, 32767], [4099, 9001]],
        ..Tags::default()
    });
    let Some((_, Values::Short(mut keys))) =
        sized.tags.iter().find(|(tag, _)| *tag == 34735).cloned()
    else {
        unreachable!("the page has keys");
    };
    keys.extend([3077, 34736, 1, 1]);
    let sized = sized
        .with(34735, Values::Short(keys))
        .with(34736, Values::Double(vec![7.0, 0.25]));
    let map = read(Tiff, &sized.bytes()).unwrap();
    assert!(map.notes.is_empty());
    let field = filled(map);
    assert_eq!(field.spacing(), [0.5, 0.5]);
}

#[test]
fn units_of_heights_are_read_from_metadata() {
    let unit = |name| {
        format!(
            "<GDALMetadata><Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">{name}</Item></GDALMetadata>"
        )
    };
    for (name, metres) in [
        ("ft", 0.3048),
        ("US survey foot", US_FOOT),
        ("m", 1.0),
        ("mm", 1e-3),
    ] {
        let metadata = unit(name);
        let tags = Tags {
            metadata: Some(&metadata),
            ..Tags::default()
        };
        let plain = read(Tiff, &map(tags)).unwrap();
        assert!(!plain.spacing_is_known() && plain.unit == LengthUnit::Metre);
        assert_eq!(heights_of(plain)[0], 10.0 * metres);
        let geographic = Tags {
            pixel_scale: Some(&[2.0, 2.0, 0.0]),
            keys: &[[1024, 1], [3076, 9001], [4096, 5703]],
            ..tags
        };
        let read = read(Tiff, &map(geographic)).unwrap();
        assert!(read.notes.is_empty());
        assert_eq!(heights_of(read)[0], 10.0 * metres);
    }
    let metadata = unit("K");
    let file = map(Tags {
        metadata: Some(&metadata),
        ..Tags::default()
    });
    refused(Tiff, &file, "the unit of its heights is `K`");
}

#[test]
fn what_is_assumed_is_noted() {
    let plain = read(Tiff, &map(Tags::default())).unwrap();
    assert!(!plain.spacing_is_known() && plain.unit == LengthUnit::Arbitrary);
    assert_eq!(plain.missing(), 0);
    assert!(plain.notes.is_empty());
}

/// The page of a plain file with a description and a resolution of `5 / 2` and `5 / 4`.
fn described(text: &str) -> Page {
    page(Tags::default())
        .with_text(270, text)
        .with(282, Values::Quotient(5, 2))
        .with(283, Values::Quotient(5, 4))
        .with_short(296, 1)
}

#[test]
fn scales_of_imagej_and_ome_are_read() {
    let assumed = |unit| {
        format!("the file states no unit for its heights; `{unit}`, that of its grid, is assumed")
    };
    let imagej = "ImageJ=1.54f\nimages=1\n";
    for (text, spacing, unit, first, note) in [
        (
            format!("{imagej}unit=um\n"),
            [0.4, 0.8],
            LengthUnit::Micrometre,
            10.0,
            assumed("um"),
        ),
        (
            format!("{imagej}unit=\\u00B5m\n"),
            [0.4, 0.8],
            LengthUnit::Micrometre,
            10.0,
            assumed("\u{b5}m"),
        ),
        (
            format!("{imagej}unit=micron\nyunit=nm\n"),
            [0.4, 8e-4],
            LengthUnit::Micrometre,
            10.0,
            assumed("micron"),
        ),
        (
            format!("{imagej}unit=Micrometres\nyunit=nanometer\n"),
            [0.4, 8e-4],
            LengthUnit::Micrometre,
            10.0,
            assumed("Micrometres"),
        ),
        (
            format!("{imagej}unit=millimeter\n"),
            [0.4, 0.8],
            LengthUnit::Millimetre,
            10.0,
            assumed("millimeter"),
        ),
        (
            format!("{imagej}unit=Angstrom\nyunit=\u{c5}\n"),
            [0.4e-10, 0.8e-10],
            LengthUnit::Metre,
            10e-10,
            assumed("Angstrom"),
        ),
        (
            OME.replace(" PhysicalSizeY=\"0.5\"", ""),
            [250.0, 250.0],
            LengthUnit::Nanometre,
            10.0,
            format!(
                "the file states a spacing along x alone: it is taken for both axes{}",
                assumed("nm")
            ),
        ),
        (
            format!("{imagej}unit=inch\n"),
            [1.016e-2, 2.032e-2],
            LengthUnit::Metre,
            0.254,
            assumed("inch"),
        ),
        (
            format!("{imagej}unit=mm\ncf=0\nc0=-5\nc1=2\nvunit=um\n"),
            [0.4, 0.8],
            LengthUnit::Millimetre,
            0.015,
            String::new(),
        ),
        (
            OME.to_owned(),
            [250.0, 500.0],
            LengthUnit::Nanometre,
            10.0,
            assumed("nm"),
        ),
        (
            OME.replace(" PhysicalSizeXUnit=\"nm\"", "")
                .replace(" PhysicalSizeYUnit=\"&#181;m\"", ""),
            [250.0, 0.5],
            LengthUnit::Micrometre,
            10.0,
            assumed("\u{b5}m"),
        ),
    ] {
        let map = read(Tiff, &described(&text).bytes()).unwrap();
        assert!(map.spacing_is_known(), "{text}");
        assert_eq!((map.unit, map.notes.join("")), (unit, note), "{text}");
        let field = filled(map);
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-15 * b;
        let found = field.spacing();
        assert!(
            close(found[0], spacing[0]) && close(found[1], spacing[1]),
            "{text}: {found:?}"
        );
        assert!(close(field.height(0, 0), first), "{text}");
    }
    for (text, words) in [
        (format!("{imagej}cf=20\n"), "has the function 20"),
        (format!("{imagej}cf=0\nc0=1\n"), "lacks c1"),
        (
            format!("{imagej}vunit=OD\n"),
            "the unit of its heights is `OD`",
        ),
        (
            OME.replace("\"250\"", "\"wide\""),
            "PhysicalSizeX is `wide`",
        ),
        (OME.replace("SizeX=\"3\"", "SizeX=3"), "its OME metadata"),
    ] {
        refused(Tiff, &described(&text).bytes(), words);
    }
}

#[test]
fn a_scale_that_is_not_taken_is_named() {
    let imagej = "ImageJ=1.54f\nunit=";
    for (page, note) in [
        (described(&format!("{imagej}pixel\n")), ""),
        (
            described(&format!("{imagej}sec\n")),
            "the file states a spacing of 0.4 x 0.8 in `sec`, which is no unit of length",
        ),
        (
            described("made by hand"),
            "the file has a resolution of 2.5 x 1.25 samples per unit, which many programs write without a measurement: \
             it is not taken for a spacing, which would be 0.4 x 0.8",
        ),
        (
            described("").with_short(296, 3),
            "the file has a resolution of 2.5 x 1.25 samples per cm, which many programs write without a measurement: \
             it is not taken for a spacing, which would be 4000 x 8000 um",
        ),
        (
            page(Tags::default()).with_text(34682, "[Scan]\nPixelWidth=1e-9\n"),
            "the scale that FEI may have written (tag 34682) is not read",
        ),
    ] {
        let map = read(Tiff, &page.bytes()).unwrap();
        assert!(!map.spacing_is_known());
        assert_eq!(map.notes.join(""), note);
    }
}
