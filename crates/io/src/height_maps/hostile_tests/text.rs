//! Text matrices: where errors are, and headers of instruments.

use asperity_surface::{Border, LengthUnit, MissingPolicy};

use super::{read, refused};
use crate::error::ReadError;
use crate::formats::HeightMapFormat;

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
