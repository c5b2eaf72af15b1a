//! Text matrices: where errors are, and headers of instruments.

use asperity_surface::{Border, LengthUnit, MissingPolicy};

use super::{read, refused};
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
        let field = map
            .into_height_field(MissingPolicy::Refuse, Border::Mirrored)
            .unwrap();
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
    let field = map
        .into_height_field(MissingPolicy::Refuse, Border::Mirrored)
        .unwrap();
    assert_eq!(field.unit(), LengthUnit::Micrometre);
    assert_eq!(field.spacing(), [12.5, 10.25]);
    assert_eq!(field.heights()[1], 2.0 / 1000.0);

    for (old, new, words) in [
        ("Value units: nm", "Value units: V", "`Value units` is `V`"),
        ("# Value units: nm\n", "", "`Value units` is missing"),
        ("Width: 50 \u{b5}m", "Width: 50", "`Width` is `50`"),
        ("Width: 50 \u{b5}m", "Width: -1 m", "`Width` is `-1 m`"),
        ("# Width: 50 \u{b5}m\n", "", "`Width` is missing"),
    ] {
        refused(
            HeightMapFormat::Text,
            GWYDDION.replace(old, new).as_bytes(),
            words,
        );
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
    for (old, new, words) in [
        ("ncols 3", "ncols 4", "this row has 3 numbers, but 4"),
        ("nrows 2", "nrows 3", "3 rows were expected"),
        ("nrows 2", "nrows 4000000000", "claims"),
        ("ncols 3", "ncols x", "ncols is `x`"),
        ("cellsize 25", "cellsize 0", "cellsize is `0`"),
        ("cellsize 25\n", "", "no cellsize"),
    ] {
        refused(
            HeightMapFormat::Text,
            TERRAIN.replace(old, new).as_bytes(),
            words,
        );
    }
    let unequal = TERRAIN.replace("cellsize 25", "dx 2\ndy 3");
    let map = read(HeightMapFormat::Text, unequal.as_bytes()).unwrap();
    let field = map.into_height_field(MissingPolicy::Fill, Border::Open);
    assert_eq!(field.unwrap().spacing(), [2.0, 3.0]);
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
