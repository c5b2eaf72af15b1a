//! Text matrices: where errors are, and headers of instruments.

use asperity_surface::{Border, LengthUnit, MissingPolicy};

use super::{filled, read, refused, whole};
use crate::damage_tests::changes;
use crate::error::ReadProblem;
use crate::formats::HeightMapFormat;

#[test]
fn text_errors_name_line_and_column() {
    use HeightMapFormat::Text;
    let at = |text: &str| match refused(Text, text.as_bytes(), "").problem {
        ReadProblem::Text { line, column, .. } => (line, column),
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
        let field = whole(map);
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

/// Rows x, y, z of an `nx` x `ny` grid of these steps, z = 10 iy + ix.
fn points([nx, ny]: [usize; 2], [dx, dy]: [f64; 2]) -> Vec<String> {
    let row = |iy: usize, ix: usize| {
        let (x, y) = (5.0 + dx * ix as f64, -3.0 + dy * iy as f64);
        format!("{x:.4} {y:.4} {}", 10 * iy + ix)
    };
    let rows = (0..ny).flat_map(|iy| (0..nx).map(move |ix| row(iy, ix)));
    rows.collect()
}

#[test]
fn lists_of_points_on_a_grid_are_maps() {
    let list = points([5, 4], [1.0 / 3.0, 0.5]);
    let expected: Vec<f64> = (0..20).map(|k| f64::from(10 * (k / 5) + k % 5)).collect();
    let mut reversed = list.clone();
    reversed.reverse();
    for (heading, rows) in [("", &list), ("x,y,z\n", &reversed)] {
        let text = format!("{heading}{}\n", rows.join("\n"));
        let map = read(HeightMapFormat::Text, text.as_bytes()).unwrap();
        assert!(map.spacing_is_known() && map.shape() == [4, 5]);
        let field = whole(map);
        assert_eq!(field.heights(), expected);
        let [dx, dy] = field.spacing();
        assert!((dx - 1.0 / 3.0).abs() < 1e-4 && (dy - 0.5).abs() < 1e-4);
    }
    // A list may leave out points that were not measured.
    let holes = [&list[..7], &list[9..]].concat().join("\n");
    let map = read(HeightMapFormat::Text, holes.as_bytes()).unwrap();
    assert_eq!((map.shape(), map.missing()), ([4, 5], 2));
}

#[test]
fn lists_of_points_on_no_grid_are_refused() {
    let list = points([5, 4], [1.0, 1.0]);
    let change = |old: &str, new: &str| list.join("\n").replacen(old, new, 1);
    for text in [
        // One point off the grid, twice on one place, without a place
        change("6.0000", "6.4000"),
        change("6.0000", "5.0000"),
        change("6.0000", "nan"),
    ] {
        refused(HeightMapFormat::Text, text.as_bytes(), "points x, y, z");
    }
    // Few rows of three columns are a matrix.
    let matrix = read(HeightMapFormat::Text, b"1 2 3\n4 5 6\n7 8 9\n").unwrap();
    assert_eq!(matrix.shape(), [3, 3]);
}

const GWYDDION: &str = "# Channel: Topography\n# Width: 50 \u{b5}m\n# Height: 20,5 \u{b5}m\n\
    # Value units: nm\n1 2 3 4\n5 6 7 8\n";

#[test]
fn comments_of_gwyddion_give_scale_and_unit() {
    let map = read(HeightMapFormat::Text, GWYDDION.as_bytes()).unwrap();
    let field = whole(map);
    assert_eq!(field.unit(), LengthUnit::Micrometre);
    assert_eq!(field.spacing(), [12.5, 10.25]);
    assert_eq!(field.heights()[1], 2.0 / 1000.0);

    let cases = r"
        Value units: nm => Value units: V => `Value units` is `V`
        # Value units: nm\n =>  => `Value units` is missing
        Width: 50 µm => Width: 50 => `Width` is `50`
        Width: 50 µm => Width: -1 m => `Width` is `-1 m`
        # Width: 50 µm\n =>  => `Width` is missing
    ";
    for (text, words) in changes(GWYDDION, cases) {
        refused(HeightMapFormat::Text, text.as_bytes(), words);
    }
    // A comment of one such name alone is any comment.
    let text = b"# Height: varies\n1 2\n3 4\n";
    assert!(
        !read(HeightMapFormat::Text, text)
            .unwrap()
            .spacing_is_known()
    );
}

const TERRAIN: &str = "ncols 3\nnrows 2\nxllcorner 0\nYLLCENTER 7.5\ncellsize 25\n\
    NODATA_value -1\n1 2 -1\n4 5 6\n";

#[test]
fn grids_of_terrain_have_their_cell_size_and_missing_points() {
    let map = read(HeightMapFormat::Text, TERRAIN.as_bytes()).unwrap();
    assert!(map.spacing_is_known() && map.unit == LengthUnit::Arbitrary);
    assert_eq!((map.shape(), map.missing()), ([2, 3], 1));
    let field = map
        .into_height_field(MissingPolicy::Fill, Border::Mirrored)
        .unwrap();
    assert_eq!(field.spacing(), [25.0, 25.0]);
    let cases = r"
        ncols 3 => ncols 4 => 4 x 2 numbers were expected
        nrows 2 => nrows 3 => 3 x 3 numbers were expected
        nrows 2 => nrows 1 => not a valid text matrix: 3 x 1
        nrows 2 => nrows 4000000000 => claims
        ncols 3 => ncols x => ncols is `x`
        cellsize 25 => cellsize 0 => cellsize is `0`
        cellsize 25\n =>  => no cellsize
    ";
    for (text, words) in changes(TERRAIN, cases) {
        refused(HeightMapFormat::Text, text.as_bytes(), words);
    }
    let unequal = TERRAIN.replace("cellsize 25", "dx 2\ndy 3");
    let map = read(HeightMapFormat::Text, unequal.as_bytes()).unwrap();
    let field = filled(map);
    assert_eq!(field.spacing(), [2.0, 3.0]);
}

/// The heights of a text, and how many of them are missing.
fn heights_of(text: &str) -> (Vec<f64>, usize, [usize; 2]) {
    let map = read(HeightMapFormat::Text, text.as_bytes()).unwrap();
    let (missing, shape) = (map.missing(), map.shape());
    let field = filled(map);
    (field.into_heights(), missing, shape)
}

#[test]
fn lines_of_terrain_end_anywhere() {
    let plain = heights_of(TERRAIN);
    for text in [
        TERRAIN.replace("1 2 -1\n4 5 6", "1 2\n-1 4 5\n\n6"),
        TERRAIN.replace("1 2 -1\n4 5 6", "1 2 -1 4 5 6"),
        TERRAIN.replace('\n', " "),
        TERRAIN.replace('\n', "\t\r\n"),
    ] {
        assert_eq!(heights_of(&text), plain, "{text}");
    }
    // Lines of the length of the columns are rather rows that were exchanged with them.
    let exchanged = TERRAIN.replace("1 2 -1\n4 5 6", "1 2\n-1 4\n5 6");
    refused(HeightMapFormat::Text, exchanged.as_bytes(), "exchanged");
}

#[test]
fn marks_of_missing_points_of_terrain_are_words_and_rounded_numbers() {
    let single = "-3.40282346638528898e+38";
    for (mark, number) in [
        ("null", "null"),
        ("nan", "nan"),
        ("missing", "Missing"),
        ("-inf", "-inf"),
        ("x", "X"),
        (single, "-3.4028235e+38"),
        ("-3.4028235e+38", single),
        ("1e20", "100000002004087734272"),
        ("-9999", "-9999.0"),
        ("-3.40282e+38", single),
        ("-3.402823E+38", "-3.4028235e+38"),
        (single, "-3.403e+38"),
        ("-1.70141e+38", "-170141183460469231731687303715884105728"),
        ("-1.797693134862316e+308", "-1.7976931348623157e+308"),
        ("-9999.9", "-9999.900390625"),
        ("-9999.900390625", "-9999.9"),
        ("-9999.9", "-9999.9004"),
    ] {
        let text = TERRAIN.replace("value -1", &format!("value {mark}"));
        let text = text.replace("2 -1", &format!("2 {number}"));
        assert_eq!(heights_of(&text).1, 1, "{mark}");
    }
    for (mark, height) in [
        ("-9999", "-9999.0004"),
        ("-9999", "-9998.9991"),
        ("-9999.4", "-9999"),
        ("-999999", "-999999.4"),
        ("100000000", "100000003"),
        ("100000003", "100000000"),
    ] {
        let text = TERRAIN.replace("value -1", &format!("value {mark}"));
        let text = text.replace("2 -1", &format!("2 {height}"));
        assert_eq!(heights_of(&text).1, 0, "{mark}");
    }
    let default = TERRAIN.replace("NODATA_value -1\n", "");
    let default = default.replace("2 -1", "2 -9999");
    assert_eq!(heights_of(&default).1, 1);
    let unknown = TERRAIN.replace("2 -1", "2 x");
    refused(
        HeightMapFormat::Text,
        unknown.as_bytes(),
        "`x` is not a number",
    );
}

/// Rows of heights without a pattern, separated by `separator`.
fn rough([nx, ny]: [usize; 2], separator: &str) -> Vec<String> {
    let height = |y: usize, x: usize| format!("{:.3}", ((7 * x + 13 * y * y) as f64).sin());
    let row = |y: usize| (0..nx).map(|x| height(y, x)).collect::<Vec<_>>();
    (0..ny).map(|y| row(y).join(separator)).collect()
}

#[test]
fn profiles_are_refused_in_every_arrangement() {
    use HeightMapFormat::Text;
    let heights = rough([1, 40], "");
    let line = |separator: &str, is_first: bool| {
        let pairs = heights.iter().enumerate().map(|(i, z)| match is_first {
            true => format!("{}{separator}{z}\n", 0.5 * i as f64),
            false => format!("{z}{separator}{}\n", -0.5 * i as f64),
        });
        pairs.collect::<String>()
    };
    let mut texts = vec![line(" ", true), line(", ", true), line("\t", false)];
    texts.push(line(";", true).replace('.', ","));
    texts.push(line(" ", true).replace('.', ","));
    texts.push("# x z\n0 1\n1 3\n2 2\n".to_owned());
    texts.push(rough([2, 40], " ").join("\n"));
    let positions: Vec<String> = (0..40).map(|i| format!("{i}.5")).collect();
    texts.push(format!("{}\n{}\n", positions.join(","), heights.join(",")));
    for text in texts {
        refused(Text, text.as_bytes(), "look like a profile");
    }
    assert_eq!(heights_of("1 2\n3 4\n").2, [2, 2]);
    assert_eq!(heights_of("1 2\n3 4\n0 1\n").2, [3, 2]);
}

#[test]
fn numbers_of_rows_and_columns_are_no_heights() {
    use HeightMapFormat::Text;
    for separator in [",", ";", "\t"] {
        let rows = rough([16, 12], separator);
        let above = |first: usize| {
            let names: Vec<String> = (0..16).map(|i| (first + 2 * i).to_string()).collect();
            names.join(separator)
        };
        let beside: Vec<String> = rows
            .iter()
            .enumerate()
            .map(|(y, row)| format!("{y}{separator}{row}"))
            .collect();
        let table = [vec![above(0)], rows.clone()].concat().join("\n");
        refused(Text, table.as_bytes(), "in its first row are in ascending");
        refused(
            Text,
            beside.join("\n").as_bytes(),
            "in its first column are",
        );
        let corner = if separator == "\t" {
            "nan\t"
        } else {
            separator
        };
        for corner in [corner, &format!("-1{separator}"), &format!("0{separator}")] {
            let head = format!("{corner}{}", above(1));
            let table = [vec![head], beside.clone()].concat().join("\n");
            refused(Text, table.as_bytes(), "index=False");
        }
        let words = format!("a{separator}b\n{}", rows.join("\n"));
        refused(Text, words.as_bytes(), "a heading above the numbers");
        assert_eq!(heights_of(&rows.join("\n")).2, [12, 16]);
    }
    // Rounded and uneven steps, with a row of the same kind above or without
    for step in [
        |i: usize| format!("{:.2}", i as f64 / 3.0),
        |i: usize| format!("{:.1}", -(1.4_f64.powi(i as i32))),
    ] {
        let rows = rough([16, 12], ",");
        let beside = rows.iter().enumerate();
        let beside: Vec<String> = beside
            .map(|(y, row)| format!("{},{row}", step(y)))
            .collect();
        refused(
            Text,
            beside.join("\n").as_bytes(),
            "in its first column are",
        );
        let names: Vec<String> = (0..16).map(step).collect();
        let table = [vec![format!(",{}", names.join(","))], beside].concat();
        refused(
            Text,
            table.join("\n").as_bytes(),
            "first row and first column",
        );
    }
    // A column of a smooth surface may rise alone.
    let height = |x: usize, y: usize| (0.45 * (y as f64 - 4.0) + 0.5 * x as f64).sin();
    let row = |y| {
        (0..12)
            .map(|x| format!("{:.4}", height(x, y)))
            .collect::<Vec<_>>()
    };
    let smooth: Vec<String> = (0..8).map(|y| row(y).join(" ")).collect();
    assert_eq!(heights_of(&smooth.join("\n")).2, [8, 12]);
    let gap = "0 1 2 3\n1 nan 3 4\n2 3 4 5\n";
    assert_eq!(heights_of(gap).1, 1);
    // A plane is a surface.
    let plane = |y: usize| {
        (0..9)
            .map(|x| (x + 3 * y).to_string())
            .collect::<Vec<_>>()
            .join(" ")
    };
    let plane: Vec<String> = (0..9).map(plane).collect();
    assert_eq!(heights_of(&plane.join("\n")).2, [9, 9]);
}

#[test]
fn separators_at_either_end_are_no_points() {
    for (separator, end) in [
        (",", ","),
        (";", ";"),
        ("\t", "\t"),
        (",", ",,, "),
        (";", "; ;"),
    ] {
        let rows = rough([5, 4], separator);
        let plain_rows = rows.join("\n");
        let plain = heights_of(&plain_rows);
        let ended = rows.join(&format!("{end}\n")) + end;
        assert_eq!(heights_of(&ended), plain, "{ended}");
        if separator != "\t" {
            for begun in [&plain_rows, &ended] {
                let begun = format!(
                    "{separator}{}",
                    begun.replace('\n', &format!("\n{separator}"))
                );
                assert_eq!(heights_of(&begun), plain, "{begun}");
                assert_eq!(heights_of(&format!("w=5 h=4\n{begun}")), plain, "{begun}");
            }
        }
        let below = format!("{ended}\n{}\n", separator.repeat(5));
        assert_eq!(heights_of(&below), plain, "{below}");
        let stated = format!("w=5 h=4\n{ended}");
        assert_eq!(heights_of(&stated), plain, "{stated}");
    }
    // A point or row that is missing among others stays missing.
    assert_eq!(heights_of("1,2,\n3,4,5\n0,7,8\n").1, 1);
    assert_eq!(heights_of(",1,2\n3,4,5\n0,7,8\n").1, 1);
    assert_eq!(heights_of("1,2,7\n,,\n0,7,8\n").1, 3);
}

#[test]
fn decimal_commas_are_told_from_separators() {
    let plain = heights_of("0.5 1.25 -3\n2 4.5 6e-1\n");
    for text in [
        "0,5 1,25 -3\n2 4,5 6e-1\n",
        "0,5;1,25;-3\n2;4,5;6e-1\n",
        "0,5\t1,25\t-3\n2\t4,5\t6e-1\n",
        "0.5, 1.25, -3\n2, 4.5, 6e-1\n",
        "0.5 ,1.25 ,-3\n2 ,4.5 ,6e-1\n",
        "0.5;1.25;-3\n2;4.5;6e-1\n",
        "! by hand\n% by hand\n0.5,1.25,-3\n// between\n2,4.5,6e-1\n",
    ] {
        assert_eq!(heights_of(text), plain, "{text}");
    }
    refused(
        HeightMapFormat::Text,
        b"1.234,5;2\n3;4\n",
        "`1.234,5` is not a number; numbers are needed, or nan or bad for missing points; digits in groups are not read",
    );
}

#[test]
fn exponents_of_fortran_and_lines_of_old_macintoshes_are_read() {
    let plain = heights_of("0.5 1.25 -300\n2 4.5 6e-1\n");
    for text in [
        "0.5D0 1.25d+00 -3D+02\n2 4.5 6D-1\n",
        "0.5D0,1.25d+00,-3D+02\n2,4.5,6D-1\n",
        "0,5D0;1,25d+00;-3D+02\n2;4,5;6D-1\n",
        "0.5 1.25 -300\r2 4.5 6e-1\r",
        "# by hand\r0.5 1.25 -300\r2 4.5 6e-1",
    ] {
        assert_eq!(heights_of(text), plain, "{text}");
    }
    refused(
        HeightMapFormat::Text,
        b"1 2\r3 x\r",
        "line 2, column 3: `x`",
    );
}

#[test]
fn numbers_in_quotes_and_digits_in_groups_are_told() {
    let told = |text: &str, what: &str| refused(HeightMapFormat::Text, text.as_bytes(), what);
    told("\"0.5\",\"1\"\n", "quotes around numbers are not read");
    told("1 2\n'3' 4\n", "quotes around numbers are not read");
    told("1,234.5;2\n", "digits in groups are not read");
    told("1,234,567;2\n", "digits in groups are not read");
    told("\"a\",\"b\"\n", "a heading above the numbers is not read");
}

#[test]
fn lists_of_points_have_headings_and_separators_of_many_programs() {
    let list = points([5, 4], [2.0, 2.0]);
    let plain = heights_of(&list.join("\n"));
    for (heading, separator) in [
        ("//X Y Z", " "),
        ("X;Y;Z", ";"),
        ("# x, y, z", ", "),
        ("\"x\",\"y\",\"z\"", ","),
        ("% X\tY\tZ", "\t"),
    ] {
        let mut rows = vec![heading.to_owned()];
        rows.extend(list.iter().map(|row| row.replace(' ', separator)));
        let text = rows.join("\n");
        assert_eq!(heights_of(&text), plain, "{heading}");
        if separator != "," && separator != ", " {
            assert_eq!(heights_of(&text.replace('.', ",")), plain, "{heading}");
        }
    }
    let counted = |count: usize| format!("//X Y Z\n{count}\n{}\n", list.join("\n"));
    assert_eq!(heights_of(&counted(20)), plain);
    assert_eq!(heights_of(&counted(20)["//X Y Z\n".len()..]), plain);
    refused(
        HeightMapFormat::Text,
        counted(21).as_bytes(),
        "says 21 points, but 20 rows",
    );
    let more = |heading: &str| {
        let rows: Vec<String> = list.iter().map(|row| format!("{row} 0.5")).collect();
        format!("{heading}{}", rows.join("\n"))
    };
    for heading in ["", "//X Y Z Intensity\n"] {
        refused(
            HeightMapFormat::Text,
            more(heading).as_bytes(),
            "have 4 numbers, but three",
        );
    }
}

#[test]
fn comments_of_gwyddion_are_known_in_every_language() {
    let plain = heights_of(GWYDDION);
    for [channel, width, height, units] in [
        ["Kanal", "Breite", "H\u{f6}he", "Value units"],
        ["Canale", "Larghezza", "Altezza", "unit\u{e0} valore"],
        [
            "Canal\u{a0}",
            "Largeur\u{a0}",
            "Hauteur\u{a0}",
            "Unit\u{e9}s de valeur\u{a0}",
        ],
        [
            "Kan\u{e1}l",
            "\u{160}\u{ed}\u{159}ka",
            "V\u{fd}\u{161}ka",
            "Jednotky hodnot",
        ],
        [
            "\u{30c1}\u{30e3}\u{30f3}\u{30cd}\u{30eb}",
            "\u{5e45}",
            "\u{9ad8}\u{3055}",
            "\u{5024}\u{306e}\u{5358}\u{4f4d}",
        ],
    ] {
        let text = GWYDDION
            .replace("Channel", channel)
            .replace("Width", width)
            .replace("Height", height)
            .replace("Value units", units);
        let wide = text.replace("# Width:", "# Width\u{ff1a}");
        let latin: Vec<u8> = text
            .chars()
            .map(|c| u8::try_from(c).unwrap_or(b'?'))
            .collect();
        for bytes in [text.as_bytes(), wide.as_bytes(), &latin] {
            let map = read(HeightMapFormat::Text, bytes).unwrap();
            assert!(
                map.spacing_is_known() && map.unit == LengthUnit::Micrometre,
                "{text}"
            );
        }
        assert_eq!(heights_of(&text), plain);
        for unit in ["\u{c5}", "Pouces"] {
            let unknown = text.replace(" \u{b5}m", &format!(" {unit}"));
            let words = format!("`Width` is `50 {unit}`");
            refused(HeightMapFormat::Text, unknown.as_bytes(), &words);
        }
        let volts = text.replace("nm\n", "V\n");
        refused(
            HeightMapFormat::Text,
            volts.as_bytes(),
            "`Value units` is `V`",
        );
    }
    // Two lengths among other comments are no size.
    let other = "# Wavelength: 633 nm\n# Focus: 2 mm\n# Operator: Smith\n1 2\n3 4\n";
    assert!(
        !read(HeightMapFormat::Text, other.as_bytes())
            .unwrap()
            .spacing_is_known()
    );
}

#[test]
fn files_named_as_lists_of_points_are_lists_alone() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        crate::read_height_map(path)
    };
    let square = "0 0 1\n1 0 2\n0 1 3\n1 1 4\n";
    assert_eq!(read("square.xyz", square).unwrap().shape(), [2, 2]);
    // One place twice
    let twice = format!("{square}1 1 5\n");
    let error = read("twice.XYZ", &twice).unwrap_err().to_string();
    assert!(error.contains("points x, y, z"), "{error}");
    assert_eq!(read("twice.txt", &twice).unwrap().shape(), [5, 3]);
    let error = read("matrix.xyz", "1 2\n3 4\n").unwrap_err().to_string();
    assert!(error.contains("have 2 numbers, but three"), "{error}");
}
